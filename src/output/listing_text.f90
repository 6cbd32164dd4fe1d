!> Text of the listing: titles, wrapped lines, numbers in columns, the echo of the deck.
module listing_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: dp, long
   use quantity_types, only: quantity_type
   use text, only: string_type, to_text
   use zone_diagram, only: zone_numeral
   implicit none
   private
   public :: page_width, print_title, print_wrapped, print_list, print_deck
   public :: column, in_columns, table_cell, table_head

   integer, parameter :: page_width = 132   !! columns of the line printer

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

end module listing_text
