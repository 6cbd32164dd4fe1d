!> Coulomb's law for one contact point, eq. (1.6), with a largest friction, in increments: pure
!> functions of numbers.
module friction
   use contact_states, only: contact_open, contact_slip, contact_stick, is_capped, with_cap
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: response_type, rounding_type, next_contact_state

   !> What a contact point does under its present condition.
   type :: response_type
      real(dp) :: gap = 0.0_dp           !! gamma [length]
      real(dp) :: force = 0.0_dp         !! normal force, positive in compression [force]
      real(dp) :: shear_force = 0.0_dp   !! tangential force on the slave [force]
      real(dp) :: slip = 0.0_dp          !! tangential motion since the increment began [length]
   end type response_type

   !> What counts as zero.
   type :: rounding_type
      real(dp) :: gap = 0.0_dp           !! of gap and slip [length]
      real(dp) :: force = 0.0_dp         !! of both forces [force]
   end type rounding_type

contains

   !> Contact state that a contact point must have, given what it did under its present one. A stuck
   !> contact point slips once its friction force would leave the cone; a slipping contact point
   !> sticks once friction would drive it instead of resisting, and slips with the largest friction
   !> once its pressure allows more. A contact point that closes first shows without friction (slip,
   !> direction 0) which way it slides.
   pure subroutine next_contact_state(contact_state, direction, response, friction, has_tangent, &
      rounding, excess)
      integer, intent(inout) :: contact_state !! contact_open, contact_slip or contact_stick
      integer, intent(inout) :: direction   !! of friction on the slave, as in contact_state_type
      type(response_type), intent(in) :: response
      type(friction_law_type), intent(in) :: friction   !! with the largest force for a shear
      logical, intent(in) :: has_tangent    !! whether the contact point can move along its tangent
      type(rounding_type), intent(in) :: rounding
      real(dp), intent(out) :: excess       !! violation of the present condition, 0 for none
      real(dp) :: bound, over_largest

      excess = 0.0_dp
      over_largest = friction%coefficient*response%force - friction%largest_shear
      select case (contact_state)
      case (contact_open)
         if (response%gap >= -rounding%gap) return
         excess = -response%gap/rounding%gap
         contact_state = contact_slip
         direction = 0
      case default
         if (response%force < -rounding%force) then
            excess = -response%force/rounding%force
            contact_state = contact_open
         else if (contact_state == contact_stick .and. has_tangent) then
            bound = friction_bound(friction%coefficient, friction%largest_shear, response%force)
            if (abs(response%shear_force) <= bound + rounding%force) return
            excess = (abs(response%shear_force) - bound)/rounding%force
            contact_state = contact_slip
            direction = with_cap(merge(1, -1, response%shear_force > 0.0_dp), &
               over_largest > 0.0_dp)
         else if (contact_state == contact_slip .and. direction == 0 .and. &
            friction%coefficient > 0.0_dp) then
            excess = 1.0_dp
            if (has_tangent .and. abs(response%slip) > rounding%gap) then
               direction = merge(-1, 1, response%slip > 0.0_dp)
            else
               contact_state = contact_stick
            end if
         else if (contact_state == contact_slip .and. friction%coefficient > 0.0_dp) then
            if (direction*response%slip > rounding%gap) then
               excess = direction*response%slip/rounding%gap
               contact_state = contact_stick
               direction = 0
            else if (.not. is_capped(direction) .and. over_largest > rounding%force) then
               excess = over_largest/rounding%force
               direction = with_cap(direction, .true.)
            else if (is_capped(direction) .and. over_largest < -rounding%force) then
               excess = -over_largest/rounding%force
               direction = with_cap(direction, .false.)
            end if
         end if
      end select
   end subroutine next_contact_state

end module friction
