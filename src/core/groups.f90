!> Groups of things that hang together, by union and find.
module groups
   implicit none
   private
   public :: separate_groups, join, find_root

contains

   !> Every thing a group of its own.
   pure function separate_groups(things) result(parent)
      integer, intent(in) :: things      !! number of things
      integer :: parent(things)          !! (things) each its own parent
      integer :: i

      parent = [(i, i=1, things)]
   end function separate_groups

   !> Joins the groups of two things.
   pure subroutine join(parent, a, b)
      integer, intent(inout) :: parent(:)   !! (things) another thing of the group, or itself
      integer, intent(in) :: a, b           !! things
      integer :: root_a, root_b

      call find_root(parent, a, root_a)
      call find_root(parent, b, root_b)
      parent(max(root_a, root_b)) = min(root_a, root_b)
   end subroutine join

   !> The thing that stands for a group; the way to it is halved on the walk.
   pure subroutine find_root(parent, thing, root)
      integer, intent(inout) :: parent(:)   !! (things) another thing of the group, or itself
      integer, intent(in) :: thing          !! thing of the group
      integer, intent(out) :: root          !! its root

      root = thing
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root

end module groups
