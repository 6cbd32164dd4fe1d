!> Seconds that the skyline and LAPACK's dpbtrf take to factor uniform bands, the best of three. The
!> argument is the number of equations.
program skyline_bench
   use column_panels, only: column_panels_type
   use kinds, only: dp
   implicit none
   integer, parameter :: bands(4) = [100, 200, 400, 800], repeats = 3
   real(dp) :: seconds(2), best(2)
   integer :: equations, i, repeat
   character(20) :: argument

   interface
      subroutine dpbtrf(uplo, n, kd, ab, ldab, info)
         import :: dp
         implicit none
         character, intent(in) :: uplo
         integer, intent(in) :: n, kd, ldab
         real(dp), intent(inout) :: ab(ldab, *)
         integer, intent(out) :: info
      end subroutine dpbtrf
   end interface

   call get_command_argument(1, argument)
   read (argument, *) equations
   print '(4a12)', 'bandwidth', 'dpbtrf [s]', 'skyline [s]', 'ratio'
   do i = 1, size(bands)
      best = huge(best)
      do repeat = 1, repeats
         call factor_band(bands(i), seconds)
         best = min(best, seconds)
      end do
      print '(i12, 2f12.4, f12.2)', bands(i), best, best(2)/best(1)
   end do

contains

   !> CPU seconds of dpbtrf and of the skyline for one band, whose pivots must agree.
   subroutine factor_band(band, seconds)
      integer, intent(in) :: band
      real(dp), intent(out) :: seconds(2)
      type(column_panels_type) :: columns
      real(dp), allocatable :: entries(:, :)
      real(dp) :: times(3), smallest
      integer :: bad_column, first(equations), info, j

      allocate (entries(band + 1, equations))
      call random_number(entries)
      entries = -entries
      entries(band + 1, :) = 2.0_dp*band
      first = [(max(1, j - band), j=1, equations)]
      call columns%set_profile(first, equations)
      do j = 1, equations
         associate (at => columns%place(columns%panel(j), first(j), j))
            columns%value(at:at + j - first(j)) = entries(band + 1 - (j - first(j)):, j)
         end associate
      end do
      call cpu_time(times(1))
      call dpbtrf('U', equations, band, entries, band + 1, info)
      call cpu_time(times(2))
      call columns%factor(1, 0.0_dp, smallest, bad_column)
      call cpu_time(times(3))
      seconds = times(2:) - times(:2)
      if (info /= 0 .or. bad_column /= 0 .or. any(abs(columns%pivot/entries(band + 1, :)**2 - &
         1.0_dp) > 1.0e-10_dp)) error stop 'the factors differ'
   end subroutine factor_band

end program skyline_bench
