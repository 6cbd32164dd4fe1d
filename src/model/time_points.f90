!> Instants at which the deck asks for output (*TIME POINTS).
module time_points
   use kinds, only: dp
   use named_items, only: named_type
   implicit none
   private
   public :: time_points_type

   !> One *TIME POINTS; without times where a card names none.
   type, extends(named_type) :: time_points_type
      logical :: total_time = .false.       !! whether times are total ones, not those of the step
      real(dp), allocatable :: times(:)     !! (points) ascending [time]
   contains
      procedure :: in_step
   end type time_points_type

contains

   !> The instants from the start of a step.
   pure function in_step(self, step_start) result(times)
      class(time_points_type), intent(in) :: self
      real(dp), intent(in) :: step_start     !! total time at the start of the step [time]
      real(dp), allocatable :: times(:)      !! [time]

      allocate (times(0))
      if (allocated(self%times)) times = self%times - merge(step_start, 0.0_dp, self%total_time)
   end function in_step

end module time_points
