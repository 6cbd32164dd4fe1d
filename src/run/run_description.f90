!> Summary of a run once it is started: physics in words, sizes, Biot number. `thercon check` prints
!> a deck as it was understood.
module run_description
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: command_type
   use conductance_laws, only: is_constant
   use contact_definitions, only: makes_friction_heat
   use contact_points, only: contact_points_type
   use controls, only: solver_mumps
   use deck_outcomes, only: print_document
   use deck_preparation, only: prepare_deck, read_deck_type
   use errors, only: error_type
   use interface_warnings, only: gap_range
   use json, only: json_type
   use kinds, only: dp
   use messages, only: print_line
   use model, only: has_friction, model_type
   use model_words, only: alike_words, closed_law_words, first_alike, friction_heat_words, &
      friction_words, from_to, &
      open_law_words, open_words, overlap_words, pairing_words, points_words, wear_words
   use run_summaries, only: in_check, put_run, run_entries, run_entry_type, run_summary_type
   use simulation, only: simulation_type
   use steps, only: analysis_coupled, solves_heat, solves_mechanics
   use text, only: counted, string_type, to_text
   use utf8, only: character_count
   use version, only: program_version
   implicit none
   private
   public :: describe_run, check_deck

contains

   !> Fills in the summary of a run, but for its times and verdicts.
   subroutine describe_run(path, model, simulation, run)
      character(*), intent(in) :: path                 !! deck as the command line names it
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation  !! the run, started
      type(run_summary_type), intent(inout) :: run

      run%version = program_version
      run%deck_path = path
      run%solver = 'SKYLINE'
      if (model%solver == solver_mumps) run%solver = 'MUMPS'
      associate (division => simulation%bodies%mechanical%division)
         if (allocated(division%graph%value) .and. division%cuts_bodies()) run%solver = &
            'SKYLINE, sparse tail'
      end associate
      call name_physics(model, run)
      run%sizes = simulation%sizes
      if (any(solves_heat(model%steps%analysis))) call find_biot(model, simulation, run)
   end subroutine describe_run

   !> Which parts of the physics are on or off, and what in the deck makes them so.
   subroutine name_physics(model, run)
      type(model_type), intent(in) :: model
      type(run_summary_type), intent(inout) :: run
      character(:), allocatable :: why_off, why_on
      logical :: has_heat, has_mechanics, has_contact, has_law

      has_heat = any(solves_heat(model%steps%analysis))
      has_mechanics = any(solves_mechanics(model%steps%analysis))
      has_contact = size(model%contacts) > 0
      has_law = .not. all(is_constant(model%interactions(model%contacts%interaction)%law))
      run%modelled = ''
      run%reasons = ''
      call name('elasticity', has_mechanics, steps_that(solves_mechanics(model%steps%analysis)), &
         'no step but *HEAT TRANSFER')
      if (any(model%materials%law%strains(1) > 0)) call name('plasticity', has_mechanics, &
         '*PLASTIC', 'no step but *HEAT TRANSFER')
      if (any(model%materials%law%strains(2) > 0)) call name('creep', any(model%steps%creeps), &
         '*CREEP in real time', 'no step in real time')
      call name('heat', has_heat, steps_that(solves_heat(model%steps%analysis)), &
         'no step solves temperatures')
      call name('contact', has_contact, '*CONTACT PAIR', 'no *CONTACT PAIR')
      why_off = 'no *FRICTION above 0'
      if (.not. has_contact) why_off = 'no contact'
      if (has_contact .and. .not. has_mechanics) why_off = 'no step solves mechanics'
      call name('friction', has_friction(model) .and. (has_mechanics .or. .not. has_contact), &
         '*FRICTION', why_off)
      why_on = 'a conductance of gap, pressure or temperature'
      why_off = 'no '//why_on(3:)
      if (makes_friction_heat(model%interactions, model%contacts)) then
         if (.not. has_law) why_on = 'heat of friction'
         has_law = .true.
      end if
      if (has_law) why_off = 'no step solves heat and mechanics together'
      call name('coupling', has_law .and. any(model%steps%analysis == analysis_coupled), &
         '*COUPLED TEMPERATURE-DISPLACEMENT and '//why_on, why_off)
   contains
      subroutine name(part, is_on, why_on, why_off)
         character(*), intent(in) :: part, why_on, why_off
         logical, intent(in) :: is_on
         character(:), allocatable :: reason

         if (len(run%reasons) > 0) run%reasons = run%reasons//'; '
         reason = ' is off: '//why_off
         if (is_on) then
            reason = ' is on: '//why_on
            if (len(run%modelled) > 0) run%modelled = run%modelled//', '
            run%modelled = run%modelled//part
         end if
         run%reasons = run%reasons//part//reason
      end subroutine name
   end subroutine name_physics

   !> Names the steps for which something holds.
   pure function steps_that(holds) result(words)
      logical, intent(in) :: holds(:)
      character(:), allocatable :: words
      integer :: i

      if (all(holds)) then
         words = 'every step solves it'
         return
      end if
      words = 'step'//trim(merge('s', ' ', count(holds) > 1))
      do i = 1, size(holds)
         if (holds(i)) words = words//' '//to_text(i)
      end do
      words = words//' of '//to_text(size(holds))//merge(' solves', ' solve ', count(holds) == 1)
      words = trim(words)//' it'
   end function steps_that

   !> Contact Biot number omega L/K of the initial gaps: L the length of the interface, K the
   !> slave's conductivity.
   subroutine find_biot(model, simulation, run)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(run_summary_type), intent(inout) :: run
      real(dp) :: conductivity, length
      integer :: element, i, first, last

      run%contact_biot = [huge(1.0_dp), 0.0_dp]
      do i = 1, size(model%contacts)
         element = model%mesh%surfaces(model%contacts(i)%slave)%faces(1, 1)
         associate (material => model%materials(model%sections( &
            model%mesh%element_section(element))%material), points => simulation%bodies%points)
            conductivity = sqrt(product(material%conductivity))
            length = simulation%bodies%interfaces(i)%length()
            first = points%interface_start(i)
            last = points%interface_start(i + 1) - 1
         end associate
         associate (biot => simulation%state%omega(first:last)*length/conductivity)
            run%contact_biot = [min(run%contact_biot(1), minval(biot)), &
               max(run%contact_biot(2), maxval(biot))]
         end associate
         run%has_biot = .true.
      end do
   end subroutine find_biot

   !> Reads one deck and prints what was understood, unless it is asked to be quiet; nothing is
   !> solved.
   subroutine check_deck(path, command, status)
      character(*), intent(in) :: path            !! the deck as given
      type(command_type), intent(in) :: command   !! options of the command line
      integer, intent(out) :: status              !! exit status
      type(read_deck_type) :: deck
      type(model_type) :: model
      type(simulation_type), allocatable :: simulation
      type(run_summary_type) :: run
      type(error_type), allocatable :: error
      type(json_type) :: members
      type(contact_points_type) :: points
      real(dp) :: gaps(2)
      integer :: i

      status = 0
      allocate (simulation)
      call prepare_deck(path, command, deck, model, simulation, error)
      if (allocated(error)) then
         status = error%status
      else if (allocated(model%steps) .and. .not. command%quiet) then
         call describe_run(path, model, simulation, run)
         call print_deck(model, simulation, run)
      end if
      if (command%json) then
         if (.not. allocated(error) .and. allocated(model%steps)) then
            call describe_run(path, model, simulation, run)
            call put_run(members, run, model)
            call members%open('{', 'interfaces')
            do i = 1, size(model%contacts)
               call simulation%bodies%view(i, points)
               gaps = gap_range(model%mesh, points)
               call members%open('{', points%name)
               call members%put(size(points%slave), 'contact_points')
               call members%put(pairing_words(model%contacts(i)%pairing, points), 'pairing')
               call members%put(gaps(1), 'smallest_initial_gap')
               call members%put(gaps(2), 'largest_initial_gap')
               call members%close('}')
            end do
            call members%close('}')
         end if
         call print_document('check', path, status, deck%messages, members)
      end if
      call simulation%release()
   end subroutine check_deck

   subroutine print_deck(model, simulation, run)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(run_summary_type), intent(in) :: run
      type(run_entry_type), allocatable :: entries(:)
      type(contact_points_type) :: points(size(simulation%bodies%interfaces))
      type(string_type), dimension(size(points)) :: gaps, pairings
      character(:), allocatable :: words
      integer :: first(size(points)), i

      call print_line(output_unit, run%deck_path//': no errors, '// &
         counted(size(model%warnings), 'warning'))
      entries = run_entries(run, model)
      do i = 1, size(entries)
         if (entries(i)%is_told(in_check)) call line(entries(i)%label, entries(i)%words)
      end do
      do i = 1, size(model%interactions)
         associate (interaction => model%interactions(i))
            words = 'friction '//friction_words(interaction%friction)
            if (interaction%heat%efficiency > 0.0_dp) words = words//'; heat of friction '// &
               friction_heat_words(interaction%heat)
            if (interaction%overlap%is_soft()) words = words//'; pressure '// &
               overlap_words(interaction%overlap)
            if (interaction%wear%wears()) words = words//'; wear '//wear_words(interaction%wear)
            call line('interaction '//interaction%name, words//'; conductance, open: '// &
               open_law_words(interaction%law)//'; closed: '//closed_law_words(interaction%law))
         end associate
      end do
      do i = 1, size(points)
         call simulation%bodies%view(i, points(i))
         gaps(i)%value = to_text(size(points(i)%slave))//' '//points_words(points(i))// &
            ', initial gaps '//from_to(gap_range(model%mesh, points(i)))
         pairings(i)%value = pairing_words(model%contacts(i)%pairing, points(i))
      end do
      first = first_alike([(string_type(gaps(i)%value//pairings(i)%value//open_words(points(i))// &
         model%interactions(model%contacts(i)%interaction)%name), i=1, size(points))])
      do i = 1, size(points)
         if (first(i) /= i) cycle
         call line('contact pair '//points(i)%name//alike_words(first, i), gaps(i)%value)
         call line('pairing of '//points(i)%name, pairings(i)%value)
         if (len(open_words(points(i))) > 0) call line('note on '//points(i)%name, &
            open_words(points(i)))
      end do
      if (run%has_biot) call line('contact Biot number', from_to(run%contact_biot)// &
         ' at the initial gaps')
   end subroutine print_deck

   subroutine line(name, value)
      character(*), intent(in) :: name, value

      call print_line(output_unit, '   '//name//' '//repeat('.', &
         max(26 - character_count(name), 2))//' '//value)
   end subroutine line

end module run_description
