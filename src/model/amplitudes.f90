!> Load curves, and the value that a load has at an instant of a step.
module amplitudes
   use kinds, only: dp
   use piecewise_lines, only: line_value
   implicit none
   private
   public :: amplitude_type, amplitude_value

   !> One *AMPLITUDE: straight lines between points, held constant outside.
   type :: amplitude_type
      character(:), allocatable :: name      !! name in upper case
      logical :: total_time = .false.        !! abscissa is total time, not step time
      real(dp), allocatable :: times(:)      !! (points) ascending [time]
      real(dp), allocatable :: values(:)     !! (points) factors [-]
   end type amplitude_type

contains

   !> Factor of an amplitude at an instant.
   pure function amplitude_value(amplitude, time) result(factor)
      type(amplitude_type), intent(in) :: amplitude !! the curve
      real(dp), intent(in) :: time                  !! of the step or in total, as the curve asks
      real(dp) :: factor                            !! ordinate [-]

      factor = line_value(amplitude%times, amplitude%values, time)
   end function amplitude_value

end module amplitudes
