!> Data cards of *NODE and *ELEMENT in the fixed columns of FORMAT=, such as (I5,2F10.0): lines ->
!> fields, and the signs of shifted columns.
module fixed_columns
   use card_fields, only: last_text
   use card_parameters, only: has_parameter, parameter_place, parameter_text
   use cards, only: field_type, keyword_card_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: fixed_columns_type, edit_type, parse_format
   public :: edit_whole, edit_real, edit_skip

   integer, parameter :: edit_whole = 1   !! I: a whole number
   integer, parameter :: edit_real = 2    !! F, E: a number
   integer, parameter :: edit_skip = 3    !! X: columns passed over

   integer, parameter :: most_edits = 1000      !! so that a slip in a repeat count is told
   integer, parameter :: most_columns = 10000   !! and one in a width
   integer, parameter :: least_of_node = 3, most_of_node = 4   !! number, x, y, z

   integer, parameter :: undescribed = 0   !! column of which the format says nothing
   integer, parameter :: skipped = -1      !! column that it passes over

   character(*), parameter :: digits = '0123456789'

   !> Fault of a format that does not begin as one.
   character(*), parameter :: unquoted_format = &
      'write a format in parentheses and quotes, as in FORMAT="(I5,2F10.0)"'

   !> One edit descriptor.
   type :: edit_type
      integer :: kind = 0       !! edit_whole, ...
      integer :: width = 0      !! columns
      integer :: decimals = 0   !! digits behind the point where none is written
   end type edit_type

   !> The format of the keyword card that is open, and the card that is not complete yet. The format
   !> begins anew on each line.
   type :: fixed_columns_type
      private
      logical, public :: open = .false.             !! whether the keyword card has a format
      type(edit_type), allocatable :: edits(:)      !! the format, its repeats written out
      integer :: due = 0                            !! fields of a complete card
      integer :: count = 0                          !! those so far
      logical :: sound = .true.                     !! whether the card can be used
      type(field_type), allocatable :: fields(:)    !! (due) its fields
   contains
      procedure :: begin
      procedure :: take
      procedure :: release
   end type fixed_columns_type

