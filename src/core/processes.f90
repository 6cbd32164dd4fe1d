!> Work in processes of its own: a crash, or memory that runs out, is that of the child alone, and
!> the system says what the child took. The calls themselves are in system_processes.c.
module processes
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, &
      c_long, c_null_char, c_ptr, c_size_t, c_sizeof
   use, intrinsic :: iso_fortran_env, only: error_unit
   use errors, only: error_type, set_error, status_internal
   use open_files, only: close_descriptor
   use text, only: to_text
   implicit none
   private
   public :: task_type, child_type, report_type
   public :: file_report, set_reason, reason_of, share_numbers, pause_briefly

   integer, parameter :: longest_reason = 4096            !! characters, with the 0 at the end
   integer, parameter :: block_length = 65536             !! characters read at once
   integer(c_int), parameter :: brief_pause = 5000_c_int  !! [microseconds]

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

   !> Work of a child; an extension holds its data.
   type, abstract :: task_type
   contains
      procedure(execute_task), deferred :: execute
   end type task_type

   abstract interface
      !> Does the work, in the child.
      subroutine execute_task(self, report)
         import :: report_type, task_type
         class(task_type), intent(inout) :: self
         type(report_type), intent(inout) :: report   !! how it ended; status is the exit status
      end subroutine execute_task
   end interface

   !> A child; it never outlives the program.
   type :: child_type
      logical :: is_running = .false.   !! from its start until its end is collected
      type(process_end_type) :: end     !! once it has ended
      integer(c_int), private :: process = 0_c_int
      integer(c_int), private :: messages = -1_c_int   !! file of what it printed
      integer(c_int), private :: reports = -1_c_int    !! file of what it reported
   contains
      procedure :: start
      procedure :: has_ended
      procedure :: kill
      procedure :: send_signal
      procedure :: report
      procedure :: take_messages
      procedure :: drop_files
      procedure :: sudden_end
      procedure :: signal_name
   end type child_type

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

      !> POSIX pread(2): how many bytes were read, negative after an error.
      integer(c_size_t) function c_read(file, bytes, length, offset) bind(c, name='pread')
         import :: c_char, c_int, c_long, c_size_t
         integer(c_int), value :: file
         integer(c_size_t), value :: length
         character(c_char), intent(out) :: bytes(length)
         integer(c_long), value :: offset
      end function c_read

      !> A child says how far it is; in the first process nothing happens.
      subroutine file_report(report) bind(c, name='thercon_file_report')
         import :: report_type
         type(report_type), intent(in) :: report
      end subroutine file_report

      type(c_ptr) function c_share(bytes) bind(c, name='thercon_share')
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: bytes
      end function c_share

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

