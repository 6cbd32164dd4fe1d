!> One deck to its results.
module deck_run
   use accuracy_lines, only: missed_words
   use accuracy_rounds, only: accuracy_rounds_type
   use batch_table, only: table_name
   use blas_lapack, only: reserve_blas_memory
   use clock, only: wall_seconds
   use command_line, only: command_type
   use deck_outcomes, only: deck_outcome_type
   use deck_preparation, only: not_a_deck, prepare_deck, read_deck_type
   use error_estimator, only: error_estimator_type
   use errors, only: error_type, set_error, status_deck, status_interrupted, status_internal, &
      status_no_convergence, status_ok, status_verify
   use file_calls, only: make_folder
   use increments, only: simulation_type
   use input_files, only: input_files_type
   use interruption, only: end_after_grace, end_at_once, end_by_increments
   use kinds, only: dp
   use messages, only: print_error
   use model, only: model_type
   use records, only: increment_record_type
   use run_description, only: describe_run
   use run_ending, only: check_signals, prepare_end, report_failure, run_type, say_when
   use run_output, only: paths_written, run_output_type
   use text, only: append, string_type
   use variations, only: variation_type
   implicit none
   private
   public :: run_deck, base_name, results_of, outputs_of

   !> What goes from one round to the next.
   type :: rounds_type
      type(read_deck_type) :: deck
      type(accuracy_rounds_type) :: accuracy
      type(variation_type), allocatable :: variation   !! of the deck; unallocated in the first one
      integer :: lock = -1                             !! as run_output_type's reserve
   end type rounds_type

