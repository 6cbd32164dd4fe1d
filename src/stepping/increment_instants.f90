!> The instants at which increments end. Numbers in, numbers out.
module increment_instants
   use kinds, only: dp
   implicit none
   private
   public :: next_end, cut_size, grown_size, is_smallest

   real(dp), parameter :: remainder = 1.0e-6_dp   !! part of an increment too small for one
   real(dp), parameter :: rounding = 1.0e-13_dp   !! of the period: what sums of increments lose
   real(dp), parameter :: cut = 0.25_dp           !! part of a failed increment that is tried next
   real(dp), parameter :: growth = 2.0_dp         !! of increments after one that did not fail
   real(dp), parameter :: hardly_longer = 1.001_dp !! factor that makes no longer increment

contains

   !> The end of the next increment: the next multiple of the first increment, reckoned and not
   !> added up, or an earlier instant on which the step must land; short of these where increments
   !> were cut back. A remainder too small for an increment goes to the one before it.
   pure function next_end(step_time, size_allowed, first, period, landings) result(ending)
      real(dp), intent(in) :: step_time      !! end of the last increment [time]
      real(dp), intent(in) :: size_allowed   !! largest size of the next one [time]
      real(dp), intent(in) :: first          !! first increment [time]
      real(dp), intent(in) :: period         !! length of the step [time]
      real(dp), intent(in) :: landings(:)    !! (n) instants on which it must land [time]
      real(dp) :: ending                     !! all from the start of the step [time]
      real(dp) :: least, target
      integer :: i

      associate (tolerance => max(remainder*size_allowed, rounding*period))
         least = step_time + tolerance
         target = (floor(least/first) + 1)*first
         do i = 1, size(landings)
            if (landings(i) > least .and. landings(i) < target) target = landings(i)
         end do
         if (target > period - tolerance) target = period
         ending = step_time + size_allowed
         if (target <= ending + tolerance) ending = target
      end associate
   end function next_end

   !> Size of the increment that is tried after one that failed.
   elemental function cut_size(failed, smallest) result(next)
      real(dp), intent(in) :: failed     !! size that failed [time]
      real(dp), intent(in) :: smallest   !! smallest size [time]
      real(dp) :: next                   !! shorter by a good deal, but not below it [time]

      next = max(cut*failed, smallest)
   end function cut_size

   !> Size of the increment after one that converged at its first attempt.
   elemental function grown_size(converged, first) result(next)
      real(dp), intent(in) :: converged  !! largest size allowed to that one [time]
      real(dp), intent(in) :: first      !! first increment, the longest of all [time]
      real(dp) :: next                   !! largest size of the next one [time]

      next = min(growth*converged, first)
   end function grown_size

   !> Whether an increment is so small that it is not cut back any more.
   elemental function is_smallest(failed, smallest)
      real(dp), intent(in) :: failed     !! size that failed [time]
      real(dp), intent(in) :: smallest   !! smallest size [time]
      logical :: is_smallest             !! whether it is the smallest

      is_smallest = failed <= hardly_longer*smallest
   end function is_smallest

end module increment_instants
