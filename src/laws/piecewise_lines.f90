!> Curves of straight lines between points that hold their end values outside.
module piecewise_lines
   use kinds, only: dp
   implicit none
   private
   public :: line_value, line_slope, line_abscissa

contains

   !> Ordinate of a curve.
   pure function line_value(abscissas, ordinates, at) result(value)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: at             !! abscissa
      real(dp) :: value                      !! [as the ordinates]
      integer :: i, n

      n = size(abscissas)
      if (at <= abscissas(1)) then
         value = ordinates(1)
      else if (at >= abscissas(n)) then
         value = ordinates(n)
      else
         i = count(abscissas <= at)
         value = ordinates(i) + (ordinates(i + 1) - ordinates(i))*(at - abscissas(i))/ &
            (abscissas(i + 1) - abscissas(i))
      end if
   end function line_value

   !> Slope of a curve: at a point that of the line behind it, 0 where an end value is held.
   pure function line_slope(abscissas, ordinates, at) result(slope)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: at             !! abscissa
      real(dp) :: slope                      !! [ordinate/abscissa]
      integer :: i

      slope = 0.0_dp
      i = count(abscissas <= at)
      if (i == 0 .or. i == size(abscissas)) return
      slope = (ordinates(i + 1) - ordinates(i))/(abscissas(i + 1) - abscissas(i))
   end function line_slope

   !> Abscissa at which a curve first has a value on a line that is not level; negative where it has
   !> it nowhere, abscissas being positive.
   pure function line_abscissa(abscissas, ordinates, value) result(at)
      real(dp), intent(in) :: abscissas(:)   !! (points) ascending, >= 0, at least one
      real(dp), intent(in) :: ordinates(:)   !! (points)
      real(dp), intent(in) :: value          !! ordinate
      real(dp) :: at                         !! [abscissa]
      integer :: i

      at = -1.0_dp
      do i = 1, size(abscissas) - 1
         associate (from => ordinates(i), to => ordinates(i + 1))
            if (min(from, to) > value .or. max(from, to) < value) cycle
            if (abs(to - from) <= 0.0_dp) cycle
            at = abscissas(i) + (abscissas(i + 1) - abscissas(i))*(value - from)/(to - from)
            return
         end associate
      end do
   end function line_abscissa

end module piecewise_lines
