!> A Fortran format, such as (I5,2F10.0), as a list of what it reads and passes over.
module card_formats
   use text, only: read_integer, to_text, to_upper
   implicit none
   private
   public :: card_format_type, edit_type, parse_format
   public :: edit_whole, edit_real, edit_skip, edit_tab, edit_card, unquoted_format

   integer, parameter :: edit_whole = 1   !! I: a whole number
   integer, parameter :: edit_real = 2    !! F, E, D, G: a number
   integer, parameter :: edit_skip = 3    !! X, TL, TR: columns passed over, forward or back
   integer, parameter :: edit_tab = 4     !! T: go to a column
   integer, parameter :: edit_card = 5    !! a slash: go on with the next card

   integer, parameter :: most_edits = 1000   !! so that a slip in a repeat count is told
   integer, parameter :: most_columns = 10000   !! and one in a width
   integer, parameter :: most_depth = 8      !! groups in each other

   !> What is wrong with a format that does not begin as one.
   character(*), parameter :: unquoted_format = &
      'write a format in parentheses and quotes, as in FORMAT="(I5,2F10.0)"'

   !> One edit descriptor.
   type :: edit_type
      integer :: kind = 0       !! edit_whole, ...
      integer :: width = 0      !! columns; of edit_tab the column
      integer :: decimals = 0   !! digits behind the point where none is written
   end type edit_type

   !> A format with its groups and repeat counts written out.
   type :: card_format_type
      type(edit_type), allocatable :: edits(:)   !! what it does, in order
      integer :: again = 1                       !! where it goes on when it ends and fields are due
   end type card_format_type

