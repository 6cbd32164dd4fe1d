!> What the pairs do: contact states, and the laws of pairs that close within an increment.
module contact_states
   use kinds, only: dp
   implicit none
   private
   public :: contact_state_type, closing_law_type, condition_code
   public :: status_open, status_slip, status_stick

   integer, parameter :: status_open = 0    !! gap, zone I
   integer, parameter :: status_slip = 1    !! closed, slipping or frictionless, zone II
   integer, parameter :: status_stick = 2   !! closed and stuck, zone III

   !> Contact state of all pairs.
   type :: contact_state_type
      integer, allocatable :: status(:)       !! (m) status_open, status_slip or status_stick
      integer, allocatable :: direction(:)    !! (m) sign of the friction force where it slips
      real(dp), allocatable :: reference(:)   !! (m) d_t from which friction counts [length]
      real(dp), allocatable :: gap(:)         !! (m) gamma = h - d_n [length]
      !> (m) d_n, with the digits that it loses in h; unallocated before a solution [length]
      real(dp), allocatable :: approach(:)
      real(dp), allocatable :: tangential(:)  !! (m) d_t [length]
      real(dp), allocatable :: slip_origin(:) !! (m) d_t at which a pair last closed [length]
      real(dp), allocatable :: force(:)       !! (m) -lambda_n, positive in compression [force]
      real(dp), allocatable :: shear_force(:) !! (m) lambda_t [force]
      real(dp), allocatable :: link(:)        !! (links) what holds rings together [length]
   end type contact_state_type

   !> Where a pair that closes within the increment sticks: at the reference d_t - slip, where slip
   !> is the left-hand side of the condition in contact_system.
   type :: closing_law_type
      logical :: acts = .false.                !! whether the pair closes in this increment
      real(dp) :: start = 0.0_dp               !! d_t,i [length]
      real(dp) :: fraction = 0.0_dp            !! f, the instant of closing
      real(dp) :: compliance(2) = 0.0_dp       !! c_n, c_t [length/force]
      real(dp) :: rate(2) = 0.0_dp             !! derivative of f by lambda_n, lambda_t [1/force]
   end type closing_law_type

contains

   !> One number per pair for its contact condition.
   pure function condition_code(state) result(codes)
      type(contact_state_type), intent(in) :: state   !! statuses and directions
      integer :: codes(size(state%status))            !! (m)

      codes = 3*state%status
      where (state%status == status_slip) codes = codes + state%direction
   end function condition_code

end module contact_states
