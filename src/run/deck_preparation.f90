!> One deck from its cards to a run that can start, or to what is wrong with it.
module deck_preparation
   use, intrinsic :: iso_fortran_env, only: error_unit
   use accuracy_rounds, only: needs_full
   use cards, only: cards_type
   use command_line, only: command_run, command_type
   use contact_definitions, only: pairing_surfaces
   use connections, only: contact_laws_type, laws_of_step
   use contact_quantities, only: estimated
   use deck_builder, only: build_model
   use deck_origins, only: find_origin, reads_restart
   use deck_reader, only: read_deck
   use deck_report, only: deck_report_type, frictionless
   use deck_source, only: place_type
   use earlier_results, only: earlier_result_type, origin_type
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp
   use load_histories, only: load_history_type
   use loads, only: loads_type
   use messages, only: append_message, message_type, print_error, print_line
   use model, only: model_type, uncertainty_full, uncertainty_last, uncertainty_no
   use no_estimates, only: of_branches, of_path, of_sliding, reason_of_run
   use interface_reports, only: check_arc_lengths, make_interfaces, make_ties
   use held_points, only: first_redundant
   use progress, only: progress_type
   use reported_quantities, only: verifiable
   use steps, only: solves_heat, solves_mechanics
   use simulation, only: simulation_type
   use text, only: append, string_type, to_text
   use unconstrained_bodies, only: unconstrained_in_step, undetermined_in_step
   use variations, only: variation_type, vary
   implicit none
   private
   public :: prepare_deck, read_deck_type

   !> A deck that was read, from which any number of variations can be made.
   type :: read_deck_type
      type(cards_type) :: cards
      type(model_type), private :: model                  !! on the deck's mesh
      type(deck_report_type), allocatable, private :: report
      !> Why there is no model to solve, though there is no error; unallocated where there is one
      character(:), allocatable :: why_skipped
      type(origin_type), allocatable :: origin            !! where its run goes on from, if anywhere
      type(message_type), allocatable :: messages(:)      !! what was printed of it
      !> With --resume: its result, where nothing is left to be solved
      type(earlier_result_type), allocatable :: finished
   end type read_deck_type

