!> One deck to its results.
module deck_run
   use blas_memory, only: reserve_blas_memory
   use cards, only: cards_type
   use clock, only: wall_seconds
   use command_line, only: command_type
   use batch_table, only: table_name
   use deck_outcomes, only: deck_outcome_type
   use deck_preparation, only: prepare_deck
   use error_estimator, only: error_estimator_type
   use errors, only: error_type, set_error, status_deck, status_interrupted, &
      status_internal, status_no_convergence, status_verify
   use file_calls, only: make_folder
   use increment_control, only: increment_control_type
   use increments, only: simulation_type
   use interruption, only: caught_signal
   use kinds, only: dp
   use load_courses, only: step_clock_type
   use messages, only: print_error
   use model, only: model_type
   use records, only: increment_record_type
   use run_description, only: describe_run
   use run_output, only: run_output_type
   use text, only: string_type, to_text
   implicit none
   private
   public :: run_deck, base_name

contains

   !> Solves one deck. What goes wrong is printed on stderr and stands in the outcome's status.
   subroutine run_deck(path, command, outcome)
      character(*), intent(in) :: path                  !! the deck as given
      type(command_type), intent(in) :: command         !! options of the command line
      class(deck_outcome_type), intent(inout) :: outcome !! how it ended
      type(cards_type) :: cards
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(run_output_type) :: output
      type(error_type), allocatable :: error
      real(dp) :: since

      since = wall_seconds()
      outcome%path = path
      if (any(path(max(len(path) - 3, 1):) == ['.lst', '.sta', '.cvg']) .or. &
         path(max(len(path) - 6, 1):) == '.vtkhdf' .or. &
         path(index(path, '/', back=.true.) + 1:) == table_name) then
         call print_error(path, 'a deck cannot have the name of a result file')
         outcome%status = status_deck
         return
      end if
      call reserve_blas_memory(error)
      if (allocated(error)) then
         call report_failure(path, error, outcome)
         return
      end if
      call prepare_deck(path, command, cards, model, simulation, outcome%status)
      if (outcome%status == 0) then
         output%run%deck_path = path
         call make_folder(command%folder)
         call output%reserve(command%folder//'/'//base_name(path), error)
         if (.not. allocated(error)) then
            call simulation%reduce(model, error)
            if (allocated(error)) call say_when(model, simulation, error)
         end if
         if (allocated(error)) call report_failure(path, error, outcome)
      end if
      if (outcome%status == 0) then
         output%run%seconds_read = wall_seconds() - since - simulation%seconds%assemble - &
            simulation%seconds%reduce
         call describe_run(path, model, simulation, output%run)
         call solve_deck(command%quiet, cards, model, simulation, output, outcome, error)
         if (allocated(error)) call report_failure(path, error, outcome)
         ! Of a run that could not go on for want of a file or of memory a check says nothing.
         if (outcome%status /= status_internal) then
            call report_checks(path, output%failed_checks(model))
         end if
         outcome%verify_passed = output%run%verify_passed
         outcome%verify_failed = output%run%verify_failed
         if (outcome%status == 0 .and. outcome%verify_failed > 0) outcome%status = status_verify
      end if
      call output%close()
      call simulation%release()
      outcome%seconds = wall_seconds() - since
   end subroutine run_deck

   !> All increments, with their output.
   subroutine solve_deck(quiet, cards, model, simulation, output, outcome, error)
      logical, intent(in) :: quiet
      type(cards_type), intent(in) :: cards
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      type(run_output_type), intent(inout) :: output
      class(deck_outcome_type), intent(inout) :: outcome
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: output_error
      type(error_estimator_type) :: estimator
      type(increment_record_type) :: record

      associate (pairs => simulation%operators%interfaces, points => simulation%recovery%points)
         call output%start(model, pairs, points%node, points%element_points, cards%images, quiet, &
            error)
         if (allocated(error)) return
         call estimator%start(model, simulation)
         do while (.not. simulation%finished(model))
            call check_signals(simulation%control, error)
            if (allocated(error)) then
               record = increment_record_type()
               exit
            end if
            call estimator%begin_increment(simulation)
            call simulation%advance(model, record, error)
            output%run%seconds_assemble = simulation%seconds%assemble
            output%run%seconds_reduce = simulation%seconds%reduce
            output%run%seconds_iterate = simulation%seconds%iterate
            output%run%seconds_recover = simulation%seconds%recover
            output%run%factor_bytes = simulation%sizes%factor_bytes
            output%run%smallest_pivot = simulation%sizes%smallest_pivot
            if (allocated(error)) exit
            call estimator%end_increment(model, simulation, record)
            call output%accept(record, model, pairs, error)
            call outcome%note(record, output%accepted())
            if (allocated(error)) then
               call output%break_off(error%message)
               return
            end if
         end do
         if (allocated(error)) then
            if (error%status == status_deck) then
               ! What only an increment shows is no mistake of the deck's cards; one that has no
               ! number yet failed as it was set up.
               if (record%increment == 0) call say_when(model, simulation, error)
               error%status = status_no_convergence
            end if
            call output%fail(error%message, record)
            call outcome%note(record, output%accepted())
         end if
         call output%finish(model, pairs, output_error)
         if (allocated(output_error)) then
            if (allocated(error)) output_error%message = error%message//'; '//output_error%message
            call move_alloc(output_error, error)
         end if
      end associate
   end subroutine solve_deck

   !> Puts the increment that was tried before what went wrong.
   subroutine say_when(model, simulation, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(error_type), intent(inout) :: error
      type(step_clock_type) :: clock

      clock = simulation%control%next_instant(model)
      error%message = 'increment '//to_text(simulation%control%increments + 1)//' (time '// &
         to_text(clock%total_time)//'): '//error%message
   end subroutine say_when

   !> A signal ends the run between two increments.
   !> Error: status_interrupted.
   subroutine check_signals(control, error)
      type(increment_control_type), intent(in) :: control
      type(error_type), allocatable, intent(out) :: error

      if (caught_signal() == '') return
      if (control%increments == 0) then
         call set_error(error, status_interrupted, 'ended by '//caught_signal()// &
            ' before the first increment')
      else
         call set_error(error, status_interrupted, 'ended by '//caught_signal()// &
            ' after increment '//to_text(control%increments)//' (time '// &
            to_text(control%step_start + control%step_time)//')')
      end if
   end subroutine check_signals

   !> Prints which checks of the deck failed.
   subroutine report_checks(path, lines)
      character(*), intent(in) :: path
      type(string_type), intent(in) :: lines(:)
      integer :: i

      do i = 1, size(lines)
         call print_error(path, lines(i)%value)
      end do
   end subroutine report_checks

   !> Prints why a run ended early.
   subroutine report_failure(path, error, outcome)
      character(*), intent(in) :: path
      type(error_type), intent(in) :: error
      class(deck_outcome_type), intent(inout) :: outcome

      outcome%status = error%status
      call print_error(path, error%message)
      if (error%status == status_no_convergence) call print_error(path, &
         'not converged; the listing has the iteration history')
   end subroutine report_failure

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
