!> Curves of straight lines between points that hold their end values outside.
module piecewise_lines
   use kinds, only: dp
   implicit none
   private
   public :: line_value, line_slope

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

end module piecewise_lines
