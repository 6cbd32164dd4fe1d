!> One deck from its cards to a run that can start, or to what is wrong with it.
module deck_preparation
   use, intrinsic :: iso_fortran_env, only: error_unit
   use cards, only: cards_type
   use command_line, only: command_type
   use deck_builder, only: build_model
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type
   use deck_source, only: place_type
   use errors, only: error_type, set_error, status_deck
   use increments, only: simulation_type
   use loads, only: loads_type
   use messages, only: print_error
   use model, only: model_type
   use interface_reports, only: make_interfaces, make_ties
   use all_contact_points, only: over_constrained
   use progress, only: progress_type
   use reported_quantities, only: verifiable
   use steps, only: solves_heat, solves_mechanics
   use text, only: string_type, to_text
   use unconstrained_bodies, only: unconstrained_in_step, undetermined_in_step
   use variations, only: variation_type
   use verify_positions, only: check_arc_lengths
   implicit none
   private
   public :: prepare_deck

contains

   !> Reads a deck and prepares its run. Warnings and errors are printed on stderr.
   !> Errors: status_deck, with the first of the deck's errors; as simulation_type's start.
   subroutine prepare_deck(path, command, cards, model, simulation, error, variation)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(cards_type), intent(out) :: cards
      type(model_type), intent(out) :: model
      type(simulation_type), intent(inout) :: simulation  !! a fresh run
      type(error_type), allocatable, intent(out) :: error
      type(variation_type), intent(in), optional :: variation   !! what is other than in the deck
      type(deck_report_type) :: report
      type(progress_type) :: progress

      call progress%start(command%quiet)
      call progress%say('reading')
      call read_deck(path, command%width, command%settings, cards, report)
      call build_model(cards, verifiable, model, report, error, variation)
      if (.not. (report%has_errors() .or. allocated(error))) then
         call make_interfaces(model, simulation%bodies%interfaces, report)
         call make_ties(model, simulation%bodies%ties, model%notes, report)
      end if
      if (.not. (report%has_errors() .or. allocated(error))) then
         call simulation%start(model, error)
         if (.not. allocated(error)) call check_arc_lengths(model, &
            simulation%bodies%interfaces, report)
         call check_supports(cards%last, model, simulation, report)
         call report_at_card(error, report)
      end if
      model%warnings = report%warnings()
      call progress%clear()
      call report%print(error_unit)
      if (report%has_errors()) then
         call set_error(error, status_deck, report%first_error())
      else if (allocated(error)) then
         call print_error(path, error%message)
      end if
   end subroutine prepare_deck

   !> Reports an error at the card that it names.
   subroutine report_at_card(error, report)
      type(error_type), allocatable, intent(inout) :: error
      type(deck_report_type), intent(inout) :: report

      if (.not. allocated(error)) return
      if (error%card == 0) return
      if (.not. report%has_errors()) call report%error(place_type(image=error%card), error%message)
      deallocate (error)
   end subroutine report_at_card

   !> Reports what supports hold too much, and what they and the contact leave unconstrained or
   !> without a temperature, for the first step that has such.
   subroutine check_supports(last, model, simulation, report)
      type(place_type), intent(in) :: last
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(deck_report_type), intent(inout) :: report
      type(loads_type) :: loads
      integer :: step

      loads = simulation%loads
      do step = 1, size(model%steps)
         call loads%begin_step(model%steps(step), simulation%state%displacement, &
            simulation%state%temperature)
         call check_step(last, model, simulation, loads, step, report)
         if (report%has_errors()) return
      end do
   end subroutine check_supports

   subroutine check_step(last, model, simulation, loads, step, report)
      type(place_type), intent(in) :: last
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(loads_type), intent(in) :: loads
      integer, intent(in) :: step
      type(deck_report_type), intent(inout) :: report
      type(string_type), allocatable :: messages(:)

      associate (analysis => model%steps(step)%analysis, points => simulation%bodies%points)
         if (solves_mechanics(analysis)) then
            call report_over_constrained(model, simulation, loads%displacement%active, step, report)
            call unconstrained_in_step(model, points, loads%displacement%active, messages)
            call report_all()
         end if
         if (solves_heat(analysis)) then
            call undetermined_in_step(model, points, loads%temperature%active, step, messages)
            call report_all()
         end if
      end associate
   contains
      subroutine report_all()
         integer :: i

         do i = 1, size(messages)
            call report%error(last, 'step '//to_text(step)//': '//messages(i)%value)
         end do
      end subroutine report_all
   end subroutine check_step

   !> Reports the first contact point of each interface whose relative motion is prescribed along
   !> the normal, because that of both nodes is.
   subroutine report_over_constrained(model, simulation, held, step, report)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      logical, intent(in) :: held(:)
      integer, intent(in) :: step
      type(deck_report_type), intent(inout) :: report
      logical :: too_much(size(simulation%bodies%points%slave))
      integer :: i, k

      too_much = over_constrained(simulation%bodies%points, held)
      do i = 1, size(model%contacts)
         associate (points => simulation%bodies%interfaces(i), number => model%mesh%node_number, &
            start => simulation%bodies%points%interface_start)
            k = findloc(too_much(start(i):start(i + 1) - 1), .true., dim=1)
            if (k == 0) cycle
            call report%error(place_type(image=model%contacts(i)%card), 'step '// &
               to_text(step)//': contact pair '//points%name//': *BOUNDARY prescribes the '// &
               'motion of slave node '//to_text(number(points%slave_node(k)))// &
               ' and master node '//to_text(number(points%master_node(k)))//' towards each '// &
               'other, so that their contact force is undetermined; free one of the two '// &
               'nodes along the normal of the faces')
         end associate
      end do
   end subroutine report_over_constrained

end module deck_preparation