contains

   !> Begins a keyword card, which may have a format.
   subroutine begin(self, card, element_fields, report, valid)
      class(fixed_columns_type), intent(out) :: self      !! receives the format
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: element_fields               !! of an *ELEMENT; 0 for an unknown type
      type(deck_report_type), intent(inout) :: report     !! receives an error
      logical, intent(out) :: valid                       !! false after it: data cannot be read
      integer, allocatable :: kinds(:)
      character(:), allocatable :: fault
      type(place_type) :: place
      integer :: position

      valid = .true.
      self%open = has_parameter(card, 'FORMAT')
      if (.not. self%open) return
      place = parameter_place(card, 'FORMAT')
      call parse_format(parameter_text(card, 'FORMAT'), self%edits, position, fault)
      kinds = pack(self%edits%kind, self%edits%kind /= edit_skip)
      self%due = size(kinds)
      if (report%source%images(place%image)%value(place%column:place%column) /= '"') then
         fault = unquoted_format
      else if (len(fault) > 0) then
         place%column = place%column + position
      else if (card%name == 'ELEMENT') then
         if (element_fields > 0) self%due = element_fields
         if (any(kinds == edit_real)) fault = 'FORMAT= of *ELEMENT reads whole numbers, I'
      else if (self%due < least_of_node .or. self%due > most_of_node .or. &
         kinds(1) /= edit_whole .or. any(kinds(2:) /= edit_real)) then
         fault = 'FORMAT= of *NODE reads a whole number, I, and x, y and perhaps z, F'
      end if
      valid = len(fault) == 0
      if (.not. valid) call report%error(place, fault)
   end subroutine begin

   !> Parses a format.
   pure subroutine parse_format(string, edits, position, fault)
      character(*), intent(in) :: string                       !! with its brackets
      type(edit_type), allocatable, intent(out) :: edits(:)    !! its repeats written out
      integer, intent(out) :: position                         !! where the fault is in string
      character(:), allocatable, intent(out) :: fault          !! what is wrong, or empty
      character(:), allocatable :: upper
      type(edit_type) :: edit
      integer :: start, times

      ! The blank ends a number at the end of the string.
      upper = to_upper(string)//' '
      allocate(edits(0))
      fault = ''
      position = max(verify(upper, ' '), 1)
      if (upper(position:position) /= '(') fault = unquoted_format
      do while (len(fault) == 0)
         position = min(position + verify(upper(position + 1:)//')', ' ,'), len(upper))
         if (position > len(string)) fault = 'the format lacks a closing bracket'
         if (position > len(string) .or. upper(position:position) == ')') exit
         start = position
         call parse_edit(upper, position, edit, times)
         if (edit%kind == 0) then
            fault = edit_fault(upper(start:start + scan(upper(start:), ' ,)') - 2))
         else if (size(edits) + times > most_edits) then
            fault = 'the format reads more than '//to_text(most_edits)//' fields'
         else
            edits = [edits, spread(edit, 1, times)]
         end if
         if (len(fault) > 0) position = start
      end do
      if (len(fault) > 0) return
      if (verify(upper(position + 1:), ' ') > 0) then
         position = position + verify(upper(position + 1:), ' ')
         fault = 'text after the format'
      else if (all(edits%kind == edit_skip)) then
         fault = 'the format reads nothing'
      end if
   end subroutine parse_format

   !> Parses one descriptor with its repeat count; its kind is 0 where it is none.
   pure subroutine parse_edit(string, position, edit, times)
      character(*), intent(in) :: string        ! in upper case, a blank at its end
      integer, intent(inout) :: position        ! first character -> last
      type(edit_type), intent(out) :: edit
      integer, intent(out) :: times
      integer, parameter :: kinds(4) = [edit_whole, edit_real, edit_real, edit_skip]
      integer :: kind

      call parse_number(string, 1, position, times)
      position = min(position + verify(string(position:)//')', ' ') - 1, len(string))
      kind = index('IFEX', string(position:position))
      if (kind == 0) return
      position = position + 1
      if (kinds(kind) == edit_skip) then
         edit%width = times
         times = 1
      else
         call parse_number(string, 0, position, edit%width)
         if (string(position:position) == '.') then
            position = position + 1
            call parse_number(string, 0, position, edit%decimals)
         end if
      end if
      position = position - 1
      if (min(edit%width, times) > 0 .and. max(edit%width, edit%decimals) <= most_columns) then
         edit%kind = kinds(kind)
      end if
   end subroutine parse_edit

   !> A number where one is, else the default.
   pure subroutine parse_number(string, default, position, number)
      character(*), intent(in) :: string
      integer, intent(in) :: default
      integer, intent(inout) :: position   ! moves behind the number
      integer, intent(out) :: number
      integer :: length
      logical :: valid

      length = verify(string(position:), digits) - 1
      number = default
      if (length == 0) return
      call read_integer(string(position:position + length - 1), number, valid)
      number = merge(min(number, most_columns + 1), most_columns + 1, valid)
      position = position + length
   end subroutine parse_number

   !> Message on an unknown descriptor, and what to write in its place.
   pure function edit_fault(words) result(fault)
      character(*), intent(in) :: words
      character(:), allocatable :: fault
      integer :: first

      fault = ''''//words//''' in the format is no I, F, E or X with a width'
      first = max(verify(words, digits), 1)
      select case (words(first:first))
      case ('D', 'G')
         fault = fault//'; write E, which reads the same numbers'
      case ('T')
         fault = fault//'; skip columns by X, as in 5X'
      case ('(')
         fault = fault//'; write a group out, as in 1X,F10.0,1X,F10.0'
      case ('/')
         fault = fault//'; leave it out: the format begins anew on each line'
      case default
         return
      end select
   end function edit_fault

   !> Takes one line. A shifted column is an error.
   subroutine take(self, line, image, report, complete)
      class(fixed_columns_type), intent(inout) :: self    !! the format
      character(*), intent(in) :: line                    !! card image
      integer, intent(in) :: image                        !! its running number
      type(deck_report_type), intent(inout) :: report     !! receives an error
      logical, intent(out) :: complete                    !! whether all fields that are due are
      character(:), allocatable :: fault, text
      integer :: owner(last_text(line) + 1)   ! (columns) field, undescribed or skipped
      integer :: bad, column, i, last

      if (.not. allocated(self%fields)) allocate(self%fields(self%due))
      owner = undescribed
      fault = ''
      last = 0
      do i = 1, size(self%edits)
         column = last + 1
         last = last + self%edits(i)%width
         associate (owned => owner(min(column, size(owner) + 1):min(last, size(owner))))
            if (self%edits(i)%kind == edit_skip) owned = skipped
            if (self%edits(i)%kind == edit_skip .or. self%count == self%due) cycle
            self%count = self%count + 1
            owned = self%count
         end associate
         text = line(min(column, len(line) + 1):min(last, len(line)))
         text = text//repeat(' ', last - column + 1 - len(text))
         self%fields(self%count)%place = place_type(image, column + max(verify(text, ' '), 1) - 1)
         self%fields(self%count)%text = plain_number(text, self%edits(i))
         if (len(fault) > 0) cycle
         call find_misplaced(text, self%edits(i)%kind == edit_whole, bad, fault)
         bad = column + bad - 1
      end do
      call find_shift(line, owner, bad, fault)
      if (len(fault) > 0) call report%error(place_type(image, bad), fault)
      self%sound = self%sound .and. len(fault) == 0
      complete = self%count == self%due
   end subroutine take

   !> Hands over the fields of a card, complete or not; none where there is no card, or none that
   !> can be used.
   subroutine release(self, fields)
      class(fixed_columns_type), intent(inout) :: self         !! the format
      type(field_type), allocatable, intent(out) :: fields(:)  !! the fields; unallocated for none

      if (self%sound .and. self%count > 0) fields = self%fields(:self%count)
      self%sound = .true.
      self%count = 0
   end subroutine release

   !> The first column that shows a shift: a tab, text that the format does not read, or a number
   !> that runs across an edge. It is told before other faults of the line.
   pure subroutine find_shift(line, owner, bad, fault)
      character(*), intent(in) :: line
      integer, intent(in) :: owner(:)
      integer, intent(inout) :: bad
      character(:), allocatable, intent(inout) :: fault
      integer :: i

      do i = 1, last_text(line)
         if (line(i:i) == ' ') cycle
         if (line(i:i) == achar(9)) then
            fault = 'tabs are not allowed on a card of fixed columns'
         else if (owner(i) == undescribed) then
            fault = 'text where the format reads nothing: are the columns shifted? X in the '// &
               'format skips columns'
         else if (crosses(line, owner, i)) then
            fault = 'a number runs across the edge between columns '//to_text(i - 1)//' and '// &
               to_text(i)//': are the columns shifted?'
         else
            cycle
         end if
         bad = i
         return
      end do
   end subroutine find_shift

   !> Whether two neighbouring columns look like one number on both sides of an edge. A sign begins
   !> a number, and one that fills all its columns is close behind the one before.
   pure logical function crosses(line, owner, column)
      character(*), intent(in) :: line
      integer, intent(in) :: owner(:), column
      integer :: last

      crosses = .false.
      if (column == 1) return
      if (owner(column) == owner(column - 1)) return
      if (scan(line(column - 1:column - 1), digits//'.+-') == 0) return
      if (scan(line(column:column), digits//'.') == 0) return
      last = findloc(owner, owner(column), dim=1, back=.true.)
      crosses = last > len_trim(line)
      if (.not. crosses) crosses = index(line(column:last), ' ') > 0
   end function crosses

   !> Checks the place of a number in its field. In Fortran before 1977 blanks behind a
   !> number were zeros, later they count for nothing: such a number is valid only where its
   !> point makes both the same.
   pure subroutine find_misplaced(text, whole, bad, fault)
      character(*), intent(in) :: text                   ! all columns of the field
      logical, intent(in) :: whole                       ! whether the format is I
      integer, intent(out) :: bad                        ! where the fault is in text
      character(:), allocatable, intent(out) :: fault    ! what is wrong, or empty
      character(:), allocatable :: number
      integer :: blank

      fault = ''
      number = with_signed_exponent(trim(adjustl(text)))
      blank = index(number, ' ')
      bad = verify(text//'.', ' ') + blank - 1
      if (blank > 0) then
         fault = 'there is a blank inside this field: are the columns shifted?'
      else if (len(number) > 0 .and. len_trim(text) < len(text) .and. (whole .or. &
         index(number, '.') == 0 .or. scan(number, 'EeDd') + scan(number(2:), '+-') > 0)) then
         bad = len_trim(text) + 1
         fault = 'the number must end in the last column of its field, because blanks after it '// &
            'may count as zeros: are the columns shifted?'
      end if
   end subroutine find_misplaced

   !> A number as it is on a card of fields between commas: with the point that the format implies
   !> and an E before the exponent. What is no number stays as it is.
   pure function plain_number(text, edit) result(number)
      character(*), intent(in) :: text         ! all columns of the field
      type(edit_type), intent(in) :: edit
      character(:), allocatable :: number      ! without blanks around it
      character(:), allocatable :: whole
      integer :: first, last, mark

      number = with_signed_exponent(trim(adjustl(text)))
      if (edit%kind == edit_whole .or. len(number) == 0) return
      mark = scan(number(2:), '+-') + 1
      if (mark > 1 .and. scan(number, 'EeDd') == 0 .and. index(number, '.') > 0) number = &
         number(:mark - 1)//'E'//number(mark:)
      first = verify(number, '+-')
      last = scan(number//'E', 'EeDd') - 1
      if (edit%decimals == 0 .or. first == 0 .or. first > min(2, last)) return
      whole = number(first:last)
      if (verify(whole, digits) > 0) return
      whole = repeat('0', max(edit%decimals + 1 - len(whole), 0))//whole
      mark = len(whole) - edit%decimals
      number = number(:first - 1)//whole(:mark)//'.'//whole(mark + 1:)//number(last + 1:)
   end function plain_number

   !> Old machines print 1.5E 03: the blank is the sign of the exponent.
   pure function with_signed_exponent(number) result(signed)
      character(*), intent(in) :: number
      character(:), allocatable :: signed
      integer :: mark

      signed = number
      mark = scan(number, 'EeDd')
      if (mark == 0 .or. mark + 1 >= len(number)) return
      if (number(mark + 1:mark + 1) == ' ' .and. scan(number(mark + 2:mark + 2), digits) == 1) then
         signed(mark + 1:mark + 1) = '+'
      end if
   end function with_signed_exponent

end module fixed_columns
