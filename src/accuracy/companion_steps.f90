!> A step as solutions beside the run take it.
module companion_steps
   use controls, only: start_type
   use kinds, only: dp
   use steps, only: step_type
   implicit none
   private
   public :: companion_step

   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

contains

   !> The step without what only the run itself tells: other starts, the gain, the last digits.
   pure function companion_step(step) result(companion)
      type(step_type), intent(in) :: step   !! the step of the run
      type(step_type) :: companion          !! the same, cheaper

      companion = step
      companion%start = start_type()
      companion%fixed_point%finds_gain = .false.
      companion%fixed_point%tolerance = max(tolerance, step%fixed_point%tolerance)
   end function companion_step

end module companion_steps
