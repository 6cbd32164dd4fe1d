!> Heat at the edge of contact, where the edge lies inside a side of mortar points.
!>
!> Elsewhere a contact point has one conductance, and the jump J of its heat, weight omega J, is the
!> mean with its hat function. Over the hats of the two points at the ends of the side with an edge,
!> omega varies by orders of magnitude. D of (3.3) is evaluated with omega inside these hats: with
!> J(x) the jump at x,
!>
!>    weight omega_c = integral of phi_c omega dA,
!>    weight omega_c J_c = integral of phi_c omega J(x) dA,
!>
!> so that the heat enters the bodies where it crosses, by the same sum. On the other side of a
!> point omega is that of the point itself.
module cut_hats
   use all_contact_points, only: all_contact_points_type
   use conductance_laws, only: conductance_law_type
   use contact_points, only: contact_points_type
   use contact_states, only: contact_open, contact_slip
   use edge_segments, only: edge_profile_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use sum_lists, only: sum_list_type
   use zone_edges, only: contact_end, contact_profile_type, mean_beyond, turned
   implicit none
   private
   public :: cut_hats_type, find_cut_hats, joined_conductance

   !> The contact points whose hats an edge cuts.
   type :: cut_hats_type
      integer, allocatable :: point(:)          !! (n) contact points
      real(dp), allocatable :: conductance(:)   !! (n) mean omega_c [power/(length^2 temperature)]
      !> (n) derivative of it by the conductance of the point itself
      real(dp), allocatable :: own(:)
      type(sum_list_type) :: jump = sum_list_type()   !! (n, nodes) J_c
   contains
      procedure :: points_crossed
      procedure :: without
   end type cut_hats_type

   !> The conductance along a side with an edge; unallocated without one.
   type :: side_edge_type
      type(edge_profile_type), allocatable :: along
   end type side_edge_type

   real(dp), parameter :: least_length = 1.0e-6_dp   !! of a closed part that has a profile [t]

