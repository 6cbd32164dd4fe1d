!> Text of the listing and of the status files: titles, wrapped lines, numbers in columns, rows of
!> tables, the echo of the deck.
module listing_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use contact_system, only: contact_open, contact_stick
   use kinds, only: dp, long
   use quantity_types, only: quantity_type
   use records, only: contact_record_type
   use text, only: string_type, to_text, with_decimals
   use utf8, only: printable
   implicit none
   private
   public :: page_type, page_width, column, in_columns, to_right, table_heads, table_row
   public :: zone_numeral, zone_counts

   integer, parameter :: page_width = 132     !! columns of the line printer
   integer, parameter :: first_room = 4096    !! characters

   !> Roman numerals of the zones, by their contact states.
   character(3), parameter :: zone_numeral(contact_open:contact_stick) = ['  I', ' II', 'III']

   !> Lines that wait to be written to a file.
   type :: page_type
      private
      character(:), allocatable :: buffer
      integer, public :: length = 0    !! characters that wait in it
   contains
      procedure :: append
      procedure :: line
      procedure :: title
      procedure :: wrapped
      procedure :: list
      procedure :: table
      procedure :: deck
      procedure :: take
   end type page_type

contains

   !> Adds text as it is.
   pure subroutine append(self, lines)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: lines         !! with their ends
      character(:), allocatable :: larger
      integer :: last

      last = self%length + len(lines)
      if (.not. allocated(self%buffer)) allocate (character(first_room) :: self%buffer)
      if (last > len(self%buffer)) then
         allocate (character(2*last) :: larger)
         larger(:self%length) = self%buffer(:self%length)
         call move_alloc(larger, self%buffer)
      end if
      self%buffer(self%length + 1:last) = lines
      self%length = last
   end subroutine append

   !> Adds a line.
   pure subroutine line(self, words)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: words         !! any bytes

      call self%append(printable(words)//new_line('a'))
   end subroutine line

   !> Adds a title, underlined.
   pure subroutine title(self, words)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: words

      call self%line('')
      call self%line(words)
      call self%line(repeat('-', len(words)))
   end subroutine title

   !> Adds text under a mark, broken at blanks.
   pure subroutine wrapped(self, mark, string)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: mark          !! what is before the first line
      character(*), intent(in) :: string        !! the text
      character(len(mark)) :: before
      integer :: first, last, room

      room = max(page_width - len(mark), page_width/2)
      before = mark
      first = 1
      do
         last = len_trim(string)
         if (last - first + 1 > room) then
            last = first - 1 + index(string(first:first + room), ' ', back=.true.)
            if (last < first) last = first + room - 1
         end if
         call self%line(before//trim(string(first:last)))
         before = ''
         first = last + 1
         if (first > len_trim(string)) exit
      end do
   end subroutine wrapped

   !> Adds a list of texts under a title; nothing for an empty list.
   pure subroutine list(self, title, texts)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: title
      type(string_type), allocatable, intent(in) :: texts(:)   !! or unallocated
      integer :: i

      if (.not. allocated(texts)) return
      if (size(texts) > 0) call self%title(title)
      do i = 1, size(texts)
         call self%wrapped('   - ', texts(i)%value)
      end do
   end subroutine list

   !> Adds a table under its title.
   pure subroutine table(self, title, rows)
      class(page_type), intent(inout) :: self
      character(*), intent(in) :: title
      type(string_type), intent(in) :: rows(:)   !! the heads of the columns, then the rows
      integer :: i

      call self%line('')
      call self%line(title)
      do i = 1, size(rows)
         call self%line(rows(i)%value)
      end do
   end subroutine table

   !> Adds the card images with their numbers; a card that is wider than the page goes on below.
   pure subroutine deck(self, cards)
      class(page_type), intent(inout) :: self
      type(string_type), intent(in) :: cards(:)     !! card images as read
      integer, parameter :: room = page_width - 10
      integer :: i, first

      call self%title('DECK')
      do i = 1, size(cards)
         associate (card => cards(i)%value)
            call self%line(to_right(to_text(i), 8)//'  '//card(:min(len(card), room)))
            do first = room + 1, len(card), room
               call self%line(repeat(' ', 10)//card(first:min(len(card), first + room - 1)))
            end do
         end associate
      end do
   end subroutine deck

   !> Takes all that waits.
   pure subroutine take(self, lines)
      class(page_type), intent(inout) :: self
      character(:), allocatable, intent(out) :: lines   !! with their ends

      lines = ''
      if (self%length > 0) lines = self%buffer(:self%length)
      self%length = 0
   end subroutine take

   !> Words at the right end of so many columns, of more where these do not hold them.
   pure function to_right(words, width) result(string)
      character(*), intent(in) :: words
      integer, intent(in) :: width
      character(max(width, len(words))) :: string

      string = words
      string = adjustr(string)
   end function to_right

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
      if (abs(value) >= 1.0e99_dp .or. (abs(value) > 0.0_dp .and. abs(value) < 1.0e-99_dp)) digits &
         = 3
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

   !> The heads of columns, side by side.
   pure function table_heads(columns) result(line)
      type(quantity_type), intent(in) :: columns(:)   !! quantities that have a column
      character(:), allocatable :: line
      integer :: i

      line = ''
      do i = 1, size(columns)
         line = line//to_right(trim(columns(i)%head), columns(i)%width)
      end do
   end function table_heads

   !> A row of a table: zones by their numerals, integers to the right, plain numbers with six
   !> decimals.
   pure function table_row(columns, values) result(line)
      type(quantity_type), intent(in) :: columns(:)   !! quantities that have a column
      real(dp), intent(in) :: values(:)               !! one each
      character(:), allocatable :: line
      integer :: i

      line = ''
      do i = 1, size(columns)
         associate (width => columns(i)%width)
            if (columns(i)%name == 'status') then
               line = line//to_right(zone_numeral(nint(values(i))), width)
            else if (columns(i)%is_integer) then
               line = line//to_right(to_text(nint(values(i))), width)
            else if (columns(i)%is_plain) then
               line = line//to_right(with_decimals(values(i), 6), width)
            else
               line = line//column(values(i), width, 3)
            end if
         end associate
      end do
   end function table_row

   !> Numbers of contact points in the zones.
   pure function zone_counts(contacts) result(counts)
      type(contact_record_type), intent(in) :: contacts(:)
      integer :: counts(3)               !! contact points in zones I, II and III
      integer :: i, k

      counts = 0
      do k = 1, size(contacts)
         counts = counts + [(count(contacts(k)%contact_state == i), i=contact_open, contact_stick)]
      end do
   end function zone_counts

end module listing_text
