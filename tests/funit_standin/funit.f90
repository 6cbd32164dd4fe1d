!> Stand-in for pFUnit's module of the same name: the assertions that our tests use, with pFUnit's
!> names, arguments and rules.
!>
!> assertequal: equal, reals within an absolute `tolerance=` (0 unless given), strings without the
!> blanks around them. assertrelativelyequal: within `tolerance=` times the magnitude of what is
!> expected, not 0. assertlessthan, assertgreaterthan: the first is less (greater) than the second.
!> assertisnan, assertisfinite: of a real. asserttrue, assertfalse: of a logical.
!>
!> All take `message=`, what the test says of it. Arrays are equal when their shapes and all their
!> elements are; a scalar may be expected of every element of an array. NaN equals nothing.
module funit
   use funit_integers, only: assertequal, assertlessthan, assertgreaterthan
   use funit_messages, only: difference
   use funit_reals, only: assertequal, assertrelativelyequal, assertlessthan, assertgreaterthan, &
      assertisnan, assertisfinite
   use funit_results, only: sourcelocation, report, anyexceptions, run_test, end_tests
   implicit none
   private
   public :: sourcelocation, anyexceptions, run_test, end_tests
   public :: assertequal, assertrelativelyequal, assertlessthan, assertgreaterthan
   public :: assertisnan, assertisfinite, asserttrue, assertfalse

   ! pFUnit's module has these names too, so no test module can declare them.
   logical, parameter, public :: catch = .true., catchnext = .true., disable = .true., &
      expectation = .true., finalize = .true., generic_run = .true., get_context = .true., &
      initialize = .true., predicate = .true., run = .true., stub = .true., subject = .true., &
      test = .true., testcase = .true., testmethod = .true., testresult = .true., &
      testrunner = .true., testsuite = .true., throw = .true.

   interface assertequal
      module procedure equal_string
   end interface assertequal

contains

   !> The condition holds.
   subroutine asserttrue(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (.not. condition) call report('    not true', message, location)
   end subroutine asserttrue

   !> The condition does not hold.
   subroutine assertfalse(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (condition) call report('    not false', message, location)
   end subroutine assertfalse

   subroutine equal_string(expected, actual, message, location)
      character(*), intent(in) :: expected, actual
      character(*), intent(in), optional :: message
      type(sourcelocation), intent(in) :: location

      if (trim(adjustl(expected)) == trim(adjustl(actual))) return
      call report(difference('<'//expected//'>', '<'//actual//'>'), message, location)
   end subroutine equal_string

end module funit
