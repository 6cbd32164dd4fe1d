!> Assertions on reals; see the module funit.
module funit_reals
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: real64
   use funit_messages, only: difference, shape_difference, subscripts, to_text
   use funit_results, only: sourcelocation, report, anyexceptions
   implicit none
   private
   public :: assertequal, assertrelativelyequal, assertlessthan, assertgreaterthan
   public :: assertisnan, assertisfinite

   interface assertequal
      module procedure equal_real, equal_real_1, equal_real_2, equal_real_all_1, equal_real_all_2
   end interface assertequal

   interface assertrelativelyequal
      module procedure relatively_equal, relatively_equal_1
   end interface assertrelativelyequal

   interface assertlessthan
      module procedure less_real
   end interface assertlessthan

   interface assertgreaterthan
      module procedure greater_real
   end interface assertgreaterthan

contains

   subroutine equal_real(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected, actual
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([expected], [actual], [integer ::], [integer ::], tolerance, message, &
         location)
   end subroutine equal_real

   subroutine equal_real_1(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare(expected, actual, shape(expected), shape(actual), tolerance, message, &
         location)
   end subroutine equal_real_1

   subroutine equal_real_2(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:, :), actual(:, :)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([expected], [actual], shape(expected), shape(actual), tolerance, message, &
         location)
   end subroutine equal_real_2

   subroutine equal_real_all_1(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected, actual(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call equal_real_1(spread(expected, 1, size(actual)), actual, tolerance, message, location)
   end subroutine equal_real_all_1

   subroutine equal_real_all_2(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected, actual(:, :)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call equal_real_2(spread(spread(expected, 1, size(actual, 1)), 2, size(actual, 2)), actual, &
         tolerance, message, location)
   end subroutine equal_real_all_2

   subroutine relatively_equal(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected, actual, tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (is_within(0.0_real64, expected)) then
         call report('    0 is no measure of a relative difference', message, location)
      else
         call equal_real(expected, actual, tolerance*abs(expected), message, location)
      end if
   end subroutine relatively_equal

   subroutine relatively_equal_1(expected, actual, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:), tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location
      integer :: i

      if (size(expected) /= size(actual)) then
         call report(shape_difference(shape(expected), shape(actual)), message, location)
         return
      end if
      do i = 1, size(expected)
         call relatively_equal(expected(i), actual(i), tolerance, message, location)
         if (anyexceptions()) return
      end do
   end subroutine relatively_equal_1

   subroutine less_real(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (.not. (ieee_is_nan(lhs) .or. ieee_is_nan(rhs))) then
         if (lhs < rhs) return
      end if
      call report('    '//to_text(lhs)//' is not less than '//to_text(rhs), message, location)
   end subroutine less_real

   subroutine greater_real(lhs, rhs, message, location)
      real(real64), intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (.not. (ieee_is_nan(lhs) .or. ieee_is_nan(rhs))) then
         if (lhs > rhs) return
      end if
      call report('    '//to_text(lhs)//' is not greater than '//to_text(rhs), message, location)
   end subroutine greater_real

   !> A real is NaN.
   subroutine assertisnan(x, message, location)
      real(real64), intent(in) :: x
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (.not. ieee_is_nan(x)) call report('    not NaN: '//to_text(x), message, location)
   end subroutine assertisnan

   !> A real is neither NaN nor infinite.
   subroutine assertisfinite(x, message, location)
      real(real64), intent(in) :: x
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (.not. ieee_is_finite(x)) call report('    not finite: '//to_text(x), message, location)
   end subroutine assertisfinite

   ! Elements in storage order, and the shapes that they came in.
   subroutine compare(expected, actual, expected_shape, actual_shape, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:)
      integer, intent(in) :: expected_shape(:), actual_shape(:)
      real(real64), intent(in), optional :: tolerance
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location
      integer :: i

      if (any(expected_shape /= actual_shape)) then
         call report(shape_difference(expected_shape, actual_shape), message, location)
         return
      end if
      do i = 1, size(expected)
         if (is_within(expected(i), actual(i), tolerance)) cycle
         call report(difference(to_text(expected(i)), to_text(actual(i)), &
            subscripts(i, actual_shape)), message, location)
         return
      end do
   end subroutine compare

   ! NaN is looked for first and infinities are not subtracted: either could trap.
   pure function is_within(expected, actual, tolerance) result(within)
      real(real64), intent(in) :: expected, actual
      real(real64), intent(in), optional :: tolerance
      logical :: within

      within = .false.
      if (ieee_is_nan(expected) .or. ieee_is_nan(actual)) return
      within = .not. (expected < actual .or. expected > actual)
      if (within .or. .not. present(tolerance)) return
      if (.not. (ieee_is_finite(expected) .and. ieee_is_finite(actual))) return
      within = abs(actual - expected) <= tolerance
   end function is_within

end module funit_reals
