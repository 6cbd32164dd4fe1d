!> Nodes of an element card in another order than corners, then midside nodes side by side: what of
!> an inverted element its card explains, not the coordinates of a node.
module node_orders
   use element_kinds, only: element_corner_count, element_node_count
   use kinds, only: dp
   use mesh, only: mesh_type
   use misplaced_nodes, only: element_jacobians
   implicit none
   private
   public :: alternates, exchanged_midsides

contains

   !> Whether an inverted element is sound once its nodes are taken as corner, midside node, corner
   !> and so on.
   pure logical function alternates(mesh, e)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e               !! the element
      integer :: corners, i

      corners = element_corner_count(mesh%element_kind(e))
      alternates = element_node_count(mesh%element_kind(e)) == 2*corners
      if (alternates) alternates = is_sound(mesh, e, [(2*i - 1, i=1, corners), (2*i, i=1, corners)])
   end function alternates

   !> Midside nodes of an inverted element that is sound once each takes the side whose middle it is
   !> nearest to: those that stand for another side. None where moving one midside node to its
   !> middle would leave the element less bent.
   pure function exchanged_midsides(mesh, e) result(nodes)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e               !! the element
      integer, allocatable :: nodes(:)       !! node indexes
      real(dp), allocatable :: off(:, :)     ! (midside nodes, sides) distances to the middles
      integer, allocatable :: side(:)        ! of each midside node
      integer :: corners, i, k

      allocate (nodes(0))
      corners = element_corner_count(mesh%element_kind(e))
      if (element_node_count(mesh%element_kind(e)) /= 2*corners) return
      allocate (off(corners, corners), side(corners))
      associate (x => mesh%coordinates(:, mesh%element_nodes(:2*corners, e)))
         do k = 1, corners
            do i = 1, corners
               off(i, k) = norm2(x(:, corners + i) - 0.5_dp*(x(:, k) + x(:, mod(k, corners) + 1)))
            end do
         end do
      end associate
      side = minloc(off, dim=2)
      if (any([(count(side == k) /= 1, k=1, corners)])) return
      if (sum([(off(i, side(i)), i=1, corners)]) >= &
         sum([(off(i, i), i=1, corners)]) - maxval([(off(i, i), i=1, corners)])) return
      if (.not. is_sound(mesh, e, [[(i, i=1, corners)], &
         [(corners + findloc(side, k, dim=1), k=1, corners)]])) return
      nodes = pack(mesh%element_nodes(corners + 1:2*corners, e), side /= [(i, i=1, corners)])
   end function exchanged_midsides

   !> Whether an element is not inverted with its nodes in another order.
   pure logical function is_sound(mesh, e, order)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: e
      integer, intent(in) :: order(:)

      is_sound = all(element_jacobians(mesh%element_kind(e), &
         mesh%coordinates(:, mesh%element_nodes(order, e))) > 0.0_dp)
   end function is_sound

end module node_orders
