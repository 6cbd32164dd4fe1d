!> Mortar integrals: hat functions over the segments that two faces cut from each other.
!>
!> The multipliers of the contact are piecewise linear on the slave face: hat function phi_c of
!> corner c is 1 there and falls linearly in the side's own coordinate xi to 0 at the next corners,
!> also on sides with midside nodes. On a side that the master covers in part the two hats span the
!> covered part alone: spanning the whole side, the hat of a corner far from the master would be
!> small wherever it counts, and its multiplier as large as it likes. A point xi of the slave lies
!> opposite the point of the master that its normal meets; normals are interpolated between the
!> averaged ones of the slave's nodes.
!> The contact conditions of a corner act along the normal midway between those of both faces there.
!> Along the slave's own normal, part of the normal force would count as friction, and exchanging
!> slave and master would change it.
!> With N and M the shape functions of slave and master, dA the area of the face midway between both
!>
!>    w_c = integral phi_c dA,  D_ci = integral phi_c N_i dA,  M_cj = integral phi_c M_j dA,
!>
!> and the same D and M times the normal n(xi) midway between both faces. With the normal of the
!> corner in its place, the mean gap of faces that move apart along their radius would be too small
!> by h^2/12 on sides that turn by the angle h, and the force too: press fits would err by h^2/6.
!>
!> The integrand has kinks where a corner of either face lies, so it is integrated from kink to kink
!> (a segment); a rule on whole sides of the slave fails the patch test by 0.1 to 0.3 %.
!>
!> B. I. Wohlmuth, Acta Numerica 20 (2011) 569; A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, SIAM
!> J. Sci. Comput. 34 (2012) B421 (linear multipliers on quadratic sides).
module mortar_segments
   use chain_geometry, only: chain_tangents, length_between, side_positions, side_total
   use kinds, only: dp
   use quadrature, only: gauss_point_10, gauss_weight_10
   use shape_functions, only: side_shape, side_slope
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: face_line_type, mortar_integrals_type, integrate_segments, cross
   public :: beside_normal, hats, opposite_coordinate, side_opposite, side_type, sides_of

   real(dp), parameter :: two_pi = 6.283185307179586477_dp
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
   end type face_line_type

   !> The integrals. Corners of the slave are counted along its line.
   type :: mortar_integrals_type
      real(dp), allocatable :: weight(:)   !! (corners) w_c [length^2]
      !> (corners) w_c if the master covered the whole of the sides that it does cover in part
      real(dp), allocatable :: whole(:)
      !> (2, corners) where the hat function is 1: the corner, or the end of what is covered
      real(dp), allocatable :: position(:, :)
      real(dp), allocatable :: beyond(:)   !! (corners) how far along the line it lies from there
      !> (2, corners) unit normal midway between those of both faces, outward from the slave
      real(dp), allocatable :: normal(:, :)
      type(sparse_matrix_type) :: slave    !! (corners, nodes of the slave) D [length^2]
      type(sparse_matrix_type) :: master   !! (corners, nodes of the master) M [length^2]
      !> the same times the components of n
      type(sparse_matrix_type) :: slave_normal(2), master_normal(2)
   end type mortar_integrals_type

   !> One side of the slave, with its nodes' normals.
   type :: side_type
      integer, allocatable :: nodes(:)        !! places of its nodes along the line
      integer :: corners(2) = 0               !! its corners
      real(dp), allocatable :: x(:, :)        !! (2, nodes) [length]
      real(dp), allocatable :: normal(:, :)   !! (2, nodes)
      real(dp), allocatable :: kinks(:)       !! its coordinates where segments end, ascending
      integer, allocatable :: opposite(:)     !! (segments) side of the master, 0 for none
      real(dp) :: covered(2) = [1.0_dp, -1.0_dp] !! its coordinates where the covered part ends
   end type side_type

   !> What has been summed.
   type :: segment_sums_type
      real(dp), allocatable :: weight(:), whole(:)
      real(dp), allocatable :: apart(:)       !! (corners) from the covered part, as a coordinate
      real(dp), allocatable :: position(:, :), beyond(:)   !! of mortar_integrals_type
      !> (2, corners) normals of slave and master there
      real(dp), allocatable :: normal(:, :), facing(:, :)
      type(triplet_list_type) :: slave(0:2), master(0:2)   !! without n, with its components
   end type segment_sums_type

