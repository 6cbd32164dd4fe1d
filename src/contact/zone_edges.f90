!> Edges of the contact and stick zones, sharpened below the nodal spacing.
!>
!> Edge of contact, between a closed and an open contact point: near it p goes like sqrt(a - s) and
!> the gap like (s - a)^(3/2), so that gap^(2/3) goes to zero smoothly. The contact points next to
!> the edge err most, pressures more than gaps: the edge is the zero of a parabola through gap^(2/3)
!> of the second to fourth open contact point, kept between the two contact points. Where fewer are
!> open, it goes through the first to third, or a straight line through the first two; where there
!> is but one, p^2 is on a straight line through two contact points. Mortar points, which are as far
!> apart as two node pairs, count only near the edge. Their gap is a mean with a hat; their distance
!> d from a trial edge a is that for which d^(3/2) is the mean of (x - a)^(3/2).
!>
!> At a ridge the gap opens at an angle, gap^(2/3) vanishes before the contact point, and what
!> carries the force may be far narrower than a side. Its width goes like force/(stiffness angle),
!> and so does the zero of a straight line from the overlap that the force of a mortar point presses
!> out to the next gap. Where none beside that point is closed, the edge is no nearer than this
!> zero.
!>
!> Edge of stick: the zero of mu p - |tau|, which is p_tau = mu p_n. Behind a front that advances
!> with the load it has no root singularity on the nodal scale, but the slip that was frozen at each
!> contact point when the next one closed makes it noisy; so a straight line is fitted to the last
!> four node spacings, two sides of three nodes, weighted with the tributary lengths, which makes it
!> the resultant and moment of the nodal forces themselves.
!>
!> Edges are looked for towards growing s; an edge on the other side is the same with the arrays
!> turned round. None is looked for between pieces of a face, and on a closed face between the last
!> contact point and the first.
module zone_edges
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type, ends_of_pieces
   use contact_system, only: contact_open, contact_slip, contact_stick
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_profile_type, contact_profile, contact_edges, contact_end
   public :: edges_kept, mean_beyond, some_of, stick_edges, turned

   integer, parameter :: edges_kept = 4     !! zone edges kept for an interface

   integer, parameter :: fitted_spacings = 4   !! node spacings of two three-node sides
   integer, parameter :: halvings = 50         !! of the interval with the edge
   !> How far from the first open one mortar points count, in the length of the side with the edge.
   real(dp), parameter :: reach_of_hats = 6.0_dp

   !> States of the contact points of an interface, along it.
   type :: contact_profile_type
      real(dp), allocatable :: s(:)          !! (m) arc length [length]
      real(dp), allocatable :: weight(:)     !! (m) tributary areas [length^2]
      integer, allocatable :: contact_state(:) !! (m) contact states
      real(dp), allocatable :: pressure(:)   !! (m) [stress]
      real(dp), allocatable :: shear(:)      !! (m) [stress]
      !> (m) gap; where closed, minus the overlap that the force presses out if its nodes yield
      !> alone [length]
      real(dp), allocatable :: gap(:)
      !> node spacings from a contact point to the next, where gaps are means with hat functions; 0
      !> for node pairs
      integer :: hat_spacings = 0
      !> contact points that are the last of their pieces, but for the last piece; unallocated for
      !> one piece
      integer, allocatable :: cuts(:)
   end type contact_profile_type

