!> *STEP to *END STEP -> steps with their increments; loads become requests.
module deck_builder_steps
   use card_values, only: choice, is_on, take_parameter, decimal_comma, read_row, &
      report_decimal_comma
   use cards, only: data_card_type, keyword_card_type
   use controls, only: explicit_scheme, l_stable_scheme
   use deck_builder_contact, only: build_contact_change
   use deck_builder_controls, only: build_continuation, build_fixed_point, build_print, &
      build_restart, build_start, build_thermal_scheme, read_frequency
   use deck_builder_loads, only: build_load_card
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use kinds, only: dp
   use materials, only: has_law
   use steps, only: adapts_increments, analysis_coupled, analysis_heat, analysis_static, &
      cycle_type, increment_growth, least_increment, planned_increments, smallest_part, &
      solves_heat, solves_mechanics, step_controls_type, step_type, until_displacement, &
      until_force, until_strain
   use text, only: percent, to_text
   use print_requests, only: time_points_type
   implicit none
   private
   public :: build_steps, increment_rounding

   real(dp), parameter :: increment_rounding = 1.0e-6_dp   !! a shorter rest is none, relative
   real(dp), parameter :: most_counted = 1.0e9_dp   !! increments that a message counts

   !> Cards of a step so far.
   type :: card_counts_type
      integer :: analyses = 0
      integer :: files = 0             !! *NODE FILE, *EL FILE, *CONTACT FILE
      logical :: has_amplitude = .false.   !! AMPLITUDE= on *STEP
      logical :: is_uncoupled = .false.  !! *UNCOUPLED TEMPERATURE-DISPLACEMENT
      logical :: has_prints(2) = .false.   !! *NODE PRINT, *EL PRINT
   end type card_counts_type

