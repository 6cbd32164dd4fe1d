!> Assertions on integers; see the module funit.
module funit_integers
   use, intrinsic :: iso_fortran_env, only: int64
   use funit_messages, only: difference, shape_difference, subscripts, to_text
   use funit_results, only: sourcelocation, report
   implicit none
   private
   public :: assertequal, assertlessthan, assertgreaterthan

   interface assertequal
      module procedure equal_integer, equal_long, equal_mixed
      module procedure equal_integer_1, equal_integer_2, equal_integer_all_1
   end interface assertequal

   interface assertlessthan
      module procedure less_integer
   end interface assertlessthan

   interface assertgreaterthan
      module procedure greater_integer
   end interface assertgreaterthan

contains

   subroutine equal_integer(expected, actual, message, location)
      integer, intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([int(expected, int64)], [int(actual, int64)], [integer ::], &
         [integer ::], message, location)
   end subroutine equal_integer

   subroutine equal_long(expected, actual, message, location)
      integer(int64), intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([expected], [actual], [integer ::], [integer ::], message, location)
   end subroutine equal_long

   subroutine equal_mixed(expected, actual, message, location)
      integer, intent(in) :: expected
      integer(int64), intent(in) :: actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call equal_long(int(expected, int64), actual, message, location)
   end subroutine equal_mixed

   subroutine equal_integer_1(expected, actual, message, location)
      integer, intent(in) :: expected(:), actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([int(expected, int64)], [int(actual, int64)], shape(expected), &
         shape(actual), message, location)
   end subroutine equal_integer_1

   subroutine equal_integer_2(expected, actual, message, location)
      integer, intent(in) :: expected(:, :), actual(:, :)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call compare([int(expected, int64)], [int(actual, int64)], shape(expected), &
         shape(actual), message, location)
   end subroutine equal_integer_2

   subroutine equal_integer_all_1(expected, actual, message, location)
      integer, intent(in) :: expected, actual(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      call equal_integer_1(spread(expected, 1, size(actual)), actual, message, location)
   end subroutine equal_integer_all_1

   subroutine less_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (lhs < rhs) return
      call report('    '//to_text(lhs)//' is not less than '//to_text(rhs), message, location)
   end subroutine less_integer

   subroutine greater_integer(lhs, rhs, message, location)
      integer, intent(in) :: lhs, rhs
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (lhs > rhs) return
      call report('    '//to_text(lhs)//' is not greater than '//to_text(rhs), message, &
         location)
   end subroutine greater_integer

   ! Elements in storage order, and the shapes that they came in.
   subroutine compare(expected, actual, expected_shape, actual_shape, message, location)
      integer(int64), intent(in) :: expected(:), actual(:)
      integer, intent(in) :: expected_shape(:), actual_shape(:)
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location
      integer :: i

      if (any(expected_shape /= actual_shape)) then
         call report(shape_difference(expected_shape, actual_shape), message, location)
         return
      end if
      do i = 1, size(expected)
         if (expected(i) == actual(i)) cycle
         call report(difference(to_text(expected(i)), to_text(actual(i)), &
            subscripts(i, actual_shape)), message, location)
         return
      end do
   end subroutine compare

end module funit_integers
