!> *HEADING, *OPTIONS, *PHYSICAL CONSTANTS, *SOLVER and *REFINE.
module deck_builder_options
   use card_values, only: choice, need_parameter, needed_choice, take_parameter
   use controls, only: solver_by_size, solver_mumps, solver_skyline, tail_full, tail_sparse
   use deck_builder_rigid, only: need_faces
   use deck_context, only: deck_type
   use element_kinds, only: axisymmetric, plane_strain, plane_stress
   use model, only: refined_region_type, uncertainty_named, uncertainty_words, unit_labels_type
   use steps, only: dof_temperature
   use text, only: read_integer, to_text, to_upper
   use transforms, only: axis_in_plane
   implicit none
   private
   public :: build_options, build_load_axis, build_regions

   !> Degrees of freedom 1, 2 and 11.
   character(*), parameter :: dof_names(3) = [character(11) :: 'u_x', 'u_y', 'temperature']

   integer, parameter :: most_levels = 11   !! *REFINE: one element more often divided is too many

contains

   !> Reads *HEADING, *OPTIONS, *PHYSICAL CONSTANTS, *SOLVER and *REFINE.
   subroutine build_options(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: solver, tail
      integer :: k

      deck%model%heading = ''
      deck%model%units = unit_labels_type('', '', '', '', '')
      deck%model%solver = solver_by_size
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         select case (deck%card%name)
         case ('HEADING')
            ! That of a file that is included names a mesh.
            if (size(deck%card%data) == 0 .or. len(deck%model%heading) > 0 .or. deck%source%file( &
               deck%card%place%image) /= 1) cycle
            deck%model%heading = deck%card%data(1)%fields(1)%text
         case ('OPTIONS')
            call build_option_card(deck)
         case ('PHYSICAL CONSTANTS')
            call take_parameter(deck%card, 'ABSOLUTE ZERO', deck, &
               deck%model%constants%absolute_zero)
            call take_parameter(deck%card, 'STEFAN BOLTZMANN', deck, &
               deck%model%constants%stefan_boltzmann, '>0')
            deck%model%constants%has_absolute_zero = deck%card%has('ABSOLUTE ZERO')
            deck%model%constants%has_radiation = deck%model%constants%has_absolute_zero .and. &
               deck%card%has('STEFAN BOLTZMANN')
         case ('SOLVER')
            tail = choice(deck%card, 'TAIL', 'FULL/SPARSE', deck, '')
            if (tail == 'FULL') deck%model%tail = tail_full
            if (tail == 'SPARSE') deck%model%tail = tail_sparse
            if (deck%card%has('TAIL') .and. .not. deck%card%has('TYPE')) cycle
            solver = needed_choice(deck%card, 'TYPE', 'SKYLINE/MUMPS', deck)
            if (solver == 'SKYLINE') deck%model%solver = solver_skyline
            if (solver == 'MUMPS') deck%model%solver = solver_mumps
         case ('REFINE')
            if (deck%card%has('SURFACE') .or. deck%card%has('ELSET')) cycle
            if (deck%card%has('DISTANCE')) call deck%error(deck%card%place_of('DISTANCE'), &
               'DISTANCE= is measured from a surface or a set: give SURFACE= or ELSET= too')
            if (deck%levels_place%image > 0) call deck%error(deck%card%place, 'a second '// &
               '*REFINE of the whole model')
            deck%levels_place = deck%card%place_of('LEVELS')
            call take_levels(deck, deck%levels)
         case default
            cycle
         end select
      end do
   end subroutine build_options

   subroutine build_option_card(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: plane, rest
      character(len(deck%card%text('UNITS'))) :: words(5)
      integer :: blank, i

      plane = choice(deck%card, 'PLANE', 'STRAIN/STRESS/AXISYMMETRIC', deck, '')
      if (plane == 'STRAIN') deck%plane = plane_strain
      if (plane == 'STRESS') deck%plane = plane_stress
      if (plane == 'AXISYMMETRIC') deck%plane = axisymmetric
      if (deck%card%has('ORDER')) then
         deck%model%order_place = deck%card%place_of('ORDER')
         call take_parameter(deck%card, 'ORDER', deck, deck%order)
         if (all(deck%order /= [1, 2])) call deck%error(deck%model%order_place, 'ORDER= must '// &
            'be 1 (elements without midside nodes) or 2 (elements as they are)')
         if (deck%order /= 1) deck%order = 2
      end if
      if (deck%card%has('ERRORS')) deck%model%uncertainty = uncertainty_named(choice(deck%card, &
         'ERRORS', uncertainty_words, deck, 'LAST'))
      if (deck%card%has('LOAD')) then
         deck%load_set = to_upper(deck%card%text('LOAD'))
         deck%load_place = deck%card%place_of('LOAD')
      end if
      if (.not. deck%card%has('UNITS')) return
      ! "length stress power temperature time", the last three of which may be left out.
      rest = trim(adjustl(deck%card%text('UNITS')))
      words = ''
      do i = 1, size(words)
         blank = index(rest//' ', ' ')
         words(i) = rest(:blank - 1)
         rest = trim(adjustl(rest(blank:)))
      end do
      if (len(rest) > 0 .or. words(2) == '' .or. index(deck%card%text('UNITS'), ',') > 0) then
         call deck%error(deck%card%place_of('UNITS'), 'UNITS= has two to five words and no '// &
            'commas: length, stress, power, temperature, time')
         return
      end if
      ! Not by a constructor, in which gfortran leaks what trim makes.
      deck%model%units%length = trim(words(1))
      deck%model%units%stress = trim(words(2))
      deck%model%units%power = trim(words(3))
      deck%model%units%temperature = trim(words(4))
      deck%model%units%time = trim(words(5))
   end subroutine build_option_card

   !> Reads LEVELS= of *REFINE; 0 after an error.
   subroutine take_levels(deck, levels)
      type(deck_type), intent(inout) :: deck
      integer, intent(inout) :: levels                     !! 0 before
      character(:), allocatable :: text

      call need_parameter(deck%card, 'LEVELS', deck, text)
      call take_parameter(deck%card, 'LEVELS', deck, levels)
      if (levels >= 0 .and. levels <= most_levels) return
      call deck%error(deck%card%place_of('LEVELS'), 'LEVELS= must lie between 0 and '//to_text( &
         most_levels))
      levels = 0
   end subroutine take_levels

   !> Reads LOAD=nset,dof or node,dof of *OPTIONS: the prescribed value that the load axis follows.
   subroutine build_load_axis(deck)
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: name
      integer, allocatable :: members(:)
      integer :: comma, set, dof, i, number
      logical :: is_node, valid

      deck%model%load_label = 'time'
      if (.not. allocated(deck%load_set)) then
         call deck%note('*OPTIONS without LOAD=: the load axis is the time')
         return
      end if
      comma = index(deck%load_set, ',')
      if (comma == 0) comma = len(deck%load_set) + 1
      name = deck%load_set(:comma - 1)
      call read_integer(deck%load_set(min(comma + 1, len(deck%load_set) + 1):), dof, valid)
      call read_integer(name, number, is_node)
      set = deck%index_of('node set', name)
      is_node = is_node .and. set == 0
      members = [integer ::]
      if (set > 0) members = deck%mesh%node_sets(set)%members
      if (is_node) members = pack([deck%node_index%find(number)], deck%node_index%find(number) > 0)
      if (valid .and. size(members) > 0) dof = axis_in_plane(deck%model%transforms, &
         deck%mesh%node_sets, members, dof)
      if (.not. valid .or. .not. any(dof == [1, 2, dof_temperature])) then
         call deck%error(deck%load_place, 'LOAD= has a node or node set and a degree of '// &
            'freedom 1, 2 or 11')
         return
      end if
      if (.not. is_node) then
         call deck%look_up('node set', name, deck%load_place, set)
      else if (size(members) == 0) then
         call deck%missing(deck%load_place, 'there is no node '//name, 'node', name)
      end if
      if (size(members) == 0) return
      members = pack(members, .not. deck%dropped(members))
      if (size(members) == 0) then
         call deck%error(deck%load_place, 'ORDER=1 leaves no node of '//name//', which has '// &
            'midside nodes only; LOAD= needs one at a corner')
         return
      end if
      deck%model%load_node = members(1)
      deck%model%load_dof = dof
      deck%model%load_label = trim(dof_names(min(dof, 3)))//' of '//name
      if (deck%has_lost('boundary') .or. deck%has_lost('*STEP') .or. deck%has_lost('set')) return
      do i = 1, deck%boundaries%count
         associate (request => deck%boundaries%items(i))
            if (request%component == dof .and. any(request%members(deck%mesh%node_sets) == &
               members(1))) return
         end associate
      end do
      call deck%error(deck%load_place, 'no *BOUNDARY prescribes '//deck%model%load_label//', '// &
         'which LOAD= follows; give the value, as '//name//', '//to_text(dof)//', '//to_text( &
         dof)//', value')
   end subroutine build_load_axis

   !> Takes the *REFINE cards that name a surface or a set.
   subroutine build_regions(deck)
      type(deck_type), intent(inout) :: deck
      type(refined_region_type) :: region
      integer :: k, surface

      allocate(deck%model%regions(0))
      do k = 1, size(deck%cards%keywords)
         call deck%open_card(k)
         if (deck%card%name /= 'REFINE') cycle
         if (.not. (deck%card%has('SURFACE') .or. deck%card%has('ELSET'))) cycle
         region = refined_region_type(card=deck%card%place%image)
         call take_levels(deck, region%levels)
         if (deck%card%has('SURFACE') .and. deck%card%has('ELSET')) then
            call deck%error(deck%card%place_of('ELSET'), '*REFINE takes SURFACE= or ELSET=, '// &
               'not both; give a card for each')
         else if (deck%card%has('SURFACE')) then
            call deck%need_named('SURFACE', 'surface', surface)
            call need_faces(deck%card%place_of('SURFACE'), deck, surface)
            region%surfaces = [surface]
         else
            call deck%need_element_set(region%set)
         end if
         call take_parameter(deck%card, 'DISTANCE', deck, region%distance, '>0')
         deck%model%regions = [deck%model%regions, region]
      end do
   end subroutine build_regions

end module deck_builder_options
