!> Checks once all cards are read: whether elements, materials, surfaces and steps fit together, and
!> whether the deck uses all that it defines, for whole steps; what it does not may be a slip.
module deck_checks
   use amplitudes, only: amplitude_type, amplitude_value
   use controls, only: tail_sparse
   use deck_context, only: deck_type
   use deck_structure, only: cards_of
   use elasticity, only: equivalent_poisson
   use element_kinds, only: axisymmetric, linear_kind, plane_stress, quad8, triangle3, triangle6
   use equations, only: constrained_nodes, coupled_nodes, equation_nodes
   use kinds, only: dp, long
   use load_checks, only: check_loads
   use load_requests, only: request_list_type
   use materials, only: of_conductivity, of_elasticity
   use mesh_checks, only: check_jacobians, check_planes, check_sides, check_slenderness
   use model, only: model_type, needs_full_tail
   use refinement, only: numbering_fault
   use step_checks, only: check_sliding
   use steps, only: solves_heat, solves_mechanics
   use text, only: listed, string_type, to_text, to_upper
   implicit none
   private
   public :: check_model, check_usage

   !> Largest equivalent Poisson's ratio that is not warned of where elements lock: 0.49, which the
   !> entries of the stiffness give but for rounding.
   real(dp), parameter :: most_compressible = 0.49_dp*(1 + 1.0e-9_dp)

   integer, parameter :: most_names = 10   !! that one message lists

   !> An amplitude that ends before this part of its step is over ends long before it.
   real(dp), parameter :: long_before = 0.5_dp

   !> Part of its range by which an amplitude may leave what fixed increments see of it.
   real(dp), parameter :: most_missed = 0.01_dp

