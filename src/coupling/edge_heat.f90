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
!> point omega is that of the point itself. The pressure of a closed point beside an edge is that
!> with which its force is the integral of what falls to the edge, and of its hat on the other side,
!> however narrow the contact is: a law conducts what the force carries.
module edge_heat
   use conductance_graph, only: conductance_graph_type
   use conductance_laws, only: conductance, conductance_law_type
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_slip
   use heat_equation, only: heat_across, heat_rates_type
   use mortar_segments, only: edge_profile_type, edge_segment_type, hat_geometry_type, support
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use sum_lists, only: sum_list_type
   use zone_edges, only: contact_end, contact_profile, contact_profile_type, mean_beyond, &
      some_of, turned
   implicit none
   private
   public :: edge_integral_type, edge_heat_type, find_edge_integrals, edge_heat_at
   public :: find_heat_by_opening, joined_conductance, supplied_heat

   !> Integrals of a hat function with an edge below it, for openings of the contact points: over
   !> the sides without an edge, which the conductance of the point multiplies, and over those with
   !> an edge, which hold the conductance along them.
   type :: edge_integral_type
      integer :: point = 0                      !! contact point
      logical :: is_open = .false.
      integer, allocatable :: nodes(:)          !! (n) of both faces
      real(dp) :: area(2) = 0.0_dp              !! of phi_c [length^2], of phi_c omega
      real(dp), allocatable :: shares(:, :)     !! (n, 2) the same times J(x)
   end type edge_integral_type

   !> The contact points with an edge below their hat functions, for openings and conductances.
   type :: edge_heat_type
      integer, allocatable :: point(:)          !! (n) contact points
      real(dp), allocatable :: conductance(:)   !! (n) mean omega_c [power/(length^2 temperature)]
      !> (n) derivative of it by the conductance of the point itself
      real(dp), allocatable :: own(:)
      type(sum_list_type) :: jump = sum_list_type()   !! (n, nodes) J_c
   contains
      procedure :: without
   end type edge_heat_type

   !> The conductance along a side with an edge; unallocated without one.
   type :: side_edge_type
      type(edge_profile_type), allocatable :: along
   end type side_edge_type

   !> The conductances of an interface with edges inside sides.
   type :: edges_type
      type(side_edge_type), allocatable :: sides(:)   !! each from a contact point to the next
      !> (m) conductance of a contact point on its other sides, over that of its mean pressure
      real(dp), allocatable :: own(:)
   contains
      procedure :: has_edge
   end type edges_type

   real(dp), parameter :: least_length = 1.0e-6_dp   !! of a closed part that has a profile [t]
   integer, parameter :: farthest = 4   !! contact points from an end of a side that its edge reads
   !> Difference of openings for derivatives, as a part of those beside them: half of the digits.
   real(dp), parameter :: small_part = sqrt(epsilon(1.0_dp))

