!> Tractions from nodal forces, and their limit on the axis of an axisymmetric model, where a
!> three-node side gives its corner the weight 0: integral of N1 2 pi r over it.
module axis_limits
   use kinds, only: dp
   implicit none
   private
   public :: tractions, with_axis_limit

contains

   !> Nodal force over weight, at pairs of weight 0 the limit of the profile.
   pure function tractions(force, weight, position_x, even) result(traction)
      real(dp), intent(in) :: force(:)       !! (m) nodal forces along one interface [force]
      real(dp), intent(in) :: weight(:)      !! (m) tributary areas, >= 0 [length^2]
      real(dp), intent(in) :: position_x(:)  !! (m) distance from the axis [length]
      logical, intent(in) :: even            !! pressure; else shear, which is 0 on the axis
      real(dp) :: traction(size(force))      !! (m) [stress]

      traction = 0.0_dp
      where (weight > 0.0_dp) traction = force/weight
      traction = with_axis_limit(traction, weight, position_x, even)
   end function tractions

   !> The values, those of weight 0 replaced by the limit of the profile: an even one by the
   !> parabola without slope on the axis through the next two pairs, no further than 0 where these
   !> have one sign, an odd one by 0. With a single neighbour the limit is that one's value.
   pure function with_axis_limit(values, weight, position_x, even) result(limited)
      real(dp), intent(in) :: values(:)      !! (m) along one interface
      real(dp), intent(in) :: weight(:)      !! (m) tributary areas, >= 0 [length^2]
      real(dp), intent(in) :: position_x(:)  !! (m) distance from the axis [length]
      logical, intent(in) :: even            !! pressure, flux, conductance; else shear
      real(dp) :: limited(size(values))      !! (m)
      integer :: inward, k, m

      m = size(values)
      limited = values
      do k = 1, m
         if (weight(k) > 0.0_dp) cycle
         limited(k) = 0.0_dp
         inward = merge(1, -1, k == 1)
         if (.not. even .or. m == 1) cycle
         limited(k) = values(k + inward)
         if (m == 2) cycle
         limited(k) = parabola_top(values(k + inward), values(k + 2*inward), &
            position_x(k + inward), position_x(k + 2*inward))
      end do
   end function with_axis_limit

   !> Value at r = 0 of the parabola a + b r^2.
   pure function parabola_top(first, second, r_first, r_second) result(top)
      real(dp), intent(in) :: first, second, r_first, r_second
      real(dp) :: top

      top = first + (first - second)*r_first**2/(r_second**2 - r_first**2)
      if (min(first, second) >= 0.0_dp) top = max(top, 0.0_dp)
      if (max(first, second) <= 0.0_dp) top = min(top, 0.0_dp)
   end function parabola_top

end module axis_limits
