!> Work in processes of its own: a crash, or memory that runs out, is that of the child alone, and
!> the system says what the child took. POSIX calls, with the structures of 64-bit Linux.
module processes
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long, c_null_char
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use errors, only: error_type, set_error, status_internal
   use kinds, only: dp
   use process_ends, only: process_end_type, signal_kill
   implicit none
   private
   public :: task_type
   public :: start_process, collect_process, kill_process, send_signal, pause_briefly

   integer(c_int), parameter :: do_not_wait = 1_c_int      !! WNOHANG
   integer(c_int), parameter :: die_with_parent = 1_c_int  !! PR_SET_PDEATHSIG
   integer(c_int), parameter :: any_child = -1_c_int
   integer, parameter :: longs_of_usage = 18               !! of struct rusage

   !> Starts a child that does some work and ends; it never outlives the program.
   interface start_process
      module procedure start_with_path
      module procedure start_with_descriptor
   end interface start_process

   !> What a child does; an extension holds what it needs for that.
   type, abstract :: task_type
   contains
      procedure(execute_task), deferred :: execute
   end type task_type

   abstract interface
      !> Does the work, in the child.
      subroutine execute_task(self, status)
         import :: task_type
         class(task_type), intent(inout) :: self   !! the work
         integer, intent(out) :: status            !! exit status of the child, 0 to 255
      end subroutine execute_task
   end interface

   type, bind(c) :: time_type
      integer(c_long) :: seconds = 0_c_long
      integer(c_long) :: nanoseconds = 0_c_long
   end type time_type

   interface
      !> POSIX fork(2).
      function posix_fork() bind(c, name='fork') result(process)
         import :: c_int
         integer(c_int) :: process
      end function posix_fork

      !> wait4(2) of BSD and Linux: as waitpid, with what the child took.
      function system_wait(process, status, options, usage) bind(c, name='wait4') result(ended)
         import :: c_int, c_long
         integer(c_int), value :: process
         integer(c_int), intent(out) :: status
         integer(c_int), value :: options
         integer(c_long), intent(out) :: usage(*)
         integer(c_int) :: ended
      end function system_wait

      !> POSIX kill(2).
      function posix_kill(process, signal) bind(c, name='kill') result(status)
         import :: c_int
         integer(c_int), value :: process
         integer(c_int), value :: signal
         integer(c_int) :: status
      end function posix_kill

      !> POSIX creat(2).
      function posix_create(path, mode) bind(c, name='creat') result(descriptor)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: descriptor
      end function posix_create

      !> POSIX dup2(2).
      function posix_duplicate(from, to) bind(c, name='dup2') result(descriptor)
         import :: c_int
         integer(c_int), value :: from
         integer(c_int), value :: to
         integer(c_int) :: descriptor
      end function posix_duplicate

      !> POSIX close(2).
      function posix_close(descriptor) bind(c, name='close') result(status)
         import :: c_int
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function posix_close

      !> POSIX _exit(2): ends the process; what the parent had open stays as it is.
      subroutine posix_exit(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine posix_exit

      !> POSIX nanosleep(2).
      function posix_sleep(time, rest) bind(c, name='nanosleep') result(status)
         import :: c_int, time_type
         type(time_type), intent(in) :: time
         type(time_type), intent(out) :: rest
         integer(c_int) :: status
      end function posix_sleep

      !> prctl(2) of Linux.
      function linux_control(option, argument) bind(c, name='prctl') result(status)
         import :: c_int, c_long
         integer(c_int), value :: option
         integer(c_long), value :: argument
         integer(c_int) :: status
      end function linux_control
   end interface

contains

   !> Starts a child that prints into a file.
   !> Error: status_internal, when the system has no room for one more process.
   subroutine start_with_path(task, output_path, process, error)
      class(task_type), intent(inout) :: task              !! what the child does
      character(*), intent(in) :: output_path              !! file for all that it prints, made anew
      integer, intent(out) :: process                      !! number of the process
      type(error_type), allocatable, intent(out) :: error  !! see above
      integer(c_int), parameter :: all_may_read = int(o'644', c_int)

      call divide(process, error)
      if (process /= 0) return
      call run_child(task, posix_create(output_path//c_null_char, all_may_read))
   end subroutine start_with_path

   !> Starts a child that prints into what is open already.
   !> Error: status_internal, when the system has no room for one more process.
   subroutine start_with_descriptor(task, descriptor, process, error)
      class(task_type), intent(inout) :: task              !! what the child does
      integer, intent(in) :: descriptor                    !! where all goes that it prints
      integer, intent(out) :: process                      !! number of the process
      type(error_type), allocatable, intent(out) :: error  !! see above

      call divide(process, error)
      if (process == 0) call run_child(task, int(descriptor, c_int))
   end subroutine start_with_descriptor

   !> From here on there are two processes; in the child the number is 0.
   subroutine divide(process, error)
      integer, intent(out) :: process
      type(error_type), allocatable, intent(out) :: error

      ! What is buffered here would be printed by the child as well.
      flush (output_unit)
      flush (error_unit)
      process = int(posix_fork())
      if (process < 0) call set_error(error, status_internal, &
         'the system starts no further process')
   end subroutine divide

   subroutine run_child(task, descriptor)
      class(task_type), intent(inout) :: task
      integer(c_int), intent(in) :: descriptor
      integer :: status
      integer(c_int) :: ignored

      ignored = linux_control(die_with_parent, int(signal_kill, c_long))
      if (descriptor < 0_c_int) call posix_exit(int(status_internal, c_int))
      ignored = posix_duplicate(descriptor, 1_c_int)
      ignored = posix_duplicate(descriptor, 2_c_int)
      ignored = posix_close(descriptor)
      call task%execute(status)
      flush (output_unit)
      flush (error_unit)
      call posix_exit(int(status, c_int))
   end subroutine run_child

   !> Looks whether a child has ended, without waiting for it; each end is told once.
   subroutine collect_process(has_ended, ended)
      logical, intent(out) :: has_ended              !! whether one has ended
      type(process_end_type), intent(out) :: ended   !! which one, and how
      integer(c_int) :: process, status
      integer(c_long) :: usage(longs_of_usage)

      process = system_wait(any_child, status, do_not_wait, usage)
      has_ended = process > 0_c_int
      if (has_ended) ended = ending(process, status, usage)
   end subroutine collect_process

   !> Sends a signal to a child.
   subroutine send_signal(process, signal)
      integer, intent(in) :: process   !! number of the process
      integer, intent(in) :: signal    !! number of the signal
      integer(c_int) :: ignored

      ignored = posix_kill(int(process, c_int), int(signal, c_int))
   end subroutine send_signal

   !> Ends a child at once and waits until it is gone.
   subroutine kill_process(process)
      integer, intent(in) :: process   !! number of the process
      integer(c_int) :: status, ignored
      integer(c_long) :: usage(longs_of_usage)

      ignored = posix_kill(int(process, c_int), int(signal_kill, c_int))
      ignored = system_wait(int(process, c_int), status, 0_c_int, usage)
   end subroutine kill_process

   !> What the system says of a child: times as seconds and microseconds, memory in kilobytes.
   pure function ending(process, status, usage) result(ended)
      integer(c_int), intent(in) :: process, status
      integer(c_long), intent(in) :: usage(longs_of_usage)
      type(process_end_type) :: ended

      ended%process = int(process)
      ended%signal = int(iand(status, int(z'7f', c_int)))
      if (ended%signal == 0) ended%status = int(iand(ishft(status, -8), int(z'ff', c_int)))
      ended%cpu_seconds = real(usage(1) + usage(3), dp) + 1.0e-6_dp*real(usage(2) + usage(4), dp)
      ended%peak_bytes = 1024.0_dp*real(usage(5), dp)
   end function ending

   !> Sleeps for some milliseconds, or until a signal comes.
   subroutine pause_briefly()
      integer(c_int) :: ignored
      type(time_type) :: rest

      ignored = posix_sleep(time_type(0_c_long, 2000000_c_long), rest)
   end subroutine pause_briefly

end module processes
