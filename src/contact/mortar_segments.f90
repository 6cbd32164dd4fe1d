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
!> slave and master would change it. Where the slave slides along the master by any distance (the
!> master leads it) normals are the master's alone: slip goes along the master, and along any other
!> normal the pressure would do work on it.
!> With N and M the shape functions of slave and master, dA the area of the face midway between both
!>
!>    w_c = integral phi_c dA,  D_ci = integral phi_c N_i dA,  M_cj = integral phi_c M_j dA,
!>
!> and the same D and M times this normal n(xi) between both faces. With the normal of the
!> corner in its place, the mean gap of faces that move apart along their radius would be too small
!> by h^2/12 on sides that turn by the angle h, and the force too: press fits would err by h^2/6.
!>
!> The integrand has kinks where a corner of either face lies, so it is integrated from kink to kink
!> (a segment); a rule on whole sides of the slave fails the patch test by 0.1 to 0.3 %.
!>
!> B. I. Wohlmuth, Acta Numerica 20 (2011) 569; A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, SIAM
!> J. Sci. Comput. 34 (2012) B421 (linear multipliers on quadratic sides).
!>
!> Heat crosses the same segments where the contact ends inside a side: integrals of a hat function
!> times a conductance that varies along the side.
!> A side spans from one contact point to the next. Its coordinate t goes from 0 to 1 between them,
!> and the hat functions of the two are 1 - t and t. On a segment the shape functions of both faces,
!> times the area per t, are cubics in t: exact on straight sides. The conductance of the side with
!> the edge of contact has a root before the edge and falls by orders of magnitude behind it, so its
!> integrals take intervals that shrink towards the edge.
module mortar_segments
   use chain_geometry, only: length_between, side_positions, two_pi
   use conductance_laws, only: conductance, conductance_law_type
   use kinds, only: dp
   use mortar_sides, only: face_line_type, hats, oppose, outward_normals, project, slave_side_type
   use quadrature, only: gauss_point_10, gauss_point_3, gauss_weight_10, gauss_weight_3
   use shape_functions, only: side_shape, side_slope
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: mortar_integrals_type, integrate_segments, edge_profile_type, edge_segment_type, &
      edge_segments_of, hat_geometry_type, hat_type, hats_of, support

   !> The integrals. Corners of the slave are counted along its line.
   type :: mortar_integrals_type
      real(dp), allocatable :: weight(:)   !! (corners) w_c [length^2]
      !> (corners) w_c if the master covered the whole of the sides that it does cover in part
      real(dp), allocatable :: whole(:)
      !> (2, corners) where the hat function is 1: the corner, or the end of the cover [length]
      real(dp), allocatable :: position(:, :)
      real(dp), allocatable :: beyond(:)   !! (corners) how far along the line it lies from there
      !> (2, corners) unit normal of both faces, outward from the slave
      real(dp), allocatable :: normal(:, :)
      type(sparse_matrix_type) :: slave    !! (corners, nodes of the slave) D [length^2]
      type(sparse_matrix_type) :: master   !! (corners, nodes of the master) M [length^2]
      !> the same times the components of n
      type(sparse_matrix_type) :: slave_normal(2), master_normal(2)
   end type mortar_integrals_type

   !> Sums so far.
   type, extends(mortar_integrals_type) :: segment_sums_type
      real(dp), allocatable :: apart(:)       !! (corners) from the covered part, as a coordinate
      real(dp), allocatable :: facing(:, :)   !! (2, corners) normal of the master; the other: slave
      type(triplet_list_type) :: of_slave(0:2), of_master(0:2)   !! without n, with its components
   end type segment_sums_type

   integer, parameter :: support = 4           !! values of a cubic
   integer, parameter :: gradings = 12         !! intervals on either side of an edge
   real(dp), parameter :: grading = 0.3_dp     !! length of one in that of the next
   !> Where the values of the cubics are taken, in a segment from -1 to 1.
   real(dp), parameter :: node(support) = [-0.9_dp, -0.3_dp, 0.3_dp, 0.9_dp]

   !> A segment that both faces cut, within one side.
   type :: edge_segment_type
      integer :: points(2) = 0              !! contact points at the ends of its side
      real(dp) :: ends(2) = 0.0_dp          !! t where it begins and ends
      integer, allocatable :: nodes(:)      !! (n) of both faces
      !> (n, support) shape functions of the slave, less those of the master, times dA/dt [length^2]
      real(dp), allocatable :: difference(:, :)
      real(dp) :: area(support) = 0.0_dp    !! dA/dt [length^2]
   contains
      procedure :: side
      procedure :: hat_weights
      procedure :: force_carried
   end type edge_segment_type

   !> The hat function of a contact point.
   type :: hat_type
      integer, allocatable :: segment(:)    !! (n) segments under it
      integer, allocatable :: end(:)        !! (n) end of their side that it belongs to, 1 or 2
      integer, allocatable :: nodes(:)      !! of these segments, each once
   end type hat_type

   !> The hat functions of an interface.
   type :: hat_geometry_type
      type(edge_segment_type), allocatable :: segments(:)
      type(hat_type), allocatable :: hats(:)   !! (m) over these
   end type hat_geometry_type

   !> Conductance along the side that contains an edge of contact.
   type :: edge_profile_type
      type(conductance_law_type) :: law     !! of the interface
      logical :: closed_first = .true.      !! whether the side is closed at t = 0, or at t = 1
      real(dp) :: edge = 1.0_dp             !! distance of the edge from the closed end [t]
      real(dp) :: pressure = 0.0_dp         !! at the closed end [stress]
      real(dp) :: gap_rate = 0.0_dp         !! gap behind the edge over distance^1.5 [length/t^1.5]
   contains
      procedure :: conductance_at
   end type edge_profile_type

