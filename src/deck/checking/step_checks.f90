!> Checks of steps: of those that store heat, their capacities, a start, and what DILATATION needs;
!> of those of which a branch is followed, that it is one of steady states whose loads are
!> proportional to the load factor; of pairs with SLIDING=FINITE, what these do not go with.
module step_checks
   use errors, only: place_type
   use contact_definitions, only: contact_definition_type
   use deck_context, only: deck_type
   use deck_source, only: place_type
   use deck_structure, only: cards_of
   use element_kinds, only: element_node_count
   use heat_equation, only: heat_equation_type
   use kinds, only: dp
   use materials, only: expansion_heat, follows_temperature, has_law, heat_capacity, &
      least_heat_capacity, of_density, of_elasticity, of_expansion, of_specific_heat
   use mesh, only: surface_type
   use model, only: follows_temperatures, model_type
   use steps, only: analysis_coupled, load_film_coefficient, solves_heat, step_type
   use text, only: to_text
   implicit none
   private
   public :: check_continuations, check_laws, check_storage, check_sliding

contains

   !> Reports what stands against the *CONTINUATION of each step.
   subroutine check_continuations(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: obstacle
      integer :: k, n

      n = 0
      do k = 1, size(deck%cards%keywords)
         if (deck%cards%keywords(k)%name == 'STEP') n = n + 1
         if (deck%cards%keywords(k)%name /= 'CONTINUATION' .or. n == 0) cycle
         obstacle = obstacle_of_analysis(deck%model, deck%model%steps(n))
         if (obstacle == '') obstacle = obstacle_of_loads(deck%model, n)
         if (obstacle == '') obstacle = obstacle_of_start(deck%model%steps(n))
         if (obstacle /= '') call deck%error(deck%cards%keywords(k)%place, obstacle)
      end do
   end subroutine check_continuations

   !> Why the analysis of a step has no branch of steady states; nothing where it has.
   pure function obstacle_of_analysis(model, step) result(words)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      character(:), allocatable :: words
      integer :: i

      words = ''
      if (step%is_transient) then
         words = '*CONTINUATION follows steady states, but the step stores heat; give STEADY STATE'
      else if (step%analysis /= analysis_coupled) then
         words = '*CONTINUATION needs *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, and heat'
      else if (step%scheme%name /= 'IMPLICIT') then
         words = '*CONTINUATION needs *THERMAL SCHEME, TYPE=IMPLICIT: with '// &
            trim(step%scheme%name)//' a state depends on the increments before'
      else if (any(has_law(model%materials))) then
         words = '*CONTINUATION is refused with *PLASTIC, *CREEP and *ANNEAL TEMPERATURE: what '// &
            'a material remembers depends on the loads before'
      else if (follows_temperatures(model)) then
         words = '*CONTINUATION needs properties that are the same at all temperatures'
      else if (step%restart_frequency > 0) then
         words = '*CONTINUATION keeps no states for a restart; give *RESTART, WRITE, '// &
            'FREQUENCY=0 in this step'
      end if
      if (words /= '') return
      do i = 1, size(model%contacts)
         associate (interaction => model%interactions(model%contacts(i)%interaction))
            if (interaction%wear%wears()) words = '*CONTINUATION is refused with *WEAR: what '// &
               model%contacts(i)%name//' has lost depends on the slip before'
            if (interaction%heat%efficiency <= 0.0_dp .or. interaction%heat%leaves_plane()) cycle
            words = '*CONTINUATION has no time, by which slip in '//model%contacts(i)%name// &
               ' would make heat; give *GAP HEAT GENERATION a velocity, or leave it out'
         end associate
      end do
   end function obstacle_of_analysis

   function obstacle_of_loads(model, n) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: n                  ! number of the step
      character(:), allocatable :: words
      integer :: amplitude, s

      words = ''
      amplitude = 0
      do s = 1, n
         call look_at(model%steps(s)%boundaries%amplitude, s)
         call look_at(model%steps(s)%loads%amplitude, s)
      end do
      associate (step => model%steps(n))
         if (amplitude > 0) then
            words = 'loads of *CONTINUATION are proportional to the load factor, but some '// &
               'follow amplitude '//model%amplitudes(amplitude)%name//'; leave out '// &
               'AMPLITUDE= in this step'
         else if (.not. step%ramped) then
            words = 'loads of *CONTINUATION grow with the load factor; leave out '// &
               'AMPLITUDE=STEP on *STEP'
         else if (any(step%loads%kind == load_film_coefficient) .or. &
            step%ends_loads(load_film_coefficient)) then
            words = 'films change the conduction, to which no load factor is proportional; '// &
               'give *FILM in a step before that of *CONTINUATION'
         else if (allocated(step%changes%interferences)) then
            words = 'give *CONTACT INTERFERENCE in a step before that of *CONTINUATION: the '// &
               'branch follows loads and prescribed values'
         end if
      end associate
   contains
      !> The first amplitude that loads of the step follow.
      subroutine look_at(amplitudes, given_in)
         integer, intent(in) :: amplitudes(:), given_in
         integer :: i

         do i = 1, size(amplitudes)
            if (amplitude > 0 .or. amplitudes(i) == 0) cycle
            if (given_in == n .or. model%amplitudes(amplitudes(i))%total_time) amplitude = &
               amplitudes(i)
         end do
      end subroutine look_at
   end function obstacle_of_loads

   pure function obstacle_of_start(step) result(words)
      type(step_type), intent(in) :: step
      character(:), allocatable :: words
      real(dp) :: first

      words = ''
      first = step%first_increment/step%period
      associate (range => step%continuation%range, rises => step%continuation%rises)
         if (first < range(1) .or. first > range(2) .or. abs(first - range(merge(2, 1, &
            rises))) <= 0.0_dp) words = 'the branch begins with the first increment, at load '// &
            'factor '//to_text(first)//', which must be within its range from '// &
            to_text(range(1))//' to '//to_text(range(2))//' and not at the end'
      end associate
   end function obstacle_of_start

   !> Reports what stands against materials that remember.
   subroutine check_laws(deck)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: cards(:)
      integer :: n

      if (.not. any(has_law(deck%model%materials))) then
         n = findloc(deck%model%steps%is_viscous, .true., dim=1)
         if (n > 0) call deck%note('*VISCO: no material has *PLASTIC or *CREEP')
         return
      end if
      cards = cards_of(deck%cards, 'STABILITY')
      if (size(cards) > 0) call deck%error(deck%cards%keywords(cards(1))%place, '*STABILITY is '// &
         'refused with *PLASTIC, *CREEP and *ANNEAL TEMPERATURE: whether a motion yields '// &
         'depends on its direction')
      if (.not. any(deck%model%materials%law%strains(2) > 0)) return
      cards = cards_of(deck%cards, 'CREEP')
      if (.not. any(deck%model%steps%creeps)) then
         call deck%error(deck%cards%keywords(cards(1))%place, '*CREEP needs a step in real '// &
            'time: *VISCO, or *COUPLED TEMPERATURE-DISPLACEMENT without STEADY STATE; leave '// &
            '*CREEP out')
      else if (.not. all(deck%model%steps%creeps)) then
         call deck%note('*CREEP: materials do not creep in steps without real time, such as '// &
            'step '//to_text(findloc(deck%model%steps%creeps, .false., dim=1)))
      end if
   end subroutine check_laws

   !> Reports what the steps that store heat lack, each thing once, at the first of them.
   subroutine check_storage(deck)
      type(deck_type), intent(inout) :: deck
      logical :: is_used(size(deck%model%materials))
      integer :: first, m

      first = findloc(deck%model%steps%is_transient, .true., dim=1)
      if (first == 0) return
      is_used = [(any(deck%model%sections%material == m), m=1, size(is_used))]
      m = findloc(is_used .and. deck%model%materials%has(of_specific_heat) .and. .not. &
         deck%model%materials%has(of_density), .true., dim=1)
      if (m > 0) then
         call deck%missing(deck%analysis_place(first), 'material '//deck%model%materials(m)%name// &
            ' has *SPECIFIC HEAT, but no *DENSITY: its heat capacity is the product of both', &
            '*DENSITY')
         return
      end if
      if (.not. any(is_used .and. heat_capacity(deck%model%materials) > 0.0_dp)) call &
         deck%missing(deck%analysis_place(first), 'without STEADY STATE the bodies store heat, '// &
         'but no material of theirs has *SPECIFIC HEAT and *DENSITY; give them, or STEADY STATE', &
         '*SPECIFIC HEAT')
      if (deck%temperatures%count == 0 .and. .not. any(solves_heat(deck%model%steps(:first - &
         1)%analysis))) call deck%error(deck%analysis_place(first), 'a step that stores heat '// &
         'needs temperatures to start from; give *INITIAL CONDITIONS, TYPE=TEMPERATURE, or a '// &
         'steady step before')
      call check_dilatation(deck)
   end subroutine check_storage

   !> DILATATION needs temperatures from absolute zero.
   subroutine check_dilatation(deck)
      type(deck_type), intent(inout) :: deck
      type(place_type) :: place
      character(:), allocatable :: fault
      integer :: i, n

      n = findloc(deck%model%steps%dilates, .true., dim=1)
      if (n == 0) return
      place = deck%analysis_place(n)
      fault = ''
      do i = 1, size(deck%model%sections)
         associate (used => deck%model%materials(deck%model%sections(i)%material))
            if (follows_temperature(used, of_elasticity) .or. follows_temperature(used, &
               of_expansion)) fault = 'needs *ELASTIC and *EXPANSION of one row: with tables '// &
               'over temperature the heat of strains is another one'
         end associate
      end do
      if (any(has_law(deck%model%materials))) fault = 'is refused with *PLASTIC, *CREEP and '// &
         '*ANNEAL TEMPERATURE: the heat of strains is that of elastic ones'
      if (.not. deck%model%constants%has_absolute_zero) fault = 'needs absolute temperatures; '// &
         'give *PHYSICAL CONSTANTS, ABSOLUTE ZERO='
      n = minloc(deck%model%initial_temperature, dim=1, mask=deck%mesh%node_body > 0)
      associate (zero => deck%model%constants%absolute_zero, coldest => &
         deck%model%initial_temperature(n))
         if (fault == '' .and. coldest <= zero) fault = 'needs temperatures above absolute '// &
            'zero, '//to_text(zero)//', but node '//to_text(deck%mesh%node_number(n))// &
            ' starts at '//to_text(coldest)
      end associate
      if (fault == '') then
         call check_strained_capacity(place, deck)
      else
         call deck%error(place, 'DILATATION '//fault)
      end if
   end subroutine check_dilatation

   !> The capacity at constant strain, rho c_p - T0 beta:alpha, must be positive, or heat would make
   !> bodies that cannot expand colder, without limit. What does not expand needs none.
   subroutine check_strained_capacity(place, deck)
      type(place_type), intent(in) :: place
      type(deck_type), intent(inout) :: deck
      real(dp) :: taken(size(deck%model%materials)), here, least, row
      integer :: e, m, n, hottest(size(taken))
      character(:), allocatable :: at_row

      taken = 0.0_dp
      associate (mesh => deck%mesh, start => deck%model%initial_temperature, zero => &
         deck%model%constants%absolute_zero)
         do e = 1, size(mesh%element_kind)
            m = deck%model%sections(mesh%element_section(e))%material
            associate (nodes => mesh%element_nodes(:element_node_count(mesh%element_kind(e)), e))
               n = nodes(maxloc(start(nodes), dim=1))
            end associate
            here = (start(n) - zero)*expansion_heat(deck%model%materials(m), mesh%element_plane(e))
            if (here > taken(m)) hottest(m) = n
            taken(m) = max(taken(m), here)
         end do
         do m = 1, size(taken)
            if (taken(m) <= 0.0_dp) cycle
            call least_heat_capacity(deck%model%materials(m), least, row)
            if (least > taken(m)) cycle
            at_row = ''
            if (any([follows_temperature(deck%model%materials(m), of_density), &
               follows_temperature(deck%model%materials(m), of_specific_heat)])) at_row = ' at '// &
               'temperature '//to_text(row)
            call deck%error(place, 'DILATATION: the heat capacity of material '// &
               deck%model%materials(m)%name//' at constant strain, rho c_p - T0 beta:alpha, is '// &
               to_text(least - taken(m))//', not positive: rho c_p is '//to_text(least)//at_row// &
               ', T0 is '//to_text(start(hottest(m)) - zero)//' at node '// &
               to_text(mesh%node_number(hottest(m)))//'; give *DENSITY and *SPECIFIC HEAT '// &
               'whose product is above '//to_text(taken(m))//', in the units of *ELASTIC')
         end do
      end associate
   end subroutine check_strained_capacity

   !> Errors at *CONTACT PAIR with SLIDING=FINITE beside what its contact points cannot follow; a
   !> note where Abaqus would follow sliding.
   subroutine check_sliding(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: beside
      integer, allocatable :: cards(:)
      integer :: i

      do i = 1, size(deck%model%contacts)
         associate (contact => deck%model%contacts(i))
            if (.not. contact%follows_sliding) cycle
            beside = what_is_beside(deck%model, i)
            if (len(beside) > 0) call deck%error(place_type(image=contact%card), &
               contact%title()//': SLIDING=FINITE does not go with '//beside)
         end associate
      end do
      cards = cards_of(deck%cards, 'CONTACT PAIR')
      do i = 1, size(cards)
         associate (card => deck%cards%keywords(cards(i)))
            if (card%has('SLIDING') .and. card%has('SMALL SLIDING')) then
               if (card%text('SLIDING') /= 'SMALL') call deck%error(card%place_of('SLIDING'), &
                  'SLIDING= and SMALL SLIDING contradict each other; leave one of them out')
            else if (any(deck%model%steps%nlgeom) .and. .not. (card%has('SLIDING') .or. &
               card%has('SMALL SLIDING'))) then
               call deck%note('*CONTACT PAIR without SMALL SLIDING in a deck with NLGEOM: '// &
                  'Abaqus follows sliding there; here contact points stay those of the '// &
                  'undeformed mesh without SLIDING=FINITE')
               return
            end if
         end associate
      end do
   end subroutine check_sliding

   !> What there is, and what to do; empty for nothing.
   pure function what_is_beside(model, i) result(words)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                   ! index into its contacts
      character(:), allocatable :: words
      type(heat_equation_type) :: equation
      integer :: k, s

      words = ''
      associate (contact => model%contacts(i))
         if (contact%has_clearance) words = '*CLEARANCE: gaps are those of the displaced '// &
            'faces; move the nodes instead'
         if (contact%adjusts) words = 'ADJUST=: gaps are those of the displaced faces; move '// &
            'the nodes instead'
         do k = 1, size(model%ties)
            if (share_a_face(model%mesh%surfaces, contact, model%ties(k)%faces)) words = &
               'tie '//model%ties(k)%faces%name//' of the same face: what is tied cannot slide'
         end do
      end associate
      do s = 1, size(model%steps)
         associate (step => model%steps(s), of_step => ' of step '//to_text(s))
            if (allocated(step%changes%interferences)) then
               if (any(step%changes%interferences%contact == i)) words = '*CONTACT INTERFERENCE'// &
                  of_step//'; draw the faces with their overlap'
            end if
            if (step%stability_frequency > 0) words = '*STABILITY'//of_step// &
               ', which keeps contact points where they are; give the speed of a brake, out of '// &
               'the plane, to *GAP HEAT GENERATION instead'
            if (step%continuation%is_on) words = '*CONTINUATION'//of_step// &
               ', whose branches keep contact points where they are'
            if (step%dilates) words = 'DILATATION=YES'//of_step// &
               ', whose operators keep contact points where they are'
            equation%scheme = step%scheme
            if (equation%takes_past_conductance()) words = 'the *THERMAL SCHEME'//of_step// &
               ', which asks for heat across contact points of the past; take TYPE=IMPLICIT'
         end associate
      end do
   end function what_is_beside

   !> Whether two pairs, if their surfaces are known, have a face in common.
   pure logical function share_a_face(surfaces, one, other) result(shares)
      type(surface_type), intent(in) :: surfaces(:)
      type(contact_definition_type), intent(in) :: one, other
      integer, allocatable :: mine(:, :), others(:, :)
      integer :: k

      shares = .false.
      if (min(one%slave, one%master, other%slave, other%master) == 0) return
      mine = reshape([surfaces(one%slave)%faces, surfaces(one%master)%faces], [2, &
         size(surfaces(one%slave)%faces, 2) + size(surfaces(one%master)%faces, 2)])
      others = reshape([surfaces(other%slave)%faces, surfaces(other%master)%faces], [2, &
         size(surfaces(other%slave)%faces, 2) + size(surfaces(other%master)%faces, 2)])
      shares = any([(any(mine(1, k) == others(1, :) .and. mine(2, k) == others(2, :)), &
         k=1, size(mine, 2))])
   end function share_a_face

end module step_checks