contains

   !> Checks the model before it is refined.
   subroutine check_model(deck)
      type(deck_type), intent(inout) :: deck
      integer :: uses(4, size(deck%mesh%element_number)), e, without
      logical :: inverted(size(deck%mesh%element_number))
      character(:), allocatable :: fault
      integer, allocatable :: cards(:)

      ! The mesh once it is refined.
      fault = numbering_fault(deck%mesh, size(deck%mesh%element_number)*4_long**deck%levels)
      if (len(fault) > 0) call deck%error(deck%levels_place, fault)
      e = findloc(deck%mesh%element_section, 0, dim=1)
      without = count(deck%mesh%element_section == 0)
      if (size(deck%model%sections) > 0 .and. without > 0 .and. deck%sections_sound .and. .not. &
         deck%has_lost('set')) call deck%error(deck%element_place(e), 'no *SOLID SECTION for '// &
         'element '//to_text(deck%mesh%element_number(e))//'; elements without one: '//to_text( &
         without))
      call check_materials(deck)
      ! A sparse tail has no derivatives between all contact points.
      if (deck%model%tail == tail_sparse .and. deck%analyses_sound) then
         cards = cards_of(deck%cards, 'SOLVER')
         if (needs_full_tail(deck%model)) call deck%error(deck%cards%keywords(cards(1))%place, &
            'TAIL=SPARSE does not go with *CONTINUATION, which needs derivatives between all '// &
            'contact points; leave TAIL= out')
      end if
      call check_sliding(deck)
      call check_references(deck)
      call check_planes(deck)
      call check_orientations(deck)
      call check_jacobians(deck, inverted)
      call check_slenderness(deck)
      call check_sides(deck, inverted, uses)
      call check_loads(deck, uses)
   end subroutine check_model

   !> The reference node of a section has no displacements in the plane, which other cards relate.
   subroutine check_references(deck)
      type(deck_type), intent(inout) :: deck
      logical :: related(0:size(deck%mesh%node_number))
      integer, allocatable :: cards(:)
      integer :: i

      if (all(deck%model%sections%reference(1) == 0) .or. deck%has_errors()) return
      associate (model => deck%model, n => size(deck%mesh%node_number))
         related = .false.
         related(1:) = constrained_nodes(model%equations, model%couplings, n) .or. &
            equation_nodes(model%bars%elongation, n)
         do i = 1, size(model%couplings)
            related(coupled_nodes(deck%mesh, model%couplings(i))) = .true.
         end do
         do i = 1, size(model%transforms)
            related(deck%mesh%node_sets(model%transforms(i)%set)%members) = .true.
         end do
         cards = cards_of(deck%cards, 'SOLID SECTION')
         do i = 1, size(model%sections)
            if (related(model%sections(i)%reference(1))) call deck%error(deck%cards%keywords( &
               cards(i))%place_of('REF NODE'), 'node '//to_text(deck%mesh%node_number( &
               model%sections(i)%reference(1)))//' is also on another card that moves it, such '// &
               'as *EQUATION, *TRANSFORM, *RIGID BODY or a spring')
         end do
      end associate
   end subroutine check_references

   subroutine check_materials(deck)
      type(deck_type), intent(inout) :: deck
      logical :: mechanics, heat
      integer :: m

      if (.not. deck%analyses_sound) return
      mechanics = any(solves_mechanics(deck%model%steps%analysis))
      heat = any(solves_heat(deck%model%steps%analysis))
      do m = 1, size(deck%model%materials)
         if (.not. any(deck%model%sections%material == m)) cycle
         associate (material => deck%model%materials(m), section => deck%mesh%element_section)
            if (mechanics .and. .not. material%has(of_elasticity)) call deck%missing( &
               deck%material_place(m), 'material '//material%name//' has no *ELASTIC, which a '// &
               'step with displacements needs', '*ELASTIC')
            ! Trusses do not conduct.
            if (heat .and. .not. material%has(of_conductivity) .and. any( &
               deck%model%sections(pack(section, section > 0))%material == m)) call deck%missing( &
               deck%material_place(m), 'material '//material%name//' has no *CONDUCTIVITY, '// &
               'which a step with heat needs', '*CONDUCTIVITY')
            if (.not. (mechanics .and. material%has(of_elasticity))) cycle
            if (maxval(abs(material%elasticity)) <= 0.0_dp) cycle
            if (equivalent_poisson(material%elasticity) <= most_compressible) cycle
            ! Elements with too many integration points lock; six-node triangles do not, but their
            ! mean stress scatters and does not converge.
            call warn_of_kinds(deck, m, [quad8, triangle3], 'elements such as ', ' are too stiff')
            call warn_of_kinds(deck, m, [triangle6], 'the stresses of elements such as ', ' '// &
               'scatter')
         end associate
      end do
   end subroutine check_materials

   !> Warns of the first element of some kinds that has the material and is not in plane stress.
   subroutine warn_of_kinds(deck, m, kinds, subject, trouble)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: m, kinds(:)
      character(*), intent(in) :: subject, trouble
      integer :: e, kind

      associate (mesh => deck%mesh)
         do e = 1, size(mesh%element_number)
            if (mesh%element_section(e) == 0 .or. .not. deck%element_valid(e)) cycle
            if (deck%model%sections(mesh%element_section(e))%material /= m) cycle
            if (mesh%element_plane(e) == plane_stress) cycle
            kind = mesh%element_kind(e)
            if (deck%order == 1) kind = linear_kind(kind)
            if (all(kind /= kinds)) cycle
            call deck%warning(deck%material_place(m), 'material '//deck%model%materials(m)%name// &
               ' is nearly incompressible: '//subject//to_text(mesh%element_number(e))//trouble// &
               ' with it; take '//trim(merge('CAX8R', 'CPE8R', mesh%element_plane(e) == &
               axisymmetric)))
            return
         end do
      end associate
   end subroutine warn_of_kinds

   !> The axis of a cylindrical orientation is parallel to z, where an axisymmetric model has none.
   subroutine check_orientations(deck)
      type(deck_type), intent(inout) :: deck
      integer :: e

      do e = 1, size(deck%mesh%element_number)
         if (deck%mesh%element_section(e) == 0) cycle
         if (deck%mesh%element_plane(e) /= axisymmetric) cycle
         associate (index => deck%model%sections(deck%mesh%element_section(e))%orientation)
            if (index == 0) cycle
            if (.not. deck%model%orientations(index)%cylindrical) cycle
            call deck%error(deck%element_place(e), 'element '//to_text(deck%mesh%element_number( &
               e))//' is axisymmetric: the cylindrical orientation '// &
               deck%model%orientations(index)%name//' has its axis along z')
            return
         end associate
      end do
   end subroutine check_orientations

   !> Warns of definitions without use, and of amplitudes that end long before their step or begin
   !> after it. The deck has no errors, of which these may only be the consequence.
   subroutine check_usage(deck)
      type(deck_type), intent(inout) :: deck
      logical :: told(size(deck%model%amplitudes))

      call check_names('material', deck)
      call check_names('surface interaction', deck)
      call check_names('surface', deck)
      call check_names('amplitude', deck)
      told = .false.
      call check_amplitudes(deck%boundaries, told, deck)
      call check_amplitudes(deck%loads, told, deck)
   end subroutine check_usage

   !> Warns once of the items of a noun that no card refers to. A library that a deck includes may
   !> well have more materials, interactions and amplitudes than it needs; a surface without use may
   !> be a pair that was forgotten.
   subroutine check_names(noun, deck)
      character(*), intent(in) :: noun
      type(deck_type), intent(inout) :: deck
      type(string_type), allocatable :: names(:)
      integer, allocatable :: places(:)
      integer :: i, n

      places = cards_of(deck%cards, to_upper(noun))
      places = places(deck%unused(noun, size(places)))
      if (noun /= 'surface') places = pack(places, &
         deck%source%file(deck%cards%keywords(places)%place%image) == 1)
      n = size(places)
      if (n == 0) return
      allocate (names(n))
      do i = 1, n
         names(i)%value = to_upper(deck%cards%keywords(places(i))%text('NAME'))
      end do
      call deck%warning(deck%cards%keywords(places(1))%place, 'nothing uses the '//noun// &
         trim(merge(' ', 's', n == 1))//' '//listed(names, most_names))
   end subroutine check_names

   !> Warns of amplitudes that end long before the step in which a request begins to follow them,
   !> begin after it, or have peaks within fixed increments.
   subroutine check_amplitudes(requests, told, deck)
      type(request_list_type), intent(in) :: requests
      logical, intent(inout) :: told(:)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: message
      integer, allocatable :: cards(:)
      real(dp) :: ends(2), start, last
      integer :: a, i, s

      cards = cards_of(deck%cards, 'AMPLITUDE')
      do i = 1, requests%count
         a = requests%items(i)%amplitude
         if (a == 0) cycle
         if (told(a)) cycle
         s = max(requests%items(i)%step, 1)
         start = 0.0_dp
         if (deck%model%amplitudes(a)%total_time) start = sum(deck%model%steps(:s - 1)%period)
         associate (curve => deck%model%amplitudes(a), period => deck%model%steps(s)%period)
            message = ''
            last = curve%times(size(curve%times))
            ends = start + [0.0_dp, merge(sum(deck%model%steps(s:)%period), period, &
               curve%total_time)]
            if (.not. is_level(curve) .and. abs(amplitude_value(curve, ends(1))) + &
               abs(amplitude_value(curve, ends(2))) + sum(abs(curve%values), mask=curve%times > &
               ends(1) .and. curve%times < ends(2)) <= 0.0_dp) then
               message = 'amplitude '//curve%name//' is 0 throughout step '//to_text(s)// &
                  ', which begins to use it'
               if (.not. curve%total_time) message = message//'; without TIME=TOTAL TIME its '// &
                  'times count from the start of the step'
            end if
            if (message == '') message = missed_peak(curve, deck%model, s)
            if (message == '' .and. last - start < long_before*period .and. &
               .not. is_level(curve)) message = 'amplitude '//curve%name//' ends at '// &
               to_text(last)//', long before the end of step '//to_text(s)//' at '// &
               to_text(start + period)//': its last factor, '// &
               to_text(curve%values(size(curve%values)))//', is kept'
            if (message == '') cycle
            told(a) = .true.
            call deck%warning(deck%cards%keywords(cards(a))%place, message)
         end associate
      end do
   end subroutine check_amplitudes

   !> Says which corner of an amplitude the increments of a step with DIRECT step over, farthest
   !> beyond its values at their ends; empty for none. The amplitude acts from a step on, in it
   !> alone where its times are those of the step.
   function missed_peak(curve, model, first_step) result(message)
      type(amplitude_type), intent(in) :: curve
      type(model_type), intent(in) :: model
      integer, intent(in) :: first_step
      character(:), allocatable :: message
      real(dp) :: before, beyond, ends(2), start, worst
      integer :: k, s

      message = ''
      worst = most_missed*(maxval(curve%values) - minval(curve%values))
      do s = first_step, merge(size(model%steps), first_step, curve%total_time)
         if (.not. model%steps(s)%direct) cycle
         start = 0.0_dp
         if (curve%total_time) start = sum(model%steps(:s - 1)%period)
         associate (first => model%steps(s)%first_increment, period => model%steps(s)%period)
            do k = 1, size(curve%times)
               if (curve%times(k) <= start .or. curve%times(k) >= start + period) cycle
               before = floor((curve%times(k) - start)/first)*first
               ends = [amplitude_value(curve, start + before), &
                  amplitude_value(curve, start + min(before + first, period))]
               beyond = max(curve%values(k) - maxval(ends), minval(ends) - curve%values(k))
               if (beyond <= worst) cycle
               worst = beyond
               message = 'amplitude '//curve%name//': the increments of step '//to_text(s)// &
                  ', fixed by DIRECT, step over its factor '//to_text(curve%values(k))// &
                  ' at '//to_text(curve%times(k))//', and see '//to_text(ends(1))//' and '// &
                  to_text(ends(2))//'; without DIRECT they end on its corners'
            end do
         end associate
      end do
   end function missed_peak

   !> Whether an amplitude is the same everywhere, so that it does not matter where it ends.
   pure logical function is_level(curve)
      type(amplitude_type), intent(in) :: curve

      is_level = all(abs(curve%values - curve%values(1)) <= 0.0_dp)
   end function is_level

end module deck_checks
