!> The way from a name to its position in a list that grows, in a time that does not grow with it.
module name_index
   use kinds, only: long
   use text, only: string_type, to_upper
   implicit none
   private
   public :: name_index_type, is_pattern, matches

   integer, parameter :: first_capacity = 64

   !> Names in the order in which they are added, and a hash table of them.
   type :: name_index_type
      private
      integer :: count = 0
      type(string_type), allocatable :: names(:)   !! (capacity) in upper case
      integer, allocatable :: last(:)     !! (capacity) last name of each hash value, 0 for none
      integer, allocatable :: before(:)   !! (capacity) the name before it of the same hash value
   contains
      procedure :: add
      procedure :: find
      procedure :: known
      procedure :: matching
   end type name_index_type

contains

   !> Adds a name behind those that are there.
   pure subroutine add(self, name)
      class(name_index_type), intent(inout) :: self
      character(*), intent(in) :: name         !! in any case

      if (.not. allocated(self%names)) then
         call extend(self, first_capacity)
      else if (self%count == size(self%names)) then
         call extend(self, 2*self%count)
      end if
      self%count = self%count + 1
      self%names(self%count)%value = to_upper(name)
      call enter(self, self%count)
   end subroutine add

   !> Position of a name, whatever its case; the last of equal ones, 0 where there is none.
   pure integer function find(self, name) result(position)
      class(name_index_type), intent(in) :: self
      character(*), intent(in) :: name         !! what is looked for
      character(:), allocatable :: wanted

      position = 0
      if (self%count == 0) return
      wanted = to_upper(name)
      position = self%last(hash(wanted, size(self%last)))
      do while (position > 0)
         if (self%names(position)%value == wanted) return
         position = self%before(position)
      end do
   end function find

   !> Whether a name is a pattern of names.
   pure logical function is_pattern(name)
      character(*), intent(in) :: name         !! as written

      is_pattern = index(name, '*') > 0
   end function is_pattern

   !> Whether a name is what a pattern says, in which * is any characters, or the pattern itself.
   pure recursive logical function matches(pattern, name) result(fits)
      character(*), intent(in) :: pattern      !! in upper case, as the name
      character(*), intent(in) :: name
      integer :: k, star

      star = index(pattern, '*')
      if (star == 0) then
         fits = pattern == name
         return
      end if
      fits = index(name, pattern(:star - 1)) == 1
      if (.not. fits) return
      do k = star, len(name) + 1
         fits = matches(pattern(star + 1:), name(k:))
         if (fits) return
      end do
   end function matches

   !> Positions of the names that a pattern means, in their order.
   pure function matching(self, pattern) result(positions)
      class(name_index_type), intent(in) :: self
      character(*), intent(in) :: pattern      !! in any case
      integer, allocatable :: positions(:)
      integer :: i

      positions = pack([(i, i=1, self%count)], [(matches(to_upper(pattern), self%names(i)%value), &
         i=1, self%count)])
   end function matching

   !> All names, in upper case.
   pure function known(self) result(names)
      class(name_index_type), intent(in) :: self
      type(string_type) :: names(self%count)
      integer :: i

      do i = 1, self%count
         names(i) = self%names(i)
      end do
   end function known

   !> Gives the table another capacity.
   pure subroutine extend(self, capacity)
      class(name_index_type), intent(inout) :: self
      integer, intent(in) :: capacity
      type(string_type), allocatable :: names(:)
      integer :: i

      allocate (names(capacity))
      do i = 1, self%count
         call move_alloc(self%names(i)%value, names(i)%value)
      end do
      call move_alloc(names, self%names)
      self%last = spread(0, 1, capacity)
      self%before = self%last
      do i = 1, self%count
         call enter(self, i)
      end do
   end subroutine extend

   !> Makes a name the last of its hash value.
   pure subroutine enter(self, position)
      class(name_index_type), intent(inout) :: self
      integer, intent(in) :: position
      integer :: i

      i = hash(self%names(position)%value, size(self%last))
      self%before(position) = self%last(i)
      self%last(i) = position
   end subroutine enter

   !> A number from 1 to n that a name has; blanks at its end do not count, as for ==.
   pure integer function hash(name, n)
      character(*), intent(in) :: name
      integer, intent(in) :: n
      integer(long), parameter :: base = 257, modulus = huge(1)
      integer(long) :: code
      integer :: i

      code = 0
      do i = 1, len_trim(name)
         code = mod(base*code + iachar(name(i:i)), modulus)
      end do
      hash = int(mod(code, int(n, long))) + 1
   end function hash

end module name_index
