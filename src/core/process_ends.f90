!> How a process ended, in numbers and in words.
module process_ends
   use kinds, only: dp
   use text, only: to_text
   implicit none
   private
   public :: process_end_type, describe_end, signal_name, is_crash
   public :: signal_kill

   integer, parameter :: signal_kill = 9   !! SIGKILL

   !> Signals that end a process, by number, as Linux has them on x86 and ARM.
   character(7), parameter :: signal_names(31) = [character(7) :: 'SIGHUP', 'SIGINT', 'SIGQUIT', &
      'SIGILL', 'SIGTRAP', 'SIGABRT', 'SIGBUS', 'SIGFPE', 'SIGKILL', 'SIGUSR1', 'SIGSEGV', &
      'SIGUSR2', 'SIGPIPE', 'SIGALRM', 'SIGTERM', '', '', '', '', '', '', '', '', 'SIGXCPU', &
      'SIGXFSZ', '', '', '', '', '', 'SIGSYS']
   integer, parameter :: crashes(5) = [4, 6, 7, 8, 11]   !! signals that a fault in a program raises

   !> How a child ended, and what it took.
   type :: process_end_type
      integer :: process = 0              !! number of the process
      integer :: status = 0               !! its exit status; 0 where a signal ended it
      integer :: signal = 0               !! number of the signal that ended it, 0 for none
      real(dp) :: cpu_seconds = 0.0_dp    !! its own and the system's [s]
      real(dp) :: peak_bytes = 0.0_dp     !! largest resident memory [byte]
   end type process_end_type

contains

   !> Says in words how a child came to a sudden end; empty for one that ended by itself.
   pure function describe_end(ended) result(words)
      type(process_end_type), intent(in) :: ended   !! the end
      character(:), allocatable :: words            !! part of a sentence

      words = ''
      if (ended%signal == 0) return
      words = 'ended by signal '//to_text(ended%signal)//' ('//signal_name(ended%signal)//')'
      if (ended%signal == signal_kill) words = words//', as where memory runs out'
      if (is_crash(ended%signal)) words = words//', a crash'
   end function describe_end

   !> Name of a signal.
   pure function signal_name(signal) result(name)
      integer, intent(in) :: signal          !! its number
      character(:), allocatable :: name      !! such as SIGSEGV

      name = ''
      if (signal >= 1 .and. signal <= size(signal_names)) name = trim(signal_names(signal))
      if (len(name) == 0) name = 'signal '//to_text(signal)
   end function signal_name

   !> Whether a fault in the program raises such a signal.
   pure logical function is_crash(signal)
      integer, intent(in) :: signal   !! its number

      is_crash = any(crashes == signal)
   end function is_crash

end module process_ends
