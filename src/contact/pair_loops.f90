!> Loops of contact pairs: nodes whose relative motions are not independent of each other.
module pair_loops
   implicit none
   private
   public :: find_loop

contains

   !> The first pair whose nodes are already joined by pairs before it; 0 where there is none. Pairs
   !> as edges of a graph, with union and find.
   pure function find_loop(slave, master) result(pair)
      integer, intent(in) :: slave(:)    !! (m) slave nodes
      integer, intent(in) :: master(:)   !! (m) master nodes
      integer :: pair                    !! 1..m or 0
      integer :: parent(max(maxval(slave), maxval(master), 0))
      integer :: a, b, k

      parent = [(k, k=1, size(parent))]
      do pair = 1, size(slave)
         a = slave(pair)
         b = master(pair)
         do while (parent(a) /= a)
            parent(a) = parent(parent(a))
            a = parent(a)
         end do
         do while (parent(b) /= b)
            parent(b) = parent(parent(b))
            b = parent(b)
         end do
         if (a == b) return
         parent(a) = b
      end do
      pair = 0
   end function find_loop

end module pair_loops
