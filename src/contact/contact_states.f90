!> What the contact points do: contact states, and the laws of contact points that close within an
!> increment.
module contact_states
   use kinds, only: dp
   implicit none
   private
   public :: contact_state_type, closing_law_type, is_capped, slip_force, state_code, with_cap
   public :: contact_open, contact_slip, contact_stick

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
   elemental function slip_force(direction, friction, largest, force) result(shear_force)
      integer, intent(in) :: direction       !! as in the state
      real(dp), intent(in) :: friction       !! mu [-]
      real(dp), intent(in) :: largest        !! largest friction [force]
      real(dp), intent(in) :: force          !! positive in compression [force]
      real(dp) :: shear_force                !! [force]

      if (is_capped(direction)) then
         shear_force = sign(largest, real(direction, dp))
      else
         shear_force = direction*friction*force
      end if
   end function slip_force

   !> One number per contact point for its contact state.
   pure function state_code(state) result(codes)
      type(contact_state_type), intent(in) :: state   !! states and directions
      integer :: codes(size(state%contact_state))     !! (m)

      codes = 3*state%contact_state
      where (state%contact_state == contact_slip) codes = codes + state%direction
   end function state_code

end module contact_states
