!> One deck to its results, and the end of a run that comes early: by a signal, an error or a lack
!> of memory.
module deck_run
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use adaptive_rounds, only: adaptive_rounds_type, increment_taker_type
   use blas_lapack, only: reserve_blas_memory
   use clock, only: wall_seconds
   use command_line, only: command_type, settings_in_words
   use contact_points, only: contact_points_type
   use deck_files, only: input_files_type, outputs_of, results_of, row_file_of
   use deck_outcomes, only: deck_outcome_type
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type, set_error, status_deck, status_interrupted, status_internal, &
      status_no_convergence, status_ok, status_verify
   use file_calls, only: make_folder, remove_file
   use interruption, only: caught_signal, end_after_grace, end_at_once, end_by_increments, &
      prepare_end
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use messages, only: append_message, print_error, print_line
   use model, only: model_type, uncertainty_full
   use processes, only: set_reason
   use records, only: increment_record_type
   use restarts, only: bring_to
   use run_description, only: describe_run
   use run_output, only: run_output_type
   use simulation, only: simulation_type
   use state_tables, only: state_table_type
   use text, only: append, counted, or_blank, string_type, to_text
   use utf8, only: printable
   use variations, only: variation_type
   implicit none
   private
   public :: run_deck

   !> The run of a deck, round by round. Held by value, the copying and freeing of all that it
   !> points to, which nothing calls, would be most of the code of this module.
   type, extends(increment_taker_type) :: deck_run_type
      character(:), allocatable :: path       !! the deck as given
      type(command_type) :: command           !! options of the command line
      type(read_deck_type), pointer :: deck => null()
      type(deck_outcome_type), pointer :: outcome => null()
      integer :: lock = -1                    !! as run_output_type's reserve
      ! Of the present round.
      type(model_type), pointer :: model => null()
      type(simulation_type), pointer :: simulation => null()
      type(run_output_type), pointer :: output => null()
      logical :: is_written = .true.          !! whether the output went well
      real(dp) :: since = 0.0_dp              !! when the run began [s]
      real(dp) :: deadline = huge(1.0_dp)     !! when a later round ends [s]
   contains
      procedure :: take
   end type deck_run_type