contains

   !> States of the contact points of an interface, along it.
   pure function contact_profile(points, contact_state, pressure, shear, gap) result(profile)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: contact_state(:)   !! (m)
      real(dp), intent(in) :: pressure(:)       !! (m) [stress]
      real(dp), intent(in) :: shear(:)          !! (m) [stress]
      real(dp), intent(in) :: gap(:)            !! (m) where closed minus the overlap [length]
      type(contact_profile_type) :: profile

      profile%s = points%arc_length
      profile%weight = points%weight
      profile%contact_state = contact_state
      profile%pressure = pressure
      profile%shear = shear
      profile%gap = gap
      ! Gaps are read up to the end of the master.
      if (allocated(points%is_beyond)) profile%gap = merge(0.0_dp, gap, points%is_beyond)
      if (points%pairing == pairing_surfaces) profile%hat_spacings = points%node_spacings
      if (allocated(points%cuts)) profile%cuts = points%cuts
   end function contact_profile

   !> Some contact points of a profile, as those of the only piece.
   pure function some_of(profile, which) result(some)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: which(:)           !! the contact points
      type(contact_profile_type) :: some

      some%s = profile%s(which)
      some%weight = profile%weight(which)
      some%contact_state = profile%contact_state(which)
      some%pressure = profile%pressure(which)
      some%shear = profile%shear(which)
      some%gap = profile%gap(which)
      some%hat_spacings = profile%hat_spacings
   end function some_of

   !> Edges between contact and gap, ascending, padded with NaN, and the outer edge of the contact
   !> zone with the largest s. A zone that reaches the last contact point ends there; that end is no
   !> edge.
   pure subroutine contact_edges(profile, edges, outer)
      type(contact_profile_type), intent(in) :: profile
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without contact [length]
      integer :: found, i, k
      integer, allocatable :: ends(:)

      found = 0
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      ends = ends_of_pieces(size(profile%s), profile%cuts)
      do i = 1, size(ends), 2
         call add_contact_edges(some_of(profile, [(k, k=ends(i), ends(i + 1))]), edges, found, &
            outer)
      end do
   end subroutine contact_edges

   !> Adds the edges of a piece.
   pure subroutine add_contact_edges(profile, edges, found, outer)
      type(contact_profile_type), intent(in) :: profile
      real(dp), intent(inout) :: edges(:), outer
      integer, intent(inout) :: found
      type(contact_profile_type) :: back
      real(dp) :: edge
      integer :: k, m

      back = turned(profile)
      m = size(profile%s)
      do k = 1, m - 1
         associate (is_open => profile%contact_state(k) == contact_open, &
            next_is_open => profile%contact_state(k + 1) == contact_open)
            if (is_open .eqv. next_is_open) cycle
            if (next_is_open) then
               edge = contact_end(profile, k)
               outer = edge
            else
               edge = -contact_end(back, m - k)
            end if
         end associate
         call keep(edge, edges, found)
      end do
      if (m > 0) then
         if (profile%contact_state(m) /= contact_open) outer = profile%s(m)
      end if
   end subroutine add_contact_edges

   !> The profile of one piece from its other end.
   pure function turned(profile) result(back)
      type(contact_profile_type), intent(in) :: profile
      type(contact_profile_type) :: back
      integer :: k

      back = some_of(profile, [(k, k=size(profile%s), 1, -1)])
      back%s = -back%s
   end function turned

   !> Edge between closed contact point k and open contact point k + 1.
   pure function contact_end(profile, k) result(edge)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k
      real(dp) :: edge
      integer :: first, last
      logical :: carries, is_near

      edge = profile%s(k)
      carries = carries_alone(profile, k)
      associate (s => profile%s, gap => profile%gap)
         if (carries) edge = s(k) + (s(k + 1) - s(k))*gap(k)/(gap(k) - gap(k + 1))
         ! The first closed one behind k ends the open ones, of which four count.
         last = k - 1 + findloc([profile%contact_state(k + 1:min(k + 4, size(gap))) /= &
            contact_open, .true.], .true., dim=1)
         do while (last > k + 1)
            first = max(k + 1, last - 2)
            is_near = profile%hat_spacings == 0 .or. last == k + 2 .or. s(last) - s(k + 1) <= &
               reach_of_hats*(s(k + 1) - s(k))
            if (is_near .and. gap(first) > 0.0_dp .and. all(gap(first:last - 1) < &
               gap(first + 1:last))) then
               edge = max(edge, end_of_gap(profile, k, first, last))
               return
            end if
            last = last - 1
         end do
      end associate
      if (.not. carries) edge = end_of_pressure(profile, k)
   end function contact_end

   !> Whether a closed mortar point carries a force that none beside it shares.
   pure logical function carries_alone(profile, k)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k

      associate (states => profile%contact_state)
         carries_alone = profile%hat_spacings > 0 .and. profile%gap(k) < 0.0_dp .and. &
            count(states(max(k - 1, 1):min(k + 1, size(states))) /= contact_open) == 1
      end associate
   end function carries_alone

   !> Edge beyond contact point k: the largest zero of the parabola through gap^(2/3) at three
   !> contact points, or where it is least; of the straight line through two.
   pure function end_of_gap(profile, k, first, last) result(edge)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k, first, last      ! first..last: the contact points
      real(dp) :: edge
      real(dp) :: d(last - first + 1), g(last - first + 1)   ! distances, gap^(2/3)
      real(dp) :: bend, ends(2), slope
      integer :: j, step

      g = profile%gap(first:last)**(2.0_dp/3.0_dp)
      ends = profile%s(k:k + 1)
      bend = 0.0_dp
      do step = 1, halvings
         edge = 0.5_dp*sum(ends)
         d = [(distance(profile, j, edge), j=first, last)]
         ! Newton's form of the polynomial in d: beyond the edge it is positive and rises at d = 0.
         slope = (g(2) - g(1))/(d(2) - d(1))
         if (size(d) > 2) bend = ((g(3) - g(2))/(d(3) - d(2)) - slope)/(d(3) - d(1))
         if (g(1) - slope*d(1) + bend*d(1)*d(2) > 0.0_dp .and. slope > bend*(d(1) + d(2))) then
            ends(2) = edge
         else
            ends(1) = edge
         end if
      end do
      edge = ends(1)
      if (ends(2) >= profile%s(k + 1)) edge = ends(2)
   end function end_of_gap

   !> Distance of a contact point from a, beyond it; of mortar points that at which (x - a)^(3/2) is
   !> its mean with the hat function.
   pure real(dp) function distance(profile, k, a)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k
      real(dp), intent(in) :: a

      associate (s => profile%s)
         distance = max(s(k) - a, 0.0_dp)
         if (profile%hat_spacings > 0) distance = &
            mean_beyond(s(k - 1:min(k + 1, size(s))), a)**(2.0_dp/3.0_dp)
      end associate
   end function distance

   !> Mean of (x - a)^(3/2) beyond a with the hat function of the second of two or three contact
   !> points.
   pure real(dp) function mean_beyond(s, a)
      real(dp), intent(in) :: s(:), a
      real(dp) :: root(size(s))
      real(dp) :: once(size(s)), twice(size(s))   ! the integrals of (x - a)^(3/2)

      root = sqrt(max(s - a, 0.0_dp))
      once = root**5/2.5_dp
      twice = root**7/8.75_dp
      mean_beyond = once(2) - (twice(2) - twice(1))/(s(2) - s(1))
      if (size(s) > 2) mean_beyond = mean_beyond + (twice(3) - twice(2))/(s(3) - s(2)) - once(2)
      mean_beyond = 2*mean_beyond/(s(size(s)) - s(1))
   end function mean_beyond

   !> Edge beyond contact point k where p^2 on a straight line through contact points k - 1 and k
   !> vanishes; halfway to the next one where there is no such line, or it vanishes beyond that.
   pure function end_of_pressure(profile, k) result(edge)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k
      real(dp) :: edge
      real(dp) :: before, here

      associate (s => profile%s)
         edge = 0.5_dp*(s(k) + s(k + 1))
         if (k == 1) return
         if (profile%contact_state(k - 1) == contact_open) return
         before = profile%pressure(k - 1)**2
         here = profile%pressure(k)**2
         if ((s(k + 1) - s(k))*(before - here) > (s(k) - s(k - 1))*here) edge = s(k) + (s(k) - &
            s(k - 1))*here/(before - here)
      end associate
   end function end_of_pressure

   !> Edges of the stick zones, ascending, padded with NaN, and the outer edge of the widest zone.
   pure subroutine stick_edges(profile, friction, edges, outer)
      type(contact_profile_type), intent(in) :: profile
      type(friction_law_type), intent(in) :: friction   !! the law of all contact points
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without stick [length]
      real(dp) :: widest
      integer :: found, i, k
      integer, allocatable :: ends(:)

      found = 0
      widest = -1.0_dp
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      ends = ends_of_pieces(size(profile%s), profile%cuts)
      do i = 1, size(ends), 2
         call add_stick_edges(some_of(profile, [(k, k=ends(i), ends(i + 1))]), friction, edges, &
            found, outer, widest)
      end do
   end subroutine stick_edges

   !> Adds the edges of a piece.
   pure subroutine add_stick_edges(profile, friction, edges, found, outer, widest)
      type(contact_profile_type), intent(in) :: profile
      type(friction_law_type), intent(in) :: friction
      real(dp), intent(inout) :: edges(:), outer
      integer, intent(inout) :: found
      real(dp), intent(inout) :: widest            ! width of the widest zone [length]
      real(dp) :: edge
      integer :: first, last, m

      m = size(profile%s)
      first = 1
      do while (first <= m)
         last = first
         if (profile%contact_state(first) == contact_stick) then
            do while (last < m)
               if (profile%contact_state(last + 1) /= contact_stick) exit
               last = last + 1
            end do
            if (first > 1) call keep(-stick_end(turned(profile), friction, m + 1 - last, &
               m + 1 - first), edges, found)
            edge = profile%s(m)
            if (last < m) then
               edge = stick_end(profile, friction, first, last)
               call keep(edge, edges, found)
            end if
            associate (width => profile%s(last) - profile%s(first))
               if (width >= widest) outer = edge
               widest = max(widest, width)
            end associate
         end if
         first = last + 1
      end do
   end subroutine add_stick_edges

   pure subroutine keep(edge, edges, found)
      real(dp), intent(in) :: edge
      real(dp), intent(inout) :: edges(:)
      integer, intent(inout) :: found

      found = found + 1
      if (found <= size(edges)) edges(found) = edge
   end subroutine keep

   !> Edge beyond the last contact point of the stick zone first..last. Stick ends no later than
   !> contact.
   pure function stick_end(profile, friction, first, last) result(edge)
      type(contact_profile_type), intent(in) :: profile
      type(friction_law_type), intent(in) :: friction
      integer, intent(in) :: first, last
      real(dp) :: edge
      real(dp) :: excess(fitted_spacings + 1), limit, mean_s, mean_excess, slope, spread, total
      integer :: n, start

      start = max(first, last - fitted_spacings/max(profile%hat_spacings, 1))
      n = last - start + 1
      associate (s => profile%s(start:last), weight => profile%weight(start:last), &
         next_contact_state => profile%contact_state(last + 1))
         limit = profile%s(last + 1)
         if (next_contact_state == contact_open) limit = contact_end(profile, last)
         edge = 0.5_dp*(s(n) + limit)
         total = sum(weight)
         if (count(weight > 0.0_dp) < 2) return
         excess(:n) = friction_bound(friction%coefficient, friction%largest_shear, &
            profile%pressure(start:last)) - sign(1.0_dp, &
            merge(profile%shear(last + 1), profile%shear(last), next_contact_state == &
            contact_slip))* profile%shear(start:last)
         mean_s = sum(weight*s)/total
         mean_excess = sum(weight*excess(:n))/total
         spread = sum(weight*(s - mean_s)**2)
         slope = sum(weight*(s - mean_s)*(excess(:n) - mean_excess))
         edge = limit
         if (slope < 0.0_dp) edge = min(max(mean_s - mean_excess*spread/slope, s(n)), limit)
      end associate
   end function stick_end

end module zone_edges
