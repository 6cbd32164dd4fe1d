!> Lists of integers that grow, in a time in proportion to what they hold.
module number_lists
   implicit none
   private
   public :: number_list_type

   !> A list.
   type :: number_list_type
      integer :: count = 0                        !! how many it holds
      integer, allocatable, private :: items(:)   !! (capacity)
   contains
      procedure :: add
      procedure :: numbers
   end type number_list_type

contains

   !> Adds numbers at the end.
   pure subroutine add(self, numbers)
      class(number_list_type), intent(inout) :: self
      integer, intent(in) :: numbers(:)
      integer, allocatable :: longer(:)
      integer :: total

      total = self%count + size(numbers)
      if (.not. allocated(self%items)) allocate (self%items(0))
      if (total > size(self%items)) then
         allocate (longer(2*total))
         longer(:self%count) = self%items(:self%count)
         call move_alloc(longer, self%items)
      end if
      self%items(self%count + 1:total) = numbers
      self%count = total
   end subroutine add

   !> All numbers in the order in which they were added.
   pure function numbers(self)
      class(number_list_type), intent(in) :: self
      integer :: numbers(self%count)

      if (self%count > 0) numbers = self%items(:self%count)
   end function numbers

end module number_lists
