!> SIGINT and SIGTERM: they end a run after the current increment.
!>
!> A signal handler is called by the system with the signal's number and nothing else, so what it
!> remembers must be module variables, the only ones of the program. They are never taken back:
!> whatever is still to be solved is not started.
module interruption
   use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t
   implicit none
   private
   public :: catch_signals, caught_signal, caught_number, caught_times

   integer(c_int), parameter :: signal_numbers(2) = [2_c_int, 15_c_int] !! as POSIX has them
   character(7), parameter :: signal_names(2) = ['SIGINT ', 'SIGTERM']
   integer(c_intptr_t), parameter :: ignored = 1_c_intptr_t   !! SIG_IGN as an address

   integer(c_int), volatile :: caught = 0_c_int   !! the last of these signals that came, or 0
   integer(c_int), volatile :: times = 0_c_int    !! how many came

   interface
      !> POSIX signal(2); with glibc the handler stays, and system calls that it breaks go on.
      function posix_signal(number, handler) bind(c, name='signal') result(former)
         import :: c_funptr, c_int
         integer(c_int), value :: number
         type(c_funptr), value :: handler
         type(c_funptr) :: former
      end function posix_signal
   end interface

contains

   !> From now on both signals are only remembered; one that the caller of the program had ignored,
   !> as nohup and shells do for jobs in the background, stays so.
   subroutine catch_signals()
      type(c_funptr) :: former
      integer :: i

      do i = 1, size(signal_numbers)
         former = posix_signal(signal_numbers(i), c_funloc(remember))
         if (transfer(former, ignored) == ignored) former = posix_signal(signal_numbers(i), former)
      end do
   end subroutine catch_signals

   !> The handler. Storing numbers is all that may safely be done in one.
   subroutine remember(number) bind(c)
      integer(c_int), value, intent(in) :: number

      caught = number
      times = times + 1_c_int
   end subroutine remember

   !> Name of the signal that came, or nothing.
   function caught_signal() result(name)
      character(:), allocatable :: name   !! SIGINT, SIGTERM or empty
      integer(c_int) :: number

      number = caught
      name = ''
      if (any(signal_numbers == number)) name = &
         trim(signal_names(findloc(signal_numbers, number, dim=1)))
   end function caught_signal

   !> Number of the signal that came last, or 0.
   integer function caught_number()
      caught_number = int(caught)
   end function caught_number

   !> How many of these signals came.
   integer function caught_times()
      caught_times = int(times)
   end function caught_times

end module interruption
