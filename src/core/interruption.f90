!> SIGINT and SIGTERM: they end a run after the current increment or, where that takes longer,
!> within seconds.
!>
!> Signals are remembered in system_processes.c, and never taken back: whatever is still to be
!> solved is not started. The end of an increment that takes too long is prepared here.
module interruption
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_null_char
   use errors, only: error_type, set_error, status_interrupted
   implicit none
   private
   public :: catch_signals, caught_signal, caught_times, check_overdue
   public :: c_end_without_memory
   public :: run_end_type, end_by_increments, end_at_once, end_after_grace

   integer, parameter :: end_by_increments = 0   !! a signal ends the run where it asks for one
   integer, parameter :: end_at_once = 1         !! anywhere: there is nothing to keep
   integer, parameter :: end_after_grace = 2     !! anywhere, seconds after the signal

   !> Words and files for a run that is ended within an increment, or by a lack of memory.
   type :: run_end_type
      integer :: when = end_by_increments        !! one of the end_* constants
      logical :: shows_progress = .false.        !! whether there is a progress line to be cleared
      character(:), allocatable :: deck          !! path as given
      character(:), allocatable :: where         !! such as ' after increment 3'
      character(:), allocatable :: holds         !! what the results hold, printed behind it
      character(:), allocatable :: listing       !! path of the listing, empty for none
      character(:), allocatable :: kept          !! what the results hold, one sentence for the
      !! listing; empty where that is not begun
      character(:), allocatable :: working       !! path of the working file, empty for none
   contains
      procedure :: prepare
      procedure, nopass :: prepare_summary
      procedure, nopass :: hold
   end type run_end_type

   interface
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
   end interface

contains

   !> From now on both signals are remembered; one that the caller of the program had ignored, as
   !> nohup and shells do for jobs in the background, stays so.
   subroutine catch_signals(outlives_pipes)
      logical, intent(in) :: outlives_pipes   !! whether words that nobody reads are no error

      call c_catch_signals(merge(1_c_int, 0_c_int, outlives_pipes))
   end subroutine catch_signals

   !> Name of the signal that came, or nothing.
   function caught_signal() result(name)
      character(:), allocatable :: name   !! SIGINT, SIGTERM or empty
      character(*), parameter :: names(0:2) = [character(7) :: '', 'SIGINT', 'SIGTERM']
      integer(c_int) :: signal, times, is_overdue

      call c_signals(signal, times, is_overdue)
      name = trim(names(signal))
   end function caught_signal

   !> How many of these signals came.
   integer function caught_times()
      integer(c_int) :: signal, times, is_overdue

      call c_signals(signal, times, is_overdue)
      caught_times = int(times)
   end function caught_times

   !> Whether the current increment has had its time after a signal.
   !> Error: status_interrupted.
   subroutine check_overdue(error)
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: signal, times, is_overdue

      call c_signals(signal, times, is_overdue)
      if (is_overdue == 0_c_int) return
      call set_error(error, status_interrupted, 'ended by '//caught_signal())
   end subroutine check_overdue

   !> This holds from now on.
   subroutine prepare(self)
      class(run_end_type), intent(in) :: self

      call c_prepare_end(int(self%when, c_int), merge(1_c_int, 0_c_int, self%shows_progress), &
         self%deck//c_null_char, self%where//c_null_char, self%holds//c_null_char, &
         self%listing//c_null_char, self%kept//c_null_char, self%working//c_null_char)
   end subroutine prepare

   !> From now on this is printed on standard output behind `deck: interrupted`.
   subroutine prepare_summary(words)
      character(*), intent(in) :: words   !! lines with their ends

      call c_prepare_summary(words//c_null_char)
   end subroutine prepare_summary

   !> While files are written no signal ends the run.
   subroutine hold(holds)
      logical, intent(in) :: holds

      call c_hold_end(merge(1_c_int, 0_c_int, holds))
   end subroutine hold

end module interruption
