!> Edges of the contact and stick zones, sharpened below the nodal spacing.
!>
!> Edge of contact, between a closed and an open contact point: near it p goes like sqrt(a - s) and
!> the gap like (s - a)^(3/2), so that p^2 from inside and gap^(2/3) from outside go to zero
!> smoothly. The contact points next to the edge err most, pressures more than gaps: the edge is the
!> zero of a parabola through gap^(2/3) of the second to fourth open contact point, kept between the
!> two contact points. Where there are not so many, it is the mean of the zeros of straight lines
!> through the two contact points on each side.
!>
!> Edge of stick: the zero of mu p - |tau|, which is p_tau = mu p_n. Behind a front that advances
!> with the load it has no root singularity on the nodal scale, but the slip that was frozen at each
!> contact point when the next one closed makes it noisy; so a straight line is fitted to the last
!> two sides, weighted with the tributary lengths, which makes it the resultant and moment of the
!> nodal forces themselves.
!>
!> Edges are looked for towards growing s; an edge on the other side is the same with the arrays
!> turned round. On a closed face none is looked for between the last contact point and the first.
module zone_edges
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use contact_states, only: contact_open, contact_slip, contact_stick
   use kinds, only: dp
   implicit none
   private
   public :: contact_edges, stick_edges, edges_kept

   integer, parameter :: edges_kept = 4     !! zone edges kept for an interface

   integer, parameter :: fitted_points = 5  !! contact points of two three-node sides

contains

   !> Edges between contact and gap, ascending, padded with NaN, and the outer edge of the contact
   !> zone with the largest s. A zone that reaches the last contact point ends there; that end is no
   !> edge.
   pure subroutine contact_edges(s, contact_state, pressure, gap, edges, outer)
      real(dp), intent(in) :: s(:)                 !! (m) arc length [length]
      integer, intent(in) :: contact_state(:)      !! (m) contact states
      real(dp), intent(in) :: pressure(:)          !! (m) [stress]
      real(dp), intent(in) :: gap(:)               !! (m) [length]
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without contact [length]
      real(dp) :: edge
      integer :: found, k, m

      m = size(s)
      found = 0
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      do k = 1, m - 1
         if (contact_state(k) /= contact_open .and. contact_state(k + 1) == contact_open) then
            edge = contact_end(s, contact_state, pressure, gap, k)
            outer = edge
         else if (contact_state(k) == contact_open .and. contact_state(k + 1) /= contact_open) then
            edge = -contact_end(-s(m:1:-1), contact_state(m:1:-1), pressure(m:1:-1), gap(m:1:-1), &
               m - k)
         else
            cycle
         end if
         found = found + 1
         if (found <= edges_kept) edges(found) = edge
      end do
      if (m > 0) then
         if (contact_state(m) /= contact_open) outer = s(m)
      end if
   end subroutine contact_edges

   !> Edge between closed contact point k and open contact point k + 1.
   pure function contact_end(s, contact_state, pressure, gap, k) result(edge)
      real(dp), intent(in) :: s(:), pressure(:), gap(:)
      integer, intent(in) :: contact_state(:), k
      real(dp) :: edge
      real(dp) :: g(3)

      if (k + 4 <= size(s)) then
         g = max(gap(k + 2:k + 4), 0.0_dp)**(2.0_dp/3.0_dp)
         if (all(contact_state(k + 2:k + 4) == contact_open) .and. g(1) < g(2) .and. &
            g(2) < g(3)) then
            edge = s(k + 2)*g(2)*g(3)/((g(2) - g(1))*(g(3) - g(1))) - &
               s(k + 3)*g(1)*g(3)/((g(2) - g(1))*(g(3) - g(2))) + &
               s(k + 4)*g(1)*g(2)/((g(3) - g(1))*(g(3) - g(2)))
            edge = min(max(edge, s(k)), s(k + 1))
            return
         end if
      end if
      edge = end_of_lines(s, contact_state, pressure, gap, k)
   end function contact_end

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
   pure subroutine stick_edges(s, weight, contact_state, pressure, shear, gap, friction, edges, &
      outer)
      real(dp), intent(in) :: s(:)                 !! (m) arc length [length]
      real(dp), intent(in) :: weight(:)            !! (m) tributary areas [length^2]
      integer, intent(in) :: contact_state(:)      !! (m) contact states
      real(dp), intent(in) :: pressure(:)          !! (m) [stress]
      real(dp), intent(in) :: shear(:)             !! (m) [stress]
      real(dp), intent(in) :: gap(:)               !! (m) [length]
      real(dp), intent(in) :: friction             !! mu [-]
      real(dp), intent(out) :: edges(edges_kept)   !! edges as s [length]
      real(dp), intent(out) :: outer               !! outer edge, NaN without stick [length]
      real(dp) :: edge, widest
      integer :: first, found, last, m

      m = size(s)
      found = 0
      widest = -1.0_dp
      edges = ieee_value(1.0_dp, ieee_quiet_nan)
      outer = edges(1)
      first = 1
      do while (first <= m)
         last = first
         if (contact_state(first) == contact_stick) then
            do while (last < m)
               if (contact_state(last + 1) /= contact_stick) exit
               last = last + 1
            end do
            if (first > 1) call keep(-stick_end(-s(m:1:-1), weight(m:1:-1), contact_state(m:1:-1), &
               pressure(m:1:-1), shear(m:1:-1), gap(m:1:-1), friction, m + 1 - last, &
               m + 1 - first), edges, found)
            edge = s(m)
            if (last < m) then
               edge = stick_end(s, weight, contact_state, pressure, shear, gap, friction, first, &
                  last)
               call keep(edge, edges, found)
            end if
            if (s(last) - s(first) >= widest) outer = edge
            widest = max(widest, s(last) - s(first))
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
   pure function stick_end(s, weight, contact_state, pressure, shear, gap, friction, first, last) &
      result(edge)
      real(dp), intent(in) :: s(:), weight(:), pressure(:), shear(:), gap(:), friction
      integer, intent(in) :: contact_state(:), first, last
      real(dp) :: edge
      real(dp) :: excess(fitted_points), limit, mean_s, mean_excess, slope, spread, total
      integer :: n, start

      limit = s(last + 1)
      if (contact_state(last + 1) == contact_open) limit = contact_end(s, contact_state, pressure, &
         gap, last)
      start = max(first, last - fitted_points + 1)
      n = last - start + 1
      edge = 0.5_dp*(s(last) + limit)
      total = sum(weight(start:last))
      if (count(weight(start:last) > 0.0_dp) < 2) return
      excess(:n) = friction*pressure(start:last) - sign(1.0_dp, merge(shear(last + 1), &
         shear(last), contact_state(last + 1) == contact_slip))*shear(start:last)
      mean_s = sum(weight(start:last)*s(start:last))/total
      mean_excess = sum(weight(start:last)*excess(:n))/total
      spread = sum(weight(start:last)*(s(start:last) - mean_s)**2)
      slope = sum(weight(start:last)*(s(start:last) - mean_s)*(excess(:n) - mean_excess))
      edge = limit
      if (slope < 0.0_dp) edge = min(max(mean_s - mean_excess*spread/slope, s(last)), limit)
   end function stick_end

end module zone_edges
