!> Contact quantities at the nodes of both faces of mortar points, for fields: linear along each
!> side of the slave, as the multipliers are; at a node of the master that of the slave's point
!> whose normal meets it. A node outside the covered part has none.
module face_interpolation
   use chain_geometry, only: side_positions
   use kinds, only: dp
   use mortar_sides, only: beside_line, face_line_type, hats, opposite_coordinate, &
      side_opposite, side_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: interpolate_on_faces

   !> Step along a side's coordinate to either side of a node: at a node itself two sides meet.
   real(dp), parameter :: aside = 1.0e-6_dp
   real(dp), parameter :: on_normal = 1.0e-9_dp   !! part of a side's length that is rounding

contains

   !> Sums over the contact points that give each node its contact quantities; without terms where
   !> the node is outside the covered part.
   pure subroutine interpolate_on_faces(side, master, point_of, own_point, on_slave, on_master)
      type(side_type), intent(in) :: side(:)  !! of the slave
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: point_of(:)      !! (corners) contact point of each; 0 for none
      logical, intent(in) :: own_point(:)     !! (corners) whether the point is the corner itself
      type(sum_list_type), intent(out) :: on_slave    !! (nodes of the slave, contact points)
      type(sum_list_type), intent(out) :: on_master   !! (nodes of the master, contact points)
      real(dp) :: xi
      integer :: corner, k, nodes, per_side, s

      per_side = size(side(1)%nodes) - 1
      nodes = maxval(side(size(side))%nodes)
      call on_slave%reserve(nodes, 2*nodes)
      do k = 1, nodes
         s = min((k - 1)/per_side + 1, size(side))
         xi = 2.0_dp*(k - 1 - (s - 1)*per_side)/per_side - 1.0_dp
         if (modulo(k - 1, per_side) == 0) then
            corner = (k - 1)/per_side + 1
            if (.not. own_point(corner)) then
               if (.not. is_covered(k)) s = 0
            end if
         else if (.not. is_covered(k)) then
            s = 0
         end if
         call add_node(side, s, xi, point_of, on_slave)
      end do
      call on_master%reserve(size(master%x, 2), 2*size(master%x, 2))
      do k = 1, size(master%x, 2)
         call find_opposite(side, master, k, s, xi)
         call add_node(side, s, xi, point_of, on_master)
      end do

   contains
      !> Whether the master lies opposite a node of the slave or beside it.
      pure logical function is_covered(node)
         integer, intent(in) :: node
         integer :: i

         is_covered = .false.
         do i = 1, size(side)
            if (all(side(i)%nodes /= node)) cycle
            associate (at => 2.0_dp*(findloc(side(i)%nodes, node, dim=1) - 1)/per_side - 1.0_dp)
               is_covered = is_covered .or. side_opposite(side(i), max(at - aside, -1.0_dp), &
                  master) > 0 .or. side_opposite(side(i), min(at + aside, 1.0_dp), master) > 0
            end associate
         end do
      end function is_covered
   end subroutine interpolate_on_faces

   !> Adds the sum of a point of the slave: the values of the corners of its side, by their hats.
   pure subroutine add_node(side, s, xi, point_of, sums)
      type(side_type), intent(in) :: side(:)
      integer, intent(in) :: s                ! side, 0 for none
      real(dp), intent(in) :: xi
      integer, intent(in) :: point_of(:)
      type(sum_list_type), intent(inout) :: sums
      integer :: points(2)
      real(dp) :: hat(2)

      points = 0
      if (s > 0) points = point_of(side(s)%corners)
      hat = 0.5_dp*[1.0_dp - xi, 1.0_dp + xi]
      if (s > 0) then
         if (side(s)%covered(1) < side(s)%covered(2)) hat = hats(side(s), xi)
      end if
      if (s == 0 .or. any(points == 0 .and. abs(hat) > 0.0_dp)) then
         call sums%add([integer ::], [real(dp) ::])
      else if (points(1) == points(2)) then
         call sums%add(points(:1), [1.0_dp])
      else
         call sums%add(points, hat)
      end if
   end subroutine add_node

   !> The point of the slave opposite a node of the master: the nearest one whose normal meets it
   !> and sees it; side 0 where there is none.
   pure subroutine find_opposite(side, master, node, s, xi)
      type(side_type), intent(in) :: side(:)
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: node             ! position along the master's line
      integer, intent(out) :: s
      real(dp), intent(out) :: xi
      real(dp) :: apart, at, ends(2), nearest
      integer :: i

      s = 0
      xi = 0.0_dp
      nearest = huge(nearest)
      do i = 1, size(side)
         associate (x => master%x(:, node), n => size(side(i)%nodes))
            ends = [beside_line(side(i)%normal(:, 1), side(i)%x(:, 1), master%x(:, node:node)), &
               beside_line(side(i)%normal(:, n), side(i)%x(:, n), master%x(:, node:node))]
            where (abs(ends) <= on_normal*norm2(side(i)%x(:, n) - side(i)%x(:, 1))) ends = 0.0_dp
            if (abs(ends(1)) <= 0.0_dp) then
               at = -1.0_dp
            else if (abs(ends(2)) <= 0.0_dp) then
               at = 1.0_dp
            else if (ends(1)*ends(2) < 0.0_dp) then
               at = opposite_coordinate(side(i), x, ends)
            else
               cycle
            end if
            apart = norm2(x - side(i)%x(:, merge(1, n, at < 0.0_dp)))
         end associate
         if (apart >= nearest) cycle
         if (.not. (sees(max(at - aside, -1.0_dp)) .or. sees(min(at + aside, 1.0_dp)))) cycle
         nearest = apart
         s = i
         xi = at
      end do

   contains
      !> Whether a side of the master that has the node lies opposite.
      pure logical function sees(from)
         real(dp), intent(in) :: from
         integer :: opposite

         opposite = side_opposite(side(i), from, master)
         sees = .false.
         if (opposite > 0) sees = any(side_positions(opposite, master%side_nodes, &
            size(master%x, 2)) == node)
      end function sees
   end subroutine find_opposite

end module face_interpolation
