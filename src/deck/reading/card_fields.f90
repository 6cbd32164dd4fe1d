!> One line of a deck as fields: between commas, with quotes heeded, or in the fixed columns of
!> FORMAT=, (Iw,nFw.d) and (nIw), with the signs of shifted columns.
module card_fields
   use cards, only: field_type, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use text, only: to_text, to_upper, without_blanks
   implicit none
   private
   public :: split_fields, drop_empty_end, without_quotes, is_comment, is_keyword, first_text, &
      last_text, fixed_columns_type, take_format, split_columns

   character(*), parameter :: blanks = ' '//achar(9)   !! what separates words

   integer, parameter :: most_columns = 10000   !! so that a typing error in a width is told
   character(*), parameter :: digits = '0123456789'

   !> The format of the keyword card that is open.
   type :: fixed_columns_type
      integer, allocatable :: last(:)   !! (fields) last column of each; unallocated for commas
      integer :: decimals = 0           !! digits behind the point of F where none is written
   end type fixed_columns_type

contains

   !> Whether a line is a comment card.
   pure logical function is_comment(line)
      character(*), intent(in) :: line   !! card image
      integer :: first

      first = first_text(line)
      is_comment = line(first:min(first + 1, len(line))) == '**'
   end function is_comment

   !> Whether a line begins a keyword card; comment cards are not asked for.
   pure logical function is_keyword(line)
      character(*), intent(in) :: line   !! card image
      integer :: first

      first = first_text(line)
      is_keyword = line(first:min(first, len(line))) == '*'
   end function is_keyword

   !> Position of the first character that is not blank; behind the line where there is none.
   pure integer function first_text(line)
      character(*), intent(in) :: line   !! card image

      first_text = verify(line, blanks)
      if (first_text == 0) first_text = len(line) + 1
   end function first_text

   !> Position of the last character that is not blank; 0 where there is none.
   pure integer function last_text(line)
      character(*), intent(in) :: line   !! card image

      last_text = verify(line, blanks, back=.true.)
   end function last_text

   !> Splits a line at its commas, but for those inside quotes. Quotes stay in the fields; one that
   !> is not closed is an error.
   subroutine split_fields(line, image, report, fields)
      character(*), intent(in) :: line                            !! card image
      integer, intent(in) :: image                                !! its running number
      type(deck_report_type), intent(inout) :: report             !! receives errors
      type(field_type), allocatable, intent(out) :: fields(:)     !! at least one field
      integer :: commas(len(line) + 1), i, n, first, opened, start

      opened = 0
      n = 0
      do i = 1, last_text(line)
         if (line(i:i) == '"') then
            opened = merge(i, 0, opened == 0)
         else if (line(i:i) == ',' .and. opened == 0) then
            n = n + 1
            commas(n) = i
         end if
      end do
      if (opened > 0) call report%error(place_type(image, opened), 'this quote is not closed')
      commas(n + 1) = last_text(line) + 1
      allocate(fields(n + 1))
      first = 1
      do i = 1, n + 1
         associate (part => line(first:commas(i) - 1))
            start = first_text(part)
            fields(i)%text = part(start:last_text(part))
            if (len(fields(i)%text) == 0) start = 1
            fields(i)%place = place_type(image, first + start - 1)
         end associate
         if (opened >= first .and. opened < commas(i)) then
            fields(i)%text = ''
            fields(i)%undefined = .true.
         end if
         first = commas(i) + 1
      end do
   end subroutine split_fields

   !> Drops the empty fields at the end of a card.
   subroutine drop_empty_end(fields)
      type(field_type), allocatable, intent(inout) :: fields(:)   !! fields of a card
      integer :: n

      do n = size(fields), 1, -1
         if (len(fields(n)%text) > 0 .or. fields(n)%undefined) exit
      end do
      if (n < size(fields)) fields = fields(:n)
   end subroutine drop_empty_end

   !> A text without the quotes around it.
   pure function without_quotes(string) result(bare)
      character(*), intent(in) :: string   !! text, quoted or not
      character(:), allocatable :: bare    !! what is between the quotes
      integer :: n

      n = len(string)
      bare = string
      if (n < 2) return
      if (string(1:1) /= '"' .or. string(n:n) /= '"') return
      bare = trim(adjustl(string(2:n - 1)))
   end function without_quotes

   !> Takes the format of a keyword card, which may have none.
   subroutine take_format(card, report, columns, valid)
      type(keyword_card_type), intent(in) :: card
      type(deck_report_type), intent(inout) :: report     !! receives an error
      type(fixed_columns_type), intent(out) :: columns    !! receives the format
      logical, intent(out) :: valid                       !! false after it: data cannot be read
      character(:), allocatable :: numbers, words, written
      integer :: i, part(4), status

      valid = .true.
      if (.not. card%has('FORMAT')) return
      words = to_upper(without_blanks(card%text('FORMAT')))
      numbers = words
      do i = 1, len(words)
         if (index(digits, words(i:i)) == 0) numbers(i:i) = ' '
      end do
      part = 0
      if (card%name == 'NODE') then
         read (numbers, *, iostat=status) part
         written = '(I'//to_text(part(1))//','//to_text(part(2))//'F'//to_text(part(3))//'.'// &
            to_text(part(4))//')'
         valid = part(1) > 0 .and. any(part(2) == [2, 3])
      else
         read (numbers, *, iostat=status) part(2:3)
         written = '('//to_text(part(2))//'I'//to_text(part(3))//')'
      end if
      valid = valid .and. status == 0 .and. written == words .and. minval(part(2:3)) > 0 .and. &
         maxval(part) <= most_columns
      if (valid) then
         columns%last = [(part(1) + i*part(3), i=1, part(2))]
         if (card%name == 'NODE') columns%last = [part(1), columns%last]
         columns%decimals = part(4)
      else
         call report%error(card%place_of('FORMAT'), trim(merge('a format of *NODE is '// &
            '(Iw,2Fw.d) or (Iw,3Fw.d), as in FORMAT="(I5,2F10.0)"', 'a format of *ELEMENT is '// &
            '(nIw), as in FORMAT="(5I5)"                      ', card%name == 'NODE')))
      end if
   end subroutine take_format

   !> Splits a line. The first sign of a shifted column is an error; then no field is known.
   subroutine split_columns(columns, line, image, report, fields, valid)
      type(fixed_columns_type), intent(in) :: columns
      character(*), intent(in) :: line                            !! card image
      integer, intent(in) :: image                                !! its running number
      type(deck_report_type), intent(inout) :: report             !! receives an error
      type(field_type), allocatable, intent(out) :: fields(:)
      logical, intent(out) :: valid                               !! false after an error
      character(:), allocatable :: fault, text
      integer :: bad, i, start

      allocate (fields(size(columns%last)))
      fault = ''
      start = columns%last(size(fields)) + 1
      if (last_text(line) >= start) then
         bad = start - 1 + verify(line(start:), ' ')
         fault = 'text where the format reads nothing'
      end if
      if (index(line, achar(9)) > 0) then
         bad = index(line, achar(9))
         fault = 'a tab on a card of fixed columns'
      end if
      start = 1
      do i = 1, size(fields)
         text = line(min(start, len(line) + 1):min(columns%last(i), len(line)))
         text = text//repeat(' ', columns%last(i) - start + 1 - len(text))
         if (len(fault) == 0) then
            call find_misplaced(text, bad, fault)
            bad = start + bad - 1
         end if
         fields(i)%text = trim(adjustl(text))
         if (i > 1) fields(i)%text = with_point(fields(i)%text, columns%decimals)
         fields(i)%place = place_type(image, start + max(verify(text, ' '), 1) - 1)
         start = columns%last(i) + 1
      end do
      valid = len(fault) == 0
      fields%undefined = .not. valid
      if (.not. valid) call report%error(place_type(image, bad), fault//': are the columns '// &
         'shifted?')
   end subroutine split_columns

   !> A number has no blank in it, and none behind it: in Fortran before 1977 such blanks were
   !> zeros. Its point makes both the same.
   pure subroutine find_misplaced(text, bad, fault)
      character(*), intent(in) :: text                   ! all columns of the field
      integer, intent(out) :: bad                        ! where the fault is in text
      character(:), allocatable, intent(out) :: fault    ! what is wrong, or empty
      character(:), allocatable :: number

      fault = ''
      number = trim(adjustl(text))
      bad = verify(text//'.', ' ') + index(number, ' ') - 1
      if (index(number, ' ') > 0) then
         fault = 'there is a blank inside this field'
      else if (len(number) > 0 .and. len_trim(text) < len(text) .and. &
         (index(number, '.') == 0 .or. scan(number, 'EeDd') > 0)) then
         bad = len_trim(text) + 1
         fault = 'the number must end in the last column of its field, because blanks after it '// &
            'may count as zeros'
      end if
   end subroutine find_misplaced

   !> Puts the point that a format implies into a number without one.
   pure function with_point(number, decimals) result(string)
      character(*), intent(in) :: number     ! without blanks
      integer, intent(in) :: decimals
      character(:), allocatable :: string
      character(:), allocatable :: whole
      integer :: first

      string = number
      first = verify(number, '+-')
      if (decimals == 0 .or. first == 0 .or. first > 2) return
      whole = number(first:)
      if (verify(whole, digits) > 0) return
      whole = repeat('0', max(decimals + 1 - len(whole), 0))//whole
      string = number(:first - 1)//whole(:len(whole) - decimals)//'.'// &
         whole(len(whole) - decimals + 1:)
   end function with_point

end module card_fields
