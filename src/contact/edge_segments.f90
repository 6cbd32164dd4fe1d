!> Segments of mortar faces as heat crosses them where the contact ends inside a side: integrals of
!> a hat function times a conductance that varies along the side.
!>
!> A side spans from one contact point to the next. Its coordinate t goes from 0 to 1 between them,
!> and the hat functions of the two are 1 - t and t. On a segment the shape functions of both faces,
!> times the area per t, are cubics in t: exact on straight sides. The conductance of the side with
!> the edge of contact has a root before the edge and falls by orders of magnitude behind it, so its
!> integrals take intervals that shrink towards the edge.
module edge_segments
   use conductance_laws, only: conductance, conductance_law_type
   use kinds, only: dp
   use mortar_sides, only: face_line_type, opposed_shapes, opposed_shapes_type, slave_side_type
   use quadrature, only: gauss_point_10, gauss_weight_10
   implicit none
   private
   public :: edge_profile_type, edge_segment_type, edge_segments_of, hat_type, hats_of, support

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
   end type edge_segment_type

   !> The hat function of a contact point.
   type :: hat_type
      integer, allocatable :: segment(:)    !! (n) segments under it
      integer, allocatable :: end(:)        !! (n) end of their side that it belongs to, 1 or 2
      integer, allocatable :: nodes(:)      !! of these segments, each once
   end type hat_type

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
      real(dp), allocatable :: ends(:)
      real(dp) :: cubic(support), t
      integer :: g, i

      ends = self%ends
      if (present(profile)) ends = graded(self%ends, merge(profile%edge, &
         1.0_dp - profile%edge, profile%closed_first))
      weights = 0.0_dp
      do i = 1, size(ends) - 1
         do g = 1, size(gauss_point_10)
            t = 0.5_dp*(ends(i) + ends(i + 1) + (ends(i + 1) - ends(i))*gauss_point_10(g))
            cubic = 0.5_dp*(ends(i + 1) - ends(i))*gauss_weight_10(g)* &
               cubics((2*t - sum(self%ends))/(self%ends(2) - self%ends(1)))
            if (present(profile)) cubic = cubic*profile%conductance_at(t)
            weights(:, 1) = weights(:, 1) + (1.0_dp - t)*cubic
            weights(:, 2) = weights(:, 2) + t*cubic
         end do
      end do
   end function hat_weights

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
      integer :: count_of, k, pass, s

      do pass = 1, 2
         count_of = 0
         do s = 1, size(side)
            do k = 1, size(side(s)%opposite)
               if (side(s)%opposite(k) == 0) cycle
               count_of = count_of + 1
               if (pass == 2) segments(count_of) = segment_of(side(s), k)
            end do
         end do
         if (pass == 1) allocate (segments(count_of))
      end do

   contains
      pure function segment_of(side, k) result(segment)
         type(slave_side_type), intent(in) :: side
         integer, intent(in) :: k
         type(edge_segment_type) :: segment
         type(opposed_shapes_type) :: shapes
         real(dp) :: width, xi
         integer :: i

         width = side%covered(2) - side%covered(1)
         segment%points = point_of(side%corners)
         segment%ends = (side%kinks(k:k + 1) - side%covered(1))/width
         allocate (segment%difference(size(side%nodes) + master%side_nodes, support))
         do i = 1, support
            xi = 0.5_dp*(side%kinks(k) + side%kinks(k + 1) + &
               (side%kinks(k + 1) - side%kinks(k))*node(i))
            shapes = opposed_shapes(side, k, xi, master, section)
            segment%area(i) = width*shapes%area
            segment%difference(:, i) = segment%area(i)*[shapes%of_slave, -shapes%of_master]
         end do
         segment%nodes = nodes([side%nodes, size(nodes) - size(master%x, 2) + shapes%facing])
      end function segment_of
   end function edge_segments_of

   !> The hat functions of the contact points over the segments.
   pure function hats_of(segments, points) result(hats)
      type(edge_segment_type), intent(in) :: segments(:)
      integer, intent(in) :: points           !! number of contact points
      type(hat_type), allocatable :: hats(:)  !! (points)
      integer :: counts(points), hat, i, j, k

      allocate (hats(points))
      counts = 0
      do i = 1, size(segments)
         do j = 1, 2
            k = segments(i)%points(j)
            if (k > 0) counts(k) = counts(k) + 1
         end do
      end do
      do k = 1, points
         allocate (hats(k)%segment(counts(k)), hats(k)%end(counts(k)), hats(k)%nodes(0))
      end do
      counts = 0
      do i = 1, size(segments)
         do hat = 1, 2
            k = segments(i)%points(hat)
            if (k == 0) cycle
            counts(k) = counts(k) + 1
            hats(k)%segment(counts(k)) = i
            hats(k)%end(counts(k)) = hat
            associate (known => hats(k)%nodes, more => segments(i)%nodes)
               hats(k)%nodes = [known, pack(more, [(all(known /= more(j)), j=1, size(more))])]
            end associate
         end do
      end do
   end function hats_of

end module edge_segments