contains

   !> Integrates over all segments.
   pure subroutine integrate_segments(slave, master, thickness, about_axis, integrals)
      type(face_line_type), intent(in) :: slave, master
      real(dp), intent(in) :: thickness       !! not used about an axis [length]
      logical, intent(in) :: about_axis       !! whether areas are swept round the axis x = 0
      type(mortar_integrals_type), intent(out) :: integrals
      real(dp) :: master_normal(2, size(master%x, 2)), normal(2, size(slave%x, 2)), section
      integer :: corners, k, s
      integer, allocatable :: segments(:)
      type(segment_sums_type) :: sums
      type(side_type), allocatable :: side(:)

      side = sides_of(slave, master)
      corners = size(side) + merge(0, 1, slave%closed)
      allocate (sums%weight(corners), sums%whole(corners), sums%beyond(corners), source=0.0_dp)
      allocate (sums%apart(corners), source=huge(1.0_dp))
      normal = outward_normals(slave)
      sums%normal = normal(:, ::slave%side_nodes - 1)
      sums%position = slave%x(:, ::slave%side_nodes - 1)
      allocate (sums%facing, source=0.0_dp*sums%normal)
      master_normal = outward_normals(master)
      allocate (segments(size(side)))
      do s = 1, size(side)
         segments(s) = size(side(s)%kinks) - 1
      end do
      do k = 0, 2
         call sums%slave(k)%reserve(2*slave%side_nodes*sum(segments))
         call sums%master(k)%reserve(2*master%side_nodes*sum(segments))
      end do
      section = merge(0.0_dp, thickness, about_axis)
      do s = 1, size(side)
         do k = 1, segments(s)
            call add_segment(side(s), k, master, master_normal, section, sums)
         end do
      end do
      integrals%weight = sums%weight
      integrals%whole = sums%whole
      integrals%position = sums%position
      integrals%beyond = sums%beyond
      integrals%normal = sums%normal - sums%facing
      do k = 1, corners
         integrals%normal(:, k) = integrals%normal(:, k)/norm2(integrals%normal(:, k))
      end do
      integrals%slave = sums%slave(0)%compress(corners, size(slave%x, 2))
      integrals%master = sums%master(0)%compress(corners, size(master%x, 2))
      do k = 1, 2
         integrals%slave_normal(k) = sums%slave(k)%compress(corners, size(slave%x, 2))
         integrals%master_normal(k) = sums%master(k)%compress(corners, size(master%x, 2))
      end do
   end subroutine integrate_segments

   !> The sides of the slave, with the normals of their nodes and their segments.
   pure function sides_of(slave, master) result(side)
      type(face_line_type), intent(in) :: slave, master
      type(side_type), allocatable :: side(:)
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

   !> Adds the integrals over one segment; without a master opposite, the area of the hats alone.
   pure subroutine add_segment(side, segment, master, master_normal, section, sums)
      type(side_type), intent(in) :: side
      integer, intent(in) :: segment
      type(face_line_type), intent(in) :: master
      real(dp), intent(in) :: master_normal(:, :)  ! (2, nodes)
      real(dp), intent(in) :: section         ! thickness, 0 about an axis [length]
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: area, ends(2), eta, factor(0:2), hat(2), radius, xi
      real(dp) :: psi(size(side%nodes)), psi_master(master%side_nodes)
      real(dp) :: of_slave(2, size(psi), 0:2), of_master(2, size(psi_master), 0:2)
      integer :: facing(master%side_nodes), g, k

      if (side%covered(1) > side%covered(2)) return
      ends = side%kinks(segment:segment + 1)
      facing = side_positions(max(side%opposite(segment), 1), master%side_nodes, size(master%x, 2))
      eta = 0.0_dp
      of_slave = 0.0_dp
      of_master = 0.0_dp
      do g = 1, size(gauss_point_10)
         xi = 0.5_dp*(ends(1) + ends(2) + (ends(2) - ends(1))*gauss_point_10(g))
         psi = side_shape(size(psi), xi)
         area = 0.5_dp*(ends(2) - ends(1))*gauss_weight_10(g)* &
            norm2(matmul(side%x, side_slope(size(psi), xi)))
         radius = dot_product(psi, side%x(1, :))
         if (side%opposite(segment) > 0) then
            call project(side, xi, master%x(:, facing), eta)
            psi_master = side_shape(size(psi_master), eta)
            radius = 0.5_dp*(radius + dot_product(psi_master, master%x(1, facing)))
         end if
         area = area*merge(section, two_pi*abs(radius), section > 0.0_dp)
         sums%whole(side%corners) = sums%whole(side%corners) + area*0.5_dp*[1.0_dp - xi, &
            1.0_dp + xi]
         if (side%opposite(segment) == 0) cycle
         hat = hats(side, xi)
         sums%weight(side%corners) = sums%weight(side%corners) + area*hat
         factor = [1.0_dp, midway(matmul(side%normal, psi), &
            matmul(master_normal(:, facing), psi_master))]
         do k = 0, 2
            of_slave(:, :, k) = of_slave(:, :, k) + outer(factor(k)*area*hat, psi)
            of_master(:, :, k) = of_master(:, :, k) + outer(factor(k)*area*hat, psi_master)
         end do
      end do
      if (side%opposite(segment) == 0) return
      do k = 0, 2
         call sums%slave(k)%add_block(side%corners, side%nodes, of_slave(:, :, k))
         call sums%master(k)%add_block(side%corners, facing, of_master(:, :, k))
      end do
      call find_positions(side, segment, master%x(:, facing), master_normal(:, facing), sums)
   end subroutine add_segment

   !> Hat functions of the corners of a side that the master covers at least in part; outside the
   !> covered part their values at its end.
   pure function hats(side, xi)
      type(side_type), intent(in) :: side
      real(dp), intent(in) :: xi              !! coordinate of the side
      real(dp) :: hats(2)

      associate (ends => side%covered, at => min(max(xi, side%covered(1)), side%covered(2)))
         hats = [ends(2) - at, at - ends(1)]/(ends(2) - ends(1))
      end associate
   end function hats

   !> Where the hats of a side's corners are 1, and the normals there, if this segment lies nearer
   !> to the corner than those before.
   pure subroutine find_positions(side, segment, x, master_normal, sums)
      type(side_type), intent(in) :: side
      integer, intent(in) :: segment
      real(dp), intent(in) :: x(:, :), master_normal(:, :)  ! (2, nodes) of the side opposite
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: eta, from, normal(2), xi
      integer :: c

      do c = 1, 2
         xi = side%kinks(segment + c - 1)
         from = 2*c - 3.0_dp
         associate (corner => side%corners(c), psi => side_shape(size(side%nodes), xi))
            if (abs(xi - from) >= sums%apart(corner)) cycle
            sums%apart(corner) = abs(xi - from)
            sums%position(:, corner) = matmul(side%x, psi)
            sums%beyond(corner) = length_between(side%x, from, xi)
            normal = matmul(side%normal, psi)
            sums%normal(:, corner) = normal/norm2(normal)
            eta = 0.0_dp
            call project(side, xi, x, eta)
            sums%facing(:, corner) = matmul(master_normal, side_shape(size(x, 2), eta))
         end associate
      end do
   end subroutine find_positions

   !> Outward unit normals at the nodes of a line; at a corner midway between those of its sides.
   pure function outward_normals(line) result(normal)
      type(face_line_type), intent(in) :: line
      real(dp) :: normal(2, size(line%x, 2))
      real(dp) :: tangent(2, size(line%x, 2))

      tangent = chain_tangents(line%x, line%side_nodes, line%closed)
      normal(1, :) = line%outward*tangent(2, :)
      normal(2, :) = -line%outward*tangent(1, :)
   end function outward_normals

   !> Finds where the segments of a slave's side end, its own ends and where corners of the master
   !> lie opposite, and what lies opposite them.
   pure subroutine find_kinks(side, master)
      type(side_type), intent(inout) :: side
      type(face_line_type), intent(in) :: master
      real(dp) :: ends(2), xi
      integer :: j

      side%kinks = [-1.0_dp, 1.0_dp]
      do j = 1, size(master%x, 2), master%side_nodes - 1
         ends = [beside_normal(side, -1.0_dp, master%x(:, j)), &
            beside_normal(side, 1.0_dp, master%x(:, j))]
         if (ends(1)*ends(2) >= 0.0_dp) cycle
         xi = opposite_coordinate(side, master%x(:, j), ends)
         side%kinks = [pack(side%kinks, side%kinks <= xi), xi, pack(side%kinks, side%kinks > xi)]
      end do
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

   !> Divides the segments between sides of which one is curved or has its midside node off the
   !> middle: there the integrand is no polynomial.
   pure subroutine divide_segments(side, master)
      type(side_type), intent(inout) :: side
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

   !> How far a point lies beside the normal at a point of a side.
   pure real(dp) function beside_normal(side, xi, x)
      type(side_type), intent(in) :: side
      real(dp), intent(in) :: xi, x(2)

      associate (psi => side_shape(size(side%x, 2), xi))
         beside_normal = cross(matmul(side%normal, psi), x - matmul(side%x, psi))
      end associate
   end function beside_normal

   !> Coordinate of a side whose normal meets a point, by the Illinois method: false position, in
   !> which an end that stays counts half as much each time.
   pure function opposite_coordinate(side, x, at_ends) result(xi)
      type(side_type), intent(in) :: side
      real(dp), intent(in) :: x(2), at_ends(2)
      real(dp) :: xi
      real(dp) :: before, ends(2), value, values(2)
      integer :: step

      ends = [-1.0_dp, 1.0_dp]
      values = at_ends
      xi = 2.0_dp
      do step = 1, most_steps
         before = xi
         xi = (ends(1)*values(2) - ends(2)*values(1))/(values(2) - values(1))
         value = beside_normal(side, xi, x)
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
      type(side_type), intent(in) :: side
      real(dp), intent(in) :: xi
      type(face_line_type), intent(in) :: master
      real(dp) :: ends(2), eta, gap, nearest, normal(2), point(2), tangent(2)
      integer :: s

      side_opposite = 0
      nearest = huge(nearest)
      normal = matmul(side%normal, side_shape(size(side%x, 2), xi))
      point = matmul(side%x, side_shape(size(side%x, 2), xi))
      do s = 1, side_total(size(master%x, 2), master%side_nodes, master%closed)
         associate (x => master%x(:, side_positions(s, master%side_nodes, size(master%x, 2))))
            ends = [cross(normal, x(:, 1) - point), cross(normal, x(:, size(x, 2)) - point)]
            if (ends(1)*ends(2) > 0.0_dp) cycle
            eta = 0.0_dp
            call project(side, xi, x, eta)
            if (abs(eta) > 1.0_dp + beside) cycle
            tangent = matmul(x, side_slope(size(x, 2), eta))
            if (master%outward*cross(normal, tangent) >= 0.0_dp) cycle
            gap = norm2(matmul(x, side_shape(size(x, 2), eta)) - point)
            if (gap >= nearest) cycle
            nearest = gap
            side_opposite = s
         end associate
      end do
   end function side_opposite

   !> Coordinate eta of the master's side x at which the normal at xi of a slave's side meets it, by
   !> Newton's method.
   pure subroutine project(side, xi, x, eta)
      type(side_type), intent(in) :: side
      real(dp), intent(in) :: xi
      real(dp), intent(in) :: x(:, :)         !! (2, nodes)
      real(dp), intent(inout) :: eta          !! in: a guess
      real(dp) :: change, normal(2), point(2), rate
      integer :: step

      normal = matmul(side%normal, side_shape(size(side%x, 2), xi))
      point = matmul(side%x, side_shape(size(side%x, 2), xi))
      do step = 1, most_steps
         rate = cross(normal, matmul(x, side_slope(size(x, 2), eta)))
         if (abs(rate) <= 0.0_dp) return
         change = -cross(normal, matmul(x, side_shape(size(x, 2), eta)) - point)/rate
         eta = min(max(eta + change, -2.0_dp), 2.0_dp)
         if (abs(change) <= 4*epsilon(eta)) return
      end do
   end subroutine project

   !> Unit normal midway between those of slave and master, which may have any length.
   pure function midway(slave, master) result(normal)
      real(dp), intent(in) :: slave(2), master(2)
      real(dp) :: normal(2)

      normal = slave/norm2(slave) - master/norm2(master)
      normal = normal/norm2(normal)
   end function midway

   !> a b^T.
   pure function outer(a, b)
      real(dp), intent(in) :: a(:), b(:)
      real(dp) :: outer(size(a), size(b))

      outer = spread(a, 2, size(b))*spread(b, 1, size(a))
   end function outer

   !> a x b.
   pure real(dp) function cross(a, b)
      real(dp), intent(in) :: a(2), b(2)

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

end module mortar_segments
