!> Contact points that rest: gamma = p = 0 with a conductance between the values of a law that jumps
!> there. Without them some increments have no solution, (1.8) asking for a law without a jump.
module resting_points
   use contact_states, only: contact_state_type, contact_open, contact_slip
   use fixed_point, only: point_residual, pass_type
   use increment_data, only: contact_scales_type, increment_data_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   implicit none
   private
   public :: contact_scales, find_residual, settle

   !> Part of the pressure that the overlap of a whole displacement would make, below which none
   !> counts as the largest of an increment.
   real(dp), parameter :: least_pressure = 1.0e-6_dp

   !> Part of the largest length that a gap counts by: what is left of one is closed in the end, and
   !> takes force.
   real(dp), parameter :: least_gap = 1.0e-5_dp

contains

   !> Largest values that are known at the start of an increment. Its load counts by the overlap
   !> that it makes at a contact point alone.
   pure function contact_scales(bodies, data) result(scales)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(contact_scales_type) :: scales                     !! largest values, length > 0
      real(dp) :: stiffness
      integer :: k

      scales%force = maxval(data%previous%force)
      scales%length = max(data%displacement_scale, maxval(abs(data%previous%gap)))
      do k = 1, size(bodies%equilibrium%contact%normal)
         associate (row => bodies%equilibrium%contact%normal(k))
            stiffness = bodies%equilibrium%contact%alone(k)
            if (stiffness > 0.0_dp) scales%length = max(scales%length, &
               abs(data%welded_load(row))/stiffness)
         end associate
      end do
      if (scales%length <= 0.0_dp) scales%length = 1.0_dp
   end function contact_scales

   !> Largest residual of a pass over the contact points that carry heat, which those of weight 0 do
   !> not, and the contact points that rest in it: a conductance between the two
   !> values of its law needs no more of a contact point than that neither gap nor pressure is left.
   pure subroutine find_residual(scales, weight, pass, residual, resting)
      type(contact_scales_type), intent(in) :: scales       !! largest values of the increment
      real(dp), intent(in) :: weight(:)                     !! (m) tributary areas [length^2]
      type(pass_type), intent(in) :: pass
      real(dp), intent(out) :: residual                     !! relative
      logical, intent(out) :: resting(:)                    !! (m) contact points that rest
      real(dp), dimension(size(weight)) :: by_law, by_rest, pressure
      real(dp) :: largest

      by_law = 0.0_dp
      where (weight > 0.0_dp) by_law = point_residual(pass%omega, pass%image)
      resting = pass%graph%may_rest(pass%omega)
      if (any(resting)) then
         associate (modulus => pass%graph%modulus)
            pressure = modulus*max(-pass%opening, 0.0_dp)
            largest = max(maxval(pressure), scales%force/max(maxval(weight), tiny(1.0_dp)))
            by_rest = max(pass%opening, 0.0_dp)/max(least_gap*scales%length, largest/modulus) + &
               pressure/max(largest, least_pressure*modulus*scales%length)
         end associate
         resting = resting .and. by_rest < by_law
         where (resting) by_law = by_rest
      end if
      residual = maxval(by_law)
   end subroutine find_residual

   !> Leaves nothing of gap, pressure and shear at contact points that rest; they count as closed.
   pure subroutine settle(resting, state)
      logical, intent(in) :: resting(:)                  !! (m) contact points that rest
      type(contact_state_type), intent(inout) :: state

      where (resting .and. state%contact_state == contact_open) state%reference = state%tangential
      where (resting)
         state%contact_state = contact_slip
         state%direction = 0
         state%gap = 0.0_dp
         state%force = 0.0_dp
         state%shear_force = 0.0_dp
      end where
   end subroutine settle

end module resting_points
