!> Elapsed time.
module clock
   use kinds, only: dp, long
   implicit none
   private
   public :: wall_seconds

contains

   !> Seconds of the wall clock since some instant in the past.
   function wall_seconds() result(seconds)
      real(dp) :: seconds   !! [s]
      integer(long) :: ticks, rate

      call system_clock(ticks, rate)
      seconds = real(ticks, dp)/real(rate, dp)
   end function wall_seconds

end module clock
