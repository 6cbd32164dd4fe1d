!> Coulomb's law for one contact point, eq. (1.6), in increments: pure functions of numbers.
module friction
   use contact_states, only: contact_open, contact_slip, contact_stick
   use kinds, only: dp
   implicit none
   private
   public :: next_contact_state

contains

   !> Contact state that a contact point must have, given what it did under its present one. A stuck
   !> contact point slips once its friction force would leave the cone; a slipping contact point
   !> sticks once friction would drive it instead of resisting. A contact point that closes first
   !> shows without friction (slip, direction 0) which way it slides.
   pure subroutine next_contact_state(contact_state, direction, gap, force, shear_force, slip, &
      friction, has_tangent, gap_tolerance, force_tolerance, excess)
      integer, intent(inout) :: contact_state !! contact_open, contact_slip or contact_stick
      integer, intent(inout) :: direction !! sign of friction on the slave in slip, 0 unknown
      real(dp), intent(in) :: gap             !! gamma [length]
      real(dp), intent(in) :: force           !! normal force, positive in compression [force]
      real(dp), intent(in) :: shear_force     !! tangential force on the slave [force]
      real(dp), intent(in) :: slip !! tangential motion since the start of this increment [length]
      real(dp), intent(in) :: friction        !! mu [-]
      logical, intent(in) :: has_tangent     !! whether the contact point can move along its tangent
      real(dp), intent(in) :: gap_tolerance   !! rounding of gap and slip [length]
      real(dp), intent(in) :: force_tolerance !! rounding of the forces [force]
      real(dp), intent(out) :: excess !! violation of the present condition, 0 for none

      excess = 0.0_dp
      select case (contact_state)
      case (contact_open)
         if (gap >= -gap_tolerance) return
         excess = -gap/gap_tolerance
         contact_state = contact_slip
         direction = 0
      case default
         if (force < -force_tolerance) then
            excess = -force/force_tolerance
            contact_state = contact_open
         else if (contact_state == contact_stick .and. has_tangent) then
            if (abs(shear_force) <= friction*max(force, 0.0_dp) + force_tolerance) return
            excess = (abs(shear_force) - friction*force)/force_tolerance
            contact_state = contact_slip
            direction = merge(1, -1, shear_force > 0.0_dp)
         else if (contact_state == contact_slip .and. direction == 0 .and. friction > 0.0_dp) then
            excess = 1.0_dp
            if (has_tangent .and. abs(slip) > gap_tolerance) then
               direction = merge(-1, 1, slip > 0.0_dp)
            else
               contact_state = contact_stick
            end if
         else if (contact_state == contact_slip .and. friction > 0.0_dp) then
            if (direction*slip <= gap_tolerance) return
            excess = direction*slip/gap_tolerance
            contact_state = contact_stick
            direction = 0
         end if
      end select
   end subroutine next_contact_state

end module friction
