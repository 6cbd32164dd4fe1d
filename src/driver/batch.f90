!> Several decks, or one with several rows of values, some of them at a time. Each has a process of
!> its own, so that what becomes of one leaves the others alone.
module batch
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use batch_table, only: print_batch, table_name, write_batch
   use clock, only: wall_seconds
   use command_line, only: command_type
   use deck_files, only: base_name, batch_table_of, input_files_type, outputs_of, results_of, &
      row_file_of
   use deck_outcomes, only: deck_outcome_type
   use deck_reader, only: files_of_deck
   use deck_report, only: deck_report_type
   use deck_run, only: run_deck
   use errors, only: error_type, status_deck, status_internal, status_interrupted, &
      status_ok, status_verify
   use file_calls, only: identity_of, is_stream, make_folder
   use interruption, only: catch_signals, caught_signal, caught_times
   use kinds, only: dp
   use messages, only: pass_on, print_error, print_line
   use open_files, only: lock_file, unlock_file
   use processes, only: child_type, pause_briefly, reason_of, report_type, set_reason, task_type
   use progress, only: progress_type
   use text, only: append, counted, string_type, to_text
   use value_tables, only: read_values, value_table_type
   implicit none
   private
   public :: run_batch

   real(dp), parameter :: table_pause = 1.0_dp    !! between two writings of the CSV file [s]
   real(dp), parameter :: shortest_pause = 0.1_dp !! where a deck was started or has ended [s]
   real(dp), parameter :: one_signal = 0.5_dp     !! time within which signals are one [s]

   !> A run of a deck in a process of its own.
   type, extends(task_type) :: deck_task_type
      character(:), allocatable :: path   !! of the deck as given
      type(command_type) :: command       !! options of the command line, with those of the row
   contains
      procedure :: execute
   end type deck_task_type

   !> A deck that is running.
   type :: running_deck_type
      integer :: deck = 0                    !! number of the run, 0 where none is
      real(dp) :: since = 0.0_dp             !! when it began [s]
      logical :: is_killed = .false.         !! whether the batch was told twice to end
      type(child_type) :: child              !! its process
   end type running_deck_type

   !> All that a batch knows.
   type :: batch_type
      type(command_type) :: command                      !! decks and options
      type(value_table_type) :: table                    !! with --table
      character(:), allocatable :: noun                  !! what a run is of: deck or row
      type(deck_task_type), allocatable :: tasks(:)        !! (runs)
      type(deck_outcome_type), allocatable :: outcomes(:) !! (runs) how each ended
      type(running_deck_type), allocatable :: running(:)   !! (jobs)
      type(progress_type) :: progress                    !! progress line
      integer :: started = 0                             !! runs that were started
      integer :: ended = 0                               !! runs that have ended
      integer :: failed = 0                              !! of these, with a status that is not 0
      integer :: forwarded = 0                           !! signals that were seen
      real(dp) :: signalled = 0.0_dp                     !! when the first was passed on [s]
      real(dp) :: written = 0.0_dp                       !! when the CSV file was written [s]
      !> File that it locks, because the table is a new file whenever it is written
      character(:), allocatable :: lock_path
      logical :: has_news = .false.                      !! whether it is not up to date
   end type batch_type

