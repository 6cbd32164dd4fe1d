!> Numbers that overflowed, and what was made of them.
module finite_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use errors, only: error_type, set_error
   use kinds, only: dp
   implicit none
   private
   public :: check_finite

contains

   !> Raises an error where values overflowed.
   !> Error: the status given; some value is infinite or no number.
   subroutine check_finite(values, what, status, error)
      real(dp), intent(in) :: values(:)                   !! any values
      character(*), intent(in) :: what                    !! what they are, in the plural
      integer, intent(in) :: status                       !! one of the status_* constants
      type(error_type), allocatable, intent(out) :: error

      if (all(ieee_is_finite(values))) return
      call set_error(error, status, what//' overflow: values of the deck are too large, or too '// &
         'far apart')
   end subroutine check_finite

end module finite_values
