!> Edges of the contact and stick zones, sharpened below the nodal spacing.
!>
!> Edge of contact, between a closed and an open contact point: near it p goes like sqrt(a - s) and
!> the gap like (s - a)^(3/2), so that p^2 from inside and gap^(2/3) from outside go to zero
!> smoothly. The contact points next to the edge err most, pressures more than gaps: the edge is the
!> zero of a parabola through gap^(2/3) of the second to fourth open contact point, kept between the
!> two contact points. Where there are not so many, it is the mean of the zeros of straight lines
!> through the two contact points on each side. Of mortar points the gap is the mean of
!> (s - a)^(3/2) with a hat function, and they are as far apart as one or two node pairs: the edge
!> is that of the C (s - a)^(3/2) whose means are the gaps of the first two open ones.
!>
!> Edge of stick: the zero of mu p - |tau|, which is p_tau = mu p_n. Behind a front that advances
!> with the load it has no root singularity on the nodal scale, but the slip that was frozen at each
!> contact point when the next one closed makes it noisy; so a straight line is fitted to the last
!> four node spacings, two sides of three nodes, weighted with the tributary lengths, which makes it
!> the resultant and moment of the nodal forces themselves.
!>
!> Edges are looked for towards growing s; an edge on the other side is the same with the arrays
!> turned round. On a closed face none is looked for between the last contact point and the first.
module zone_edges
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_definitions, only: pairing_surfaces
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_slip, contact_stick
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_profile_type, contact_profile, contact_edges, contact_end, mean_beyond
   public :: edges_kept, stick_edges, turned

   integer, parameter :: edges_kept = 4     !! zone edges kept for an interface

   integer, parameter :: fitted_spacings = 4   !! node spacings of two three-node sides
   integer, parameter :: halvings = 60         !! of the interval with the edge

   !> States of the contact points of an interface, along it.
   type :: contact_profile_type
      real(dp), allocatable :: s(:)          !! (m) arc length [length]
      real(dp), allocatable :: weight(:)     !! (m) tributary areas [length^2]
      integer, allocatable :: contact_state(:) !! (m) contact states
      real(dp), allocatable :: pressure(:)   !! (m) [stress]
      real(dp), allocatable :: shear(:)      !! (m) [stress]
      real(dp), allocatable :: gap(:)        !! (m) [length]
      !> node spacings from a contact point to the next, where gaps are means with hat functions; 0
      !> for node pairs
      integer :: hat_spacings = 0
   end type contact_profile_type

