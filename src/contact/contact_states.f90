!> What the contact points do: contact states, Coulomb's law for one of them, eq. (1.6), with a
!> largest friction, in increments, and the laws of contact points that close within one.
module contact_states
   use friction_laws, only: friction_bound, friction_law_type
   use kinds, only: dp
   implicit none
   private
   public :: contact_state_type, closing_law_type, is_capped, slip_force, state_code, with_cap
   public :: contact_open, contact_slip, contact_stick
   public :: next_contact_state, response_type, rounding_type

   integer, parameter :: contact_open = 0   !! gap, zone I
   integer, parameter :: contact_slip = 1   !! closed, slipping or frictionless, zone II
   integer, parameter :: contact_stick = 2  !! closed and stuck, zone III

   integer, parameter :: capped = 2   !! magnitude of a direction whose friction is the largest

   !> Contact state of all contact points.
   type :: contact_state_type
      integer, allocatable :: contact_state(:) !! (m) contact_open, contact_slip or contact_stick
      !> (m) sign of the friction force where it slips, 0 where it is not known; times `capped`
      !> where the force is the largest that friction has, whatever the pressure
      integer, allocatable :: direction(:)
      real(dp), allocatable :: reference(:)   !! (m) d_t from which friction counts [length]
      real(dp), allocatable :: gap(:)         !! (m) gamma = h - d_n [length]
      !> (m) d_n, with the digits that it loses in h; unallocated before a solution [length]
      real(dp), allocatable :: approach(:)
      real(dp), allocatable :: tangential(:)  !! (m) d_t [length]
      !> (m) d_t at which a contact point last closed [length]
      real(dp), allocatable :: slip_origin(:)
      real(dp), allocatable :: force(:)       !! (m) -lambda_n, positive in compression [force]
      real(dp), allocatable :: shear_force(:) !! (m) lambda_t [force]
      real(dp), allocatable :: link(:)        !! (links) what holds cycles together [length]
   end type contact_state_type

   !> Where a contact point that closes within the increment sticks: at the reference d_t - slip,
   !> where slip is the left-hand side of the condition in contact_system. Forces are lambda_n and
   !> lambda_t of the contact points that close in the increment; of others the factors are zero.
   type :: closing_law_type
      logical :: acts = .false.                !! whether the contact point closes in this increment
      real(dp) :: start = 0.0_dp               !! d_t,i [length]
      real(dp) :: fraction = 0.0_dp            !! f, the instant of closing
      real(dp), allocatable :: compliance(:, :) !! (2, m) a, factors of the forces [length/force]
      !> (2, m) derivative of the slip by the forces through the instants [length/force]
      real(dp), allocatable :: rate(:, :)
   end type closing_law_type

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

   !> Whether friction is the largest whatever the pressure.
   elemental logical function is_capped(direction)
      integer, intent(in) :: direction       !! as in the state

      is_capped = abs(direction) == capped
   end function is_capped

   !> A direction of friction with the same sign that is capped, or that is not.
   elemental integer function with_cap(direction, has_cap)
      integer, intent(in) :: direction       !! as in the state, not 0
      logical, intent(in) :: has_cap

      with_cap = sign(merge(capped, 1, has_cap), direction)
   end function with_cap

   !> Friction force on the slave at a contact point that slips.
   elemental function slip_force(direction, friction, force) result(shear_force)
      integer, intent(in) :: direction       !! as in the state
      type(friction_law_type), intent(in) :: friction   !! of nodal forces
      real(dp), intent(in) :: force          !! positive in compression [force]
      real(dp) :: shear_force                !! [force]

      if (is_capped(direction)) then
         shear_force = sign(friction%largest_shear, real(direction, dp))
      else
         shear_force = direction*friction%coefficient*force
      end if
   end function slip_force

   !> One number per contact point for its contact state.
   pure function state_code(state) result(codes)
      type(contact_state_type), intent(in) :: state   !! states and directions
      integer :: codes(size(state%contact_state))     !! (m)

      codes = 3*state%contact_state
      where (state%contact_state == contact_slip) codes = codes + state%direction
   end function state_code

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
      type(friction_law_type), intent(in) :: friction   !! of nodal forces
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

end module contact_states
