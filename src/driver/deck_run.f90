!> One deck from its cards to its results, or to what is wrong with it.
module deck_run
   use, intrinsic :: iso_fortran_env, only: error_unit
   use cards, only: cards_type
   use clock, only: wall_seconds
   use command_line, only: command_type
   use deck_builder, only: build_model
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type
   use errors, only: error_type, status_deck, status_no_convergence, status_verify
   use increment_instants, only: next_instant
   use increments, only: simulation_type
   use kinds, only: dp
   use load_courses, only: step_clock_type
   use model, only: model_type
   use pair_reports, only: pair_all
   use progress, only: deck_outcome_type
   use records, only: increment_record_type, iteration_record_type
   use run_description, only: describe_run
   use run_output, only: run_output_type
   use support_checks, only: check_over_constrained, check_supports
   use system_calls, only: make_folder
   use text, only: string_type, to_text
   use verify_places, only: check_arc_lengths
   implicit none
   private
   public :: run_deck, prepare_deck, base_name

contains

   !> Solves one deck. What goes wrong is printed on stderr and stands in the outcome's status.
   subroutine run_deck(path, command, outcome)
      character(*), intent(in) :: path                  !! the deck as given
      type(command_type), intent(in) :: command         !! options of the command line
      type(deck_outcome_type), intent(inout) :: outcome !! how it ended
      type(cards_type) :: cards
      type(model_type) :: model
      type(simulation_type) :: simulation
      type(run_output_type) :: output
      type(error_type), allocatable :: error
      real(dp) :: since

      since = wall_seconds()
      outcome%path = path
      if (any(path(max(len(path) - 3, 1):) == ['.lst', '.sta', '.cvg']) .or. &
         path(max(len(path) - 6, 1):) == '.vtkhdf') then
         write (error_unit, '(2a)') path, ': error: a deck cannot have the name of a result file'
         outcome%status = status_deck
         return
      end if
      call prepare_deck(path, command, cards, model, simulation, outcome%status)
      if (outcome%status == 0) then
         call simulation%reduce(model, error)
         if (allocated(error)) call say_when(model, simulation, error)
         if (allocated(error)) call report_failure(path, error, outcome)
      end if
      if (outcome%status == 0) then
         output%run%seconds_read = wall_seconds() - since - simulation%seconds%assemble - &
            simulation%seconds%reduce
         call describe_run(path, model, simulation, output%run)
         call solve_deck(path, command, cards, model, simulation, output, error)
         if (allocated(error)) call report_failure(path, error, outcome)
         call report_checks(path, output%failed_checks(model))
         outcome%increments = output%accepted()
         outcome%verify_passed = output%run%verify_passed
         outcome%verify_failed = output%run%verify_failed
         if (outcome%status == 0 .and. outcome%verify_failed > 0) outcome%status = status_verify
      end if
      call simulation%release()
      outcome%seconds = wall_seconds() - since
   end subroutine run_deck

   !> Reads a deck and prepares its run. Warnings and errors go to stderr.
   subroutine prepare_deck(path, command, cards, model, simulation, status)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(cards_type), intent(out) :: cards              !! its cards
      type(model_type), intent(out) :: model              !! its model
      type(simulation_type), intent(inout) :: simulation  !! a fresh run
      integer, intent(out) :: status                      !! exit status so far
      type(deck_report_type) :: report
      type(error_type), allocatable :: error

      status = 0
      call read_deck(path, command%width, command%settings, cards, report)
      call build_model(cards, model, report)
      if (.not. report%has_errors()) then
         call pair_all(model, simulation%operators%interfaces, report)
      end if
      if (.not. report%has_errors()) then
         call simulation%start(model, error)
         if (allocated(error)) then
            call check_over_constrained(model, simulation, report)
            if (report%has_errors()) deallocate (error)
         else
            call check_arc_lengths(model, simulation%operators%interfaces, report)
            call check_supports(cards%last, model, simulation, report)
         end if
      end if
      model%warnings = report%warnings()
      call report%print(error_unit)
      if (report%has_errors()) status = status_deck
      if (.not. allocated(error)) return
      status = error%status
      write (error_unit, '(3a)') path, ': error: ', error%message
   end subroutine prepare_deck

   !> All increments, with their output.
   subroutine solve_deck(path, command, cards, model, simulation, output, error)
      character(*), intent(in) :: path
      type(command_type), intent(in) :: command
      type(cards_type), intent(in) :: cards
      type(model_type), intent(in) :: model
      type(simulation_type), intent(inout) :: simulation
      type(run_output_type), intent(inout) :: output
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: output_error
      type(increment_record_type) :: record
      type(iteration_record_type), allocatable :: passes(:)

      associate (pairs => simulation%operators%interfaces, points => simulation%points)
         call make_folder(command%folder)
         call output%start(command%folder//'/'//base_name(path), model, pairs, points%node, &
            points%element_points, cards%images, command%quiet, error)
         if (allocated(error)) return
         do while (.not. simulation%finished(model))
            call simulation%advance(model, record, error)
            output%run%seconds_assemble = simulation%seconds%assemble
            output%run%seconds_reduce = simulation%seconds%reduce
            output%run%seconds_iterate = simulation%seconds%iterate
            output%run%seconds_recover = simulation%seconds%recover
            output%run%factor_bytes = simulation%sizes%factor_bytes
            if (allocated(error)) exit
            call output%accept(record, model, pairs, error)
            if (allocated(error)) return
         end do
         if (allocated(error)) then
            ! An increment that had no number yet failed as it was set up.
            if (record%increment == 0) call say_when(model, simulation, error)
            if (record%increment == 0 .and. error%status == status_deck) then
               error%status = status_no_convergence
            end if
            allocate (passes(0))
            if (allocated(record%iterations)) passes = record%iterations
            call output%fail(error%message, passes)
         end if
         call output%finish(model, pairs, output_error)
         if (allocated(output_error) .and. .not. allocated(error)) then
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

      clock = next_instant(model, model%steps(simulation%step), simulation%step_start, &
         simulation%step_time)
      error%message = 'increment '//to_text(simulation%increments + 1)//' (time '// &
         to_text(clock%total_time)//'): '//error%message
   end subroutine say_when

   !> Prints which checks of the deck failed.
   subroutine report_checks(path, lines)
      character(*), intent(in) :: path
      type(string_type), intent(in) :: lines(:)
      integer :: i

      do i = 1, size(lines)
         write (error_unit, '(3a)') path, ': error: ', lines(i)%value
      end do
   end subroutine report_checks

   !> Prints why a run ended early.
   subroutine report_failure(path, error, outcome)
      character(*), intent(in) :: path
      type(error_type), intent(in) :: error
      type(deck_outcome_type), intent(inout) :: outcome

      outcome%status = error%status
      write (error_unit, '(3a)') path, ': error: ', error%message
      if (error%status == status_no_convergence) write (error_unit, '(2a)') path, &
         ': error: not converged; the listing has the iteration history'
   end subroutine report_failure

   !> Name of a deck's results: its file name without folder and extension.
   pure function base_name(path) result(name)
      character(*), intent(in) :: path           !! the deck as given
      character(:), allocatable :: name          !! such as b for a/b.inp
      integer :: dot

      name = path(index(path, '/', back=.true.) + 1:)
      dot = index(name, '.', back=.true.)
      if (dot > 1) name = name(:dot - 1)
   end function base_name

end module deck_run