contains

   !> Solves one deck, with a requested accuracy in rounds. What goes wrong is printed on stderr and
   !> recorded in the outcome.
   subroutine run_deck(path, command, outcome)
      character(*), intent(in) :: path                          !! the deck as given
      type(command_type), intent(in) :: command                 !! options of the command line
      type(deck_outcome_type), intent(inout), target :: outcome !! how it ended
      type(read_deck_type), target :: deck
      type(adaptive_rounds_type) :: rounds
      type(deck_run_type) :: self
      type(error_type), allocatable :: error

      self%since = wall_seconds()
      self%path = path
      self%command = command
      self%deck => deck
      self%outcome => outcome
      outcome%path = path
      allocate (outcome%failed_checks(0))
      call reserve_blas_memory()
      if (command%limit > 0.0_dp) self%deadline = self%since + command%limit
      rounds%deadline = self%deadline
      do
         call rounds%begin_round()
         call solve_round(self, rounds)
         if (.not. rounds%accuracy%goes_on) exit
      end do
      if (size(outcome%failed_checks) > 0) then
         call set_error(error, status_verify, outcome%failed_checks(1)%value)
         call outcome%fail(error)
      end if
      if (allocated(deck%finished)) return
      outcome%report%seconds = wall_seconds() - self%since
      if (allocated(deck%origin)) outcome%report%seconds = outcome%report%seconds + &
         sum(deck%origin%seconds)
   end subroutine run_deck

   !> Solves a deck as it is written, or as the variation of a later round has it. The files of the
   !> round before stay until a later one is whole.
   subroutine solve_round(self, rounds)
      type(deck_run_type), intent(inout) :: self
      type(adaptive_rounds_type), intent(inout) :: rounds
      type(error_type), allocatable :: error
      real(dp) :: since
      integer :: n

      since = wall_seconds()
      allocate (self%model, self%simulation, self%output)
      associate (outcome => self%outcome, model => self%model, simulation => self%simulation, &
         output => self%output)
         if (allocated(rounds%variation)) output%kept_round = size(rounds%accuracy%rounds)
         outcome%keeps_round = output%kept_round > 0
         ! Shortcomings of the round before count no longer.
         outcome%known_to = 0.0_dp
         call set_reason(outcome%report, '')
         call may_end(self, end_at_once)
         call begin_round(self, rounds%variation)
         if (outcome%report%status == status_ok .and. allocated(model%steps)) then
            output%run%seconds_read = wall_seconds() - since - simulation%seconds%assemble - &
               simulation%seconds%reduce
            output%run%verify_passed = outcome%report%verify_passed
            output%run%verify_failed = outcome%report%verify_failed
            call describe_run(self%path, model, simulation, output%run)
            output%run%settings = settings_in_words(self%command)
            if (allocated(self%deck%origin)) then
               output%run%origin = self%deck%origin%words()
               output%run%seconds_before = self%deck%origin%seconds
               outcome%report%iterations = self%deck%origin%iterations
            end if
            n = size(model%mesh%element_kind)
            if (model%uncertainty == uncertainty_full .and. .not. (self%command%quiet .or. &
               output%kept_round > 0)) call print_line(output_unit, self%path//': ERRORS=FULL '// &
               'solves the deck once more beside itself, with '//to_text(4*n)//' elements for '// &
               to_text(n)//' and increments half as long: 4 to 12 times the time of ERRORS=NO')
            call solve_deck(self, rounds, error)
            if (allocated(error)) call report_failure(self, error, is_told=.false.)
            ! Of a run that could not go on for want of a file or of memory a check says nothing.
            if (outcome%report%status /= status_internal) call take_checks(self)
         end if
         associate (goes_on => rounds%accuracy%goes_on)
            goes_on = goes_on .and. outcome%report%status == status_ok
            call output%progress%clear()
            call output%listing%close(keeps_lock=goes_on)
         end associate
         call simulation%release()
      end associate
      deallocate (self%model, self%simulation, self%output)
   end subroutine solve_round

   !> All that comes before the first increment. A first round touches no file before its deck is
   !> found sound; a later one can say in the listing what ends it.
   subroutine begin_round(self, variation)
      type(deck_run_type), intent(inout) :: self
      type(variation_type), intent(in), optional :: variation
      type(input_files_type) :: inputs
      type(error_type), allocatable :: error
      logical :: is_told

      is_told = .false.
      associate (is_later => self%output%kept_round > 0)
         if (is_later) call reserve_files(self, error)
         if (.not. allocated(error)) then
            call prepare_deck(self%path, self%command, self%deck, self%model, self%simulation, &
               error, variation)
            is_told = allocated(error)
            self%outcome%messages = self%deck%messages
         end if
         if (.not. (allocated(error) .or. allocated(self%model%steps))) then
            call set_reason(self%outcome%report, self%deck%why_skipped)
            if (.not. allocated(self%deck%finished)) return
            ! Of a finished run the outcome is that of its result, so that the table of a batch
            ! loses nothing; checks that failed in it fail again.
            associate (report => self%outcome%report, finished => self%deck%finished)
               report%increments = size(finished%iterations)
               report%iterations = sum(finished%iterations)
               report%verify_passed = finished%passed_checks
               report%verify_failed = finished%failed_checks
               report%seconds = sum(finished%seconds)
               if (finished%failed_checks == 0) return
               call set_error(error, status_verify, 'its result is finished, and '//counted( &
                  finished%failed_checks, '*VERIFY check')//' failed')
            end associate
            call self%outcome%fail(error)
            return
         end if
         if (.not. (allocated(error) .or. is_later)) then
            call inputs%add(self%path, self%deck%cards%files)
            call inputs%check(outputs_of(self%path, self%command), error)
         end if
         if (.not. (allocated(error) .or. is_later)) call reserve_files(self, error)
         if (.not. allocated(error)) then
            call self%output%progress%start(self%command%quiet)
            self%output%progress%since = self%since
            if (allocated(self%model%accuracy%targets)) self%output%progress%round = &
               self%output%kept_round + 1
            call self%output%progress%say('assembling')
            call self%simulation%assemble(self%model)
            call self%output%progress%say('reducing')
            if (allocated(self%deck%origin)) then
               self%deck%origin%table%restores = .true.
               call bring_to(self%model, self%simulation, self%deck%origin%table, error)
            else
               call self%simulation%reduce(self%model, error)
            end if
            if (.not. allocated(error)) return
            call say_when(self, error)
         end if
         if (is_later) call self%output%fail(error%message, increment_record_type())
      end associate
      call report_failure(self, error, is_told)
   end subroutine begin_round

   !> Sees to it that results can be written before anything is solved.
   !> Error: as run_output_type's reserve.
   subroutine reserve_files(self, error)
      type(deck_run_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      self%output%run%deck_path = self%path
      call make_folder(self%command%folder, error)
      if (allocated(error)) return
      call may_end(self, end_by_increments)
      call self%output%reserve(results_of(self%path, self%command), self%lock, error)
      ! Results of a row that an earlier run has left are none of what is solved now.
      if (self%command%row > 0 .and. .not. allocated(error)) call remove_file(row_file_of( &
         self%path, self%command))
      call may_end(self, end_at_once)
   end subroutine reserve_files

   !> Begins the output of a round, behind an earlier result where it goes on from one.
   !> Errors: as run_output_type's start and results_type's go_on.
   subroutine begin_output(self, error)
      type(deck_run_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      type(contact_points_type), allocatable :: interfaces(:)

      call self%simulation%bodies%views(interfaces)
      associate (output => self%output, points => self%simulation%recovery%points)
         call output%start(self%model, interfaces, points%node, points%element_points, &
            self%deck%cards%images, error)
         if (allocated(error) .or. .not. allocated(self%deck%origin)) return
         associate (origin => self%deck%origin)
            call output%verifier%exchange(origin%table)
            call output%judgement%exchange(origin%table)
            call output%results%go_on(origin%path, origin%table, origin%counts, self%model, error)
         end associate
      end associate
   end subroutine begin_output

   !> All increments, with their output.
   subroutine solve_deck(self, rounds, error)
      type(deck_run_type), intent(inout) :: self
      type(adaptive_rounds_type), intent(inout) :: rounds
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: output_error
      type(contact_points_type), allocatable :: interfaces(:)
      type(increment_record_type) :: record
      type(state_table_type), pointer :: restart   ! disassociated for none
      integer :: i
      logical :: moved

      associate (model => self%model, output => self%output, outcome => self%outcome, &
         cards => self%deck%cards%images)
         call may_end(self, end_by_increments)
         call begin_output(self, error)
         if (allocated(error)) return
         call outcome%note_files(output%written())
         call may_end(self, end_at_once)
         self%is_written = .true.
         call begin_increment(self, error)
         nullify (restart)
         if (allocated(self%deck%origin)) restart => self%deck%origin%table
         call rounds%solve_increments(model, self%simulation, self, record, error, restart)
         ! From here on, output is not cut short.
         call may_end(self, end_by_increments)
         if (.not. self%is_written) then
            call output%break_off(error%message)
            return
         end if
         if (allocated(error)) then
            if (error%status == status_deck) then
               ! A failure that only an increment shows is no mistake of the deck's cards; one that
               ! has no number yet failed as it was set up.
               if (record%increment == 0) call say_when(self, error)
               error%status = status_no_convergence
            end if
            call output%fail(error%message, record)
            call output%results%set_aside(results_of(self%path, self%command), moved)
            if (moved) call print_line(error_unit, self%path//': note: the results of an '// &
               'earlier run are in "'//results_of(self%path, self%command)//'.earlier.vtkhdf"')
            call outcome%note(record, output%results%accepted, output%written())
            if (output%kept_round > 0) return
         end if
         call self%simulation%bodies%views(interfaces)
         call output%finish(model, interfaces, cards, rounds%accuracy, output_error)
         if (output%kept_round == 0) then
            outcome%keeps_round = .false.
            outcome%report%increments = output%results%accepted
            outcome%summary = output%summary_lines(model, interfaces)
            if (self%command%json .or. self%command%row > 0) call output%report(model, &
               interfaces, outcome%results, outcome%row)
            ! There are none before the summary of a run is made.
            if (allocated(output%run%warnings) .and. output%run%accuracy%later_round == 0) then
               do i = 1, size(output%run%warnings)
                  call append_message(outcome%messages, 'warning', self%path, &
                     output%run%warnings(i)%value)
               end do
            end if
            call outcome%note_files(output%written())
         end if
         if (allocated(output_error)) then
            if (allocated(error)) output_error%message = error%message//'; '//output_error%message
            call move_alloc(output_error, error)
         end if
      end associate
   end subroutine solve_deck

   !> A signal ends the run between two increments.
   !> Error: status_interrupted.
   subroutine begin_increment(self, error)
      type(deck_run_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call may_end(self, end_after_grace)
      call check_signals(self, error)
      if (.not. allocated(error) .and. self%output%kept_round > 0 .and. &
         wall_seconds() > self%deadline) call set_error(error, status_verify, '--limit is over')
      if (.not. allocated(error)) call self%output%progress%begin_increment( &
         self%simulation%control%increments + 1, self%simulation%control%planned(self%model))
   end subroutine begin_increment

   !> Writes an increment; of one that a signal ends nothing is written.
   !> Errors: as run_output_type's accept; status_interrupted.
   subroutine take(self, simulation, record, error)
      class(deck_run_type), intent(inout) :: self
      type(simulation_type), intent(in) :: simulation
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable, intent(inout) :: error
      type(contact_points_type), allocatable :: interfaces(:)

      associate (output => self%output, outcome => self%outcome, &
         tolerance => self%model%steps(simulation%control%step)%fixed_point%tolerance)
         output%run%seconds = simulation%seconds
         output%run%sizes = simulation%sizes
         if (allocated(error)) then
            if (error%status == status_interrupted) call check_signals(self, error)
         else
            call may_end(self, end_by_increments)
            if (outcome%report%status == status_ok .and. record%residual_floor > &
               max(tolerance, outcome%known_to)) then
               outcome%known_to = record%residual_floor
               call set_reason(outcome%report, 'the contact conductance is accurate to '// &
                  to_text(outcome%known_to)//' only')
            end if
            call simulation%bodies%views(interfaces)
            call output%accept(record, self%model, interfaces, error)
            call outcome%note(record, output%results%accepted, output%written())
            self%is_written = .not. allocated(error)
            if (allocated(error)) return
            if (.not. simulation%finished(self%model)) call begin_increment(self, error)
         end if
         if (allocated(error)) then
            if (error%status == status_interrupted) record = increment_record_type()
         end if
      end associate
   end subroutine take

   !> Takes which checks of the deck failed, and which targets were missed.
   subroutine take_checks(self)
      type(deck_run_type), intent(inout) :: self
      ! gfortran never frees the components of a function's result within an array constructor.
      type(string_type), allocatable :: failed(:)

      associate (run => self%output%run, outcome => self%outcome)
         failed = self%output%failed_checks(self%model)
         outcome%failed_checks = [outcome%failed_checks, failed]
         ! A later round has the verdicts of the first one, unless it ends early.
         outcome%report%verify_passed = max(outcome%report%verify_passed, run%verify_passed)
         outcome%report%verify_failed = max(outcome%report%verify_failed, run%verify_failed)
         if (outcome%report%status /= status_ok .or. run%accuracy%later_round > 0) return
         if (run%accuracy%missed /= '') then
            call append(outcome%failed_checks, self%path//': error: '//run%accuracy%missed)
            call append_message(outcome%messages, 'error', self%path, run%accuracy%missed)
         end if
      end associate
   end subroutine take_checks

   !> When a signal may end the run from here on; what is said then, or where memory runs out.
   subroutine may_end(self, when)
      type(deck_run_type), intent(in) :: self
      integer, intent(in) :: when   ! one of the end_* constants
      character(:), allocatable :: words, leftover
      integer :: bytes

      words = where_words(self)//kept_words(self)
      associate (output => self%output, increments => self%simulation%control%increments)
         ! Increments that wait for their publication are lost with the process.
         if (output%kept_round == 0 .and. output%results%published < increments) words = words// &
            '; the results hold those up to number '//to_text(output%results%published)
         leftover = ''
         if (.not. output%listing%is_begun()) then
            ! It is locked, and holds an earlier run or nothing at all.
            inquire (file=or_blank(output%listing%path), size=bytes)
            if (bytes == 0) leftover = output%listing%path
         end if
         call prepare_end(when, output%progress%is_shown, printable(self%path), words, leftover)
      end associate
   end subroutine may_end

   !> Puts the increment that was tried before what went wrong.
   subroutine say_when(self, error)
      type(deck_run_type), intent(in) :: self
      type(error_type), intent(inout) :: error   ! receives it in its message
      type(step_clock_type) :: clock

      clock = self%simulation%control%next_instant(self%model)
      error%message = 'increment '//to_text(self%simulation%control%increments + 1)//' (time '// &
         to_text(clock%total_time)//'): '//error%message
   end subroutine say_when

   !> A signal ends the run between two increments.
   !> Error: status_interrupted.
   subroutine check_signals(self, error)
      type(deck_run_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error

      if (caught_signal() /= '') call set_error(error, status_interrupted, 'ended by '// &
         caught_signal()//where_words(self))
   end subroutine check_signals

   !> In which later round and behind which increment a run ends.
   function where_words(self) result(words)
      type(deck_run_type), intent(in) :: self
      character(:), allocatable :: words   ! with a blank before them

      words = ''
      if (self%output%kept_round > 0) words = ' in round '//to_text(self%output%kept_round + 1)
      associate (control => self%simulation%control)
         if (control%increments > 0) then
            words = words//' after increment '//to_text(control%increments)//' (time '// &
               to_text(control%step_start + control%step_time)//')'
         else
            words = words//' before the first increment'
         end if
      end associate
   end function where_words

   !> Where a later round ends early: which round the files are of.
   pure function kept_words(self) result(words)
      type(deck_run_type), intent(in) :: self
      character(:), allocatable :: words   ! with a semicolon before them

      words = ''
      associate (kept_round => self%output%kept_round)
         if (kept_round > 0 .and. self%output%results%published == 0) words = &
            '; the results are those of round '//to_text(kept_round)
      end associate
   end function kept_words

   !> Prints why a run ended early. That a later round did is no mistake of the deck.
   subroutine report_failure(self, error, is_told)
      type(deck_run_type), intent(inout) :: self
      type(error_type), intent(inout) :: error           ! in: what went wrong; out: as in outcome
      logical, intent(in) :: is_told                     ! whether the reason is printed already
      character(:), allocatable :: words
      logical :: is_there

      words = error%message
      if (error%status == status_no_convergence) words = words//'; the listing shows the iterations'
      associate (kept_round => self%output%kept_round)
         if (kept_round > 0) then
            if (error%status /= status_interrupted) words = ': '//words
            if (is_told) words = ' cannot begin'
            if (error%status /= status_interrupted) words = 'round '//to_text(kept_round + 1)//words
            words = words//kept_words(self)
            error%message = error%message//kept_words(self)
            if (error%status == status_deck) error%status = status_no_convergence
         end if
         call self%outcome%fail(error)
         call self%output%progress%clear()
         if (kept_round > 0 .or. .not. is_told) then
            call print_error(self%path, words)
            call append_message(self%outcome%messages, 'error', self%path, words)
         end if
         inquire (file=results_of(self%path, self%command)//'.vtkhdf', exist=is_there)
         if (kept_round == 0 .and. is_told .and. is_there) call print_line(error_unit, self%path// &
            ': note: "'//results_of(self%path, self%command)//'.vtkhdf" is of an earlier run')
      end associate
   end subroutine report_failure

end module deck_run