contains

   !> Solves the decks of a command. What goes wrong is printed on stderr.
   subroutine run_batch(command, status)
      type(command_type), intent(in) :: command   !! decks and options
      integer, intent(out) :: status              !! the largest of all
      type(batch_type) :: self
      type(error_type), allocatable :: error
      character(:), allocatable :: line
      integer :: i, lock
      logical :: has_collected
      real(dp) :: since

      since = wall_seconds()
      call make_tasks(self, command, status)
      if (status /= 0) return
      call catch_signals(outlives_pipes=.true.)
      self%lock_path = command%folder//'/'//table_name//'.lock'
      allocate (self%running(min(command%jobs, size(self%tasks))))
      call self%progress%start(command%quiet)
      call begin_table(self, lock, error)
      if (allocated(error)) then
         call print_error('thercon', error%message)
         status = error%status
         return
      end if
      do while (any(self%running%deck > 0) .or. &
         self%started < size(self%outcomes) .and. caught_signal() == '')
         call start_decks(self)
         call collect(self, has_collected)
         call pass_on_signals(self)
         line = to_text(self%ended)//' of '//counted(size(self%outcomes), self%noun)//' ended, '// &
            to_text(count(self%running%deck > 0))//' running, '//to_text(self%failed)//' failed'
         if (caught_signal() /= '') line = line//'; ending after their increments, again to kill'
         call self%progress%say(line)
         call renew_table(self)
         if (.not. has_collected) call pause_briefly()
      end do
      call self%progress%clear()
      do i = self%started + 1, size(self%outcomes)
         associate (outcome => self%outcomes(i))
            outcome%report%status = status_interrupted
            call set_reason(outcome%report, 'not started because of '//caught_signal())
            call print_error(outcome%path, reason_of(outcome%report))
         end associate
      end do
      status = maxval(self%outcomes%report%status)
      call write_table(self, error)
      call unlock_file(self%lock_path, lock)
      if (allocated(error)) then
         call print_error('thercon', error%message)
         status = max(status, error%status)
      end if
      if (command%quiet) return
      call print_batch(self%outcomes, self%noun, wall_seconds() - since)
      if (command%table /= '') call print_line(output_unit, 'results: '//batch_table_of(command))
   end subroutine run_batch

   !> The runs of a command: its decks, or its deck with each row of the table of values.
   subroutine make_tasks(self, command, status)
      type(batch_type), intent(inout) :: self
      type(command_type), intent(in) :: command
      integer, intent(out) :: status
      type(deck_report_type) :: report
      integer :: i, k, runs

      self%command = command
      status = 0
      ! Two decks with the same results are an error before anything runs.
      do i = 2, size(command%decks)
         do k = 1, i - 1
            if (base_name(command%decks(i)%value) /= base_name(command%decks(k)%value)) cycle
            call print_error('thercon', command%decks(k)%value//' and '//command%decks(i)%value// &
               ' would have the same results')
            status = status_deck
         end do
      end do
      if (status /= 0) return
      self%noun = 'deck'
      runs = size(command%decks)
      if (command%table /= '') then
         call read_values(command, self%table, report)
         call report%print(error_unit)
         if (report%has_errors()) status = status_deck
         if (status /= 0) return
         self%noun = 'row'
         runs = size(self%table%values, 2)
      end if
      allocate (self%tasks(runs), self%outcomes(runs))
      do i = 1, runs
         associate (task => self%tasks(i), outcome => self%outcomes(i))
            task%command = command
            task%path = command%decks(min(i, size(command%decks)))%value
            outcome%path = task%path
            outcome%ending = 'not run'
            if (command%table == '') cycle
            task%command%row = i
            task%command%settings = [command%settings, self%table%settings(i)]
            outcome%path = base_name(task%path)//'-'//to_text(i)
         end associate
      end do
   end subroutine make_tasks

   !> Writes the table as it is now.
   !> Error: as write_batch.
   subroutine write_table(self, error)
      type(batch_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      ! Without a table of values its arrays are unallocated, that is, not present.
      call write_batch(batch_table_of(self%command), self%outcomes, error, self%table%names, &
         self%table%values)
   end subroutine write_table

   !> Makes the table, which no other batch writes, and in which nothing of an earlier one is left.
   !> Errors: as check_inputs and make_folder; status_internal where another batch writes it.
   subroutine begin_table(self, lock, error)
      type(batch_type), intent(in) :: self
      integer, intent(out) :: lock                          ! descriptor of the locked file
      type(error_type), allocatable, intent(out) :: error
      logical :: has_lock

      lock = -1
      call check_inputs(self, error)
      if (.not. allocated(error)) call make_folder(self%command%folder, error)
      if (.not. allocated(error)) call lock_file(self%lock_path, lock, has_lock, error)
      if (allocated(error)) return
      if (.not. has_lock) call print_line(error_unit, 'thercon: warning: the file system of "'// &
         self%command%folder//'" has no locks: a second batch there at the same time would '// &
         'not be noticed')
      call write_table(self, error)
      if (allocated(error)) call unlock_file(self%lock_path, lock)
   end subroutine begin_table

   !> Compares the files that the decks are read from with those that the batch writes. Pipes are
   !> read once only, by their deck.
   !> Error: as input_files_type's check.
   subroutine check_inputs(self, error)
      type(batch_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error
      type(input_files_type) :: inputs
      ! A variable: gfortran does not free the components of a function's result in an expression.
      type(string_type), allocatable :: of_run(:), outputs(:), table(:)
      integer :: i, k
      logical :: any_is_there

      allocate (outputs(0))
      any_is_there = .false.
      do i = 1, size(self%tasks)
         of_run = outputs_of(self%tasks(i)%path, self%tasks(i)%command)
         do k = 1, size(of_run)
            if (identity_of(of_run(k)%value) == '') cycle
            any_is_there = .true.
            call append(outputs, of_run(k)%value)
         end do
      end do
      ! In a new folder the decks are read once only.
      if (.not. any_is_there) return
      do i = 1, size(self%command%decks)
         associate (deck => self%tasks(i)%path, settings => self%tasks(i)%command%settings)
            if (.not. is_stream(deck)) call inputs%add(deck, files_of_deck(deck, settings))
         end associate
      end do
      allocate (table(0))
      if (self%command%table /= '') call append(table, self%command%table)
      call inputs%add(self%command%decks(1)%value, table)
      call inputs%check(outputs, error)
   end subroutine check_inputs

   !> Starts decks where others have ended. One for which the system has no process has ended, too.
   subroutine start_decks(self)
      type(batch_type), intent(inout) :: self
      type(error_type), allocatable :: error
      integer :: s

      do s = 1, size(self%running)
         if (self%running(s)%deck > 0) cycle
         if (self%started == size(self%outcomes) .or. caught_signal() /= '') return
         self%started = self%started + 1
         self%has_news = .true.
         associate (outcome => self%outcomes(self%started), running => self%running(s))
            running%since = wall_seconds()
            running%is_killed = .false.
            call running%child%start(self%tasks(self%started), error)
            outcome%is_running = .not. allocated(error)
            if (outcome%is_running) then
               outcome%ending = 'running'
               running%deck = self%started
               cycle
            end if
            outcome%report%status = status_internal
            call set_reason(outcome%report, error%message)
            self%ended = self%ended + 1
            self%failed = self%failed + 1
            call self%progress%clear()
            call print_error(outcome%path, error%message)
         end associate
      end do
   end subroutine start_decks

   !> Takes what has ended, with the results of a row that came to its end.
   subroutine collect(self, has_collected)
      type(batch_type), intent(inout) :: self
      logical, intent(out) :: has_collected   !! whether anything had ended
      character(:), allocatable :: printed
      integer :: i, s

      has_collected = .false.
      do s = 1, size(self%running)
         if (self%running(s)%deck == 0) cycle
         if (.not. self%running(s)%child%has_ended()) cycle
         has_collected = .true.
         associate (task => self%tasks(self%running(s)%deck), &
            outcome => self%outcomes(self%running(s)%deck))
            call take_end(self%running(s), outcome, printed)
            if (task%command%row > 0 .and. has_come_to_its_end(outcome)) call outcome%row%read( &
               row_file_of(task%path, task%command))
            if (task%command%row > 0 .and. len(printed) > 0) then
               ! Of which row the messages are.
               printed = new_line('a')//printed
               do i = size(task%command%settings), 1, -1
                  printed = ' '//task%command%settings(i)%value//printed
               end do
               printed = outcome%path//':'//printed
            end if
            self%ended = self%ended + 1
            if (outcome%report%status /= 0) self%failed = self%failed + 1
            call self%progress%clear()
            if (len(printed) > 0) call pass_on(printed)
            if (.not. self%command%quiet .and. outcome%report%status /= status_deck) call &
               outcome%print(results_of(task%path, task%command))
         end associate
         self%running(s)%deck = 0
      end do
      self%has_news = self%has_news .or. has_collected
   end subroutine collect

   !> How a deck ended. Why a process ended before the deck did is added to what it printed.
   subroutine take_end(running, outcome, printed)
      type(running_deck_type), intent(inout) :: running
      type(deck_outcome_type), intent(inout) :: outcome
      character(:), allocatable, intent(out) :: printed   !! messages, without last line end

      outcome%report = running%child%report()
      call running%child%take_messages(printed)
      outcome%is_running = .false.
      outcome%has_run = .true.
      if (outcome%report%seconds <= 0.0_dp) outcome%report%seconds = wall_seconds() - running%since
      deallocate (outcome%ending)
      associate (child => running%child)
         outcome%cpu_seconds = child%end%cpu_seconds
         outcome%peak_bytes = child%end%peak_bytes
         if (outcome%report%is_whole == 1) return
         if (running%is_killed) then
            outcome%report%status = status_interrupted
            call set_reason(outcome%report, 'killed because a second signal came')
         else if (child%end%is_crash == 1) then
            outcome%ending = 'crash: '//child%signal_name()
         else if (child%end%signal /= 0) then
            outcome%ending = 'killed: '//child%signal_name()
         end if
      end associate
      if (len(printed) > 0) printed = printed//new_line('a')
      printed = printed//outcome%path//': error: '//reason_of(outcome%report)
   end subroutine take_end

   !> Whether all increments of a run are solved, whatever is judged of them.
   pure logical function has_come_to_its_end(outcome)
      type(deck_outcome_type), intent(in) :: outcome

      has_come_to_its_end = any(outcome%report%status == [status_ok, status_verify])
   end function has_come_to_its_end

   !> The first signal goes on to the decks, which end after their increments; a later one ends
   !> them. What comes at once, as from timeout, which signals a process and its group, is one.
   subroutine pass_on_signals(self)
      type(batch_type), intent(inout) :: self
      integer :: s
      logical :: is_first

      if (caught_times() == self%forwarded) return
      is_first = self%forwarded == 0
      self%forwarded = caught_times()
      if (is_first) self%signalled = wall_seconds()
      if (.not. is_first .and. wall_seconds() - self%signalled < one_signal) return
      do s = 1, size(self%running)
         if (self%running(s)%deck == 0) cycle
         self%running(s)%is_killed = .not. is_first
         call self%running(s)%child%send_signal(kills=.not. is_first)
      end do
   end subroutine pass_on_signals

   !> Writes the table again where that is due. What goes wrong shows at the end, in the last one.
   subroutine renew_table(self)
      type(batch_type), intent(inout) :: self
      type(error_type), allocatable :: ignored
      integer :: s

      if (wall_seconds() - self%written < merge(shortest_pause, table_pause, self%has_news)) return
      do s = 1, size(self%running)
         if (self%running(s)%deck == 0) cycle
         associate (outcome => self%outcomes(self%running(s)%deck))
            outcome%report = self%running(s)%child%report()
            outcome%report%seconds = wall_seconds() - self%running(s)%since
         end associate
      end do
      call write_table(self, ignored)
      self%written = wall_seconds()
      self%has_news = .false.
   end subroutine renew_table

   !> Solves the deck.
   subroutine execute(self, report)
      class(deck_task_type), intent(inout) :: self
      type(report_type), intent(inout) :: report   !! how the deck ended
      type(deck_outcome_type) :: outcome
      type(error_type), allocatable :: error

      call run_deck(self%path, self%command, outcome)
      call outcome%print_failed_checks()
      if (has_come_to_its_end(outcome) .and. allocated(outcome%row%names)) then
         call outcome%row%write(row_file_of(self%path, self%command), error)
         if (allocated(error)) then
            call print_error(self%path, error%message)
            outcome%report%status = error%status
            call set_reason(outcome%report, error%message)
         end if
      end if
      report = outcome%report
   end subroutine execute

end module batch
