!> Instants at which an increment of every variation of a deck ends.
module variation_instants
   use increment_control, only: increment_control_type
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use variations, only: varied_increment
   implicit none
   private
   public :: common_instants, instant_at

   integer, parameter :: few = 4             !! instants: fewer all count
   integer, parameter :: most_instants = 60  !! of all steps, but at least three in each

contains

   !> Instants at which variations are compared: ends of the longest increments, which shorter ones
   !> meet too, of many every n-th; where increments grow, only the instants on which they land. The
   !> first end of a step is the coarsest part of a path and left out, unless there are few.
   function common_instants(model, longest_factor) result(times)
      type(model_type), intent(in) :: model      !! as the deck is written
      real(dp), intent(in) :: longest_factor     !! on its increments; that of others is halved
      real(dp), allocatable :: times(:)          !! total times, ascending [time]
      type(model_type) :: longest
      type(increment_control_type) :: control
      type(step_clock_type) :: clock
      real(dp), allocatable :: ends(:)
      integer :: s, count

      longest = model
      allocate (times(0))
      do s = 1, size(model%steps)
         associate (step => longest%steps(s), most => max(most_instants/size(model%steps), 2))
            step%first_increment = varied_increment(step%first_increment, step%period, &
               longest_factor)
            count = floor(step%period/step%first_increment + 1.0e-6_dp)
            step%first_increment = step%first_increment*(1 + (count - 1)/most)
            if (step%grows) step%first_increment = step%period
            step%grows = .false.
         end associate
         call control%enter_step(longest)
         allocate (ends(0))
         do while (.not. control%step_is_over(longest))
            clock = control%next_instant(longest)
            call control%accept(longest, clock)
            ends = [ends, clock%total_time]
         end do
         times = [times, ends(merge(2, 1, count >= few .and. .not. model%steps(s)%grows):)]
         deallocate (ends)
      end do
   end function common_instants

   !> Which of some instants a time is; 0 for none.
   pure integer function instant_at(times, time)
      real(dp), intent(in) :: times(:)   !! instants [time]
      real(dp), intent(in) :: time       !! a total time [time]

      do instant_at = size(times), 1, -1
         if (abs(times(instant_at) - time) <= 1.0e-9_dp*times(size(times))) return
      end do
   end function instant_at

end module variation_instants
