!> Numbers that overflowed, and what was made of them.
module finite_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use errors, only: error_type, set_error
   use kinds, only: dp
   implicit none
   private
   public :: all_finite, check_finite

contains

   !> Whether none of some values is infinite or no number.
   pure logical function all_finite(values)
      real(dp), intent(in) :: values(:)   !! any values

      all_finite = all(ieee_is_finite(values))
   end function all_finite

   !> Raises an error where values overflowed.
   !> Error: the status given; some value is infinite or no number.
   subroutine check_finite(values, what, status, error)
      real(dp), intent(in) :: values(:)                   !! any values
      character(*), intent(in) :: what                    !! what they are, in the plural
      integer, intent(in) :: status                       !! one of the status_* constants
      type(error_type), allocatable, intent(out) :: error

      if (all_finite(values)) return
      call set_error(error, status, what//' overflow: values of the deck are too large, or too '// &
         'far apart')
   end subroutine check_finite

end module finite_values
