!> Sides of a slave face, their segments, and the points of the master opposite (mortar_segments).
module mortar_sides
   use chain_geometry, only: chain_tangents, side_positions, side_total, two_pi
   use kinds, only: dp
   use mesh, only: mesh_type
   use shape_functions, only: side_shape, side_slope
   use surface_chains, only: surface_chain_type
   implicit none
   private
   public :: face_line_type, slave_side_type
   public :: beside_line, hats, insert_kinks, line_of, no_segment, oppose, opposite_at, &
      opposite_coordinate, outward_normals, project, sides_of

   real(dp), parameter :: no_segment = 1.0e-12_dp   !! part of a side that is rounding
   integer, parameter :: curved_parts = 4           !! of a segment between sides that are not plain
   real(dp), parameter :: beside = 1.0e-9_dp        !! of a side's coordinate beyond its end
   integer, parameter :: most_steps = 60            !! of an iteration

   !> The line of nodes of one face.
   type :: face_line_type
      real(dp), allocatable :: x(:, :)     !! (2, nodes) coordinates [length]
      integer :: side_nodes = 2            !! nodes of a side, 2 or 3
      logical :: closed = .false.          !! whether the last side leads back to the first node
      real(dp) :: outward = 1.0_dp         !! 1 where the body is on the left of the line, else -1
      logical :: leads = .false.           !! whether it is a master along which the slave slides
   end type face_line_type

   !> One side of the slave, with its nodes' normals.
   type :: slave_side_type
      integer, allocatable :: nodes(:)        !! places of its nodes along the line
      integer :: corners(2) = 0               !! its corners
      real(dp), allocatable :: x(:, :)        !! (2, nodes) [length]
      real(dp), allocatable :: normal(:, :)   !! (2, nodes)
      real(dp), allocatable :: kinks(:)       !! its coordinates where segments end, ascending
      integer, allocatable :: opposite(:)     !! (segments) side of the master, 0 for none
      real(dp) :: covered(2) = [1.0_dp, -1.0_dp] !! its coordinates where the covered part ends
   end type slave_side_type

