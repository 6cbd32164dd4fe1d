!> The accuracy that a deck or the command line asks for.
module accuracy_targets
   use kinds, only: dp
   implicit none
   private
   public :: accuracy_target_type, accuracy_request_type, whole_request

   !> Quantities that --accuracy bounds, at every interface.
   character(*), parameter :: usual(4) = [character(13) :: 'normal_force', 'heat_rate', &
      'peak_pressure', 'edge_contact']

   !> Bound that the error of a quantity must not exceed at the end of each step.
   type :: accuracy_target_type
      character(:), allocatable :: quantity   !! its name
      real(dp) :: bound = 0.0_dp              !! > 0: a part of the value, or in its unit
      logical :: is_relative = .true.         !! REL, else ABS
      integer :: interface = 0                !! index into the model's contacts; 0 for all
   end type accuracy_target_type

   !> *ACCURACY.
   type :: accuracy_request_type
      type(accuracy_target_type), allocatable :: targets(:)   !! unallocated: nothing is requested
      integer :: rounds = 8                                   !! ROUNDS=
   end type accuracy_request_type

contains

   !> The targets of the usual quantities of all interfaces.
   pure function whole_request(bound) result(targets)
      real(dp), intent(in) :: bound   !! a part of the values
      type(accuracy_target_type), allocatable :: targets(:)
      integer :: i

      allocate (targets(size(usual)))
      do i = 1, size(usual)
         targets(i)%quantity = trim(usual(i))
         targets(i)%bound = bound
      end do
   end function whole_request

end module accuracy_targets