contains

   !> Parses a format.
   pure subroutine parse_format(string, format, position, fault)
      character(*), intent(in) :: string                   !! with its brackets
      type(card_format_type), intent(out) :: format        !! what it says
      integer, intent(out) :: position                     !! where the fault is in string
      character(:), allocatable, intent(out) :: fault      !! what is wrong, or empty
      type(edit_type) :: edits(most_edits)
      character(:), allocatable :: upper
      integer :: n

      fault = ''
      position = 1
      allocate(format%edits(0))
      upper = to_upper(string)
      call skip_blanks(upper, position)
      if (character_at(upper, position) /= '(') then
         fault = unquoted_format
         return
      end if
      n = 0
      position = position + 1
      call parse_group(upper, 1, edits, n, format%again, position, fault)
      if (len(fault) > 0) return
      call skip_blanks(upper, position)
      if (position <= len(string)) then
         fault = 'text after the format'
      else if (.not. any(edits(format%again:n)%kind == edit_whole .or. &
         edits(format%again:n)%kind == edit_real)) then
         fault = 'the format reads nothing'
      else if (edits(n)%kind == edit_card) then
         fault = 'the format ends in a slash: no card is skipped'
      end if
      deallocate(format%edits)
      format%edits = edits(:n)
   end subroutine parse_format

   !> Parses up to the bracket that closes the group, and behind it.
   pure recursive subroutine parse_group(string, depth, edits, n, again, position, fault)
      character(*), intent(in) :: string
      integer, intent(in) :: depth
      type(edit_type), intent(inout) :: edits(:)
      integer, intent(inout) :: n, again, position
      character(:), allocatable, intent(inout) :: fault
      integer :: repeats, start

      do
         call skip_separators(string, position)
         if (position > len(string)) then
            fault = 'the format lacks a closing bracket'
            return
         end if
         if (string(position:position) == ')') exit
         start = position
         call take_number(string, 1, position, repeats)
         call skip_blanks(string, position)
         if (character_at(string, position) == '(') then
            if (depth == 1) again = n + 1
            start = n + 1
            position = position + 1
            if (depth == most_depth) fault = 'too many brackets'
            if (len(fault) == 0) call parse_group(string, depth + 1, edits, n, again, position, &
               fault)
            call repeat_edits(start, repeats, edits, n, fault)
         else
            call parse_edit(string, start, repeats, edits, n, position, fault)
         end if
         if (len(fault) > 0) return
      end do
      position = position + 1
   end subroutine parse_group

   !> Parses one descriptor behind its repeat count.
   pure subroutine parse_edit(string, start, repeats, edits, n, position, fault)
      character(*), intent(in) :: string
      integer, intent(in) :: start, repeats
      type(edit_type), intent(inout) :: edits(:)
      integer, intent(inout) :: n, position
      character(:), allocatable, intent(inout) :: fault
      character :: letter
      type(edit_type) :: edit
      integer :: times, exponent_digits

      letter = character_at(string, position)
      times = repeats
      position = position + 1
      select case (letter)
      case ('I')
         call take_number(string, 0, position, edit%width)
         call take_decimals(string, position, edit%decimals)
         edit = edit_type(edit_whole, edit%width, 0)
      case ('F', 'E', 'D', 'G')
         edit%kind = edit_real
         call take_number(string, 0, position, edit%width)
         call take_decimals(string, position, edit%decimals)
         if (letter /= 'F' .and. character_at(string, position) == 'E') then
            position = position + 1
            call take_number(string, 0, position, exponent_digits)
         end if
      case ('X')
         edit = edit_type(edit_skip, repeats, 0)
         times = 1
      case ('T')
         call parse_tab(string, position, edit)
      case ('/')
         edit = edit_type(edit_card, 1, 0)
      case default
         edit%kind = 0
      end select
      if (edit%kind == 0 .or. edit%width == 0 .or. edit%width > most_columns) then
         fault = 'in the format '''//string(start:min(position - 1, len(string)))// &
            ''' is no I, F, E, D, G, X, T or slash with a width'
         position = start
         return
      end if
      n = n + 1
      if (n > size(edits)) fault = 'the format reads more than '//to_text(most_edits)//' fields'
      if (len(fault) > 0) return
      edits(n) = edit
      call repeat_edits(n, times, edits, n, fault)
   end subroutine parse_edit

   !> T goes to a column, TL and TR go back and forward.
   pure subroutine parse_tab(string, position, edit)
      character(*), intent(in) :: string
      integer, intent(inout) :: position
      type(edit_type), intent(inout) :: edit
      integer :: sign

      edit%kind = edit_tab
      sign = index('LR', character_at(string, position))
      if (sign > 0) then
         edit%kind = edit_skip
         position = position + 1
      end if
      call take_number(string, 0, position, edit%width)
      if (sign == 1) edit%width = -edit%width
   end subroutine parse_tab

   !> Repeats the edits from one on.
   pure subroutine repeat_edits(first, times, edits, n, fault)
      integer, intent(in) :: first, times
      type(edit_type), intent(inout) :: edits(:)
      integer, intent(inout) :: n
      character(:), allocatable, intent(inout) :: fault
      integer :: length, i

      if (len(fault) > 0) return
      length = n - first + 1
      if (times < 1) fault = 'a repeat count of 0'
      if (length > 0 .and. times > (size(edits) - first + 1)/max(length, 1)) fault = &
         'the format reads more than '//to_text(most_edits)//' fields'
      if (len(fault) > 0) return
      do i = 2, times
         edits(n + 1:n + length) = edits(first:first + length - 1)
         n = n + length
      end do
   end subroutine repeat_edits

   !> A number where one is, else the default.
   pure subroutine take_number(string, default, position, number)
      character(*), intent(in) :: string
      integer, intent(in) :: default
      integer, intent(inout) :: position
      integer, intent(out) :: number
      integer :: first
      logical :: valid

      call skip_blanks(string, position)
      first = position
      do while (scan(character_at(string, position), '0123456789') > 0)
         position = position + 1
      end do
      number = default
      if (position == first) return
      call read_integer(string(first:position - 1), number, valid)
      if (.not. valid) number = huge(number)
   end subroutine take_number

   !> The digits behind the point of F10.3; 0 where none are.
   pure subroutine take_decimals(string, position, decimals)
      character(*), intent(in) :: string
      integer, intent(inout) :: position
      integer, intent(out) :: decimals

      decimals = 0
      if (character_at(string, position) /= '.') return
      position = position + 1
      call take_number(string, 0, position, decimals)
      decimals = min(decimals, most_columns)
   end subroutine take_decimals

   pure subroutine skip_blanks(string, position)
      character(*), intent(in) :: string
      integer, intent(inout) :: position

      do while (position <= len(string))
         if (string(position:position) /= ' ') return
         position = position + 1
      end do
   end subroutine skip_blanks

   pure subroutine skip_separators(string, position)
      character(*), intent(in) :: string
      integer, intent(inout) :: position

      do while (position <= len(string))
         if (scan(string(position:position), ' ,') == 0) return
         position = position + 1
      end do
   end subroutine skip_separators

   !> A character, or a blank behind the end.
   pure character function character_at(string, position)
      character(*), intent(in) :: string
      integer, intent(in) :: position

      character_at = ' '
      if (position <= len(string)) character_at = string(position:position)
   end function character_at

end module card_formats