contains

   !> The line of the nodes of a surface.
   pure function line_of(mesh, chain) result(line)
      type(mesh_type), intent(in) :: mesh
      type(surface_chain_type), intent(in) :: chain
      type(face_line_type) :: line            !! as a master that does not lead

      line = face_line_type(mesh%coordinates(:, chain%nodes), chain%side_nodes, chain%closed, &
         merge(-1.0_dp, 1.0_dp, chain%turned))
   end function line_of

   !> The sides of the slave, with the normals of their nodes and their segments.
   pure function sides_of(slave, master) result(side)
      type(face_line_type), intent(in) :: slave, master
      type(slave_side_type), allocatable :: side(:)
      real(dp) :: normal(2, size(slave%x, 2))
      integer :: corners, s

      allocate (side(side_total(size(slave%x, 2), slave%side_nodes, slave%closed)))
      corners = size(side) + merge(0, 1, slave%closed)
      normal = outward_normals(slave)
      do s = 1, size(side)
         side(s)%nodes = side_positions(s, slave%side_nodes, size(slave%x, 2))
         side(s)%corners = [s, modulo(s, corners) + 1]
         side(s)%x = slave%x(:, side(s)%nodes)
         side(s)%normal = normal(:, side(s)%nodes)
         call find_kinks(side(s), master)
      end do
   end function sides_of

   !> Shape functions of both faces at a point of the slave's side and the one opposite, and the
   !> area per coordinate.
   pure subroutine oppose(side, xi, x, section, of_slave, of_master, area)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi              !! coordinate of the side
      real(dp), intent(in) :: x(:, :)         !! (2, nodes) of the master's side opposite [length]
      real(dp), intent(in) :: section         !! thickness, 0 about an axis [length]
      real(dp), intent(out) :: of_slave(:)    !! (nodes of the slave's side)
      real(dp), intent(out) :: of_master(:)   !! (nodes of the master's side)
      real(dp), intent(out) :: area           !! dA/dxi [length^2]
      real(dp) :: along(2), eta, radius

      eta = 0.0_dp
      call project(side, xi, x, eta)
      of_slave = side_shape(size(of_slave), xi)
      of_master = side_shape(size(of_master), eta)
      radius = 0.5_dp*(dot_product(of_slave, side%x(1, :)) + dot_product(of_master, x(1, :)))
      along = matmul(side%x, side_slope(size(of_slave), xi))
      area = norm2(along)*merge(section, two_pi*abs(radius), section > 0.0_dp)
   end subroutine oppose

   !> Hat functions of the corners of a side that the master covers at least in part; outside the
   !> covered part their values at its end.
   pure function hats(side, xi)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi              !! coordinate of the side
      real(dp) :: hats(2)

      associate (ends => side%covered, at => min(max(xi, side%covered(1)), side%covered(2)))
         hats = [ends(2) - at, at - ends(1)]/(ends(2) - ends(1))
      end associate
   end function hats

   !> Outward unit normals at the nodes of a line; at a corner midway between those of its sides. A
   !> line of sides without midside nodes goes on beyond its ends as it comes: the normal there
   !> leans from that of the last side as the one before does, to the other way. With the normal of
   !> the side pressures at the ends of arcs would err by h, not h^2.
   pure function outward_normals(line) result(normal)
      type(face_line_type), intent(in) :: line
      real(dp) :: normal(2, size(line%x, 2))  !! (2, nodes)
      real(dp) :: tangent(2, size(line%x, 2))
      integer :: n

      tangent = chain_tangents(line%x, line%side_nodes, line%closed)
      n = size(tangent, 2)
      if (line%side_nodes == 2 .and. .not. line%closed .and. n > 2) then
         ! Mirrored in the tangents of the ends.
         associate (ends => tangent(:, [1, n]), before => tangent(:, [2, n - 1]))
            tangent(:, [1, n]) = 2*spread(sum(before*ends, dim=1), 1, 2)*ends - before
         end associate
      end if
      normal(1, :) = line%outward*tangent(2, :)
      normal(2, :) = -line%outward*tangent(1, :)
   end function outward_normals

   !> Finds where the segments of a slave's side end, its own ends and where corners of the master
   !> lie opposite, and what lies opposite them.
   pure subroutine find_kinks(side, master)
      type(slave_side_type), intent(inout) :: side
      type(face_line_type), intent(in) :: master
      real(dp) :: ends(2)
      integer :: j

      side%kinks = [-1.0_dp, 1.0_dp]
      call insert_kinks(side, master, side%kinks)
      allocate (side%opposite(size(side%kinks) - 1), source=0)
      do j = 1, size(side%opposite)
         ends = side%kinks(j:j + 1)
         if (ends(2) - ends(1) <= no_segment) cycle
         side%opposite(j) = side_opposite(side, 0.5_dp*(ends(1) + ends(2)), master)
         if (side%opposite(j) == 0) cycle
         side%covered = [min(side%covered(1), ends(1)), max(side%covered(2), ends(2))]
      end do
      call divide_segments(side, master)
   end subroutine find_kinks

   !> Adds the coordinates of a slave's side at which corners of another line lie opposite.
   pure subroutine insert_kinks(side, line, kinks)
      type(slave_side_type), intent(in) :: side
      type(face_line_type), intent(in) :: line
      real(dp), allocatable, intent(inout) :: kinks(:)   !! ascending
      real(dp) :: at_ends(size(line%x, 2), 2), ends(2), xi
      integer :: j, n

      n = size(side%nodes)
      at_ends(:, 1) = beside_line(side%normal(:, 1), side%x(:, 1), line%x)
      at_ends(:, 2) = beside_line(side%normal(:, n), side%x(:, n), line%x)
      do j = 1, size(line%x, 2), line%side_nodes - 1
         ends = at_ends(j, :)
         if (ends(1)*ends(2) >= 0.0_dp) cycle
         xi = opposite_coordinate(side, line%x(:, j:j), ends)
         kinks = [pack(kinks, kinks <= xi), xi, pack(kinks, kinks > xi)]
      end do
   end subroutine insert_kinks

   !> Side of the master opposite a point of the slave, 0 for none.
   pure integer function opposite_at(side, xi)
      type(slave_side_type), intent(in) :: side   !! with its segments
      real(dp), intent(in) :: xi                  !! coordinate of the side

      opposite_at = side%opposite(min(count(side%kinks <= xi), size(side%opposite)))
   end function opposite_at

   !> Divides the segments between sides of which one is curved or has its midside node off the
   !> middle: there the integrand is no polynomial.
   pure subroutine divide_segments(side, master)
      type(slave_side_type), intent(inout) :: side
      type(face_line_type), intent(in) :: master
      real(dp), allocatable :: kinks(:)
      integer, allocatable :: opposite(:)
      integer :: j, parts, q

      kinks = side%kinks(:1)
      allocate (opposite(0))
      do j = 1, size(side%opposite)
         parts = curved_parts
         associate (facing => side_positions(max(side%opposite(j), 1), master%side_nodes, &
            size(master%x, 2)))
            if (side%opposite(j) == 0 .or. (is_plain(side%x) .and. &
               is_plain(master%x(:, facing)))) parts = 1
         end associate
         do q = 1, parts - 1
            kinks = [kinks, side%kinks(j) + q*(side%kinks(j + 1) - side%kinks(j))/parts]
         end do
         kinks = [kinks, side%kinks(j + 1)]
         opposite = [opposite, spread(side%opposite(j), 1, parts)]
      end do
      side%kinks = kinks
      side%opposite = opposite
   end subroutine divide_segments

   !> Whether a side is straight, with any midside node at its middle.
   pure logical function is_plain(x)
      real(dp), intent(in) :: x(:, :)

      is_plain = size(x, 2) == 2
      if (is_plain) return
      is_plain = norm2(2*x(:, 2) - x(:, 1) - x(:, 3)) <= beside*norm2(x(:, 3) - x(:, 1))
   end function is_plain

   !> How far points lie beside a line through a point.
   pure function beside_line(direction, point, x) result(beside)
      real(dp), intent(in) :: direction(2)    !! of the line
      real(dp), intent(in) :: point(2)        !! on it [length]
      real(dp), intent(in) :: x(:, :)         !! (2, n) the points [length]
      real(dp) :: beside(size(x, 2))          !! times the length of the direction

      beside = direction(1)*(x(2, :) - point(2)) - direction(2)*(x(1, :) - point(1))
   end function beside_line

   !> How far points lie beside the normal at a point of a slave's side. All counts from the side's
   !> first node: so what the distance from the origin makes of rounding is that of nodes alone.
   pure function beside_normal(side, psi, x) result(beside)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: psi(:)          !! shape functions at the point of the side
      real(dp), intent(in) :: x(:, :)         !! (2, n) the points [length]
      real(dp) :: beside(size(x, 2))          !! times the length of the normal
      real(dp), dimension(2) :: normal, point
      integer :: k

      ! The hottest place of faces that slide: without room for arrays.
      normal = 0.0_dp
      point = 0.0_dp
      do k = 1, size(psi)
         normal = normal + side%normal(:, k)*psi(k)
         point = point + (side%x(:, k) - side%x(:, 1))*psi(k)
      end do
      do k = 1, size(x, 2)
         beside(k) = normal(1)*(x(2, k) - side%x(2, 1) - point(2)) - normal(2)* &
            (x(1, k) - side%x(1, 1) - point(1))
      end do
   end function beside_normal

   !> Coordinate of a side whose normal meets a point, by the Illinois method: false position, in
   !> which an end that stays counts half as much each time.
   pure function opposite_coordinate(side, x, at_ends) result(xi)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: x(2, 1)         !! the point [length]
      !> how far it lies beside the normals at the side's ends, of opposite signs
      real(dp), intent(in) :: at_ends(2)
      real(dp) :: xi
      real(dp) :: before, ends(2), psi(size(side%nodes)), value, values(2)
      integer :: step

      ends = [-1.0_dp, 1.0_dp]
      values = at_ends
      xi = 2.0_dp
      do step = 1, most_steps
         before = xi
         xi = (ends(1)*values(2) - ends(2)*values(1))/(values(2) - values(1))
         psi = side_shape(size(psi), xi)
         value = sum(beside_normal(side, psi, x))
         if (abs(value) <= 0.0_dp .or. abs(xi - before) <= epsilon(xi)) exit
         if (value*values(2) < 0.0_dp) then
            ends(1) = ends(2)
            values(1) = values(2)
         else
            values(1) = 0.5_dp*values(1)
         end if
         ends(2) = xi
         values(2) = value
      end do
   end function opposite_coordinate

   !> Side of the master that the normal at a point of the slave meets nearest to it, of those that
   !> face the slave; 0 where none does.
   pure integer function side_opposite(side, xi, master)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi              !! coordinate of the slave's side
      type(face_line_type), intent(in) :: master
      real(dp) :: beside_it(size(master%x, 2)), psi(size(side%nodes))
      real(dp) :: eta, gap, nearest, point(2), x(2, master%side_nodes)
      integer :: nodes(master%side_nodes), s

      side_opposite = 0
      nearest = huge(nearest)
      psi = side_shape(size(psi), xi)
      point = matmul(side%x, psi)
      beside_it = beside_normal(side, psi, master%x)
      do s = 1, side_total(size(master%x, 2), master%side_nodes, master%closed)
         nodes = side_positions(s, size(nodes), size(beside_it))
         if (beside_it(nodes(1))*beside_it(nodes(size(nodes))) > 0.0_dp) cycle
         x = master%x(:, nodes)
         eta = 0.0_dp
         call project(side, xi, x, eta)
         if (abs(eta) > 1.0_dp + beside) cycle
         if (master%outward*dot_product(beside_it(nodes), side_slope(size(nodes), eta)) >= &
            0.0_dp) cycle
         gap = norm2(matmul(x, side_shape(size(x, 2), eta)) - point)
         if (gap >= nearest) cycle
         nearest = gap
         side_opposite = s
      end do
   end function side_opposite

   !> Coordinate eta of the master's side x at which the normal at xi of a slave's side meets it, by
   !> Newton's method.
   pure subroutine project(side, xi, x, eta)
      type(slave_side_type), intent(in) :: side
      real(dp), intent(in) :: xi              !! coordinate of the slave's side
      real(dp), intent(in) :: x(:, :)         !! (2, nodes) [length]
      real(dp), intent(inout) :: eta          !! in: a guess
      real(dp) :: beside_it(size(x, 2)), change, psi(size(side%nodes)), rate
      real(dp), dimension(size(x, 2)) :: phi, slope
      integer :: step

      psi = side_shape(size(psi), xi)
      beside_it = beside_normal(side, psi, x)
      do step = 1, most_steps
         slope = side_slope(size(x, 2), eta)
         rate = dot_product(beside_it, slope)
         if (abs(rate) <= 0.0_dp) return
         phi = side_shape(size(x, 2), eta)
         change = -dot_product(beside_it, phi)/rate
         eta = min(max(eta + change, -2.0_dp), 2.0_dp)
         ! Each step doubles the number of digits.
         if (abs(change) <= beside) return
      end do
   end subroutine project

end module mortar_sides