contains

   !> Integrates over all segments.
   pure subroutine integrate_segments(slave, master, side, thickness, about_axis, integrals)
      type(face_line_type), intent(in) :: slave, master
      type(slave_side_type), intent(in) :: side(:)  !! of the slave
      real(dp), intent(in) :: thickness       !! not used about an axis [length]
      logical, intent(in) :: about_axis       !! whether areas are swept round the axis x = 0
      type(mortar_integrals_type), intent(out) :: integrals
      real(dp) :: master_normal(2, size(master%x, 2)), normal(2, size(slave%x, 2)), section
      integer :: corners, k, s
      integer, allocatable :: segments(:)
      type(segment_sums_type) :: sums

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
         call sums%of_slave(k)%reserve(2*slave%side_nodes*sum(segments))
         call sums%of_master(k)%reserve(2*master%side_nodes*sum(segments))
      end do
      section = merge(0.0_dp, thickness, about_axis)
      do s = 1, size(side)
         do k = 1, segments(s)
            call add_segment(side(s), k, master, master_normal, section, sums)
         end do
      end do
      integrals = sums%mortar_integrals_type
      integrals%normal = sums%normal - sums%facing
      do k = 1, corners
         integrals%normal(:, k) = integrals%normal(:, k)/norm2(integrals%normal(:, k))
      end do
      integrals%slave = sums%of_slave(0)%compress(corners, size(slave%x, 2))
      integrals%master = sums%of_master(0)%compress(corners, size(master%x, 2))
      do k = 1, 2
         integrals%slave_normal(k) = sums%of_slave(k)%compress(corners, size(slave%x, 2))
         integrals%master_normal(k) = sums%of_master(k)%compress(corners, size(master%x, 2))
      end do
   end subroutine integrate_segments

   !> Adds the integrals over one segment; without a master opposite, the area of the hats alone.
   pure subroutine add_segment(side, segment, master, master_normal, section, sums)
      type(slave_side_type), intent(in) :: side
      integer, intent(in) :: segment
      type(face_line_type), intent(in) :: master
      real(dp), intent(in) :: master_normal(:, :)  ! (2, nodes)
      real(dp), intent(in) :: section         ! thickness, 0 about an axis [length]
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: along(2), area, between(2), ends(2), eta, factor(0:2), hat(2), normals(2, 2), &
         radius, weighted(2), xi
      real(dp) :: psi(size(side%nodes)), psi_master(master%side_nodes)
      real(dp) :: of_slave(2, size(psi), 0:2), of_master(2, size(psi_master), 0:2)
      real(dp), dimension(2, size(psi_master)) :: facing_normal, x
      integer :: facing(master%side_nodes), g, i, k

      if (side%covered(1) > side%covered(2)) return
      ends = side%kinks(segment:segment + 1)
      facing = side_positions(max(side%opposite(segment), 1), master%side_nodes, size(master%x, 2))
      x = master%x(:, facing)
      facing_normal = master_normal(:, facing)
      eta = 0.0_dp
      of_slave = 0.0_dp
      of_master = 0.0_dp
      do g = 1, size(gauss_point_10)
         xi = 0.5_dp*(ends(1) + ends(2) + (ends(2) - ends(1))*gauss_point_10(g))
         psi = side_shape(size(psi), xi)
         along = matmul(side%x, side_slope(size(psi), xi))
         area = 0.5_dp*(ends(2) - ends(1))*gauss_weight_10(g)*norm2(along)
         radius = dot_product(psi, side%x(1, :))
         if (side%opposite(segment) > 0) then
            call project(side, xi, x, eta)
            psi_master = side_shape(size(psi_master), eta)
            radius = 0.5_dp*(radius + dot_product(psi_master, x(1, :)))
         end if
         area = area*merge(section, two_pi*abs(radius), section > 0.0_dp)
         sums%whole(side%corners) = sums%whole(side%corners) + area*0.5_dp*[1.0_dp - xi, &
            1.0_dp + xi]
         if (side%opposite(segment) == 0) cycle
         hat = hats(side, xi)
         sums%weight(side%corners) = sums%weight(side%corners) + area*hat
         normals(:, 1) = matmul(side%normal, psi)
         normals(:, 2) = matmul(facing_normal, psi_master)
         if (master%leads) normals(:, 1) = -normals(:, 2)
         ! The unit normal midway between both, which may have any length.
         between = normals(:, 1)/norm2(normals(:, 1)) - normals(:, 2)/norm2(normals(:, 2))
         factor = [1.0_dp, between/norm2(between)]
         do k = 0, 2
            weighted = factor(k)*area*hat
            do i = 1, size(psi)
               of_slave(:, i, k) = of_slave(:, i, k) + weighted*psi(i)
            end do
            do i = 1, size(psi_master)
               of_master(:, i, k) = of_master(:, i, k) + weighted*psi_master(i)
            end do
         end do
      end do
      if (side%opposite(segment) == 0) return
      do k = 0, 2
         call sums%of_slave(k)%add_block(side%corners, side%nodes, of_slave(:, :, k))
         call sums%of_master(k)%add_block(side%corners, facing, of_master(:, :, k))
      end do
      call find_positions(side, segment, x, facing_normal, master%leads, sums)
   end subroutine add_segment

   !> Where the hats of a side's corners are 1, and the normals there, if this segment lies nearer
   !> to the corner than those before.
   pure subroutine find_positions(side, segment, x, master_normal, leads, sums)
      type(slave_side_type), intent(in) :: side
      integer, intent(in) :: segment
      real(dp), intent(in) :: x(:, :), master_normal(:, :)  ! (2, nodes) of the side opposite
      logical, intent(in) :: leads                          ! whether its normals count alone
      type(segment_sums_type), intent(inout) :: sums
      real(dp) :: eta, from, normal(2), xi
      integer :: c

      do c = 1, 2
         if (c == 2 .and. any(side%opposite(segment + 1:) > 0)) cycle   ! these lie nearer
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
            if (leads) sums%normal(:, corner) = -sums%facing(:, corner)
         end associate
      end do
   end subroutine find_positions

   !> Near the edge p = p_k sqrt((a - x)/(a - x_k)) and gap = C (x - a)^1.5.
   pure real(dp) function conductance_at(self, t)
      class(edge_profile_type), intent(in) :: self
      real(dp), intent(in) :: t             !! coordinate of the side
      real(dp) :: beyond

      beyond = merge(t, 1.0_dp - t, self%closed_first) - self%edge
      if (beyond < 0.0_dp) then
         conductance_at = conductance(self%law, .true., 0.0_dp, &
            self%pressure*sqrt(min(-beyond/self%edge, 1.0_dp)))
      else
         conductance_at = conductance(self%law, .false., self%gap_rate*beyond*sqrt(beyond), 0.0_dp)
      end if
   end function conductance_at

   !> The side that a segment is in, between contact points `side` and `side + 1`; 0 where its two
   !> are not beside each other.
   pure integer function side(self)
      class(edge_segment_type), intent(in) :: self

      side = minval(self%points)
      if (abs(self%points(2) - self%points(1)) /= 1) side = 0
   end function side

   !> Integrals of the cubics of a segment times both hat functions, 1 - t and t, and times the
   !> conductance of a profile.
   pure function hat_weights(self, profile) result(weights)
      class(edge_segment_type), intent(in) :: self
      type(edge_profile_type), intent(in), optional :: profile   !! without it: a conductance of 1
      real(dp) :: weights(support, 2)
      real(dp), allocatable :: ends(:), point(:), weight(:)
      real(dp) :: cubic(support), t
      integer :: g, i

      if (present(profile)) then
         ends = graded(self%ends, merge(profile%edge, 1.0_dp - profile%edge, profile%closed_first))
         point = gauss_point_10
         weight = gauss_weight_10
      else
         ends = self%ends
         point = gauss_point_3   ! exact
         weight = gauss_weight_3
      end if
      weights = 0.0_dp
      do i = 1, size(ends) - 1
         do g = 1, size(point)
            t = 0.5_dp*(ends(i) + ends(i + 1) + (ends(i + 1) - ends(i))*point(g))
            cubic = 0.5_dp*(ends(i + 1) - ends(i))*weight(g)* &
               cubics((2*t - sum(self%ends))/(self%ends(2) - self%ends(1)))
            if (present(profile)) cubic = cubic*profile%conductance_at(t)
            weights(:, 1) = weights(:, 1) + (1.0_dp - t)*cubic
            weights(:, 2) = weights(:, 2) + t*cubic
         end do
      end do
   end function hat_weights

   !> Integral over a segment of the pressure of a profile that is 1 at its closed end. In the root
   !> that this pressure is, the integrand is a polynomial.
   pure real(dp) function force_carried(self, profile) result(force)
      class(edge_segment_type), intent(in) :: self
      type(edge_profile_type), intent(in) :: profile
      real(dp) :: apart(2), root, roots(2), t
      integer :: g

      apart = merge(self%ends, 1.0_dp - self%ends, profile%closed_first)
      roots = sqrt(max(1.0_dp - apart/profile%edge, 0.0_dp))
      force = 0.0_dp
      do g = 1, size(gauss_point_10)
         root = 0.5_dp*(sum(roots) + (roots(2) - roots(1))*gauss_point_10(g))
         t = profile%edge*(1.0_dp - root**2)
         if (.not. profile%closed_first) t = 1.0_dp - t
         force = force + abs(roots(2) - roots(1))*gauss_weight_10(g)*profile%edge*root**2* &
            dot_product(self%area, cubics((2*t - sum(self%ends))/(self%ends(2) - self%ends(1))))
      end do
   end function force_carried

   !> Ends of intervals that shrink towards an edge.
   pure function graded(ends, edge) result(all_ends)
      real(dp), intent(in) :: ends(2), edge
      real(dp), allocatable :: all_ends(:)
      real(dp) :: at_edge(2*gradings + 1)
      integer :: i

      at_edge = edge + [(-grading**i, i=1, gradings), 0.0_dp, (grading**i, i=gradings, 1, -1)]
      all_ends = [ends(1), pack(at_edge, at_edge > ends(1) .and. at_edge < ends(2)), ends(2)]
   end function graded

   !> The cubics that are 1 at one of the support points.
   pure function cubics(x) result(values)
      real(dp), intent(in) :: x              ! -1 to 1 in the segment
      real(dp) :: values(support)
      integer :: i, j

      values = 1.0_dp
      do i = 1, support
         do j = 1, support
            if (i /= j) values(i) = values(i)*(x - node(j))/(node(i) - node(j))
         end do
      end do
   end function cubics

   !> The segments of two faces that lie opposite each other.
   pure function edge_segments_of(side, master, nodes, section, point_of) result(segments)
      type(slave_side_type), intent(in) :: side(:)  !! of the slave
      type(face_line_type), intent(in) :: master
      integer, intent(in) :: nodes(:)         !! of the slave, then of the master
      real(dp), intent(in) :: section         !! thickness, 0 about an axis [length]
      integer, intent(in) :: point_of(:)      !! (corners) contact point of each; 0 for none
      type(edge_segment_type), allocatable :: segments(:)
      integer :: k, n, s

      allocate (segments(sum([(count(side(s)%opposite > 0), s=1, size(side))])))
      n = 0
      do s = 1, size(side)
         do k = 1, size(side(s)%opposite)
            if (side(s)%opposite(k) == 0) cycle
            n = n + 1
            segments(n) = segment_of(side(s), k)
         end do
      end do

   contains
      pure function segment_of(side, k) result(segment)
         type(slave_side_type), intent(in) :: side
         integer, intent(in) :: k
         type(edge_segment_type) :: segment
         real(dp) :: area, of_master(master%side_nodes), of_slave(size(side%nodes)), width, xi
         real(dp) :: x(2, size(of_master))
         integer :: facing(size(of_master)), i

         facing = side_positions(side%opposite(k), size(facing), size(master%x, 2))
         x = master%x(:, facing)
         width = side%covered(2) - side%covered(1)
         segment%points = point_of(side%corners)
         segment%ends = (side%kinks(k:k + 1) - side%covered(1))/width
         allocate (segment%difference(size(of_slave) + size(of_master), support))
         do i = 1, support
            xi = 0.5_dp*(side%kinks(k) + side%kinks(k + 1) + &
               (side%kinks(k + 1) - side%kinks(k))*node(i))
            call oppose(side, xi, x, section, of_slave, of_master, area)
            segment%area(i) = width*area
            segment%difference(:size(of_slave), i) = segment%area(i)*of_slave
            segment%difference(size(of_slave) + 1:, i) = -segment%area(i)*of_master
         end do
         allocate (segment%nodes(size(of_slave) + size(of_master)))
         segment%nodes(:size(of_slave)) = nodes(side%nodes)
         segment%nodes(size(of_slave) + 1:) = nodes(size(nodes) - size(master%x, 2) + facing)
      end function segment_of
   end function edge_segments_of

   !> The hat functions of the contact points over the segments.
   pure function hats_of(segments, points) result(hats)
      type(edge_segment_type), intent(in) :: segments(:)
      integer, intent(in) :: points           !! number of contact points
      type(hat_type), allocatable :: hats(:)  !! (points)
      integer :: counts(points), hat, i, j, k, n
      integer, allocatable :: known(:)

      allocate (hats(points))
      counts = 0
      n = 0
      do i = 1, size(segments)
         n = n + size(segments(i)%nodes)
         do j = 1, 2
            k = segments(i)%points(j)
            if (k > 0) counts(k) = counts(k) + 1
         end do
      end do
      allocate (known(n))
      do k = 1, points
         allocate (hats(k)%segment(counts(k)), hats(k)%end(counts(k)))
      end do
      counts = 0
      do i = 1, size(segments)
         do hat = 1, 2
            k = segments(i)%points(hat)
            if (k == 0) cycle
            counts(k) = counts(k) + 1
            hats(k)%segment(counts(k)) = i
            hats(k)%end(counts(k)) = hat
         end do
      end do
      do k = 1, points
         n = 0
         do i = 1, counts(k)
            associate (more => segments(hats(k)%segment(i))%nodes)
               do j = 1, size(more)
                  if (any(known(:n) == more(j))) cycle
                  n = n + 1
                  known(n) = more(j)
               end do
            end associate
         end do
         hats(k)%nodes = known(:n)
      end do
   end function hats_of

end module mortar_segments