contains

   !> Solves one deck, with a requested accuracy in rounds. What goes wrong is printed on stderr and
   !> recorded in the outcome.
   subroutine run_deck(path, command, outcome)
      character(*), intent(in) :: path                  !! the deck as given
      type(command_type), intent(in) :: command         !! options of the command line
      type(deck_outcome_type), intent(inout) :: outcome !! how it ended
      type(rounds_type) :: rounds
      type(error_type), allocatable :: error
      real(dp) :: since

      since = wall_seconds()
      outcome%path = path
      call reserve_blas_memory()
      allocate (outcome%failed_checks(0))
      do
         call run_round(path, command, rounds, outcome)
         if (outcome%status /= status_ok .or. .not. rounds%accuracy%goes_on) exit
      end do
      if (size(outcome%failed_checks) > 0) then
         call set_error(error, status_verify, outcome%failed_checks(1)%value)
         call outcome%fail(error)
      end if
      outcome%seconds = wall_seconds() - since
   end subroutine run_deck

   !> Solves a deck as it is written, or as the variation of a later round has it. The files of the
   !> round before stay until a later one is whole.
   subroutine run_round(path, command, rounds, outcome)
      character(*), intent(in) :: path
      type(command_type), intent(in) :: command
      type(rounds_type), intent(inout) :: rounds
      type(deck_outcome_type), intent(inout) :: outcome
      type(run_type) :: self
      type(model_type), target :: model
      type(simulation_type), target :: simulation
      type(run_output_type), target :: output
      type(error_type), allocatable :: error
      real(dp) :: since

      self%model => model
      self%simulation => simulation
      self%output => output
      since = wall_seconds()
      call cpu_time(self%cpu_start)
      self%path = path
      self%command = command
      if (allocated(rounds%variation)) self%output%kept_round = size(rounds%accuracy%rounds)
      call outcome%begin(self%output%kept_round > 0)
      if (outcome%keeps_round .and. .not. command%quiet) call self%end%prepare_summary( &
         outcome%round_summary(results_of(path, command)))
      call prepare_end(self, end_at_once)
      call begin_round(self, rounds, outcome)
      if (outcome%status == status_ok .and. allocated(self%model%steps)) then
         self%output%run%seconds_read = wall_seconds() - since - &
            self%simulation%seconds%assemble - self%simulation%seconds%reduce
         call describe_run(path, self%model, self%simulation, self%output%run)
         self%output%run%accuracy = rounds%accuracy
         call solve_deck(self, rounds%deck%cards%images, outcome, error)
         rounds%accuracy = self%output%run%accuracy
         if (allocated(error)) call report_failure(self, error, outcome, is_told=.false.)
         ! Of a run that could not go on for want of a file or of memory a check says nothing.
         if (outcome%status /= status_internal) call take_checks(self, outcome)
         if (rounds%accuracy%goes_on) then
            if (.not. allocated(rounds%variation)) allocate (rounds%variation)
            call self%indicators%add_to(rounds%variation)
         end if
      end if
      call self%output%close(outcome%status == status_ok .and. rounds%accuracy%goes_on)
      call self%simulation%release()
   end subroutine run_round

   !> All that comes before the first increment. A first round touches no file before its deck is
   !> found sound; a later one can say in the listing what ends it.
   subroutine begin_round(self, rounds, outcome)
      type(run_type), intent(inout) :: self
      type(rounds_type), intent(inout) :: rounds
      type(deck_outcome_type), intent(inout) :: outcome
      type(input_files_type) :: inputs
      type(error_type), allocatable :: error
      logical :: is_told

      is_told = .false.
      associate (is_later => self%output%kept_round > 0)
         if (is_later) call reserve_files(self, rounds%lock, error)
         if (.not. allocated(error)) then
            call prepare_deck(self%path, self%command, rounds%deck, self%model, &
               self%simulation, error, rounds%variation)
            is_told = allocated(error)
         end if
         if (.not. (allocated(error) .or. allocated(self%model%steps))) then
            outcome%reason = not_a_deck
            return
         end if
         if (.not. (allocated(error) .or. is_later)) then
            call inputs%add(self%path, rounds%deck%cards%files)
            call inputs%check(outputs_of(self%path, self%command), error)
         end if
         if (.not. (allocated(error) .or. is_later)) call reserve_files(self, rounds%lock, error)
         if (.not. allocated(error)) call reduce_bodies(self, error)
         if (.not. allocated(error)) return
         if (is_later) call self%output%fail(error%message, increment_record_type())
      end associate
      call report_failure(self, error, outcome, is_told)
   end subroutine begin_round

   !> Sees to it that results can be written before anything is solved.
   !> Error: as run_output_type's reserve.
   subroutine reserve_files(self, lock, error)
      type(run_type), intent(inout) :: self
      integer, intent(inout) :: lock                !! as run_output_type's reserve
      type(error_type), allocatable, intent(out) :: error

      self%output%run%deck_path = self%path
      call make_folder(self%command%folder, error)
      if (allocated(error)) return
      call self%end%hold(.true.)
      call self%output%reserve(results_of(self%path, self%command), lock, error)
      call prepare_end(self, end_at_once)
      call self%end%hold(.false.)
   end subroutine reserve_files

   !> What the first step needs before its first increment.
   !> Error: as simulation_type's reduce.
   subroutine reduce_bodies(self, error)
      type(run_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      associate (progress => self%output%progress)
         call progress%start(self%command%quiet)
         call progress%say('assembling')
         call self%simulation%assemble(self%model)
         call progress%say('reducing')
         call self%simulation%reduce(self%model, error)
         if (allocated(error)) call say_when(self, error)
      end associate
   end subroutine reduce_bodies

   !> All increments, with their output.
   subroutine solve_deck(self, cards, outcome, error)
      type(run_type), intent(inout) :: self
      type(string_type), intent(in) :: cards(:)     !! card images as read
      type(deck_outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: output_error
      type(error_estimator_type) :: estimator
      type(increment_record_type) :: record
      logical :: is_written

      associate (model => self%model, simulation => self%simulation, output => self%output, &
         interfaces => self%simulation%bodies%interfaces, points => self%simulation%recovery%points)
         call self%end%hold(.true.)
         call output%start(model, interfaces, points%node, points%element_points, cards, error)
         if (allocated(error)) return
         call outcome%note_files(output%written())
         call prepare_end(self, end_at_once)
         call self%end%hold(.false.)
         call solve_increments(self, estimator, outcome, record, is_written, error)
         call estimator%release()
         ! What is written now is no longer cut short.
         call self%end%hold(.true.)
         call prepare_end(self, end_by_increments)
         if (.not. allocated(error)) call judge_round(self)
         if (.not. is_written) then
            call output%break_off(error%message)
            return
         end if
         if (allocated(error)) then
            if (error%status == status_deck) then
               ! What only an increment shows is no mistake of the deck's cards; one that has no
               ! number yet failed as it was set up.
               if (record%increment == 0) call say_when(self, error)
               error%status = status_no_convergence
            end if
            call output%fail(error%message, record)
            call outcome%note(record, output%accepted(), output%written())
            if (output%kept_round > 0) return
         end if
         call output%finish(model, interfaces, cards, output_error)
         if (output%kept_round == 0) then
            outcome%keeps_round = .false.
            outcome%increments = output%accepted()
            outcome%summary = output%summary_lines(model, interfaces)
            call outcome%note_files(output%written())
         end if
         if (allocated(output_error)) then
            if (allocated(error)) output_error%message = error%message//'; '//output_error%message
            call move_alloc(output_error, error)
         end if
      end associate
   end subroutine solve_deck

   !> Solves increment after increment, each with its output.
   !> Errors: as simulation_type's advance and run_output_type's accept; status_interrupted.
   subroutine solve_increments(self, estimator, outcome, record, is_written, error)
      type(run_type), intent(inout) :: self
      type(error_estimator_type), intent(inout) :: estimator   !! fresh
      type(deck_outcome_type), intent(inout) :: outcome
      type(increment_record_type), intent(out) :: record    !! the last; empty after a signal
      logical, intent(out) :: is_written                    !! whether the output went well
      type(error_type), allocatable, intent(out) :: error

      is_written = .true.
      associate (model => self%model, simulation => self%simulation, output => self%output)
         call estimator%start(model, simulation)
         call output%run%accuracy%begin_round(model%accuracy, size(model%contacts), &
            size(model%steps))
         call self%indicators%start(model)
         do while (.not. simulation%finished(model))
            call prepare_end(self, end_after_grace)
            call check_signals(self, error)
            if (.not. allocated(error)) then
               call output%progress%begin_increment(simulation%control%increments + 1, &
                  simulation%control%planned(model))
               call estimator%begin_increment(simulation)
               call simulation%advance(model, record, error)
               output%run%seconds = simulation%seconds
               output%run%sizes = simulation%sizes
               if (allocated(error)) then
                  if (error%status == status_interrupted) call check_signals(self, error)
               end if
            end if
            if (allocated(error)) then
               if (error%status == status_interrupted) record = increment_record_type()
               return
            end if
            call estimator%end_increment(model, simulation, record, &
               output%run%accuracy%courses)
            call output%run%accuracy%follow(simulation%bodies%interfaces, record)
            if (output%run%accuracy%is_on .and. record%last_of_step) call self%indicators%take( &
               model, simulation%bodies%interfaces, output%run%accuracy, record)
            call self%end%hold(.true.)
            associate (tolerance => model%steps(record%step)%fixed_point%tolerance)
               if (record%residual_floor > tolerance) call outcome%doubt(record%residual_floor)
            end associate
            call output%accept(record, model, simulation%bodies%interfaces, error)
            call outcome%note(record, output%accepted(), output%written())
            is_written = .not. allocated(error)
            if (allocated(error)) return
            call self%end%hold(.false.)
         end do
      end associate
   end subroutine solve_increments

   !> Judges whether a requested accuracy is reached, or another round follows.
   subroutine judge_round(self)
      type(run_type), intent(inout) :: self
      real(dp) :: now

      associate (accuracy => self%output%run%accuracy, run => self%output%run)
         if (.not. accuracy%is_on) return
         associate (round => accuracy%rounds(size(accuracy%rounds)), sizes => run%sizes)
            round%unknowns = sizes%equations_thermal + sizes%equations_mechanical + &
               sizes%contact_unknowns
            round%elements = size(self%model%mesh%element_kind)
            call cpu_time(now)
            round%cpu_seconds = now - self%cpu_start
         end associate
         call accuracy%conclude(self%model%accuracy%rounds, self%indicators%asks_for_nothing())
      end associate
   end subroutine judge_round

   !> Takes which checks of the deck failed, and which targets were missed.
   subroutine take_checks(self, outcome)
      type(run_type), intent(in) :: self
      type(deck_outcome_type), intent(inout) :: outcome
      character(:), allocatable :: missed
      ! gfortran never frees the components of a function's result within an array constructor.
      type(string_type), allocatable :: failed(:)

      associate (output => self%output)
         failed = output%failed_checks(self%model)
         outcome%failed_checks = [outcome%failed_checks, failed]
         ! Later rounds tell the verdicts of the first one, unless they end early.
         outcome%verify_passed = max(outcome%verify_passed, output%run%verify_passed)
         outcome%verify_failed = max(outcome%verify_failed, output%run%verify_failed)
         if (outcome%status /= status_ok .or. output%run%accuracy%goes_on) return
         missed = missed_words(output%run%accuracy, self%simulation%bodies%interfaces)
         if (missed /= '') call append(outcome%failed_checks, self%path//': error: '//missed)
      end associate
   end subroutine take_checks

   !> Path of a deck's results without extension.
   pure function results_of(path, command) result(results)
      character(*), intent(in) :: path           !! the deck as given
      type(command_type), intent(in) :: command
      character(:), allocatable :: results       !! such as DIR/b for a/b.inp

      results = command%folder//'/'//base_name(path)
   end function results_of

   !> Paths of all files that a deck writes, and of the table that a batch writes beside them: no
   !> deck may be lost to a batch of others either.
   pure function outputs_of(path, command) result(outputs)
      character(*), intent(in) :: path           !! the deck as given
      type(command_type), intent(in) :: command
      type(string_type), allocatable :: outputs(:)

      outputs = paths_written(results_of(path, command))
      call append(outputs, command%folder//'/'//table_name)
   end function outputs_of

   !> Name of a deck's results: its file name without folder and extension, or stdin where it is
   !> read from an open file, which has a number only.
   pure function base_name(path) result(name)
      character(*), intent(in) :: path           !! the deck as given
      character(:), allocatable :: name          !! such as b for a/b.inp
      integer :: dot

      if (index(path, '/dev/fd/') == 1 .or. index(path, '/proc/self/fd/') == 1) then
         name = 'stdin'
         return
      end if
      name = path(index(path, '/', back=.true.) + 1:)
      dot = index(name, '.', back=.true.)
      if (dot > 1) name = name(:dot - 1)
   end function base_name

end module deck_run