contains

   !> The integrals at edges for openings of the contact points.
   pure subroutine find_edge_integrals(bodies, modulus, opening, hats)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: modulus(:)        !! (m) pressure per overlap [stress/length]
      real(dp), intent(in) :: opening(:)        !! (m) openings [length]
      type(edge_integral_type), allocatable, intent(out) :: hats(:)
      type(edge_integral_type), allocatable :: beside(:)
      type(contact_points_type) :: points
      logical :: is_beside(size(opening))
      logical, allocatable :: is_crossed(:)
      integer :: faced, found, i

      do i = 1, size(bodies%interfaces)
         associate (first => bodies%points%interface_start(i), &
            last => bodies%points%interface_start(i + 1) - 1)
            is_beside(first:last) = .false.
            if (.not. bodies%points%resolves_edge(i)) cycle
            if (all(bodies%laws%removed(first:last))) cycle
            is_beside(first:last) = bodies%jump_index(first:last) > 0 .and. &
               beside_edge(opening(first:last) > 0.0_dp, bodies%laws%removed(first:last))
         end associate
      end do
      allocate (beside(count(is_beside)))
      found = 0
      do i = 1, size(bodies%interfaces)
         associate (first => bodies%points%interface_start(i), &
            last => bodies%points%interface_start(i + 1) - 1)
            if (.not. any(is_beside(first:last))) cycle
            call bodies%view(i, points)
            faced = first - 1 + findloc(bodies%laws%removed(first:last), .false., dim=1)
            call integrate_hats(bodies%points%mortar(i), edges_of(points, &
               bodies%laws%conductance(faced), opening(first:last), modulus(first:last), &
               bodies%equilibrium%contact%nodal_stiffness(first:last), bodies%points%mortar(i), &
               bodies%laws%removed(first:last)), is_beside(first:last), beside(found + 1:found + &
               count(is_beside(first:last))))
            associate (new => beside(found + 1:found + count(is_beside(first:last))))
               new%is_open = opening(first - 1 + new%point) > 0.0_dp
               new%point = first - 1 + new%point
            end associate
            found = found + count(is_beside(first:last))
         end associate
      end do
      is_crossed = [(beside(i)%area(2) > 0.0_dp .and. on_tail(bodies, beside(i)%nodes), &
         i=1, size(beside))]
      hats = beside(pack([(i, i=1, size(beside))], is_crossed))
   end subroutine find_edge_integrals

   !> Contact points with an edge in the side before or behind them, or beside a cut. Sides that
   !> reach beyond the master have none.
   pure function beside_edge(is_open, is_beyond) result(beside)
      logical, intent(in) :: is_open(:), is_beyond(:)
      logical :: beside(size(is_open)), has_edge(size(is_open) - 1)

      associate (m => size(is_open))
         has_edge = (is_open(:m - 1) .neqv. is_open(2:)) .and. .not. (is_beyond(:m - 1) .or. &
            is_beyond(2:))
      end associate
      beside = [.false., has_edge] .or. [has_edge, .false.]
   end function beside_edge

   !> The integrals of the hat functions of an interface beside an edge.
   pure subroutine integrate_hats(mortar, edges, is_beside, hats)
      type(hat_geometry_type), intent(in) :: mortar
      type(edges_type), intent(in) :: edges
      logical, intent(in) :: is_beside(:)                ! (m)
      type(edge_integral_type), intent(inout) :: hats(:) ! (count of them)
      real(dp) :: weights(support, 2)
      integer :: i, k, n, side

      hats%point = pack([(k, k=1, size(is_beside))], is_beside)
      do n = 1, size(hats)
         hats(n)%nodes = mortar%hats(hats(n)%point)%nodes
         allocate (hats(n)%shares(size(hats(n)%nodes), 2), source=0.0_dp)
      end do
      do n = 1, size(hats)
         k = hats(n)%point
         do i = 1, size(mortar%hats(k)%segment)
            associate (segment => mortar%segments(mortar%hats(k)%segment(i)), &
               end => mortar%hats(k)%end(i))
               side = segment%side()
               if (.not. edges%has_edge(side)) then
                  weights = edges%own(k)*segment%hat_weights()
                  call add(segment, weights(:, end), 1, hats(n))
               else if (side == k .or. .not. is_beside(side)) then
                  ! Both hats of the side take their integrals at once.
                  weights = segment%hat_weights(edges%sides(side)%along)
                  call add(segment, weights(:, end), 2, hats(n))
                  if (side < k) cycle
                  if (is_beside(k + 1)) call add(segment, weights(:, 3 - end), 2, hats(n + 1))
               end if
            end associate
         end do
      end do
   end subroutine integrate_hats

   !> Adds the integrals over a segment to those of a hat.
   pure subroutine add(segment, weights, kind, hat)
      type(edge_segment_type), intent(in) :: segment
      real(dp), intent(in) :: weights(support)
      integer, intent(in) :: kind             ! of the side: 1 without an edge, 2 with one
      type(edge_integral_type), intent(inout) :: hat
      integer :: at, j

      hat%area(kind) = hat%area(kind) + dot_product(segment%area, weights)
      do j = 1, size(segment%nodes)
         at = findloc(hat%nodes, segment%nodes(j), dim=1)
         hat%shares(at, kind) = hat%shares(at, kind) + &
            dot_product(segment%difference(j, :), weights)
      end do
   end subroutine add

   !> Heat at edges for conductances of the contact points.
   pure function edge_heat_at(hats, weight, omega) result(at_edge)
      type(edge_integral_type), intent(in) :: hats(:)
      real(dp), intent(in) :: weight(:)         !! (m) tributary areas [length^2]
      real(dp), intent(in) :: omega(:)          !! (m) conductances of the points themselves
      type(edge_heat_type) :: at_edge
      real(dp) :: area
      integer :: i

      at_edge%point = hats%point
      allocate (at_edge%conductance(size(hats)), at_edge%own(size(hats)))
      call at_edge%jump%reserve(size(hats), sum([(size(hats(i)%nodes), i=1, size(hats))]))
      do i = 1, size(hats)
         associate (hat => hats(i), own => omega(hats(i)%point))
            area = own*hat%area(1) + hat%area(2)
            at_edge%conductance(i) = area/weight(hat%point)
            at_edge%own(i) = hat%area(1)/weight(hat%point)
            if (.not. hat%is_open .and. own > 0.0_dp) at_edge%own(i) = at_edge%own(i) + &
               hat%area(2)/(own*weight(hat%point))
            call at_edge%jump%add(hat%nodes, (own*hat%shares(:, 1) + hat%shares(:, 2))/area)
         end associate
      end do
   end function edge_heat_at

   !> How the heat that enters the nodes by the hats at edges follows the openings, at given
   !> temperatures: differences with each opening that moves an edge or changes what is beside it,
   !> away from zero. Contact points at rest keep theirs.
   pure subroutine find_heat_by_opening(bodies, graph, opening, resting, temperature, point, heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(conductance_graph_type), intent(in) :: graph(:)   !! (m)
      real(dp), intent(in) :: opening(:)                     !! (m) openings [length]
      logical, intent(in) :: resting(:)                      !! (m) points at rest
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      integer, allocatable, intent(out) :: point(:)          !! (n) whose opening counts
      real(dp), allocatable, intent(out) :: heat(:, :)       !! (nodes, n) [power/length]
      type(edge_integral_type), allocatable :: hats(:), unmoved(:)
      real(dp) :: moved(size(opening)), step
      integer :: i, k, m

      m = size(opening)
      call find_edge_integrals(bodies, graph%modulus, opening, unmoved)
      point = pack([(k, k=1, m)], [(any(abs(unmoved%point - k) <= farthest), k=1, m)] .and. &
         .not. resting)
      allocate (heat(size(temperature), size(point)), source=0.0_dp)
      ! Those that no hat reads both of are moved at once.
      do i = 0, 2*farthest
         moved = opening
         do k = 1, size(point)
            if (modulo(point(k), 2*farthest + 1) /= i) cycle
            associate (j => point(k))
               step = small_part*sum(abs(opening(max(j - 1, 1):min(j + 1, m))))
               moved(j) = opening(j) + merge(step, -step, opening(j) > 0.0_dp)
            end associate
         end do
         if (.not. any(abs(moved - opening) > 0.0_dp)) cycle
         call find_edge_integrals(bodies, graph%modulus, moved, hats)
         call add_entering(hats, moved, 1.0_dp, heat)
         call add_entering(unmoved, opening, -1.0_dp, heat)
      end do
   contains
      !> Adds the heat that enters the nodes by the hats at edges, for each opening that is moved.
      pure subroutine add_entering(integrals, at, factor, sums)
         type(edge_integral_type), intent(in) :: integrals(:)
         real(dp), intent(in) :: at(:)                       ! (m) openings
         real(dp), intent(in) :: factor
         real(dp), intent(inout) :: sums(:, :)               ! (nodes, n)
         type(edge_heat_type) :: at_edge
         real(dp), dimension(size(integrals)) :: crossing, jump
         integer :: n, j

         at_edge = edge_heat_at(integrals, bodies%points%weight, &
            graph%omega(graph%coordinate_of_opening(at)))
         jump = 0.0_dp
         call at_edge%jump%add_totals(temperature, jump)
         crossing = heat_across(bodies%points%weight(at_edge%point), at_edge%conductance, jump)
         do n = 1, size(integrals)
            do j = 1, size(point)
               associate (change => moved(point(j)) - opening(point(j)), &
                  nodes => at_edge%jump%values_of(n))
                  if (abs(point(j) - at_edge%point(n)) > farthest .or. abs(change) <= 0.0_dp) cycle
                  sums(nodes, j) = sums(nodes, j) - factor*crossing(n)/change* &
                     at_edge%jump%coefficients_of(n)
               end associate
            end do
         end do
      end subroutine add_entering
   end subroutine find_heat_by_opening

   !> Whether there is a side of this number, and has an edge.
   elemental logical function has_edge(self, side)
      class(edges_type), intent(in) :: self
      integer, intent(in) :: side

      has_edge = side >= 1 .and. side <= size(self%sides)
      if (has_edge) has_edge = allocated(self%sides(side)%along)
   end function has_edge

   !> The conductances at the edges of an interface.
   pure function edges_of(points, law, opening, modulus, stiffness, mortar, is_beyond) result(edges)
      type(contact_points_type), intent(in) :: points
      type(conductance_law_type), intent(in) :: law
      real(dp), intent(in) :: opening(:), modulus(:)  ! (m)
      real(dp), intent(in) :: stiffness(:)            ! (m) at the nodes [force/length]
      type(hat_geometry_type), intent(in) :: mortar
      logical, intent(in) :: is_beyond(:)             ! (m) the master's end
      type(edges_type) :: edges
      type(contact_profile_type) :: piece, profile
      integer, allocatable :: ends(:)
      integer :: i, k

      profile = contact_profile(points, merge(contact_open, contact_slip, opening > 0.0_dp), &
         max(-opening, 0.0_dp)*modulus, 0.0_dp*opening, merge(opening, opening*modulus* &
         points%weight/max(stiffness, tiny(1.0_dp)), opening > 0.0_dp))
      allocate (edges%sides(size(opening) - 1))
      allocate (edges%own(size(opening)), source=1.0_dp)
      ends = points%ends()
      do i = 1, size(ends), 2
         piece = some_of(profile, [(k, k=ends(i), ends(i + 1))])
         do k = ends(i), ends(i + 1) - 1
            if (count(profile%contact_state(k:k + 1) == contact_open) == 1 .and. .not. &
               any(is_beyond(k:k + 1))) edges%sides(k)%along = edge_between(law, piece, k + 1 - &
               ends(i))
         end do
      end do
      do k = 1, size(opening)
         if (opening(k) >= 0.0_dp) cycle
         if (any(edges%has_edge([k - 1, k]))) call carry_force(mortar, k, edges)
      end do
   end function edges_of

   !> Gives a closed contact point beside edges the pressure whose integral is its force.
   pure subroutine carry_force(mortar, point, edges)
      type(hat_geometry_type), intent(in) :: mortar
      integer, intent(in) :: point
      type(edges_type), intent(inout) :: edges
      real(dp) :: carried, of_hat, of_mean, weight, weights(support, 2)
      integer :: i, side

      carried = 0.0_dp   ! by a pressure of 1
      weight = 0.0_dp
      do i = 1, size(mortar%hats(point)%segment)
         associate (segment => mortar%segments(mortar%hats(point)%segment(i)), &
            end => mortar%hats(point)%end(i))
            weights = segment%hat_weights()
            of_hat = dot_product(segment%area, weights(:, end))
            weight = weight + of_hat
            side = segment%side()
            if (edges%has_edge(side)) of_hat = segment%force_carried(edges%sides(side)%along)
            carried = carried + of_hat
         end associate
      end do
      do side = point - 1, point
         if (.not. edges%has_edge(side)) cycle
         associate (along => edges%sides(side)%along)
            of_mean = conductance(along%law, .true., 0.0_dp, along%pressure)
            along%pressure = along%pressure*weight/carried
            if (of_mean > 0.0_dp) edges%own(point) = conductance(along%law, .true., 0.0_dp, &
               along%pressure)/of_mean
         end associate
      end do
   end subroutine carry_force

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

   !> Heat at edges without the contact points that are left out.
   pure function without(self, left_out) result(kept)
      class(edge_heat_type), intent(in) :: self
      logical, intent(in) :: left_out(:)        !! (m)
      type(edge_heat_type) :: kept
      integer, allocatable :: stay(:)
      integer :: i

      if (.not. allocated(self%point)) return
      stay = pack([(i, i=1, size(self%point))], .not. left_out(self%point))
      kept%point = self%point(stay)
      kept%conductance = self%conductance(stay)
      kept%own = self%own(stay)
      kept%jump = self%jump%chosen(stay)
   end function without

   !> Conductances of the contact points, at edges the mean ones.
   pure function joined_conductance(omega, at_edge) result(joined)
      real(dp), intent(in) :: omega(:)          !! (m)
      type(edge_heat_type), intent(in) :: at_edge
      real(dp) :: joined(size(omega))           !! (m)

      joined = omega
      if (allocated(at_edge%point)) joined(at_edge%point) = at_edge%conductance
   end function joined_conductance

   !> Heat that the supports of each node must supply, without the forces of ties: K T - Q plus what
   !> is stored and what leaves through the contact points, at edges where it crosses, less what
   !> friction makes there.
   pure function supplied_heat(bodies, at_edge, rates) result(heat)
      type(reduced_bodies_type), intent(in) :: bodies
      type(edge_heat_type), intent(in) :: at_edge
      type(heat_rates_type), intent(in) :: rates
      real(dp), allocatable :: heat(:)          !! (nodes) zero where not prescribed [power]
      real(dp) :: undivided(size(rates%crossing))

      undivided = rates%crossing
      if (allocated(at_edge%point)) undivided(at_edge%point) = 0.0_dp
      heat = rates%conducted - rates%entering
      if (allocated(rates%stored)) heat = heat + rates%stored
      call bodies%points%difference%add_shares(undivided, heat)
      if (allocated(rates%friction_heat)) call bodies%points%heat_shares%add_shares( &
         -rates%friction_heat, heat)
      if (allocated(at_edge%point)) call at_edge%jump%add_shares(rates%crossing(at_edge%point), &
         heat)
      call bodies%thermal%map%carry_over(heat)
   end function supplied_heat

end module edge_heat
