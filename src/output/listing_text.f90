!> Text of the listing: titles, wrapped lines, numbers in columns, the echo of the deck.
!>
!> Fortran's own statements print it into memory, from where it is taken: whether it then finds room
!> in a file is seen in one place, and so are its control characters.
module listing_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use errors, only: error_type, set_error, status_internal
   use file_calls, only: read_file
   use kinds, only: dp, long
   use open_files, only: close_descriptor, open_in_memory
   use quantity_types, only: quantity_type
   use text, only: string_type, to_text
   use utf8, only: printable
   use zone_diagram, only: zone_numeral
   implicit none
   private
   public :: page_width, print_title, print_wrapped, print_list, print_deck
   public :: column, in_columns, table_cell, table_head, printed_text_type

   integer, parameter :: page_width = 132   !! columns of the line printer

   !> Text that waits to be taken.
   type :: printed_text_type
      integer :: unit = 0                               !! Fortran unit to print on
      integer, private :: descriptor = -1               !! of the file in memory
      character(:), allocatable, private :: path        !! by which Fortran opens it
   contains
      procedure :: open => open_text
      procedure :: take
      procedure :: close => close_text
   end type printed_text_type

contains

   !> Prints a title, underlined.
   subroutine print_title(unit, title)
      integer, intent(in) :: unit         !! unit of the listing
      character(*), intent(in) :: title   !! the title

      write (unit, '(/, a, /, a)') title, repeat('-', len(title))
   end subroutine print_title

   !> A number in a column, with a blank before it: decimals are left out where it would not fit
   !> otherwise, exponents of three digits keep their E, and zero has no sign.
   pure function column(value, width, decimals) result(string)
      real(dp), intent(in) :: value      !! the number
      integer, intent(in) :: width       !! columns, at least 9
      integer, intent(in) :: decimals    !! digits behind the point where they fit, at most 9
      character(width) :: string         !! such as '  1.350E+00'
      character(40) :: buffer
      character(10) :: edit
      integer :: digits, places
      logical :: is_sure

      if (.not. ieee_is_finite(value)) then
         write (buffer, '(es40.2)') value
         string = buffer(41 - width:)
         return
      end if
      digits = 2
      if (abs(value) >= 1.0e99_dp .or. (abs(value) > 0.0_dp .and. abs(value) < 1.0e-99_dp)) then
         digits = 3
      end if
      ! Beside the places there are a blank, a minus, a digit, the point, E and a sign.
      places = min(decimals, width - digits - merge(6, 5, value < 0.0_dp))
      if (abs(value) > 0.0_dp) then
         call write_digits(value, places, buffer, is_sure)
         if (is_sure) then
            string = buffer(41 - width:)
            return
         end if
         edit = '(es40.#e#)'
         edit(7:7) = digit(places)
         edit(9:9) = digit(digits)
         write (buffer, edit) value
      else
         buffer = '0.'//repeat('0', places)//'E+00'
         buffer = adjustr(buffer)
      end if
      string = buffer(41 - width:)
   end function column

   !> A number as es40 writes it, by arithmetic: tables are thousands of numbers, and Fortran's
   !> statement takes fifty times as long. Not sure of numbers of extreme size and where rounding of
   !> the arithmetic might show.
   pure subroutine write_digits(value, places, buffer, is_sure)
      real(dp), intent(in) :: value
      integer, intent(in) :: places        !! digits behind the point, at most 9
      character(40), intent(out) :: buffer
      logical, intent(out) :: is_sure
      real(dp), parameter :: sizes(2) = [1.0e-30_dp, 1.0e30_dp], near_tie = 1.0e-3_dp
      real(dp) :: scaled
      integer :: exponent, i
      integer(long) :: rest

      buffer = ''
      is_sure = abs(value) > sizes(1) .and. abs(value) < sizes(2)
      if (.not. is_sure) return
      exponent = floor(log10(abs(value)))
      scaled = abs(value)*10.0_dp**(places - exponent)
      rest = nint(scaled, long)
      is_sure = abs(scaled - aint(scaled) - 0.5_dp) > near_tie .and. rest >= 10_long**places .and. &
         rest < 10_long**(places + 1)
      if (.not. is_sure) return
      buffer(37:40) = 'E'//merge('-', '+', exponent < 0)//digit(abs(exponent)/10)// &
         digit(mod(abs(exponent), 10))
      do i = 36, 37 - places, -1
         buffer(i:i) = digit(int(mod(rest, 10_long)))
         rest = rest/10
      end do
      buffer(36 - places:36 - places) = '.'
      buffer(35 - places:35 - places) = digit(int(rest))
      if (value < 0.0_dp) buffer(34 - places:34 - places) = '-'
   end subroutine write_digits

   !> A number below 10 as a character.
   pure character function digit(number)
      integer, intent(in) :: number

      digit = achar(iachar('0') + number)
   end function digit

   !> A quantity in its column of a table: zones by their numerals, integers to the right, plain
   !> numbers with six decimals.
   pure function table_cell(quantity, value) result(string)
      type(quantity_type), intent(in) :: quantity   !! which one; has a column
      real(dp), intent(in) :: value                 !! its value
      character(quantity%width) :: string

      if (quantity%is_integer) then
         string = to_text(nint(value))
         if (quantity%name == 'status') string = zone_numeral(nint(value))
         string = adjustr(string)
      else if (quantity%is_plain) then
         write (string, '(f'//to_text(quantity%width)//'.6)') value
      else
         string = column(value, quantity%width, 3)
      end if
   end function table_cell

   !> The head of the column of a quantity.
   pure function table_head(quantity) result(string)
      type(quantity_type), intent(in) :: quantity   !! which one; has a column
      character(quantity%width) :: string

      string = quantity%head
      string = adjustr(string)
   end function table_head

   !> Numbers in columns side by side.
   pure function in_columns(values, width, decimals) result(string)
      real(dp), intent(in) :: values(:)          !! (n) the numbers
      integer, intent(in) :: width               !! columns of each, at least 9
      integer, intent(in) :: decimals            !! digits behind the point where they fit
      character(width*size(values)) :: string    !! as from column
      integer :: i

      do i = 1, size(values)
         string(width*(i - 1) + 1:width*i) = column(values(i), width, decimals)
      end do
   end function in_columns

   !> Prints text under a mark, broken at blanks.
   subroutine print_wrapped(unit, mark, string)
      integer, intent(in) :: unit          !! unit of the listing
      character(*), intent(in) :: mark     !! what is before the first line
      character(*), intent(in) :: string   !! the text
      integer :: first, last, room

      room = max(page_width - len(mark), page_width/2)
      first = 1
      do
         last = len_trim(string)
         if (last - first + 1 > room) then
            last = first - 1 + index(string(first:first + room), ' ', back=.true.)
            if (last < first) last = first + room - 1
         end if
         if (first == 1) then
            write (unit, '(2a)') mark, trim(string(first:last))
         else
            write (unit, '(2a)') repeat(' ', len(mark)), trim(string(first:last))
         end if
         first = last + 1
         if (first > len_trim(string)) exit
      end do
   end subroutine print_wrapped

   !> Prints a list of texts under a title; nothing for an empty list.
   subroutine print_list(unit, title, list)
      integer, intent(in) :: unit                            !! unit of the listing
      character(*), intent(in) :: title                      !! the title
      type(string_type), allocatable, intent(in) :: list(:)  !! the texts, or unallocated
      integer :: i

      if (.not. allocated(list)) return
      if (size(list) == 0) return
      call print_title(unit, title)
      do i = 1, size(list)
         call print_wrapped(unit, '   - ', list(i)%value)
      end do
   end subroutine print_list

   !> Prints the card images with their numbers; a card that is wider than the page goes on below.
   subroutine print_deck(unit, cards)
      integer, intent(in) :: unit                   !! unit of the listing
      type(string_type), intent(in) :: cards(:)     !! card images as read
      integer, parameter :: room = page_width - 10
      integer :: i, first

      call print_title(unit, 'DECK')
      do i = 1, size(cards)
         associate (card => cards(i)%value)
            write (unit, '(i8, 2x, a)') i, card(:min(len(card), room))
            do first = room + 1, len(card), room
               write (unit, '(10x, a)') card(first:min(len(card), first + room - 1))
            end do
         end associate
      end do
   end subroutine print_deck

   !> Opens a text in memory.
   !> Error: status_internal, when the system opens no file there.
   subroutine open_text(self, error)
      class(printed_text_type), intent(inout) :: self     !! the text, empty
      type(error_type), allocatable, intent(out) :: error
      character(200) :: reason
      integer :: status

      call open_in_memory(self%descriptor, self%path, error)
      if (allocated(error)) return
      open (newunit=self%unit, file=self%path, status='old', action='readwrite', iostat=status, &
         iomsg=reason)
      if (status /= 0) call set_error(error, status_internal, trim(reason))
   end subroutine open_text

   !> Takes all lines that were printed since the last time.
   subroutine take(self, lines)
      class(printed_text_type), intent(inout) :: self
      character(:), allocatable, intent(out) :: lines   !! with their ends, and printable
      character(:), allocatable :: contents, reason
      integer :: first, length, n

      flush (self%unit)
      call read_file(self%path, huge(1), contents, reason)
      rewind (self%unit)
      endfile (self%unit)
      rewind (self%unit)
      allocate (character(0) :: lines)
      if (all_printable(contents)) then
         call move_alloc(contents, lines)
         return
      end if
      first = 1
      do while (first <= len(contents))
         length = index(contents(first:), new_line('a')) - 1
         if (length < 0) exit
         n = len(lines)
         lines = lines//printable(contents(first:first + length - 1))//new_line('a')
         first = first + length + 1
      end do
   end subroutine take

   !> Whether a text has plain letters and ends of line only, as most have.
   pure logical function all_printable(contents)
      character(*), intent(in) :: contents
      integer :: i

      all_printable = .false.
      do i = 1, len(contents)
         if (iachar(contents(i:i)) >= 32 .and. iachar(contents(i:i)) < 127) cycle
         if (contents(i:i) /= new_line('a')) return
      end do
      all_printable = .true.
   end function all_printable

   !> Ends the text; what was not taken is lost.
   subroutine close_text(self)
      class(printed_text_type), intent(inout) :: self

      if (self%descriptor < 0) return
      close (self%unit)
      call close_descriptor(self%descriptor)
      self%descriptor = -1
   end subroutine close_text

end module listing_text
