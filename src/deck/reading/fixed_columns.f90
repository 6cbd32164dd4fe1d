!> One line of a deck as fields in fixed columns, and what shows that its columns are shifted.
module fixed_columns
   use card_fields, only: last_text
   use card_formats, only: card_format_type, edit_card, edit_real, edit_skip, edit_tab, edit_type, &
      edit_whole
   use cards, only: field_type
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use fixed_numbers, only: number_fault, plain_number
   use text, only: to_text
   implicit none
   private
   public :: cut_line

   integer, parameter :: undescribed = 0   !! column of which the format says nothing
   integer, parameter :: skipped = -1      !! column that it passes over

   !> Where a field is.
   type :: column_field_type
      integer :: first = 0       !! first column
      integer :: last = 0        !! last column
      type(edit_type) :: edit    !! how it is read
   end type column_field_type

contains

   !> Cuts a line by a format from one of its edits on, until a number of fields is complete or the
   !> card ends. A shifted column is an error.
   subroutine cut_line(line, image, format, most, edit, fields, sound, report)
      character(*), intent(in) :: line                            !! card image
      integer, intent(in) :: image                                !! its running number
      type(card_format_type), intent(in) :: format
      integer, intent(in) :: most                                 !! fields that are due
      integer, intent(inout) :: edit                              !! where the format goes on
      type(field_type), allocatable, intent(out) :: fields(:)     !! the fields of this line
      logical, intent(out) :: sound       !! whether all whole numbers are well before an error
      type(deck_report_type), intent(inout) :: report             !! receives an error
      type(column_field_type) :: places(size(format%edits))
      integer :: owner(last_text(line) + 1), n, i, bad
      character(:), allocatable :: fault, text

      call place_fields(format, most, edit, owner, places, n)
      call find_fault(line, owner, bad, fault)
      do i = 1, n
         if (len(fault) > 0) exit
         call number_fault(columns(line, places(i)), places(i)%edit%kind == edit_whole, bad, fault)
         bad = places(i)%first + bad - 1
      end do
      sound = .true.
      allocate(fields(n))
      do i = 1, n
         text = columns(line, places(i))
         fields(i)%place = place_type(image, places(i)%first + max(verify(text, ' '), 1) - 1)
         fields(i)%text = plain_number(text, places(i)%edit%decimals, &
            places(i)%edit%kind == edit_real)
         if (len(fault) == 0) cycle
         if (places(i)%edit%kind == edit_real) fields(i)%text = '0'
         if (places(i)%edit%kind /= edit_whole) cycle
         sound = sound .and. bad > places(i)%last + 1 .and. len(fields(i)%text) > 0
      end do
      if (len(fault) > 0) call report%error(place_type(image, bad), fault)
   end subroutine cut_line

   !> The columns of the fields on a card, up to its end or until all are there that are due.
   pure subroutine place_fields(format, most, edit, owner, places, n)
      type(card_format_type), intent(in) :: format
      integer, intent(in) :: most
      integer, intent(inout) :: edit
      integer, intent(out) :: owner(:)   ! (columns) field, undescribed or skipped
      type(column_field_type), intent(inout) :: places(:)
      integer, intent(out) :: n
      integer :: column

      owner = undescribed
      column = 1
      n = 0
      do while (edit <= size(format%edits))
         associate (next => format%edits(edit))
            if (next%kind == edit_card) exit
            select case (next%kind)
            case (edit_skip)
               call mark(owner, column, column + next%width - 1, skipped)
               column = max(column + next%width, 1)
            case (edit_tab)
               call mark(owner, column, next%width - 1, skipped)
               column = next%width
            case default
               if (n < most) then
                  n = n + 1
                  places(n) = column_field_type(column, column + next%width - 1, next)
                  call mark(owner, places(n)%first, places(n)%last, n)
               end if
               column = column + next%width
            end select
         end associate
         edit = edit + 1
      end do
      edit = edit + 1
      if (edit > size(format%edits)) edit = format%again
   end subroutine place_fields

   pure subroutine mark(owner, first, last, value)
      integer, intent(inout) :: owner(:)
      integer, intent(in) :: first, last, value

      if (first <= size(owner)) owner(max(first, 1):min(last, size(owner))) = value
   end subroutine mark

   !> The first column that shows a shift: a tab, text that the format does not read, or a number
   !> that runs across an edge.
   pure subroutine find_fault(line, owner, bad, fault)
      character(*), intent(in) :: line
      integer, intent(in) :: owner(:)
      integer, intent(out) :: bad
      character(:), allocatable, intent(out) :: fault

      fault = ''
      do bad = 1, last_text(line)
         if (line(bad:bad) == ' ') cycle
         if (line(bad:bad) == achar(9)) then
            fault = 'tabs are not allowed on a card of fixed columns'
         else if (owner(bad) == undescribed) then
            fault = 'text where the format reads nothing: are the columns shifted? X in the '// &
               'format skips columns'
         else if (crosses(line, owner, bad)) then
            fault = 'a number runs across the edge between columns '//to_text(bad - 1)//' and '// &
               to_text(bad)//': are the columns shifted?'
         end if
         if (len(fault) > 0) return
      end do
   end subroutine find_fault

   !> Whether two neighbouring columns look like one number on both sides of an edge. A sign begins
   !> a number, and one that fills all its columns is close behind the one before.
   pure logical function crosses(line, owner, column)
      character(*), intent(in) :: line
      integer, intent(in) :: owner(:), column
      integer :: last

      crosses = .false.
      if (column == 1) return
      if (owner(column) == owner(column - 1)) return
      if (scan(line(column - 1:column - 1), '0123456789.+-') == 0) return
      if (scan(line(column:column), '0123456789.') == 0) return
      last = column
      do while (last < size(owner))
         if (owner(last + 1) /= owner(column)) exit
         last = last + 1
      end do
      crosses = last > len_trim(line)
      if (.not. crosses) crosses = index(line(column:last), ' ') > 0
   end function crosses

   !> The columns of a field, blank where the line has ended.
   pure function columns(line, place) result(text)
      character(*), intent(in) :: line
      type(column_field_type), intent(in) :: place
      character(place%last - place%first + 1) :: text

      text = ''
      if (place%first <= len(line)) text = line(place%first:min(place%last, len(line)))
   end function columns

end module fixed_columns
