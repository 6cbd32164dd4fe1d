!> The lines of a deck as they stand in its files: the deck itself and, where they are included, the
!> others.
module deck_source
   use text, only: string_type
   implicit none
   private
   public :: deck_source_type, place_type, read_lines

   integer, parameter :: first_capacity = 1024   !! images before the list grows for the first time

   !> A place in a deck.
   type :: place_type
      integer :: image = 0    !! running number of the card image; 0 for the deck as a whole
      integer :: column = 1   !! byte in the image
   end type place_type

   !> All card images of a deck in the order in which they are read.
   type :: deck_source_type
      integer :: count = 0                         !! number of images
      type(string_type), allocatable :: images(:)  !! (capacity) card images
      integer, allocatable :: file(:)              !! (capacity) file of the image
      integer, allocatable :: line(:)              !! (capacity) line of the image in its file
      type(string_type), allocatable :: paths(:)   !! (files) paths as given
   contains
      procedure :: add_image
   end type deck_source_type

contains

   !> Adds one card image.
   subroutine add_image(self, file, line, image)
      class(deck_source_type), intent(inout) :: self  !! the source
      integer, intent(in) :: file                     !! index into paths
      integer, intent(in) :: line                     !! line in that file, from 1
      character(*), intent(in) :: image               !! the line, without its end

      if (.not. allocated(self%images)) then
         allocate(self%images(first_capacity))
         allocate(self%file(first_capacity), self%line(first_capacity), source=0)
      else if (self%count == size(self%images)) then
         call grow(self)
      end if
      self%count = self%count + 1
      self%images(self%count)%value = image
      self%file(self%count) = file
      self%line(self%count) = line
   end subroutine add_image

   !> Doubles the capacity.
   subroutine grow(self)
      type(deck_source_type), intent(inout) :: self
      type(string_type), allocatable :: images(:)
      integer, allocatable :: numbers(:)
      integer :: i

      allocate(images(2*self%count))
      do i = 1, self%count
         call move_alloc(self%images(i)%value, images(i)%value)
      end do
      call move_alloc(images, self%images)
      allocate(numbers(2*self%count), source=0)
      numbers(:self%count) = self%file
      call move_alloc(numbers, self%file)
      allocate(numbers(2*self%count), source=0)
      numbers(:self%count) = self%line
      call move_alloc(numbers, self%line)
   end subroutine grow

   !> The lines of a text file, with ends of line in the manner of Unix or Windows.
   subroutine read_lines(path, lines, readable)
      character(*), intent(in) :: path                          !! file
      type(string_type), allocatable, intent(out) :: lines(:)   !! its lines
      logical, intent(out) :: readable                          !! whether the file could be read
      character(:), allocatable :: contents
      integer :: i, n, first, last

      allocate(lines(0))
      call read_contents(path, contents, readable)
      if (.not. readable) return
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

   !> A whole file, unless it is no text; its last line has an end even where the file has none.
   subroutine read_contents(path, contents, readable)
      character(*), intent(in) :: path
      character(:), allocatable, intent(out) :: contents
      logical, intent(out) :: readable
      character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      integer :: unit, length, status

      readable = .false.
      open (newunit=unit, file=path, access='stream', form='unformatted', action='read', &
         status='old', iostat=status)
      if (status /= 0) return
      inquire (unit=unit, size=length)
      if (length >= 0) then
         allocate(character(length) :: contents)
         read (unit, iostat=status) contents
         readable = status == 0
      end if
      close (unit)
      if (readable) readable = index(contents, achar(0)) == 0
      if (.not. readable .or. length == 0) return
      if (contents(length:length) /= new_line('a')) contents = contents//new_line('a')
      if (index(contents, byte_order_mark) == 1) contents = contents(4:)
   end subroutine read_contents

end module deck_source
