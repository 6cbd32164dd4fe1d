!> The lines of a deck as they are in its files: the deck itself, and those that it includes; and as
!> messages show them, with a caret under the place that is meant.
module deck_source
   use errors, only: place_type
   use file_calls, only: read_file
   use messages, only: print_line
   use text, only: string_type, to_text
   use utf8, only: as_utf8, character_count, first_byte, printable
   implicit none
   private
   public :: deck_source_type, earlier_deck_type, place_type, read_lines, print_card, column_of

   integer, parameter :: first_capacity = 1024   !! images before the list grows for the first time
   integer, parameter :: most_bytes = 1000000000   !! of a file

   !> A deck of a result that another deck goes on from.
   type :: earlier_deck_type
      character(:), allocatable :: path             !! of the result
      type(string_type), allocatable :: images(:)   !! card images, up to the end of a step
      integer :: steps = 0                          !! images before the first *STEP
   end type earlier_deck_type

   !> All card images of a deck in the order in which they are read.
   type :: deck_source_type
      integer :: count = 0                         !! number of images
      type(string_type), allocatable :: images(:)  !! (capacity) card images
      integer, allocatable :: file(:)              !! (capacity) file of the image
      integer, allocatable :: line(:)              !! (capacity) line of the image in its file
      type(string_type), allocatable :: paths(:)   !! (files) paths as given
      type(earlier_deck_type), allocatable :: earlier   !! whose steps are not read yet
   contains
      procedure :: add_image
      procedure :: words_of
   end type deck_source_type

   integer, parameter :: longest_echo = 200     !! characters of a card that are printed
   integer, parameter :: echo_before = 100      !! of these, before the place that is meant
   character(*), parameter :: gap = '...'       !! where characters are left out

contains

   !> Adds one card image.
   subroutine add_image(self, file, line, image)
      class(deck_source_type), intent(inout) :: self
      integer, intent(in) :: file                     !! index into paths
      integer, intent(in) :: line                     !! line in that file, from 1
      character(*), intent(in) :: image               !! the line, without its end
      type(string_type), allocatable :: images(:)
      integer :: i

      if (.not. allocated(self%images)) then
         allocate(self%images(first_capacity))
         allocate(self%file(first_capacity), self%line(first_capacity), source=0)
      else if (self%count == size(self%images)) then
         allocate(images(2*self%count))
         do i = 1, self%count
            call move_alloc(self%images(i)%value, images(i)%value)
         end do
         call move_alloc(images, self%images)
         self%file = [self%file, spread(0, 1, self%count)]
         self%line = [self%line, spread(0, 1, self%count)]
      end if
      self%count = self%count + 1
      self%images(self%count)%value = image
      self%file(self%count) = file
      self%line(self%count) = line
   end subroutine add_image

   !> A place in words, such as 'line 12', or 'line 3 of mesh.inc' of a file that is included.
   pure function words_of(self, place) result(words)
      class(deck_source_type), intent(in) :: self
      type(place_type), intent(in) :: place           !! with an image
      character(:), allocatable :: words

      words = 'line '//to_text(self%line(place%image))
      if (self%file(place%image) > 1) words = words//' of '// &
         self%paths(self%file(place%image))%value
   end function words_of

   !> The lines of a text file in UTF-8, with ends of line in the manner of Unix or Windows.
   subroutine read_lines(path, lines, fault)
      character(*), intent(in) :: path                          !! file
      type(string_type), allocatable, intent(out) :: lines(:)
      character(:), allocatable, intent(out) :: fault           !! why it is not read; else empty
      character(:), allocatable :: contents
      character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      integer :: i, n, first, last
      logical :: there

      allocate(lines(0))
      fault = ''
      inquire (file=path, exist=there)
      if (.not. there) fault = 'there is no such file'
      inquire (file=path//'/.', exist=there)
      if (there) fault = 'it is a folder'
      if (len(fault) > 0) return
      call read_file(path, most_bytes, contents, fault)
      if (len(fault) == 0) fault = text_fault(contents)
      if (len(fault) > 0 .or. len(contents) == 0) return
      ! The last line has an end even where the file has none.
      if (contents(len(contents):) /= new_line('a')) contents = contents//new_line('a')
      if (index(contents, byte_order_mark) == 1) contents = contents(4:)
      contents = as_utf8(contents)
      n = 0
      do i = 1, len(contents)
         if (contents(i:i) == new_line('a')) n = n + 1
      end do
      deallocate(lines)
      allocate(lines(n))
      first = 1
      do i = 1, n
         last = first + index(contents(first:), new_line('a')) - 2
         lines(i)%value = contents(first:last)
         if (last >= first) then
            if (contents(last:last) == achar(13)) lines(i)%value = contents(first:last - 1)
         end if
         first = last + 2
      end do
   end subroutine read_lines

   !> Why the contents of a file are no text in UTF-8 or Latin-1 with ends of line, such as text in
   !> UTF-16, which has zeros; else empty.
   pure function text_fault(contents) result(fault)
      character(*), intent(in) :: contents
      character(:), allocatable :: fault
      integer :: code, i, line

      fault = ''
      line = 1
      do i = 1, len(contents)
         code = iachar(contents(i:i))
         if (code == 10) line = line + 1
         select case (code)
         case (13)
            ! At the end of a line, in the manner of Windows.
            if (i == len(contents)) cycle
            if (contents(i + 1:i + 1) == new_line('a')) cycle
         case (0:8, 11:12, 14:31, 127)
            continue
         case default
            cycle
         end select
         fault = 'it is not text in UTF-8: control character '//to_text(code)//' in line '// &
            to_text(line)
         return
      end do
   end function text_fault

   !> Prints a card, or the part of a long one about a byte, and below it a caret under this byte.
   !> Each tab is shown as one blank.
   subroutine print_card(unit, image, column)
      integer, intent(in) :: unit          !! open for formatted output
      character(*), intent(in) :: image    !! the card
      integer, intent(in) :: column        !! the byte, which may be the one behind the card
      character(:), allocatable :: before, behind
      integer :: room

      before = shown(image(:column - 1))
      behind = shown(image(column:))
      room = longest_echo
      if (character_count(before) + character_count(behind) > longest_echo) then
         if (character_count(before) > echo_before) before = gap//before(first_byte(before, &
            character_count(before) - echo_before + len(gap) + 1):)
         room = longest_echo - character_count(before)
         if (character_count(behind) > room) behind = behind(:first_byte(behind, &
            room - len(gap) + 1) - 1)//gap
      end if
      call print_line(unit, before//behind)
      call print_line(unit, repeat(' ', character_count(before))//'^')
   end subroutine print_card

   pure function shown(part) result(string)
      character(*), intent(in) :: part
      character(:), allocatable :: string
      character(len(part)) :: untabbed
      integer :: i

      untabbed = part
      do i = 1, len(part)
         if (part(i:i) == achar(9)) untabbed(i:i) = ' '
      end do
      string = printable(untabbed)
   end function shown

   !> Column of a byte, which may be behind the line: a character of several bytes is one column.
   pure integer function column_of(image, byte)
      character(*), intent(in) :: image
      integer, intent(in) :: byte

      column_of = character_count(image(:min(byte - 1, len(image)))) + 1 + &
         max(0, byte - 1 - len(image))
   end function column_of

end module deck_source
