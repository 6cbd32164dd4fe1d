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
   public :: catch_signals, caught_signal, caught_times, check_overdue, prepare_end
   public :: c_end_without_memory, end_by_increments, end_at_once, end_after_grace

   ! When a signal ends a run.
   integer, parameter :: end_by_increments = 0   !! where the run asks for one, as while it writes
   integer, parameter :: end_at_once = 1         !! anywhere: there is nothing to keep
   integer, parameter :: end_after_grace = 2     !! anywhere, seconds after the signal

   interface
      subroutine c_catch_signals(outlives_pipes) bind(c, name='thercon_catch_signals')
         import :: c_int
         integer(c_int), value :: outlives_pipes
      end subroutine c_catch_signals

      !> Which signal came: nothing 0, SIGINT 1, SIGTERM 2.
      integer(c_int) function c_caught() bind(c, name='thercon_caught')
         import :: c_int
      end function c_caught

      !> How many of these signals came.
      integer(c_int) function caught_times() bind(c, name='thercon_caught_times')
         import :: c_int
      end function caught_times

      integer(c_int) function c_is_overdue() bind(c, name='thercon_is_overdue')
         import :: c_int
      end function c_is_overdue

      subroutine c_prepare_end(when, shows, deck, where, leftover) &
         bind(c, name='thercon_prepare_end')
         import :: c_char, c_int
         integer(c_int), value :: when, shows
         character(c_char), intent(in) :: deck(*), where(*), leftover(*)
      end subroutine c_prepare_end

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

      name = trim(names(c_caught()))
   end function caught_signal

   !> Whether the current increment has had its time after a signal.
   !> Error: status_interrupted.
   subroutine check_overdue(error)
      type(error_type), allocatable, intent(out) :: error

      if (c_is_overdue() /= 0_c_int) call set_error(error, status_interrupted, &
         'ended by '//caught_signal())
   end subroutine check_overdue

   !> From now on this holds where a signal or a lack of memory ends the run: a line on stderr, and
   !> which file goes, beside working files.
   subroutine prepare_end(when, shows_progress, deck, where, leftover)
      integer, intent(in) :: when             !! one of the end_* constants
      logical, intent(in) :: shows_progress   !! whether there is a progress line to be cleared
      character(*), intent(in) :: deck        !! path as given
      character(*), intent(in) :: where       !! printed behind the reason
      character(*), intent(in) :: leftover    !! path of a file without use then; empty for none

      call c_prepare_end(int(when, c_int), merge(1_c_int, 0_c_int, shows_progress), &
         deck//c_null_char, where//c_null_char, leftover//c_null_char)
   end subroutine prepare_end

end module interruption
