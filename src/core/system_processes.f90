!> Interfaces of system_processes.c, which says what they do.
module system_processes
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long
   implicit none
   private
   public :: report_type, process_end_type, longest_reason
   public :: c_start_child, c_collect_child, c_signal_child, c_read, c_file_report
   public :: c_catch_signals, c_signals, c_prepare_end, c_prepare_summary, c_hold_end
   public :: c_end_without_memory
   public :: c_close, c_exit_at_once, c_sleep

   integer, parameter :: longest_reason = 4096   !! characters, with the 0 at the end

   !> Report of a child; all of it is 0 at first.
   type, bind(c) :: report_type
      integer(c_int) :: is_whole = 0_c_int        !! 1 once the child has said all
      integer(c_int) :: lacks_memory = 0_c_int    !! 1 where memory ran out
      integer(c_int) :: status = 0_c_int          !! exit status
      integer(c_int) :: increments = 0_c_int      !! increments accepted so far
      integer(c_int) :: iterations = 0_c_int      !! passes so far
      integer(c_int) :: verify_passed = 0_c_int   !! *VERIFY checks
      integer(c_int) :: verify_failed = 0_c_int   !! *VERIFY checks
      integer(c_int) :: files = 0_c_int           !! how many of its files it has written so far
      real(c_double) :: seconds = 0.0_c_double    !! time that the work took [s]
      character(c_char) :: reason(longest_reason) = achar(0)   !! why, where the status is not 0
   end type report_type

   !> How a child ended, and what it took.
   type, bind(c) :: process_end_type
      integer(c_int) :: status = 0_c_int              !! exit status; 0 where a signal ended it
      integer(c_int) :: signal = 0_c_int              !! number of the signal that ended it, or 0
      integer(c_int) :: is_crash = 0_c_int            !! 1 for a signal that a fault raises
      character(c_char) :: signal_name(16) = achar(0) !! such as SIGSEGV, ended by a 0
      real(c_double) :: cpu_seconds = 0.0_c_double    !! its own and the system's [s]
      real(c_double) :: peak_bytes = 0.0_c_double     !! largest resident memory [byte]
   end type process_end_type

   interface
      integer(c_int) function c_start_child(messages, report) bind(c, name='thercon_start_child')
         import :: c_int
         integer(c_int), intent(out) :: messages, report
      end function c_start_child

      integer(c_int) function c_collect_child(child, waits, end) &
         bind(c, name='thercon_collect_child')
         import :: c_int, process_end_type
         integer(c_int), value :: child, waits
         type(process_end_type), intent(inout) :: end
      end function c_collect_child

      subroutine c_signal_child(child, kills) bind(c, name='thercon_signal_child')
         import :: c_int
         integer(c_int), value :: child, kills
      end subroutine c_signal_child

      integer(c_int) function c_read(file, offset, length, bytes) bind(c, name='thercon_read')
         import :: c_char, c_int, c_long
         integer(c_int), value :: file, length
         integer(c_long), value :: offset
         character(c_char), intent(out) :: bytes(length)
      end function c_read

      subroutine c_file_report(report) bind(c, name='thercon_file_report')
         import :: report_type
         type(report_type), intent(in) :: report
      end subroutine c_file_report

      subroutine c_catch_signals(outlives_pipes) bind(c, name='thercon_catch_signals')
         import :: c_int
         integer(c_int), value :: outlives_pipes
      end subroutine c_catch_signals

      subroutine c_signals(name, number, overdue) bind(c, name='thercon_signals')
         import :: c_int
         integer(c_int), intent(out) :: name, number, overdue
      end subroutine c_signals

      subroutine c_prepare_end(when, shows, deck, where, holds, listing, kept, working) &
         bind(c, name='thercon_prepare_end')
         import :: c_char, c_int
         integer(c_int), value :: when, shows
         character(c_char), intent(in) :: deck(*), where(*), holds(*), listing(*), kept(*), &
            working(*)
      end subroutine c_prepare_end

      subroutine c_prepare_summary(words) bind(c, name='thercon_prepare_summary')
         import :: c_char
         character(c_char), intent(in) :: words(*)
      end subroutine c_prepare_summary

      subroutine c_hold_end(holds) bind(c, name='thercon_hold_end')
         import :: c_int
         integer(c_int), value :: holds
      end subroutine c_hold_end

      !> Ends the process because so many bytes more are not available, with what is prepared.
      subroutine c_end_without_memory(bytes) bind(c, name='thercon_end_without_memory')
         import :: c_double
         real(c_double), value :: bytes
      end subroutine c_end_without_memory

      !> POSIX close(2).
      integer(c_int) function c_close(file) bind(c, name='close')
         import :: c_int
         integer(c_int), value :: file
      end function c_close

      !> POSIX _exit(2): what the parent had open stays as it is.
      subroutine c_exit_at_once(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine c_exit_at_once

      !> usleep(3): sleeps for microseconds, or until a signal comes.
      integer(c_int) function c_sleep(microseconds) bind(c, name='usleep')
         import :: c_int
         integer(c_int), value :: microseconds
      end function c_sleep
   end interface

end module system_processes
