!> Instants at which rows with other increments are compared.
module trade_instants
   use kinds, only: dp
   use model, only: model_type
   use variations, only: varied_increment
   implicit none
   private
   public :: common_instants, instant_at

   real(dp), parameter :: same = 1.0e-6_dp   !! of an increment: instants nearer than this are one
   integer, parameter :: few = 4             !! longest increments of a step: fewer all count
   integer, parameter :: most_instants = 60  !! of all steps, but at least three in each

contains

   !> Instants that every row meets: ends of the longest increments, which all halves of these meet
   !> too, every n-th of them where a step has many, and the end of the step. The first one is the
   !> coarsest part of a path and left out, unless there are few. Increments that are not fixed
   !> also land on corners of amplitudes and times of *VERIFY; those that grow meet nothing else.
   pure function common_instants(model, longest) result(times)
      type(model_type), intent(in) :: model      !! the model as the deck is written
      real(dp), intent(in) :: longest            !! largest factor on the increments
      real(dp), allocatable :: times(:)          !! total times, ascending [time]
      real(dp), allocatable :: corners(:)
      real(dp) :: start, increment
      integer :: s, i, k, count, most

      allocate (times(0))
      start = 0.0_dp
      most = max(most_instants/size(model%steps), 2)
      do s = 1, size(model%steps)
         associate (step => model%steps(s))
            increment = varied_increment(step%first_increment, step%period, longest)
            count = floor(step%period/increment + same)
            if (step%grows) count = 0
            do i = merge(2, 1, count >= few), count, 1 + (count - 1)/most
               call add(i*increment, times)
            end do
            if (.not. step%direct) then
               do i = 1, size(model%verifications)
                  if (model%verifications(i)%at_last) cycle
                  call add(model%verifications(i)%when - start, times)
               end do
               do i = 1, size(model%amplitudes)
                  corners = model%amplitudes(i)%times - merge(start, 0.0_dp, &
                     model%amplitudes(i)%total_time)
                  do k = 1, size(corners)
                     call add(corners(k), times)
                  end do
               end do
            end if
            start = start + step%period
            times = [times, start]
         end associate
      end do
      call sort(times)
   contains
      pure subroutine add(step_time, instants)
         real(dp), intent(in) :: step_time
         real(dp), allocatable, intent(inout) :: instants(:)

         if (step_time < same*increment) return
         if (step_time > model%steps(s)%period - same*increment) return
         if (any(abs(instants - (start + step_time)) < same*increment)) return
         instants = [instants, start + step_time]
      end subroutine add
   end function common_instants

   pure subroutine sort(times)
      real(dp), intent(inout) :: times(:)
      real(dp) :: time
      integer :: i, k

      do i = 2, size(times)
         time = times(i)
         do k = i - 1, 1, -1
            if (times(k) <= time) exit
            times(k + 1) = times(k)
         end do
         times(k + 1) = time
      end do
   end subroutine sort

   !> Which of some instants a time is; 0 for none.
   pure integer function instant_at(times, time)
      real(dp), intent(in) :: times(:)   !! instants [time]
      real(dp), intent(in) :: time       !! a total time [time]

      do instant_at = size(times), 1, -1
         if (abs(times(instant_at) - time) <= 1.0e-9_dp*times(size(times))) return
      end do
   end function instant_at

end module trade_instants
