!> Load curves, and the value that a load has at an instant of a step.
module amplitudes
   use kinds, only: dp
   use text, only: named_type
   use conductance_laws, only: line_value
   implicit none
   private
   public :: amplitude_type, amplitude_value

   !> One *AMPLITUDE: lines between points, straight or smooth, held constant outside.
   type, extends(named_type) :: amplitude_type
      logical :: total_time = .false.        !! abscissa is total time, not step time
      real(dp), allocatable :: times(:)      !! (points) ascending [time]
      real(dp), allocatable :: values(:)     !! (points) factors [-]
      !> Between two points a polynomial of fifth order that is level at both, without curvature
      logical :: smooth = .false.
   end type amplitude_type

contains

   !> Factor of an amplitude at an instant.
   pure function amplitude_value(amplitude, time) result(factor)
      type(amplitude_type), intent(in) :: amplitude !! the curve
      real(dp), intent(in) :: time                  !! of the step or in total, as the curve asks
      real(dp) :: factor                            !! ordinate [-]
      real(dp) :: share
      integer :: i

      i = count(amplitude%times <= time)
      if (.not. amplitude%smooth .or. i == 0 .or. i == size(amplitude%times)) then
         factor = line_value(amplitude%times, amplitude%values, time)
         return
      end if
      share = (time - amplitude%times(i))/(amplitude%times(i + 1) - amplitude%times(i))
      factor = amplitude%values(i) + (amplitude%values(i + 1) - amplitude%values(i))* &
         share**3*(10.0_dp - 15.0_dp*share + 6.0_dp*share**2)
   end function amplitude_value

end module amplitudes