contains

   !> Starts a child.
   !> Error: status_internal, when the system has no room for one more process or file.
   subroutine start(self, task, error)
      class(child_type), intent(out) :: self
      class(task_type), intent(inout) :: task              !! what it does
      type(error_type), allocatable, intent(out) :: error
      type(report_type) :: report

      ! Text that is buffered here would be printed by the child as well.
      flush (error_unit)
      self%process = c_start_child(self%messages, self%reports)
      self%is_running = self%process > 0_c_int
      if (self%process < 0_c_int) then
         call self%drop_files()
         call set_error(error, status_internal, 'the system starts no further process')
      else if (self%process == 0_c_int) then
         call task%execute(report)
         flush (error_unit)
         report%is_whole = 1_c_int
         call file_report(report)
         call c_exit_at_once(report%status)
      end if
   end subroutine start

   !> Whether the child has just ended, which is told once.
   logical function has_ended(self)
      class(child_type), intent(inout) :: self

      has_ended = .false.
      if (self%is_running) has_ended = c_collect_child(self%process, 0_c_int, self%end) == 1_c_int
      if (has_ended) self%is_running = .false.
   end function has_ended

   !> Ends a child at once, waits until it is gone and drops what it said.
   subroutine kill(self)
      class(child_type), intent(inout) :: self
      integer(c_int) :: ignored

      call self%send_signal(kills=.true.)
      ignored = c_collect_child(self%process, 1_c_int, self%end)
      self%is_running = .false.
      call self%drop_files()
   end subroutine kill

   !> Sends the signal that came on to the child, or kills it; its end is still to be collected.
   subroutine send_signal(self, kills)
      class(child_type), intent(in) :: self
      logical, intent(in) :: kills

      call c_signal_child(self%process, merge(1_c_int, 0_c_int, kills))
   end subroutine send_signal

   !> The child's report so far; of one that ended before it had said all, that and why.
   function report(self)
      class(child_type), intent(in) :: self
      type(report_type) :: report
      character(c_char) :: bytes(c_sizeof(report))

      if (c_read(self%reports, bytes, size(bytes, kind=c_size_t), 0_c_long) == size(bytes)) report &
         = transfer(bytes, report)
      if (self%is_running .or. self%end%signal == 0 .and. report%is_whole == 1) return
      report%is_whole = 0_c_int
      report%status = int(status_internal, c_int)
      call set_reason(report, self%sudden_end())
   end function report

   !> Takes all that a child printed, without a line end behind it, and closes its files.
   subroutine take_messages(self, contents)
      class(child_type), intent(inout) :: self
      character(:), allocatable, intent(out) :: contents   !! lines with their ends between them
      character(c_char) :: block(block_length)
      integer(c_size_t) :: count

      contents = ''
      do
         count = c_read(self%messages, block, int(block_length, c_size_t), &
            len(contents, kind=c_long))
         if (count <= 0) exit
         contents = contents//transfer(block(:count), repeat(' ', int(count)))
      end do
      contents = contents(:verify(contents, new_line('a'), back=.true.))
      call self%drop_files()
   end subroutine take_messages

   !> Drops what a child said.
   subroutine drop_files(self)
      class(child_type), intent(in) :: self

      call close_descriptor(int(self%messages))
      call close_descriptor(int(self%reports))
   end subroutine drop_files

   !> Says in words how a child came to an end that it did not report.
   function sudden_end(self) result(words)
      class(child_type), intent(in) :: self
      character(:), allocatable :: words   !! part of a sentence

      if (self%end%signal == 0_c_int) then
         words = 'its process ended with status '//to_text(int(self%end%status))// &
            ' before it was done'
         return
      end if
      words = 'ended by signal '//to_text(int(self%end%signal))//' ('//self%signal_name()//')'
      if (self%signal_name() == 'SIGKILL') words = words//', as where memory runs out'
      if (self%end%is_crash == 1_c_int) words = words//', a crash'
   end function sudden_end

   !> Name of the signal that ended a child.
   pure function signal_name(self) result(name)
      class(child_type), intent(in) :: self
      character(:), allocatable :: name   !! such as SIGSEGV

      name = text_of(self%end%signal_name)
   end function signal_name

   !> Puts a reason into a report; what is too long is cut.
   pure subroutine set_reason(report, words)
      type(report_type), intent(inout) :: report
      character(*), intent(in) :: words   !! one sentence
      integer :: n

      n = min(len(words), longest_reason - 1)
      report%reason(:n + 1) = transfer(words(:n)//c_null_char, report%reason)
   end subroutine set_reason

   !> The reason in a report.
   pure function reason_of(report) result(words)
      type(report_type), intent(in) :: report
      character(:), allocatable :: words   !! one sentence, or nothing

      words = text_of(report%reason)
   end function reason_of

   !> The characters before the first 0.
   pure function text_of(characters) result(text)
      character(c_char), intent(in) :: characters(:)
      character(:), allocatable :: text
      integer :: n

      n = findloc(characters, c_null_char, dim=1) - 1
      text = transfer(characters(:n), repeat(' ', n))
   end function text_of

   !> Makes room for numbers, zeros at first, that later children write and this process reads.
   !> Error: status_internal, when there is no memory.
   subroutine share_numbers(numbers, rows, columns, error)
      real(c_double), pointer, intent(out) :: numbers(:, :)   !! (rows, columns)
      integer, intent(in) :: rows, columns
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr) :: memory

      nullify (numbers)
      memory = c_share(max(rows*columns, 1)*c_sizeof(0.0_c_double))
      if (.not. c_associated(memory)) then
         call set_error(error, status_internal, 'no memory can be shared with further processes')
         return
      end if
      call c_f_pointer(memory, numbers, [rows, columns])
   end subroutine share_numbers

   !> Sleeps for some milliseconds, or until a signal comes.
   subroutine pause_briefly()
      integer(c_int) :: ignored

      ignored = c_sleep(brief_pause)
   end subroutine pause_briefly

end module processes
