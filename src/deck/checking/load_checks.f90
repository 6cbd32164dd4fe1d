!> Whether loads and supports act on something, and in a step that has use for them.
module load_checks
   use equations, only: constrained_nodes, equation_nodes
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric
   use kinds, only: dp
   use load_requests, only: request_type
   use materials, only: of_density
   use order_reduction, only: side_corners
   use steps, only: analysis_static, centrifugal_round, dof_temperature, load_body_heat, &
      load_centrifugal, load_face_heat, load_film_coefficient, load_force, load_gravity, &
      load_nodal_heat, load_pressure, load_temperature, solves_heat, solves_mechanics
   use text, only: counted, others, to_text
   implicit none
   private
   public :: check_loads, check_amplitudes, first_heat

contains

   !> Checks the requests before the model is refined.
   subroutine check_loads(deck, uses)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: uses(:, :)  !! (4, elements) elements that meet at each side
      logical :: used(0:size(deck%mesh%node_number))
      integer :: i, card

      ! Where an element is not known, no node is known to be without one.
      used = deck%has_lost('element') .or. .not. all(deck%element_valid)
      used([deck%mesh%element_nodes]) = .true.
      used(1:) = used(1:) .or. constrained_nodes(deck%model%equations, deck%model%couplings, &
         size(used) - 1) .or. equation_nodes(deck%model%bars%elongation, size(used) - 1)
      do i = 1, size(deck%model%sections)
         used(deck%model%sections(i)%reference) = .true.
      end do
      card = 0
      do i = 1, deck%loads%count
         associate (request => deck%loads%items(i))
            ! A data card may make several requests.
            if (request%card == card) cycle
            card = request%card
            select case (request%kind)
            case (load_force, load_nodal_heat)
               if (.not. (deck%has_lost('equation') .or. deck%has_lost('element') .or. &
                  all(used(request%members(deck%mesh%node_sets))))) then
                  call deck%error(request%place, trim(merge('a force', 'heat   ', &
                     request%kind == load_force))//' on a node that no element has')
               end if
            case (load_gravity)
               call check_density(request, 'GRAV', deck)
            case (load_centrifugal)
               call check_density(request, 'CENTRIF', deck)
               ! A body of revolution turns round its axis, and a plane round an axis along z.
               associate (rings => deck%mesh%element_plane(request%members( &
                  deck%mesh%element_sets)) == axisymmetric)
                  if (any(rings .neqv. request%component == centrifugal_round)) call deck%error( &
                     request%place, 'axisymmetric elements turn round the y axis, point 0, 0, '// &
                     '0, direction 0, 1, 0, others round an axis along z, direction 0, 0, 1')
               end associate
            case (load_temperature)
               if (deck%analyses_sound .and. deck%model%steps(request%step)%analysis /= &
                  analysis_static) call deck%error(request%place, 'the step solves for '// &
                  'temperatures; *BOUNDARY with degree of freedom 11 prescribes them')
            case (load_pressure, load_face_heat, load_film_coefficient)
               call check_faces(request, uses, deck)
            case default
               continue
            end select
            if (.not. deck%analyses_sound) cycle
            associate (analyses => deck%model%steps(request%step:)%analysis)
               if (is_heat(request%kind) .and. .not. any(solves_heat(analyses))) then
                  call deck%warning(request%place, 'a heat load without effect: no step from '// &
                     'here on solves heat')
               else if (request%kind /= load_temperature .and. .not. (is_heat(request%kind) .or. &
                  any(solves_mechanics(analyses)))) then
                  call deck%warning(request%place, 'a load without effect: no step from here '// &
                     'on solves mechanics')
               end if
            end associate
         end associate
      end do
      call check_boundaries(deck, used)
   end subroutine check_loads

   !> Loads of a step that add up at one location have the same time history.
   subroutine check_amplitudes(deck)
      type(deck_type), intent(inout) :: deck
      integer :: i, s

      do s = 1, size(deck%model%steps)
         associate (loads => deck%model%steps(s)%loads, requests => deck%loads%items)
            do i = 2, size(loads)
               if (loads(i)%kind /= loads(i - 1)%kind .or. loads(i)%item /= loads(i - 1)%item .or. &
                  loads(i)%component /= loads(i - 1)%component) cycle
               if (loads(i)%amplitude == loads(i - 1)%amplitude) cycle
               call deck%error(requests(findloc(requests%card, loads(i)%card, dim=1))%place, &
                  'two loads of one step at one location have different amplitudes')
               exit
            end do
         end associate
      end do
   end subroutine check_amplitudes

   !> Index of the first step that loads heat or prescribes a temperature; behind the last for none.
   pure integer function first_heat(deck)
      type(deck_type), intent(in) :: deck
      integer :: i

      first_heat = size(deck%model%steps) + 1
      do i = 1, deck%boundaries%count
         if (deck%boundaries%items(i)%component == dof_temperature) first_heat = min(first_heat, &
            max(1, deck%boundaries%items(i)%step))
      end do
      do i = 1, deck%loads%count
         if (is_heat(deck%loads%items(i)%kind)) first_heat = min(first_heat, &
            deck%loads%items(i)%step)
      end do
   end function first_heat

   pure logical function is_heat(kind)
      integer, intent(in) :: kind

      is_heat = any(kind == [load_nodal_heat, load_face_heat, load_body_heat, &
         load_film_coefficient])
   end function is_heat

   subroutine check_density(request, label, deck)
      type(request_type), intent(in) :: request
      character(*), intent(in) :: label
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: elements(:)
      integer :: i, section, m

      elements = request%members(deck%mesh%element_sets)
      do i = 1, size(elements)
         section = deck%mesh%element_section(elements(i))
         if (section == 0) cycle
         m = deck%model%sections(section)%material
         if (m == 0) cycle
         if (deck%model%materials(m)%has(of_density)) cycle
         call deck%missing(request%place, 'material '//deck%model%materials(m)%name//' has no '// &
            '*DENSITY, which '//label//' needs', '*DENSITY')
         return
      end do
   end subroutine check_density

   !> Warns of loads on sides between two elements.
   subroutine check_faces(request, uses, deck)
      type(request_type), intent(in) :: request
      integer, intent(in) :: uses(:, :)
      type(deck_type), intent(inout) :: deck
      integer, allocatable :: elements(:)

      elements = request%members(deck%mesh%element_sets)
      elements = pack(elements, uses(request%component, elements) > 1)
      if (size(elements) == 0) return
      call deck%warning(request%place, 'side '//to_text(request%component)//' of element '// &
         to_text(deck%mesh%element_number(elements(1)))//' lies inside a body; the load still '// &
         'acts there'//others(size(elements), '; elements with such a side: '))
   end subroutine check_faces

   !> Checks whether *BOUNDARY acts on something, in a step that has use for it, and says one thing.
   subroutine check_boundaries(deck, used)
      type(deck_type), intent(inout) :: deck
      logical, intent(in) :: used(0:)                      ! (0:nodes) whether elements have them
      integer, allocatable :: nodes(:)
      integer :: i, card
      logical :: unknown   ! whether an element may have the nodes

      unknown = deck%has_lost('equation') .or. deck%has_lost('element')
      card = 0
      do i = 1, deck%boundaries%count
         associate (request => deck%boundaries%items(i))
            associate (analyses => deck%model%steps(max(1, request%step):)%analysis)
               if (.not. deck%analyses_sound) then
                  continue
               else if (request%component == dof_temperature) then
                  if (.not. (any(solves_heat(analyses)) .or. deck%has_lost('heat'))) call &
                     deck%warning(request%place, 'a temperature without effect: no step from '// &
                     'here on solves heat; take *COUPLED TEMPERATURE-DISPLACEMENT', &
                     'temperature without effect')
               else if (abs(request%value) > 0.0_dp .and. .not. any(solves_mechanics( &
                  analyses))) then   ! supports of 0 do no harm
                  call deck%warning(request%place, 'a displacement without effect: no step '// &
                     'from here on solves mechanics')
               end if
            end associate
            if (request%card == card) cycle
            card = request%card
            ! As CalculiX does.
            nodes = request%members(deck%mesh%node_sets)
            nodes = pack(nodes, .not. used(nodes))
            if (size(nodes) > 0 .and. .not. unknown) call deck%warning(request%place, 'node '// &
               to_text(deck%mesh%node_number(nodes(1)))//' belongs to no element: what is '// &
               'prescribed there has no effect'//others(size(nodes), '; nodes without one: '))
         end associate
      end do
      if (any(deck%dropped)) call check_dropped(deck)
      call check_conflicts(deck)
   end subroutine check_boundaries

   !> Where ORDER=1 drops all nodes of a data card, their corners have values in their place.
   subroutine check_dropped(deck)
      type(deck_type), intent(inout) :: deck
      integer :: corners(2, size(deck%mesh%node_number)), i, j, card
      integer :: first(3, size(deck%mesh%node_number))   ! first step that gives a value
      integer, allocatable :: nodes(:)

      corners = side_corners(deck%mesh)
      first = huge(first)
      do i = deck%boundaries%count, 1, -1
         associate (request => deck%boundaries%items(i))
            first(min(request%component, 3), request%members(deck%mesh%node_sets)) = max(1, &
               request%step)
         end associate
      end do
      card = 0
      do i = 1, deck%boundaries%count
         associate (request => deck%boundaries%items(i))
            nodes = request%members(deck%mesh%node_sets)
            if (.not. all(deck%dropped(nodes)) .or. request%card == card) cycle
            do j = 1, size(nodes)
               if (all(first(min(request%component, 3), corners(:, nodes(j))) <= &
                  max(1, request%step))) cycle
               card = request%card
               call deck%error(request%place, 'ORDER=1 drops midside node '// &
                  to_text(deck%mesh%node_number(nodes(j)))//' and what is prescribed there; '// &
                  'prescribe it at the corners of its side, '// &
                  to_text(deck%mesh%node_number(corners(1, nodes(j))))//' and '// &
                  to_text(deck%mesh%node_number(corners(2, nodes(j)))))
               exit
            end do
         end associate
      end do
   end subroutine check_dropped

   !> Warns where a data card replaces what another one of the same step prescribes. What is
   !> before the first step may be replaced in it.
   subroutine check_conflicts(deck)
      type(deck_type), intent(inout) :: deck
      integer :: given(3, size(deck%mesh%node_number)), i, j, dof, n, node
      integer, allocatable :: nodes(:)

      given = 0
      do i = 1, deck%boundaries%count
         associate (request => deck%boundaries%items(i))
            if (request%step /= deck%boundaries%items(max(i - 1, 1))%step) given = 0
            dof = min(request%component, 3)
            nodes = request%members(deck%mesh%node_sets)
            n = 0
            do j = 1, size(nodes)
               if (given(dof, nodes(j)) > 0) then
                  associate (other => deck%boundaries%items(given(dof, nodes(j))))
                     if (abs(request%value - other%value) > 0.0_dp .or. (request%amplitude /= &
                        other%amplitude .and. abs(request%value) > 0.0_dp)) then
                        n = n + 1
                        if (n == 1) node = nodes(j)
                     end if
                  end associate
               end if
               given(dof, nodes(j)) = i
            end do
            if (n > 0) call deck%warning(request%place, 'node '// &
               to_text(deck%mesh%node_number(node))//': another card of this step gives degree '// &
               'of freedom '//to_text(request%component)//' another value; the last value is '// &
               'used ('//counted(n, 'node')//')')
         end associate
      end do
   end subroutine check_conflicts

end module load_checks
