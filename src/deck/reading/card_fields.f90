!> One line of a deck as fields between commas, with quotes heeded.
module card_fields
   use cards, only: field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use text, only: to_upper, without_blanks
   implicit none
   private
   public :: split_fields, drop_empty_end, without_quotes
   public :: is_comment, is_keyword, first_text, last_text

   character(*), parameter :: blanks = ' '//achar(9)   !! what separates words

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

   !> Splits a line at its commas. Quotes stay in the fields, but for one that is not closed; a
   !> comma inside quotes, but for those of FORMAT= and SOURCE=, and a quote without its end are
   !> errors.
   subroutine split_fields(line, image, report, fields)
      character(*), intent(in) :: line                            !! card image
      integer, intent(in) :: image                                !! its running number
      type(deck_report_type), intent(inout) :: report             !! receives errors
      type(field_type), allocatable, intent(out) :: fields(:)     !! at least one field
      integer :: commas(len(line) + 1)
      integer :: i, n, first, opened, start, told
      logical :: holds_commas

      holds_commas = .false.
      told = 0
      opened = 0
      n = 0
      do i = 1, last_text(line)
         if (line(i:i) == '"') then
            opened = merge(i, 0, opened == 0)
            first = 1
            if (n > 0) first = commas(n) + 1
            if (opened > 0) holds_commas = any(to_upper(without_blanks(line(first:i - 1))) == &
               ['FORMAT=', 'SOURCE='])
         else if (line(i:i) == ',') then
            if (opened > 0 .and. holds_commas) then
               cycle
            else if (opened > 0) then
               if (opened /= told) call report%error(place_type(image, i), &
                  'commas are not allowed inside quotes; write blanks instead')
               told = opened
            else
               n = n + 1
               commas(n) = i
            end if
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

end module card_fields
