!> Loops of contact pairs: nodes whose relative motions are not independent of each other.
module pair_loops
   use groups, only: find_root, join, separate_groups
   implicit none
   private
   public :: find_loop

contains

   !> The first pair whose nodes are already joined by pairs before it; 0 where there is none.
   pure function find_loop(slave, master) result(pair)
      integer, intent(in) :: slave(:)    !! (m) slave nodes
      integer, intent(in) :: master(:)   !! (m) master nodes
      integer :: pair                    !! 1..m or 0
      integer :: parent(max(maxval(slave), maxval(master), 0))
      integer :: a, b

      parent = separate_groups(size(parent))
      do pair = 1, size(slave)
         call find_root(parent, slave(pair), a)
         call find_root(parent, master(pair), b)
         if (a == b) return
         call join(parent, a, b)
      end do
      pair = 0
   end function find_loop

end module pair_loops
