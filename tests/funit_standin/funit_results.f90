!> Running of tests and their verdicts, with the output lines of pFUnit.
module funit_results
   use, intrinsic :: iso_fortran_env, only: output_unit
   implicit none
   private
   public :: sourcelocation, report, anyexceptions, run_test, end_tests

   !> Place of an assertion in the test source.
   type :: sourcelocation
      character(256) :: file_name      !! name of the source, without its folder
      integer :: line = 0              !! line number
   end type sourcelocation

   abstract interface
      !> A test, or what is called before and after it.
      subroutine test_procedure()
      end subroutine test_procedure
   end interface

   ! Test sources call the assertions without any handle of the test that runs: its verdict can only
   ! be kept here.
   character(:), allocatable :: failures       !! what has failed in the test that runs
   character(:), allocatable :: failed_tests   !! what has failed in all of them
   integer :: failed_assertions = 0            !! in the test that runs
   integer :: tests_run = 0                    !! in all
   integer :: tests_failed = 0                 !! in all

contains

   !> An assertion of the test that runs has failed.
   subroutine report(reason, message, location)
      character(*), intent(in) :: reason                !! expected and found
      character(*), intent(in), optional :: message     !! what the test says of it
      type(sourcelocation), intent(in) :: location      !! where it stands
      character(1), parameter :: newline = new_line('a')
      character(12) :: line

      if (.not. allocated(failures)) failures = ''
      write (line, '(i0)') location%line
      failures = failures//'  Location: '//newline// &
         '['//trim(location%file_name)//':'//trim(line)//']'//newline
      if (present(message)) failures = failures//message//newline
      failures = failures//reason//newline
      failed_assertions = failed_assertions + 1
   end subroutine report

   !> Whether an assertion of the test that runs has failed.
   function anyexceptions() result(any_failed)
      logical :: any_failed   !! verdict so far

      any_failed = failed_assertions > 0
   end function anyexceptions

   !> One test: a failed assertion ends it, and the next test goes on.
   subroutine run_test(name, test, before, after)
      character(*), intent(in) :: name                  !! suite and test
      procedure(test_procedure) :: test                 !! the test
      procedure(test_procedure), optional :: before     !! called first; its failure is the test's
      procedure(test_procedure), optional :: after      !! called last, whatever the verdict

      failures = ''
      failed_assertions = 0
      tests_run = tests_run + 1
      write (output_unit, '(a)') ' Start: <'//name//'>'
      flush (output_unit)
      if (present(before)) call before()
      if (.not. anyexceptions()) then
         call test()
         if (present(after)) call after()
      end if
      if (anyexceptions()) then
         tests_failed = tests_failed + 1
         write (output_unit, '(a)') ' Failure in <'//name//'>'
         if (.not. allocated(failed_tests)) failed_tests = ''
         failed_tests = failed_tests//'Failure in: '//name//new_line('a')//failures//new_line('a')
      end if
      write (output_unit, '(a)') '   end: <'//name//'>'
      flush (output_unit)
   end subroutine run_test

   !> Prints what has failed and the verdict over all tests; a failed one, or none at all, makes the
   !> exit status.
   subroutine end_tests()
      if (tests_failed == 0 .and. tests_run > 0) then
         write (output_unit, '(a,/,a,i0,a)') ' OK', ' (', tests_run, ' tests)'
      else
         if (allocated(failed_tests)) write (output_unit, '(/,a)', advance='no') failed_tests
         write (output_unit, '(a,/,2(a,i0))') ' FAILURES!!!', &
            'Tests run: ', tests_run, ', Failures: ', tests_failed
         write (output_unit, '(a)') '*** Encountered 1 or more failures/errors during testing ***'
         flush (output_unit)
         stop 2
      end if
   end subroutine end_tests

end module funit_results