contains

   !> Builds all steps, in their order.
   subroutine build_steps(deck)
      type(deck_type), intent(inout) :: deck
      type(step_controls_type) :: controls
      type(card_counts_type) :: counts
      type(step_type) :: before
      logical :: has_scheme       ! whether *THERMAL SCHEME was there
      integer :: k, n

      has_scheme = .false.
      deck%analyses_sound = .not. deck%has_lost('*STEP')
      n = size(cards_of(deck%cards, 'STEP'))
      allocate(deck%model%steps(n), deck%step_place(n), deck%analysis_place(n))
      n = 0
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         select case (deck%card%name)
         case ('STEP')
            n = n + 1
            counts = card_counts_type(has_amplitude=deck%card%has('AMPLITUDE'))
            deck%step_place(n) = deck%card%place
            if (n > 1) before = deck%model%steps(n - 1)
            call begin_step(n > 1, before, deck, deck%model%steps(n))
         case ('STATIC', 'VISCO', 'HEAT TRANSFER', 'COUPLED TEMPERATURE-DISPLACEMENT', &
            'UNCOUPLED TEMPERATURE-DISPLACEMENT')
            counts%analyses = counts%analyses + 1
            if (counts%analyses > 1) call deck%error(deck%card%place, 'a second analysis in '// &
               'one step')
            if (n == 0) cycle
            ! Which increments it has depends on the scheme so far.
            deck%model%steps(n)%scheme = controls%scheme
            if (.not. has_scheme) deck%model%steps(n)%scheme = l_stable_scheme
            call build_analysis(n, counts, deck, deck%model%steps(n))
         case ('END STEP')
            if (counts%analyses > 0) cycle
            deck%analyses_sound = .false.
            call deck%missing(deck%card%place, 'the step has no *STATIC, *HEAT TRANSFER or '// &
               '*COUPLED TEMPERATURE-DISPLACEMENT')
         case ('FIXED POINT')
            call build_fixed_point(deck, controls%fixed_point)
         case ('RESTART')
            call build_restart(deck, controls)
         case ('START')
            call build_start(deck, controls%start)
         case ('THERMAL SCHEME')
            has_scheme = .true.
            call build_thermal_scheme(deck, controls%scheme)
         case ('WEAR')
            if (n > 0) call build_wear_count(deck, controls%wear_count)
         case ('CYCLE')
            call build_cycle(n, deck)
         case ('CONTINUATION')
            if (n > 0) call build_continuation(deck, deck%model%steps(n)%continuation)
         case ('BOUNDARY', 'CLOAD', 'DLOAD', 'DSLOAD', 'CFLUX', 'DFLUX', 'DSFLUX', 'FILM', &
            'SFILM', 'TEMPERATURE')
            call build_load_card(n, deck)
         case ('CHANGE FRICTION', 'FRICTION', 'MODEL CHANGE', 'CONTACT INTERFERENCE')
            call build_contact_change(k, n, deck)
         case default
            if (deck%card%meant == 'STATIC' .or. deck%card%name == 'NO ANALYSIS') then
               ! One that is refused is reported already.
               counts%analyses = counts%analyses + 1
               deck%analyses_sound = .false.
            else if (n > 0) then
               call build_output(deck, counts, deck%model%steps(n))
            end if
         end select
         if (n == 0) cycle
         ! Transients have their own scheme until the deck names one.
         associate (step => deck%model%steps(n))
            step%step_controls_type = controls
            if ((step%is_transient .or. step%is_viscous) .and. .not. has_scheme) step%scheme = &
               l_stable_scheme
            if (counts%is_uncoupled .and. .not. has_scheme) step%scheme = explicit_scheme
         end associate
      end do
      call warn_of_nlgeom(deck, deck%model%steps)
   end subroutine build_steps

   !> Reads *WEAR of a step: how many cycles the slip of this step and of later ones stands for.
   subroutine build_wear_count(deck, cycles)
      type(deck_type), intent(inout) :: deck
      real(dp), intent(inout) :: cycles

      if (size(deck%card%data) > 0) call deck%error(deck%card%data(1)%place(1), '*WEAR in a '// &
         'step has no data cards: laws of wear belong to a *SURFACE INTERACTION')
      if (deck%card%has('CYCLES')) then
         call take_parameter(deck%card, 'CYCLES', deck, cycles, '>0')
      else
         call deck%error(deck%card%place, '*WEAR in a step needs CYCLES=, for how many cycles '// &
            'its slip stands')
      end if
      if (.not. any(deck%model%interactions%wear%wears())) call deck%missing(deck%card%place, &
         'no surface interaction has a law of wear', '*WEAR')
   end subroutine build_wear_count

   !> Reads *CYCLE, whose steps stand behind it as often as it says: those that end a cycle have it.
   subroutine build_cycle(n, deck)
      integer, intent(in) :: n                            ! last step of the first cycle
      type(deck_type), intent(inout) :: deck
      type(cycle_type) :: cycle
      integer :: k, repeats

      cycle%steps = 1
      repeats = 1
      call take_parameter(deck%card, 'STEPS', deck, cycle%steps, '>=1')
      call take_parameter(deck%card, 'REPEAT', deck, repeats, '>=1')
      call take_parameter(deck%card, 'TOLERANCE', deck, cycle%tolerance, '>=0')
      select case (choice(deck%card, 'UNTIL', 'PE/U/CFN', deck, 'PE'))
      case ('U')
         cycle%until = until_displacement
      case ('CFN')
         cycle%until = until_force
      case default
         cycle%until = until_strain
      end select
      if (deck%has_errors()) return
      if (cycle%until == until_strain .and. .not. any(has_law( &
         deck%model%materials))) call deck%error(deck%card%place, 'no material yields or '// &
         'creeps, so strains of all cycles are equal; UNTIL=U or UNTIL=CFN compares '// &
         'displacements or contact forces')
      cycle%last = n + repeats*cycle%steps
      do k = n, cycle%last, cycle%steps
         deck%model%steps(k)%cycle = cycle
      end do
   end subroutine build_cycle

   !> Reads a card of a step that asks for output; others are ignored.
   subroutine build_output(deck, counts, step)
      type(deck_type), intent(inout) :: deck
      type(card_counts_type), intent(inout) :: counts
      type(step_type), intent(inout) :: step
      type(time_points_type) :: points
      integer :: frequency

      select case (deck%card%name)
      case ('NODE FILE', 'EL FILE', 'CONTACT FILE', 'NODE OUTPUT', 'ELEMENT OUTPUT', &
         'CONTACT OUTPUT')
         ! As often as the most frequent of these cards asks; FREQUENCY=0 leaves the last increment.
         call read_frequency(deck, frequency, points)
         if (counts%files == 0) step%field_points = time_points_type()
         if (allocated(points%times)) step%field_points = points
         if (frequency == 0) then
            call deck%note('*'//deck%card%name//', FREQUENCY=0: the last increment of the step '// &
               'is written')
            frequency = huge(frequency)
         end if
         if (counts%files > 0) frequency = min(frequency, step%field_frequency)
         counts%files = counts%files + 1
         step%field_frequency = frequency
      case ('NODE PRINT')
         call build_print(counts%has_prints(1), deck, step%node_prints)
      case ('EL PRINT')
         call build_print(counts%has_prints(2), deck, step%element_prints)
      case ('STABILITY')
         if (step%analysis /= analysis_coupled .or. counts%analyses == 0) call deck%error( &
            deck%card%place, '*STABILITY needs a step with *COUPLED TEMPERATURE-DISPLACEMENT '// &
            'before it: whether a state lasts is decided by heat and contact together')
         if (any(deck%model%interactions%wear%wears())) call deck%error(deck%card%place, &
            '*STABILITY is refused with *WEAR: whether a state lasts would be decided with the '// &
            'wear of its increment; leave one of them out')
         step%stability_frequency = huge(1)
         call take_parameter(deck%card, 'FREQUENCY', deck, step%stability_frequency, '>=1')
         call take_parameter(deck%card, 'MODES', deck, step%stability_modes, '>=1')
      case ('CONTACT PRINT')
         call read_frequency(deck, step%contact_print_frequency, step%contact_print_points)
      case default   ! of the model, or not known
      end select
   end subroutine build_output

   !> NLGEOM means nothing where no displacements are solved, and is warned of once elsewhere.
   subroutine warn_of_nlgeom(deck, steps)
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: steps(:)
      integer, allocatable :: places(:)

      steps%nlgeom = steps%nlgeom .and. solves_mechanics(steps%analysis)
      places = pack(cards_of(deck%cards, 'STEP'), steps%nlgeom)
      if (size(places) > 0) call deck%warning(deck%cards%keywords(places(1))%place_of('NLGEOM'), &
         'NLGEOM is not modelled: displacements and strains stay small')
   end subroutine warn_of_nlgeom

   !> Reads *STEP; output goes on as in the step before.
   subroutine begin_step(is_later, before, deck, step)
      logical, intent(in) :: is_later
      type(step_type), intent(in) :: before
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: step

      call take_parameter(deck%card, 'INC', deck, step%max_increments, '>=1')
      if (.not. deck%card%has('INC')) then
         call deck%note('*STEP without INC=: '//to_text(step%max_increments)//' increments')
      end if
      step%ramped = choice(deck%card, 'AMPLITUDE', 'RAMP/STEP', deck, 'RAMP') == 'RAMP'
      step%field_frequency = before%field_frequency
      step%field_points = before%field_points
      step%contact_print_frequency = before%contact_print_frequency
      step%contact_print_points = before%contact_print_points
      if (allocated(before%node_prints)) step%node_prints = before%node_prints
      if (allocated(before%element_prints)) step%element_prints = before%element_prints
      step%nlgeom = is_on(deck%card, 'NLGEOM', deck)
      ! A perturbation of the initial state is a step, unless contact changes with the load.
      if (.not. deck%card%has('PERTURBATION')) return
      if (is_later .or. size(deck%model%contacts) > 0) then
         call deck%error(deck%card%place_of('PERTURBATION'), &
            'PERTURBATION is refused on *STEP: '//trim(merge('steps go on from the one before', &
            'contact changes with the load  ', is_later))//'; leave it out')
      else
         call deck%note('*STEP: PERTURBATION is ignored: the step begins with the initial state')
      end if
   end subroutine begin_step

   !> Reads *STATIC, *HEAT TRANSFER or *COUPLED TEMPERATURE-DISPLACEMENT.
   subroutine build_analysis(n, counts, deck, step)
      integer, intent(in) :: n   ! number of the step
      type(card_counts_type), intent(inout) :: counts
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: step
      character(:), allocatable :: creep
      integer :: errors

      counts%is_uncoupled = deck%card%name(1:2) == 'UN'
      deck%analysis_place(n) = deck%card%place
      errors = deck%error_count()
      step%analysis = analysis_coupled
      step%is_viscous = deck%card%name == 'VISCO'
      if (deck%card%name == 'STATIC' .or. step%is_viscous) step%analysis = analysis_static
      if (deck%card%name == 'HEAT TRANSFER') step%analysis = analysis_heat
      step%is_transient = solves_heat(step%analysis) .and. deck%card%lacks('STEADY STATE')
      creep = choice(deck%card, 'CREEP', 'NONE', deck, 'NONE')
      step%creeps = (step%is_transient .or. step%is_viscous) .and. solves_mechanics( &
         step%analysis) .and. deck%card%lacks('CREEP')
      step%direct = is_on(deck%card, 'DIRECT', deck)
      call take_parameter(deck%card, 'STRAIN LIMIT', deck, step%strain_limit, '>0')
      if (size(deck%card%data) > 0) then
         call build_increments(deck%card%data(1), deck, step)
      else
         call deck%note('*'//deck%card%name//' without data: one increment, period 1')
      end if
      if (adapts_increments(step) .and. .not. has_largest(deck%card)) step%largest_increment = &
         step%period
      call build_storage(deck, step)
      if (deck%card%flawed .or. deck%error_count() > errors) then
         deck%analyses_sound = .false.
      else if (.not. adapts_increments(step)) then
         call fit_increments(n, deck, step)
      end if
      if (counts%has_amplitude .or. .not. (step%is_transient .or. step%is_viscous)) return
      step%ramped = .false.
      call deck%note('*'//deck%card%name//trim(merge(' without STEADY STATE', '                '// &
         '     ', step%is_transient))//': loads without an amplitude act at once; *STEP, '// &
         'AMPLITUDE=RAMP ramps them')
   end subroutine build_analysis

   pure logical function has_largest(card)
      type(keyword_card_type), intent(in) :: card

      has_largest = size(card%data) > 0
      if (has_largest) has_largest = card%data(1)%has(4)
   end function has_largest

   !> What a step that stores heat allows its increments, and whether strains take up heat.
   subroutine build_storage(deck, step)
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: step

      call take_parameter(deck%card, 'CETOL', deck, step%creep_tolerance, '>0')
      if (step%is_viscous) then
         call take_parameter(deck%card, 'LOCAL ERROR', deck, step%local_error, '>0')
         if (adapts_increments(step) .and. .not. deck%card%has('LOCAL ERROR')) call deck%note( &
            '*VISCO without LOCAL ERROR=: inelastic strains err in an increment by at most '// &
            percent(step%local_error)//' of the largest elastic strain')
         return
      else if (.not. step%is_transient) then
         if (deck%card%has('DELTMX') .or. deck%card%has('LOCAL ERROR') .or. deck%card%has( &
            'DILATATION')) call deck%note('*'//deck%card%name//', STEADY STATE: DELTMX=, LOCAL '// &
            'ERROR= and DILATATION= are ignored, no heat is stored')
         return
      end if
      call take_parameter(deck%card, 'DELTMX', deck, step%largest_change, '>0')
      call take_parameter(deck%card, 'LOCAL ERROR', deck, step%local_error, '>0')
      step%dilates = is_on(deck%card, 'DILATATION', deck)
      if (step%direct .and. (deck%card%has('DELTMX') .or. deck%card%has( &
         'LOCAL ERROR'))) call deck%note('*'//deck%card%name//', DIRECT: DELTMX= and LOCAL '// &
         'ERROR= are ignored, increments are fixed')
      if (adapts_increments(step) .and. .not. deck%card%has('LOCAL ERROR')) call deck%note('*'// &
         deck%card%name//' without LOCAL ERROR=: increments err by at most '//percent( &
         step%local_error)//' of the range of temperatures')
   end subroutine build_storage

   !> Increments are all as long as the first, unless INC= does not hold for these: then they grow
   !> as in CalculiX, up to the largest.
   subroutine fit_increments(n, deck, step)
      integer, intent(in) :: n                ! of the step
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: step
      character(:), allocatable :: number

      if (too_many(step)) then
         number = to_text(ceiling(min(planned_increments(step) - increment_rounding, most_counted)))
         step%grows = .not. step%direct
         if (.not. has_largest(deck%card)) step%largest_increment = step%period
         if (too_many(step)) then
            call deck%error(deck%step_place(n), 'the step takes '//number//' increments of '// &
               to_text(step%first_increment)//', more than the '//to_text(step%max_increments)// &
               ' of INC=; give INC='//number//' or a first increment of '// &
               to_text(step%period/step%max_increments))
         else
            call deck%note('*'//deck%card%name//': INC='//to_text(step%max_increments)//' is '// &
               'not enough for increments of '//to_text(step%first_increment)//'; they grow, '// &
               'each to '//to_text(increment_growth)//' times the one before, up to '//to_text( &
               step%largest_increment))
         end if
      else if (has_largest(deck%card) .and. .not. step%direct) then
         call deck%note('largest increment ignored: no increment is longer than the first')
      end if
   end subroutine fit_increments

   pure logical function too_many(step)
      type(step_type), intent(in) :: step

      too_many = planned_increments(step) > step%max_increments + increment_rounding
   end function too_many

   !> First increment, period, smallest and largest increment.
   subroutine build_increments(data, deck, step)
      type(data_card_type), intent(in) :: data             !! data card of the analysis
      type(deck_type), intent(inout) :: deck
      type(step_type), intent(inout) :: step               !! receives the times
      real(dp) :: given(5)
      integer :: comma, most
      logical :: valid

      most = merge(5, 4, step%analysis == analysis_heat)
      call read_row(data, 'first increment? >0 =1/period? >0 =1/smallest increment? >0/largest '// &
         'increment? >0'//trim(merge('/@rate', '      ', most == 5)), deck, given(:most), valid)
      step%first_increment = given(1)
      step%period = given(2)
      step%smallest_increment = min(step%first_increment, merge(max(least_increment*step%period, &
         smallest_part*step%first_increment), smallest_part*step%period, step%is_viscous))
      step%largest_increment = step%first_increment
      if (data%has(3)) step%smallest_increment = given(3)
      if (data%has(4)) step%largest_increment = given(4)
      ! With it Abaqus ends a step early.
      if (most == 5 .and. data%has(5)) call deck%warning(data%place(5), 'the fifth field, the '// &
         'rate of temperature at which END=SS ends a step, is ignored: the step lasts its period')
      if (.not. data%has(1)) call deck%note('first increment not given: 1')
      if (.not. data%has(2)) call deck%note('period not given: 1')
      if (step%direct .and. (data%has(3) .or. data%has(4))) call deck%note('smallest and '// &
         'largest increment ignored: with DIRECT increments are fixed')
      if (.not. (step%direct .or. data%has(3))) call deck%note('smallest increment not given: '// &
         to_text(step%smallest_increment))
      if (valid .and. step%first_increment > step%period) then
         call deck%error(data%place(1), 'the first increment is longer than the period; give a '// &
            'shorter one')
         valid = .false.
      else if (valid .and. step%smallest_increment > step%first_increment) then
         call deck%error(data%place(3), 'the smallest increment is longer than the first; give '// &
            'a shorter one')
         valid = .false.
      end if
      comma = decimal_comma(data)
      if (comma > 0 .and. .not. valid) call report_decimal_comma(data, comma, deck)
      if (.not. valid) then
         step%first_increment = 1.0_dp
         step%period = 1.0_dp
      else if (step%largest_increment < step%first_increment) then
         step%first_increment = step%largest_increment
         step%smallest_increment = min(step%smallest_increment, step%first_increment)
         call deck%warning(data%place(4), 'the first increment is longer than the largest, and '// &
            'is shortened to it')
      else if (step%smallest_increment < least_increment*step%period) then
         step%smallest_increment = least_increment*step%period
         call deck%note('smallest increment raised to '//to_text(step%smallest_increment)// &
            ': a smaller part of the period is lost in rounding')
      end if
   end subroutine build_increments

end module deck_builder_steps