contains

   !> The cut hats for openings of the contact points.
   pure subroutine find_cut_hats(bodies, modulus, opening, omega, cut)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: modulus(:)        !! (m) pressure per overlap [stress/length]
      real(dp), intent(in) :: opening(:)        !! (m) openings [length]
      real(dp), intent(in) :: omega(:)          !! (m) conductances of the points themselves
      type(cut_hats_type), intent(out) :: cut
      type(contact_profile_type) :: profile
      type(side_edge_type), allocatable :: edges(:)
      integer :: first, i, k, last

      allocate (cut%point(0), cut%conductance(0), cut%own(0))
      call cut%jump%reserve(8, 64)
      do i = 1, size(bodies%interfaces)
         first = bodies%points%interface_start(i)
         last = bodies%points%interface_start(i + 1) - 1
         if (.not. bodies%points%cuts_hats(i) .or. bodies%points%removed(first)) cycle
         associate (points => bodies%interfaces(i), z => opening(first:last))
            profile%s = points%arc_length
            profile%weight = points%weight
            profile%contact_state = merge(contact_open, contact_slip, z > 0.0_dp)
            profile%gap = max(z, 0.0_dp)
            profile%pressure = max(-z, 0.0_dp)*modulus(first:last)
            profile%shear = 0.0_dp*z
            profile%hat_spacings = points%node_spacings
            edges = edges_of(bodies%points, profile, first - 1)
            do k = 1, size(z)
               if (bodies%jump_index(first + k - 1) == 0) cycle
               associate (beside => profile%contact_state(max(k - 1, 1):min(k + 1, size(z))))
                  if (all(beside == contact_open) .or. all(beside /= contact_open)) cycle
               end associate
               call add_hat(bodies, points, edges, [k, first - 1], z(k) > 0.0_dp, omega, cut)
            end do
         end associate
      end do
   end subroutine find_cut_hats

   !> Adds a contact point if an edge cuts its hat.
   pure subroutine add_hat(bodies, points, edges, numbers, is_open, omega, cut)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_points_type), intent(in) :: points
      type(side_edge_type), intent(in) :: edges(:)   ! (sides)
      integer, intent(in) :: numbers(2)  ! contact point of the interface; those before it
      logical, intent(in) :: is_open
      real(dp), intent(in) :: omega(:)
      type(cut_hats_type), intent(inout) :: cut
      integer, allocatable :: nodes(:)
      real(dp), allocatable :: shares(:), part(:)
      real(dp) :: area, factor, of_segment, own
      integer :: hat, i, j, side
      logical :: crossed, is_cut

      is_cut = .false.
      area = 0.0_dp
      own = 0.0_dp
      associate (k => numbers(1), point => sum(numbers))
         nodes = bodies%points%difference%values_of(point)
         allocate (shares(size(nodes)), source=0.0_dp)
         do i = 1, size(points%segments)
            associate (segment => points%segments(i))
               do hat = 1, 2
                  if (segment%points(hat) /= k) cycle
                  part = 0.0_dp*segment%difference(:, 1)
                  of_segment = 0.0_dp
                  side = side_between(k, segment%points(3 - hat))
                  crossed = .false.
                  if (side > 0) crossed = allocated(edges(side)%along)
                  if (crossed) then
                     call segment%integrate(hat, part, of_segment, edges(side)%along)
                  else
                     call segment%integrate(hat, part, of_segment)
                  end if
                  is_cut = is_cut .or. crossed
                  factor = merge(1.0_dp, omega(point), crossed)
                  area = area + factor*of_segment
                  if (.not. crossed) then
                     own = own + of_segment
                  else if (.not. is_open .and. omega(point) > 0.0_dp) then
                     own = own + of_segment/omega(point)
                  end if
                  do j = 1, size(part)
                     call add_share(segment%nodes(j), factor*part(j), nodes, shares)
                  end do
               end do
            end associate
         end do
         if (.not. is_cut .or. area <= 0.0_dp) return
         if (.not. on_tail(bodies, nodes)) return
         cut%point = [cut%point, point]
         cut%conductance = [cut%conductance, area/bodies%points%weight(point)]
         cut%own = [cut%own, own/bodies%points%weight(point)]
         call cut%jump%add(nodes, shares/area)
      end associate
   end subroutine add_hat

   !> The side between two contact points, 0 where they are not beside each other.
   pure integer function side_between(k, other)
      integer, intent(in) :: k, other      ! other: 0 for none

      side_between = 0
      if (other > 0 .and. abs(other - k) == 1) side_between = min(k, other)
   end function side_between

   !> The conductances along the sides with an edge, each between a contact point and the next.
   pure function edges_of(points, profile, before) result(edges)
      type(all_contact_points_type), intent(in) :: points
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: before
      type(side_edge_type), allocatable :: edges(:)   ! (sides)
      integer :: k

      allocate (edges(size(profile%s) - 1))
      do k = 1, size(edges)
         if (count(profile%contact_state(k:k + 1) == contact_open) == 1) edges(k)%along = &
            edge_between(points%law(before + k), profile, k)
      end do
   end function edges_of

   !> Whether temperatures of nodes follow from the unknowns of the tail alone.
   pure logical function on_tail(bodies, nodes)
      type(reduced_bodies_type), intent(in) :: bodies
      integer, intent(in) :: nodes(:)
      integer :: i

      on_tail = .true.
      do i = 1, size(nodes)
         on_tail = on_tail .and. all(bodies%thermal%map%tail_index( &
            bodies%thermal%map%by_unknowns%values_of(nodes(i))) > 0)
      end do
   end function on_tail

   pure subroutine add_share(node, share, nodes, shares)
      integer, intent(in) :: node
      real(dp), intent(in) :: share
      integer, allocatable, intent(inout) :: nodes(:)
      real(dp), allocatable, intent(inout) :: shares(:)
      integer :: i

      i = findloc(nodes, node, dim=1)
      if (i == 0) then
         nodes = [nodes, node]
         shares = [shares, 0.0_dp]
         i = size(nodes)
      end if
      shares(i) = shares(i) + share
   end subroutine add_share

   !> The conductance along the side between contact points k and k + 1 with an edge.
   pure function edge_between(law, profile, k) result(edge)
      type(conductance_law_type), intent(in) :: law
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k
      type(edge_profile_type) :: edge
      type(contact_profile_type) :: along
      real(dp) :: a, length, mean
      integer :: closed, m

      m = size(profile%s)
      edge%law = law
      edge%closed_first = profile%contact_state(k) /= contact_open
      along = profile
      closed = k
      if (.not. edge%closed_first) then
         along = turned(profile)
         closed = m - k
      end if
      a = contact_end(along, closed)
      associate (s => along%s)
         length = s(closed + 1) - s(closed)
         edge%edge = max((a - s(closed))/length, least_length)
         edge%pressure = along%pressure(closed)
         mean = mean_beyond(s(closed:min(closed + 2, m)), a)
         edge%gap_rate = huge(1.0_dp)**0.25_dp
         if (mean > 0.0_dp) edge%gap_rate = along%gap(closed + 1)/mean*length**1.5_dp
      end associate
   end function edge_between

   !> The contact points with the sums by which heat crosses them.
   pure function points_crossed(self, points) result(crossed)
      class(cut_hats_type), intent(in) :: self
      type(all_contact_points_type), intent(in) :: points
      type(all_contact_points_type) :: crossed
      integer :: i, k

      crossed = points
      if (.not. allocated(self%point)) return
      if (size(self%point) == 0) return
      call crossed%difference%reserve(size(points%slave), size(points%difference%value))
      do k = 1, size(points%slave)
         i = findloc(self%point, k, dim=1)
         if (i > 0) then
            call crossed%difference%add(self%jump%values_of(i), self%jump%coefficients_of(i))
         else
            call crossed%difference%add(points%difference%values_of(k), &
               points%difference%coefficients_of(k))
         end if
      end do
   end function points_crossed

   !> The cut hats of the contact points that are not left out.
   pure function without(self, left_out) result(kept)
      class(cut_hats_type), intent(in) :: self
      logical, intent(in) :: left_out(:)        !! (m)
      type(cut_hats_type) :: kept
      logical, allocatable :: stays(:)
      integer :: i

      if (.not. allocated(self%point)) return
      stays = .not. left_out(self%point)
      kept%point = pack(self%point, stays)
      kept%conductance = pack(self%conductance, stays)
      kept%own = pack(self%own, stays)
      call kept%jump%reserve(size(stays), size(self%jump%value))
      do i = 1, size(stays)
         if (stays(i)) call kept%jump%add(self%jump%values_of(i), self%jump%coefficients_of(i))
      end do
   end function without

   !> Conductances of the contact points, of cut hats the mean ones.
   pure function joined_conductance(omega, cut) result(joined)
      real(dp), intent(in) :: omega(:)          !! (m)
      type(cut_hats_type), intent(in) :: cut
      real(dp) :: joined(size(omega))           !! (m)

      joined = omega
      if (allocated(cut%point)) joined(cut%point) = cut%conductance
   end function joined_conductance

end module cut_hats