contains

   !> Reads a deck, unless that is done, and prepares the run of it or of a variation. Warnings and
   !> errors are printed on stderr; warnings of a variation are those of the deck, and are not.
   !> Of several decks, a file without errors and without *STEP is none: its model stays empty, as
   !> that of a deck does whose result is finished, or that has *NO ANALYSIS.
   !> Errors: status_deck, with the first of the deck's errors; as vary and simulation_type's start.
   subroutine prepare_deck(path, command, deck, model, simulation, error, variation)
      character(*), intent(in) :: path                    !! the deck as given
      type(command_type), intent(in) :: command           !! options of the command line
      type(read_deck_type), intent(inout) :: deck         !! fresh, or of an earlier round
      type(model_type), intent(out) :: model
      type(simulation_type), intent(inout) :: simulation  !! a fresh run
      type(error_type), allocatable, intent(out) :: error
      type(variation_type), intent(in), optional :: variation   !! what is other than in the deck
      type(deck_report_type) :: report
      type(progress_type) :: progress

      call progress%start(command%quiet)
      call progress%say('reading')
      if (.not. allocated(deck%report)) call read_model(path, command, deck)
      report = deck%report
      if (.not. report%has_errors() .and. has_card(deck%cards, 'NO ANALYSIS') .and. .not. &
         allocated(deck%why_skipped)) deck%why_skipped = 'it has *NO ANALYSIS; it is read and '// &
         'found sound'
      if (allocated(deck%why_skipped)) then
         call progress%clear()
         if (allocated(deck%model%steps)) call report%print(error_unit)
         if (allocated(deck%model%steps)) deck%messages = report%messages()
         call append_message(deck%messages, 'note', path, deck%why_skipped)
         call print_line(error_unit, path//': note: '//trim(merge('not solved', 'skipped   ', &
            allocated(deck%model%steps)))//': '//deck%why_skipped)
         return
      end if
      if (.not. report%has_errors()) then
         if (present(variation)) then
            call vary(deck%model, variation, model, error)
         else
            call vary(deck%model, variation_type(), model, error)
         end if
         call report_at_card(error, report)
      end if
      if (.not. (report%has_errors() .or. allocated(error))) then
         call make_interfaces(model, simulation%bodies%interfaces, report)
         call make_ties(model, simulation%bodies%ties, model%notes, report)
      end if
      if (.not. (report%has_errors() .or. allocated(error))) then
         call simulation%start(model, error)
         if (.not. allocated(error)) call check_arc_lengths(model, &
            simulation%bodies%interfaces, report)
         call check_supports(deck%cards, model, simulation, report)
         call report_at_card(error, report)
      end if
      model%warnings = report%warnings()
      call progress%clear()
      if (report%has_errors() .or. .not. present(variation)) then
         call report%print(error_unit)
         deck%messages = report%messages()
      end if
      if (report%has_errors()) then
         call set_error(error, status_deck, report%first_error())
      else if (allocated(error)) then
         call print_error(path, error%message)
         call append_message(deck%messages, 'error', path, error%message)
      end if
   end subroutine prepare_deck

   !> Reads a deck and builds its model.
   subroutine read_model(path, command, deck)
      character(*), intent(in) :: path
      type(command_type), intent(in) :: command
      type(read_deck_type), intent(inout) :: deck         ! fresh

      allocate (deck%report)
      call read_deck(path, command%width, command%settings, deck%cards, deck%report)
      call find_origin(path, command, deck%cards, deck%report, deck%origin, deck%finished)
      if (allocated(deck%finished)) then
         deck%why_skipped = 'its result is finished'
      else if (size(command%decks) > 1 .and. .not. (deck%report%has_errors() .or. &
         has_card(deck%cards, 'STEP'))) then
         deck%why_skipped = 'it has no *STEP; it is taken as a file that decks include'
      end if
      if (allocated(deck%why_skipped)) return
      ! Without the result that it goes on from there is no model.
      if (reads_restart(deck%cards)) return
      call build_model(deck%cards, verifiable, estimated, deck%model, deck%report)
      if (deck%report%has_errors()) return
      if (command%limit > 0.0_dp .and. command%action == command_run .and. .not. &
         (allocated(command%targets) .or. allocated(deck%model%accuracy%targets))) call &
         deck%report%error(deck%cards%last, '--limit ends the rounds of a requested accuracy, '// &
         'and none is requested; add --accuracy or *ACCURACY, or leave it out')
      if (command%uncertainty >= 0) deck%model%uncertainty = command%uncertainty
      if (allocated(command%targets)) then
         deck%model%uncertainty = max(deck%model%uncertainty, uncertainty_last)
         deck%model%accuracy%targets = command%targets
      end if
      if (allocated(deck%model%accuracy%targets) .and. deck%model%uncertainty == &
         uncertainty_last) then
         if (needs_full(deck%model)) then
            deck%model%uncertainty = uncertainty_full
            call append(deck%model%notes, 'the requested accuracy takes ERRORS=FULL: the last '// &
               'increment alone does not tell uncertainties that build up along the path')
         end if
      end if
      select case (reason_of_run(deck%model))
      case (of_sliding)
         call append(deck%model%notes, 'no numerical uncertainties: the last increment alone '// &
            'does not tell those of faces with SLIDING=FINITE; ERRORS=FULL follows the run '// &
            'once more')
      case (of_path)
         call append(deck%model%notes, 'no numerical uncertainties: where heat is stored, '// &
            'bodies yield or creep, faces wear, properties follow temperatures or sections '// &
            'have a pre-tension, errors build up along the path, which ERRORS=FULL follows '// &
            'once more')
      case (of_branches)
         call append(deck%model%notes, 'no numerical uncertainties of branches')
         deck%model%uncertainty = uncertainty_no
      case default   ! none, or asked for none
      end select
      if (.not. allocated(command%targets)) return
      deck%model%steps%restart_frequency = 0
      ! Targets of --accuracy replace those of the deck.
      if (reason_of_run(deck%model) == of_branches) call deck%report%error(deck%cards%last, &
         'a requested accuracy needs numerical uncertainties, which branches of *CONTINUATION '// &
         'do not have; refine by *REFINE')
      if (size(deck%model%contacts) == 0) call deck%report%error(deck%cards%last, &
         'the deck has no *CONTACT PAIR: there is no quantity whose accuracy could be requested')
   end subroutine read_model

   !> Whether a deck has a card.
   pure logical function has_card(cards, name)
      type(cards_type), intent(in) :: cards
      character(*), intent(in) :: name
      integer :: k

      has_card = any([(cards%keywords(k)%name == name, k=1, size(cards%keywords))])
   end function has_card

   !> Reports an error at the card that it names.
   subroutine report_at_card(error, report)
      type(error_type), allocatable, intent(inout) :: error
      type(deck_report_type), intent(inout) :: report

      if (.not. allocated(error)) return
      if (error%card == 0) return
      if (.not. report%has_errors()) call report%error(place_type(error%card, error%column), &
         error%message)
      deallocate (error)
   end subroutine report_at_card

   !> Reports what supports hold too much, and what they and the contact leave unconstrained or
   !> without a temperature, for the first step that has such.
   subroutine check_supports(cards, model, simulation, report)
      type(cards_type), intent(in) :: cards
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(deck_report_type), intent(inout) :: report
      type(loads_type) :: loads
      integer, allocatable :: begins(:)
      integer :: step

      loads = simulation%loads
      begins = pack([(step, step=1, size(cards%keywords))], [(cards%keywords(step)%name == &
         'STEP', step=1, size(cards%keywords))])
      do step = 1, size(model%steps)
         call loads%begin_step(model%steps(step), simulation%state%displacement, &
            simulation%state%temperature)
         associate (points => simulation%bodies%points)
            call check_step(cards%keywords(begins(step))%place, model, simulation, &
               laws_of_step(model, points, step), loads, step, report)
         end associate
         if (report%has_errors()) return
      end do
   end subroutine check_supports

   subroutine check_step(place, model, simulation, laws, loads, step, report)
      type(place_type), intent(in) :: place
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(contact_laws_type), intent(in) :: laws            ! in the step
      type(loads_type), intent(in) :: loads
      integer, intent(in) :: step
      type(deck_report_type), intent(inout) :: report
      type(string_type), allocatable :: messages(:)
      logical :: is_told

      associate (analysis => model%steps(step)%analysis, points => simulation%bodies%points)
         if (solves_mechanics(analysis)) then
            call report_redundant(model, simulation, laws, loads%displacement, step, report)
            call unconstrained_in_step(model, points, laws, loads%displacement%active, messages)
            is_told = .false.
            if (size(messages) > 0) call report%confirm_cause(frictionless, is_told)
            if (.not. is_told) call report_all()
         end if
         if (solves_heat(analysis)) then
            call undetermined_in_step(model, points, laws, loads%temperature%active, step, messages)
            call report_all()
         end if
      end associate
   contains
      subroutine report_all()
         integer :: i

         do i = 1, size(messages)
            call report%error(place, 'step '//to_text(step)//': '//messages(i)%value)
         end do
      end subroutine report_all
   end subroutine check_step

   !> Reports the first contact point of each interface whose force is undetermined because supports
   !> leave fewer nodes to act on than there are contact points.
   subroutine report_redundant(model, simulation, laws, supports, step, report)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(contact_laws_type), intent(in) :: laws
      type(load_history_type), intent(in) :: supports
      integer, intent(in) :: step
      type(deck_report_type), intent(inout) :: report
      integer :: i, k

      do i = 1, size(model%contacts)
         associate (row => simulation%bodies%points, own => simulation%bodies%interfaces(i), &
            number => model%mesh%node_number, first => simulation%bodies%points% &
            interface_start(i), last => simulation%bodies%points%interface_start(i + 1) - 1)
            if (own%pairing /= pairing_surfaces) cycle
            k = first_redundant(row, first, last, supports%active, &
               laws%friction%coefficient > 0.0_dp)
            if (k == 0) cycle
            call report%error(place_type(image=model%contacts(i)%card), 'step '// &
               to_text(step)//': contact pair '//own%name//': *BOUNDARY holds slave node '// &
               to_text(number(row%slave(k)))//', and too few nodes of the master are free '// &
               'there to determine the contact forces; '// &
               'exchange slave and master so that the held face is the master, make the '// &
               'slave coarser, or leave the faces at held nodes out of the surface')
         end associate
      end do
   end subroutine report_redundant

end module deck_preparation
