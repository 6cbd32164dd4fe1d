!> The instants at which increments end.
module increment_instants
   use kinds, only: dp
   use load_courses, only: step_clock_type
   use model, only: model_type
   use steps, only: step_type
   implicit none
   private
   public :: next_instant, step_is_over

   real(dp), parameter :: remainder = 1.0e-6_dp !! part of an increment too small for one

contains

   !> Whether a step is solved to its end.
   pure logical function step_is_over(step, step_time)
      type(step_type), intent(in) :: step      !! the step
      real(dp), intent(in) :: step_time        !! time since its start [time]

      step_is_over = step_time >= step%period - remainder*step%first_increment
   end function step_is_over

   !> The end of the next increment: the next multiple of the first increment, reckoned and not
   !> added up, or without DIRECT an earlier instant on which the step must land.
   pure function next_instant(model, step, step_start, step_time) result(clock)
      type(model_type), intent(in) :: model    !! the model
      type(step_type), intent(in) :: step      !! its present step
      real(dp), intent(in) :: step_start       !! total time at the start of the step [time]
      real(dp), intent(in) :: step_time        !! time since then, of the last increment [time]
      type(step_clock_type) :: clock           !! the instant
      real(dp) :: least, offset
      integer :: i, k

      least = step_time + remainder*step%first_increment
      clock%step_time = (floor(least/step%first_increment) + 1)*step%first_increment
      if (.not. step%direct) then
         do i = 1, size(model%verifications)
            if (model%verifications(i)%at_last) cycle
            clock%step_time = earlier(clock%step_time, least, &
               model%verifications(i)%when - step_start)
         end do
         do i = 1, size(model%amplitudes)
            associate (curve => model%amplitudes(i))
               offset = merge(step_start, 0.0_dp, curve%total_time)
               do k = 1, size(curve%times)
                  clock%step_time = earlier(clock%step_time, least, curve%times(k) - offset)
               end do
            end associate
         end do
      end if
      if (clock%step_time > step%period - remainder*step%first_increment) then
         clock%step_time = step%period
      end if
      clock%period = step%period
      clock%total_time = step_start + clock%step_time
      clock%ramped = step%ramped
   end function next_instant

   !> The earlier of an instant and another one that lies behind the least.
   pure function earlier(instant, least, other) result(first)
      real(dp), intent(in) :: instant, least, other
      real(dp) :: first

      first = instant
      if (other > least .and. other < instant) first = other
   end function earlier

end module increment_instants
