!> Rings of contact pairs: pairs whose relative motion follows from that of others, as where a
!> block stands in an inner corner, or where two pellets touch each other and the tube round them.
module pair_rings
   use groups, only: find_root, join, separate_groups
   use kinds, only: dp
   implicit none
   private
   public :: close_rings, first_repeated

   real(dp), parameter :: parallel = 0.99_dp   !! cosine between normals that count as one

contains

   !> Which pairs close a ring: their nodes are already joined by the pairs before them, or by
   !> prescribed values, which are all tied to the ground.
   pure function close_rings(slave, master, prescribed) result(closes)
      integer, intent(in) :: slave(:)            !! (m) slave nodes
      integer, intent(in) :: master(:)           !! (m) master nodes
      logical, intent(in) :: prescribed(:, :)    !! (components, nodes) prescribed values
      logical :: closes(size(slave))             !! (m)
      integer :: parent(size(prescribed, 2) + 1, size(prescribed, 1))
      integer :: c, first, ground, k, second

      ground = size(prescribed, 2) + 1
      do c = 1, size(prescribed, 1)
         parent(:, c) = separate_groups(ground)
         do k = 1, size(slave)
            if (prescribed(c, slave(k))) call join(parent(:, c), slave(k), ground)
            if (prescribed(c, master(k))) call join(parent(:, c), master(k), ground)
         end do
      end do
      closes = .false.
      do k = 1, size(slave)
         associate (free => .not. (prescribed(:, slave(k)) .and. prescribed(:, master(k))))
            do c = 1, size(prescribed, 1)
               call find_root(parent(:, c), slave(k), first)
               call find_root(parent(:, c), master(k), second)
               closes(k) = closes(k) .or. (free(c) .and. first == second)
            end do
         end associate
         if (closes(k)) cycle
         do c = 1, size(prescribed, 1)
            call join(parent(:, c), slave(k), master(k))
         end do
      end do
   end function close_rings

   !> The first pair that stands among those before it already: the same two nodes, and normals
   !> along one line; 0 where there is none.
   pure integer function first_repeated(slave, master, normal)
      integer, intent(in) :: slave(:)            !! (m) slave nodes
      integer, intent(in) :: master(:)           !! (m) master nodes
      real(dp), intent(in) :: normal(:, :)       !! (2, m) unit vectors
      logical :: closes(size(slave)), free(1, max(maxval(slave), maxval(master), 0))
      integer :: i, k

      free = .false.
      closes = close_rings(slave, master, free)
      do k = 1, size(slave)
         if (.not. closes(k)) cycle
         do i = 1, k - 1
            if (min(slave(i), master(i)) /= min(slave(k), master(k))) cycle
            if (max(slave(i), master(i)) /= max(slave(k), master(k))) cycle
            first_repeated = k
            if (abs(dot_product(normal(:, i), normal(:, k))) > parallel) return
         end do
      end do
      first_repeated = 0
   end function first_repeated

end module pair_rings