contains

   !> States of the contact points of an interface, along it.
   pure function contact_profile(points, contact_state, pressure, shear, gap) result(profile)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: contact_state(:)   !! (m)
      real(dp), intent(in) :: pressure(:)       !! (m) [stress]
      real(dp), intent(in) :: shear(:)          !! (m) [stress]
      real(dp), intent(in) :: gap(:)            !! (m) [length]
      type(contact_profile_type) :: profile

      profile%s = points%arc_length
      profile%weight = points%weight
      profile%contact_state = contact_state
      profile%pressure = pressure
      profile%shear = shear
      profile%gap = gap
      if (points%pairing == pairing_surfaces) profile%hat_spacings = points%node_spacings
   end function contact_profile

   !> Edges between contact and gap, ascending, padded with NaN, and the outer edge of the contact
   !> zone with the largest s. A zone that reaches the last contact point ends there; that end is no
   !> edge.
   pure subroutine contact_edges(profile, edges, outer)
      type(contact_profile_type), intent(in) :: profile
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without contact [length]
      type(contact_profile_type) :: back
      real(dp) :: edge
      integer :: found, k, m

      back = turned(profile)
      m = size(profile%s)
      found = 0
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
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
   end subroutine contact_edges

   !> The profile from its other end.
   pure function turned(profile) result(back)
      type(contact_profile_type), intent(in) :: profile
      type(contact_profile_type) :: back
      integer :: m

      m = size(profile%s)
      back%s = -profile%s(m:1:-1)
      back%weight = profile%weight(m:1:-1)
      back%contact_state = profile%contact_state(m:1:-1)
      back%pressure = profile%pressure(m:1:-1)
      back%shear = profile%shear(m:1:-1)
      back%gap = profile%gap(m:1:-1)
      back%hat_spacings = profile%hat_spacings
   end function turned

   !> Edge between closed contact point k and open contact point k + 1.
   pure function contact_end(profile, k) result(edge)
      type(contact_profile_type), intent(in) :: profile
      integer, intent(in) :: k
      real(dp) :: edge
      real(dp) :: g(3)

      associate (s => profile%s, gap => profile%gap)
         if (profile%hat_spacings > 0 .and. k + 2 <= size(s)) then
            if (profile%contact_state(k + 2) == contact_open .and. gap(k + 1) > 0.0_dp .and. &
               gap(k + 2) > gap(k + 1)) then
               edge = end_of_hats(s(k:min(k + 3, size(s))), gap(k + 1:k + 2))
               return
            end if
         else if (k + 4 <= size(s)) then
            g = max(gap(k + 2:k + 4), 0.0_dp)**(2.0_dp/3.0_dp)
            if (all(profile%contact_state(k + 2:k + 4) == contact_open) .and. g(1) < g(2) .and. &
               g(2) < g(3)) then
               edge = s(k + 2)*g(2)*g(3)/((g(2) - g(1))*(g(3) - g(1))) - &
                  s(k + 3)*g(1)*g(3)/((g(2) - g(1))*(g(3) - g(2))) + &
                  s(k + 4)*g(1)*g(2)/((g(3) - g(1))*(g(3) - g(2)))
               edge = min(max(edge, s(k)), s(k + 1))
               return
            end if
         end if
      end associate
      edge = end_of_lines(profile%s, profile%contact_state, profile%pressure, profile%gap, k)
   end function contact_end

   !> Edge a of the C (s - a)^(3/2) whose means with two hat functions are the gaps there.
   pure function end_of_hats(s, gap) result(edge)
      real(dp), intent(in) :: s(:)      ! last closed, two open, and the next contact point, if any
      real(dp), intent(in) :: gap(2)    ! of the two
      real(dp) :: edge
      real(dp) :: ends(2)
      integer :: step

      ends = s(:2)
      do step = 1, halvings
         edge = 0.5_dp*sum(ends)
         if (mean_beyond(s(:3), edge)*gap(2) > gap(1)*mean_beyond(s(2:), edge)) then
            ends(1) = edge
         else
            ends(2) = edge
         end if
      end do
   end function end_of_hats

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

   !> The same by straight lines through at most two contact points on each side.
   pure function end_of_lines(s, contact_state, pressure, gap, k) result(edge)
      real(dp), intent(in) :: s(:), pressure(:), gap(:)
      integer, intent(in) :: contact_state(:), k
      real(dp) :: edge
      real(dp) :: before, here, inside, outside
      logical :: has_inside, has_outside

      has_inside = k > 1
      if (has_inside) has_inside = contact_state(k - 1) /= contact_open
      has_outside = k + 2 <= size(s)
      if (has_outside) has_outside = contact_state(k + 2) == contact_open
      inside = s(k + 1)
      if (has_inside) then
         before = pressure(k - 1)**2
         here = pressure(k)**2
         if (before > here) then
            inside = min(s(k) + (s(k) - s(k - 1))*here/(before - here), s(k + 1))
         end if
      end if
      outside = s(k)
      if (has_outside) then
         here = gap(k + 1)**(2.0_dp/3.0_dp)
         before = gap(k + 2)**(2.0_dp/3.0_dp)
         if (before > here) then
            outside = max(s(k + 1) - (s(k + 2) - s(k + 1))*here/(before - here), s(k))
         end if
      end if
      edge = 0.5_dp*(s(k) + s(k + 1))
      if (has_inside .and. has_outside) edge = 0.5_dp*(inside + outside)
      if (has_inside .and. .not. has_outside) edge = inside
      if (has_outside .and. .not. has_inside) edge = outside
   end function end_of_lines

   !> Edges of the stick zones, ascending, padded with NaN, and the outer edge of the widest zone.
   pure subroutine stick_edges(profile, friction, edges, outer)
      type(contact_profile_type), intent(in) :: profile
      type(friction_law_type), intent(in) :: friction   !! the law of all contact points
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without stick [length]
      real(dp) :: edge, widest
      integer :: first, found, last, m

      m = size(profile%s)
      found = 0
      widest = -1.0_dp
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
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
   end subroutine stick_edges

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
