!> Lengths, weights and tangents along a line of sides with two or three nodes, open or closed to a
!> closed face.
module chain_geometry
   use kinds, only: dp
   use quadrature, only: gauss_point_3, gauss_weight_3
   use shape_functions, only: side_shape, side_slope
   implicit none
   private
   public :: arc_lengths, edge_lengths, tributary_areas, chain_tangents, chord_depth
   public :: at_tips, length_between, side_positions, side_total, turns_back, two_pi

   !> Angle of a full turn [rad].
   real(dp), parameter :: two_pi = 6.283185307179586477_dp
   !> Slope of a side at its end, over the chord, that counts as 0. The side turns away from such a
   !> slope within the square of this part of its length.
   real(dp), parameter :: no_slope = 1.0e-3_dp
   !> Angle between sides from which on a line has a corner, 60 degrees [rad].
   real(dp), parameter :: corner = two_pi/6

contains

   !> Number of sides of a line.
   pure integer function side_total(nodes, side_nodes, closed)
      integer, intent(in) :: nodes, side_nodes
      logical, intent(in) :: closed

      side_total = (nodes - merge(0, 1, closed))/(side_nodes - 1)
   end function side_total

   !> Positions of the nodes of a side along the line; the last side of a closed face ends at the
   !> first node.
   pure function side_positions(side, side_nodes, nodes) result(position)
      integer, intent(in) :: side, side_nodes, nodes
      integer :: position(side_nodes)
      integer :: q

      position = [(mod((side - 1)*(side_nodes - 1) + q, nodes) + 1, q=0, side_nodes - 1)]
   end function side_positions

   !> Length of a side between two of its points, negative against its direction.
   pure function length_between(x, from, to) result(length)
      real(dp), intent(in) :: x(:, :)     !! (2, nodes) the side [length]
      real(dp), intent(in) :: from, to    !! coordinates, from -1 to 1
      real(dp) :: length
      integer :: g

      length = 0.0_dp
      do g = 1, 3
         length = length + 0.5_dp*(to - from)*gauss_weight_3(g)*norm2(matmul(x, &
            side_slope(size(x, 2), 0.5_dp*(from + to + (to - from)*gauss_point_3(g)))))
      end do
   end function length_between

   !> Arc length of each node from the first.
   pure function arc_lengths(x, side_nodes, closed) result(s)
      real(dp), intent(in) :: x(:, :)     !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes   !! nodes of a side, 2 or 3
      logical, intent(in) :: closed       !! whether it is a closed face
      real(dp) :: s(size(x, 2))           !! (nodes) [length]
      integer :: position(side_nodes), q, side

      s(1) = 0.0_dp
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         do q = 2, side_nodes
            if (position(q) == 1) cycle
            s(position(q)) = s(position(q - 1)) + length_between(x(:, position), &
               2*(q - 2.0_dp)/(side_nodes - 1) - 1, 2*(q - 1.0_dp)/(side_nodes - 1) - 1)
         end do
      end do
   end function arc_lengths

   !> Length of the longest side that each node belongs to.
   pure function edge_lengths(x, side_nodes, closed) result(edge)
      real(dp), intent(in) :: x(:, :)     !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes   !! nodes of a side, 2 or 3
      logical, intent(in) :: closed       !! whether it is a closed face
      real(dp) :: edge(size(x, 2))        !! (nodes) [length]
      integer :: position(side_nodes), side

      edge = 0.0_dp
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         edge(position) = max(edge(position), length_between(x(:, position), -1.0_dp, 1.0_dp))
      end do
   end function edge_lengths

   !> Integral of each node's shape function over the face. A constant pressure so has constant
   !> nodal force over weight, which is what makes the lumped recovery pass the patch test.
   pure function tributary_areas(x, side_nodes, closed, section) result(weight)
      real(dp), intent(in) :: x(:, :)     !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes   !! nodes of a side, 2 or 3
      logical, intent(in) :: closed       !! whether it is a closed face
      real(dp), intent(in) :: section     !! thickness; 0 where the line sweeps round x = 0 [length]
      real(dp) :: weight(size(x, 2))      !! (nodes) [length^2]
      real(dp) :: factor, psi(side_nodes)
      integer :: g, position(side_nodes), side

      weight = 0.0_dp
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         do g = 1, 3
            psi = side_shape(side_nodes, gauss_point_3(g))
            factor = 1.0_dp
            if (section <= 0.0_dp) factor = two_pi*dot_product(psi, x(1, position))
            weight(position) = weight(position) + factor*gauss_weight_3(g)*psi* &
               norm2(matmul(x(:, position), side_slope(side_nodes, gauss_point_3(g))))
         end do
      end do
      if (section > 0.0_dp) weight = section*weight
   end function tributary_areas

   !> Corners that are the tip of all sides that meet there: these have quarter points, and the
   !> integral of the corner's shape function along the line is 0.
   pure function at_tips(x, side_nodes, closed) result(tip)
      real(dp), intent(in) :: x(:, :)      !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes    !! nodes of a side, 2 or 3
      logical, intent(in) :: closed        !! whether it is a closed face
      logical :: tip(size(x, 2))           !! (nodes)
      integer :: position(side_nodes), q, side

      tip = side_nodes == 3
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         do q = 1, side_nodes
            tip(position(q)) = tip(position(q)) .and. is_tip(x(:, position), q)
         end do
      end do
   end function at_tips

   !> Whether a side runs back at one of its nodes, as with a midside node beyond a quarter point.
   pure logical function turns_back(x)
      real(dp), intent(in) :: x(:, :)      !! (2, nodes) the side [length]
      integer :: node

      associate (chord => x(:, size(x, 2)) - x(:, 1))
         turns_back = any([(dot_product(slope_at(x, node), chord) < -no_slope* &
            dot_product(chord, chord), node=1, size(x, 2))])
      end associate
   end function turns_back

   !> Whether a side has no slope at one of its nodes: the end next to a quarter point.
   pure logical function is_tip(x, node)
      real(dp), intent(in) :: x(:, :)
      integer, intent(in) :: node

      associate (chord => x(:, size(x, 2)) - x(:, 1))
         is_tip = abs(dot_product(slope_at(x, node), chord)) <= no_slope*dot_product(chord, chord)
      end associate
   end function is_tip

   !> Derivative of a side at one of its nodes.
   pure function slope_at(x, node) result(slope)
      real(dp), intent(in) :: x(:, :)
      integer, intent(in) :: node
      real(dp) :: slope(2)

      slope = matmul(x, side_slope(size(x, 2), 2*(node - 1.0_dp)/(size(x, 2) - 1) - 1))
   end function slope_at

   !> How far sides at most lie from the smooth curve through their nodes. Sides without midside
   !> nodes that turn by the angle a are chords of the curvature a/h, h^2/8 of it deep. A parabola
   !> whose midside node stands out by s is s^3/h^2 from the circle through its three nodes.
   pure real(dp) function chord_depth(x, side_nodes, closed) result(depth)
      real(dp), intent(in) :: x(:, :)     !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes   !! nodes of a side, 2 or 3
      logical, intent(in) :: closed       !! whether it is a closed face
      real(dp) :: along(2), before(2), turn
      integer :: position(side_nodes), side

      depth = 0.0_dp
      before = 0.0_dp
      if (closed .and. side_nodes == 2) before = x(:, 1) - x(:, size(x, 2))
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         along = x(:, position(side_nodes)) - x(:, position(1))
         if (side_nodes == 3) then
            depth = max(depth, abs(across(along, x(:, position(2)) - x(:, position(1))))**3/ &
               norm2(along)**5)
            cycle
         end if
         turn = abs(atan2(across(before, along), dot_product(before, along)))
         if (turn < corner .and. norm2(before) > 0.0_dp) depth = max(depth, &
            turn*max(norm2(before), norm2(along))**2/(4*(norm2(before) + norm2(along))))
         before = along
      end do
   contains
      pure real(dp) function across(one, other)
         real(dp), intent(in) :: one(2), other(2)

         across = one(1)*other(2) - one(2)*other(1)
      end function across
   end function chord_depth

   !> Unit tangents at the nodes along the line; at a shared corner the direction midway.
   pure function chain_tangents(x, side_nodes, closed) result(tangent)
      real(dp), intent(in) :: x(:, :)      !! (2, nodes) the line [length]
      integer, intent(in) :: side_nodes    !! nodes of a side, 2 or 3
      logical, intent(in) :: closed        !! whether it is a closed face
      real(dp) :: tangent(2, size(x, 2))   !! (2, nodes)
      real(dp) :: along(2)
      integer :: position(side_nodes), node, q, side

      tangent = 0.0_dp
      do side = 1, side_total(size(x, 2), side_nodes, closed)
         position = side_positions(side, side_nodes, size(x, 2))
         do q = 1, side_nodes
            along = slope_at(x(:, position), q)
            ! At a tip the limit of the direction counts, that of the way to the quarter point.
            if (is_tip(x(:, position), q)) along = (x(:, position(2)) - x(:, position(q)))*(2 - q)
            tangent(:, position(q)) = tangent(:, position(q)) + along/norm2(along)
         end do
      end do
      do node = 1, size(x, 2)
         tangent(:, node) = tangent(:, node)/max(norm2(tangent(:, node)), tiny(1.0_dp))
      end do
   end function chain_tangents

end module chain_geometry
