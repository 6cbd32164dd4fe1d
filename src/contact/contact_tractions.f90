!> Tractions from nodal forces, and their limits at contact points of weight 0: on the axis of an
!> axisymmetric model, where a three-node side gives its corner the integral of N1 2 pi r, and at
!> the tip of sides with quarter points.
module contact_tractions
   use contact_points, only: contact_points_type, on_axis
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: in_contact, no_gap, pressures, shears

   !> Part of the side's length below which a gap is rounding.
   real(dp), parameter :: no_gap = 1.0e-12_dp

contains

   !> Contact points in contact. The force of a contact point of weight 0 is a difference of
   !> pressures: 0 where the pressure is uniform, and a tension, which opens the contact point,
   !> where the pressure grows away from it. Such a contact point is in contact where the contact
   !> points beside it press more than it takes to close it.
   pure function in_contact(points, closed, gap, force, stiffness) result(contact)
      type(contact_points_type), intent(in) :: points !! contact points of one interface
      logical, intent(in) :: closed(:)               !! (m) as the active set has them
      real(dp), intent(in) :: gap(:)                 !! (m) [length]
      real(dp), intent(in) :: force(:)         !! (m) nodal forces, 0 at open contact points [force]
      real(dp), intent(in) :: stiffness(:)     !! (m) of a contact point, others held [force/length]
      logical :: contact(size(closed))               !! (m)
      real(dp) :: lacking, pressure(size(closed))
      integer, allocatable :: beside(:)
      integer :: k

      contact = closed
      pressure = over_weight(points, force)
      do k = 1, size(closed)
         if (points%weight(k) > 0.0_dp .or. closed(k)) cycle
         beside = points%beside(k)
         if (.not. any(closed(beside))) cycle
         lacking = stiffness(k)*max(gap(k) - no_gap*points%edge(k), 0.0_dp)
         ! The contact points beside it have two thirds of each side, of which it has a thirtieth.
         contact(k) = lacking <= limit(points, pressure, k)* &
            (sum(points%weight(beside))/20)
      end do
   end function in_contact

   !> Nodal force over weight. A closed contact point of weight 0 has the limit of the profile, no
   !> further than 0 where the contact points beside it press, and what carries the rest of its
   !> force; an open one has none.
   pure function pressures(points, force, closed) result(pressure)
      type(contact_points_type), intent(in) :: points !! contact points of one interface
      real(dp), intent(in) :: force(:)         !! (m) nodal forces, 0 at open contact points [force]
      logical, intent(in) :: closed(:)               !! (m) contact points in contact
      real(dp) :: pressure(size(force))              !! (m) [stress]
      integer :: k

      pressure = over_weight(points, force)
      do k = 1, size(force)
         if (.not. closed(k) .or. points%weight(k) > 0.0_dp) cycle
         pressure(k) = limit(points, pressure, k)
         pressure(k) = pressure(k) + &
            lone_pressure(points, force(k) - profile_force(points, pressure, k), k)
      end do
   end function pressures

   !> Pressure of a contact point of weight 0 that presses alone: its nodal force, if that presses,
   !> over the integral of the line that falls from 1 to 0 at the next contact points, half of the
   !> area between on the axis and a third at a tip. The one in the middle of a side has two thirds
   !> of the side.
   pure real(dp) function lone_pressure(points, force, k)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: force
      integer, intent(in) :: k
      integer :: way
      real(dp) :: area, part

      area = 0.0_dp
      do way = -1, 1, 2
         if (.not. points%on_one_piece(k, k + 2*way)) cycle
         part = coordinate(points, k, k + way)/coordinate(points, k, k + 2*way)
         if (on_axis(points, k)) then
            part = part/2
         else
            part = part**2/3
         end if
         area = area + 1.5_dp*points%weight(k + way)*part
      end do
      lone_pressure = 0.0_dp
      if (area > 0.0_dp) lone_pressure = max(force, 0.0_dp)/area
   end function lone_pressure

   !> Nodal force of the profile at a contact point of weight 0, if that presses. It is the excess
   !> of its pressure over that at the far ends of its sides, times the integral of N1^2, a
   !> thirtieth of the sides. Those of N1 N2 and N1 (N1 + N3) vanish, and N2, of the contact point
   !> in the middle of a side, has two thirds of the side.
   pure real(dp) function profile_force(points, pressure, k)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: pressure(:)
      integer, intent(in) :: k
      integer :: way

      profile_force = 0.0_dp
      do way = -1, 1, 2
         if (.not. points%on_one_piece(k, k + 2*way)) cycle
         profile_force = profile_force + &
            (pressure(k) - pressure(k + 2*way))*points%weight(k + way)/20
      end do
      profile_force = max(profile_force, 0.0_dp)
   end function profile_force

   !> The same of friction. On the axis it vanishes; elsewhere the limit is no larger than the
   !> friction that the limit of the pressure allows.
   pure function shears(points, force, closed, friction, pressure) result(shear)
      type(contact_points_type), intent(in) :: points !! contact points of one interface
      real(dp), intent(in) :: force(:)         !! (m) nodal forces, 0 at open contact points [force]
      logical, intent(in) :: closed(:)               !! (m) contact points in contact
      type(friction_law_type), intent(in) :: friction !! the law of all of them
      real(dp), intent(in) :: pressure(:)            !! (m) as from pressures [stress]
      real(dp) :: shear(size(force))                 !! (m) [stress]
      integer :: k

      shear = over_weight(points, force)
      do k = 1, size(force)
         if (points%weight(k) > 0.0_dp .or. .not. closed(k) .or. on_axis(points, k)) cycle
         shear(k) = limit(points, shear, k)
         shear(k) = sign(min(abs(shear(k)), friction_bound(friction%coefficient, &
            friction%largest_shear, pressure(k))), shear(k))
      end do
   end function shears

   !> Nodal force over weight, 0 where that is 0.
   pure function over_weight(points, force) result(traction)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: force(:)
      real(dp) :: traction(size(force))

      traction = 0.0_dp
      where (points%weight > 0.0_dp) traction = force/points%weight
   end function over_weight

   !> Limit of a profile at contact point k: the mean of those from the sides that meet there. With
   !> a single neighbour it is that one's value, with none 0.
   pure real(dp) function limit(points, values, k)
      type(contact_points_type), intent(in) :: points
      real(dp), intent(in) :: values(:)
      integer, intent(in) :: k
      integer :: sides, way

      limit = 0.0_dp
      sides = 0
      do way = -1, 1, 2
         if (.not. points%on_one_piece(k, k + way)) cycle
         sides = sides + 1
         if (points%on_one_piece(k, k + 2*way)) then
            limit = limit + continued(values(k + [way, 2*way]), coordinate(points, k, &
               k + [way, 2*way]))
         else
            limit = limit + values(k + way)
         end if
      end do
      if (sides > 0) limit = limit/sides
   end function limit

   !> Coordinate from contact point k in which a profile begins as a line: the square of the radius
   !> on the axis, where a pressure is even; at the tip of sides with quarter points the root of the
   !> distance, which is their own coordinate.
   elemental real(dp) function coordinate(points, k, other)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: k, other

      if (on_axis(points, k)) then
         coordinate = points%position(1, other)**2
      else
         coordinate = sqrt(abs(points%arc_length(other) - points%arc_length(k)))
      end if
   end function coordinate

   !> The line through two values continued to 0, no further than 0 where both have one sign.
   pure real(dp) function continued(values, position)
      real(dp), intent(in) :: values(2), position(2)

      continued = values(1) + (values(1) - values(2))*position(1)/(position(2) - position(1))
      if (minval(values) >= 0.0_dp) continued = max(continued, 0.0_dp)
      if (maxval(values) <= 0.0_dp) continued = min(continued, 0.0_dp)
   end function continued

end module contact_tractions
