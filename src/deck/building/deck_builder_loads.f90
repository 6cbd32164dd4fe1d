!> *BOUNDARY, *CLOAD, *DLOAD, ... -> requests, applied when all is read.
module deck_builder_loads
   use card_values, only: choice, check_extra, read_field, read_row
   use cards, only: data_card_type
   use deck_builder_element_loads, only: build_element_load
   use deck_context, only: deck_type
   use kinds, only: dp
   use load_requests, only: request_type
   use materials, only: reference_nodes
   use model, only: model_type
   use steps, only: dof_temperature, load_body_force, load_body_heat, load_centrifugal, &
      load_face_heat, load_film_coefficient, load_force, load_gravity, load_nodal_heat, &
      load_pressure, load_temperature, load_traction
   use text, only: read_real, to_text, to_upper
   use transforms, only: axis_in_plane
   implicit none
   private
   public :: build_load_card

   integer, parameter :: dof_rotation = 6   !! about z, of the reference node of a coupling
   integer, parameter :: dof_turn = 3       !! the same, of CalculiX' node of the rotation
   real(dp), parameter :: large_turn = 0.1_dp   !! [rad]; the motion errs by half of it

   !> Supports that are known by a name, and the degrees of freedom that each holds at 0, rotations
   !> about x, y and z as 4 to 6 among them.
   character(8), parameter :: support_names(8) = [character(8) :: 'ENCASTRE', 'PINNED', &
      'XSYMM', 'YSYMM', 'ZSYMM', 'XASYMM', 'YASYMM', 'ZASYMM']
   character(6), parameter :: support_degrees(8) = [character(6) :: '123456', '123', &
      '156', '246', '345', '234', '135', '126']

contains

   !> Takes one card of loads or prescribed values.
   subroutine build_load_card(step, deck)
      integer, intent(in) :: step                          !! index of the step, 0 before the first
      type(deck_type), intent(inout) :: deck
      type(request_type) :: request
      character(:), allocatable :: kind
      integer :: j, errors, film_amplitude

      if (step == 0 .and. deck%card%name /= 'BOUNDARY') return
      errors = deck%error_count()
      request%step = step
      film_amplitude = 0
      kind = choice(deck%card, 'TYPE', 'DISPLACEMENT', deck, 'DISPLACEMENT')
      call read_operation(step, deck)
      call deck%take_named('AMPLITUDE', 'amplitude', request%amplitude)
      request%keeps = deck%card%has('FIXED')
      if (request%keeps .and. request%amplitude > 0) call deck%error(deck%card%place_of( &
         'AMPLITUDE'), 'FIXED holds the values at the start of the step, which no amplitude '// &
         'changes; leave one of the two out')
      call deck%take_named('FILM AMPLITUDE', 'amplitude', film_amplitude)
      if (film_amplitude > 0) then
         associate (film => deck%model%amplitudes(film_amplitude))
            if (any(film%values < 0.0_dp)) call deck%error(deck%card%place_of('FILM AMPLITUDE'), &
               'amplitude '//film%name//' becomes negative ('//to_text(minval(film%values))// &
               '), but a film coefficient must not; give factors of at least 0')
         end associate
      end if
      if (any(deck%card%name == ['FILM ', 'SFILM'])) call note_film(deck%model%steps(step)%ramped, &
         deck)
      do j = 1, size(deck%card%data)
         request%place = deck%card%data(j)%place(1)
         if (deck%card%name == 'BOUNDARY') then
            call build_boundary(deck%card%data(j), request, deck)
            cycle
         end if
         deck%load_cards = deck%load_cards + 1
         request%card = deck%load_cards
         select case (deck%card%name)
         case ('CLOAD', 'CFLUX', 'TEMPERATURE')
            call build_nodal_load(deck%card%name, deck%card%data(j), request, deck)
         case default
            call build_element_load(deck%card%name, deck%card%data(j), request, film_amplitude, &
               deck)
         end select
      end do
      if (deck%card%name == 'BOUNDARY' .and. (deck%card%flawed .or. deck%error_count() > &
         errors)) call deck%lose('boundary')
   end subroutine build_load_card

   !> OP=NEW on the first card of its keyword in a step ends what former steps gave by it.
   subroutine read_operation(step, deck)
      integer, intent(in) :: step
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: operation
      logical :: first

      operation = choice(deck%card, 'OP', 'MOD/NEW', deck, 'MOD')
      first = deck%load_step(deck%card%known) < step
      deck%load_step(deck%card%known) = step
      if (operation /= 'NEW' .or. step == 0) return
      if (.not. first) then
         call deck%warning(deck%card%place_of('OP'), 'OP=NEW is ignored: it must be on the '// &
            'first *'//deck%card%name//' of a step')
         return
      end if
      associate (ends => deck%model%steps(step)%ends_loads)
         select case (deck%card%name)
         case ('BOUNDARY')
            deck%model%steps(step)%ends_boundaries = .true.
         case ('CLOAD')
            ! In CalculiX it ends all that acts on nodes, while that of *CFLUX ends heat alone.
            ends([load_force, load_nodal_heat]) = .true.
         case ('DLOAD')
            ends([load_pressure, load_traction, load_body_force, load_gravity, &
               load_centrifugal]) = .true.
         case ('DSLOAD')
            ends([load_pressure, load_traction]) = .true.
         case ('CFLUX')
            ends(load_nodal_heat) = .true.
         case ('DFLUX')
            ends([load_face_heat, load_body_heat]) = .true.
         case ('DSFLUX')
            ends(load_face_heat) = .true.
         case ('FILM', 'SFILM')
            ends(load_film_coefficient) = .true.
         case ('TEMPERATURE')
            ends(load_temperature) = .true.
         case default
            return
         end select
      end associate
   end subroutine read_operation

   !> Notes what coefficient and sink of a film do where one of them has no amplitude.
   subroutine note_film(ramped, deck)
      logical, intent(in) :: ramped
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: coefficient, sink

      if (deck%card%has('AMPLITUDE') .and. deck%card%has('FILM AMPLITUDE')) return
      coefficient = 'acts fully at once'
      sink = coefficient
      if (ramped) coefficient = 'ramps over the step'
      if (deck%card%has('FILM AMPLITUDE')) coefficient = 'follows '//to_upper(deck%card%text( &
         'FILM AMPLITUDE'))
      if (deck%card%has('AMPLITUDE')) sink = 'follows '//to_upper(deck%card%text('AMPLITUDE'))
      call deck%note('*'//deck%card%name//': the coefficient '//coefficient//', the sink '// &
         'temperature '//sink)
   end subroutine note_film

   !> *CLOAD, *CFLUX: node or set, degree of freedom, value; *TEMPERATURE: node or set, value.
   subroutine build_nodal_load(keyword, data, request, deck)
      character(*), intent(in) :: keyword
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: layout
      real(dp) :: given(3)
      integer, allocatable :: nodes(:)
      integer :: dof
      logical :: taken, valid

      select case (keyword)
      case ('TEMPERATURE')
         request%kind = load_temperature
         layout = '@node or set/temperature'
      case ('CLOAD')
         request%kind = load_force
         layout = '@node or set/#degree of freedom/force'
      case default
         request%kind = load_nodal_heat
         layout = '@node or set/#degree of freedom/power'
      end select
      call read_row(data, layout, deck, given, valid)
      call deck%need_target('node', data, 1, request%target_type, valid)
      if (.not. valid) return
      dof = 1
      if (keyword /= 'TEMPERATURE') dof = nint(given(2))
      request%value = given(merge(2, 3, keyword == 'TEMPERATURE'))
      request%component = dof
      taken = .false.
      if (keyword /= 'TEMPERATURE') call take_along_z(data, dof, request, deck, taken, valid)
      if (taken) return
      nodes = rotations_of(dof, request, deck%model)
      if (keyword == 'CLOAD') request%component = place_in_plane(request, deck%model, dof)
      if (keyword == 'CLOAD' .and. (dof == dof_rotation .or. size(nodes) > 0)) then
         if (size(nodes) == 0 .or. size(request%members(deck%mesh%node_sets)) /= 1) then
            call deck%error(data%place(2), 'a moment acts on the reference node of a *COUPLING '// &
               'or *RIGID BODY; forces act on 1 and 2')
            return
         end if
         request%set = 0
         request%item = nodes(1)
         request%component = 1
         call deck%loads%add(request)
      else if (keyword == 'CLOAD' .and. all(request%component /= [1, 2])) then
         call deck%error(data%place(2), 'a force acts on degree of freedom 1 or 2')
      else if (keyword == 'CFLUX' .and. dof /= dof_temperature) then
         call deck%error(data%place(2), 'heat acts on degree of freedom 11')
      else
         if (keyword == 'CFLUX') request%component = 1
         call deck%loads%add(request)
      end if
   end subroutine build_nodal_load

   !> Node or set, first and last degree of freedom, value; or node or set and name of a support.
   subroutine build_boundary(data, request, deck)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, place
      type(deck_type), intent(inout) :: deck               !! receives the requests
      integer, allocatable :: dofs(:)
      integer :: i
      logical :: valid

      request%card = 1
      if (deck%boundaries%count > 0) request%card = &
         deck%boundaries%items(deck%boundaries%count)%card + 1
      valid = .true.
      request%value = 0.0_dp
      call deck%need_target('node', data, 1, request%target_type, valid)
      if (valid) then
         if (place_in_plane(request, deck%model, 1) == 0) then
            call deck%error(data%place(1), 'these nodes have axes by *TRANSFORM that differ in '// &
               'which one is out of the plane; name the nodes of each on a card')
            return
         end if
      end if
      call read_degrees(data, deck, dofs, request%value, valid)
      do i = 1, size(dofs)
         if (valid) call add_support(data, dofs(i), request, deck, valid)
      end do
   end subroutine build_boundary

   !> Degrees of freedom from the first to the last, and the value; or those of a support.
   subroutine read_degrees(data, deck, dofs, value, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, allocatable, intent(out) :: dofs(:)
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid
      character(:), allocatable :: advice
      real(dp) :: given
      integer :: dof, first, i, last
      logical :: is_number

      dofs = [integer ::]
      i = findloc(support_names == to_upper(data%text(2)), .true., dim=1)
      if (i > 0) then
         call check_extra(data, 2, 'node or set, '//trim(support_names(i)), deck)
         dofs = [(index('123456', support_degrees(i)(dof:dof)), dof=1, &
            len_trim(support_degrees(i)))]
         return
      end if
      if (.not. valid) return
      first = 0
      call read_field(data, 2, 'first degree of freedom (1, 2 or 11) or a support such as '// &
         'ENCASTRE', deck, first, valid)
      last = first
      if (.not. valid) return
      advice = ''
      call read_real(data%text(3), given, is_number)
      if (is_number .and. size(data%fields) == 3) advice = '; the value is the fourth field: '// &
         data%text(1)//', '//data%text(2)//', '//data%text(2)//', '//data%text(3)
      call read_field(data, 3, 'last degree of freedom'//advice//'?', deck, last, valid)
      call read_field(data, 4, 'value?', deck, value, valid)
      call check_extra(data, 4, 'node or set, first and last degree of freedom, value', deck)
      dofs = [(dof, dof=first, last)]
      if (last >= first .or. .not. valid) return
      call deck%error(data%place(3), 'the last degree of freedom is below the first')
      valid = .false.
   end subroutine read_degrees

   !> Requests a degree of freedom. 0 on 3 to 6, which a plane does not have, is ignored.
   subroutine add_support(data, dof, request, deck, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: dof
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      character(*), parameter :: ignored = '*BOUNDARY: 0 on degrees of freedom 3 to 6 of nodes '// &
         'in the plane is ignored'
      type(request_type) :: rotation
      integer, allocatable :: nodes(:)
      integer :: i
      logical :: taken

      call take_along_z(data, dof, request, deck, taken, valid)
      if (taken) return
      nodes = rotations_of(dof, request, deck%model)
      if (size(nodes) > 0) then
         rotation = request
         rotation%set = 0
         rotation%component = 1
         do i = 1, size(nodes)
            rotation%item = nodes(i)
            call deck%boundaries%add(rotation)
         end do
         if (abs(request%value) > large_turn) call deck%warning(data%place(4), 'a rotation of '// &
            to_text(request%value)//' rad is large: points move along their tangents, and gaps '// &
            'and normals stay those of the undeformed model; turn the drawing, and let the '// &
            'rotation be below '//to_text(large_turn))
         return
      else if (size(rotations_of(dof_turn, request, deck%model)) > 0) then
         call deck%note(ignored)
         return
      end if
      request%component = place_in_plane(request, deck%model, dof)
      select case (request%component)
      case (1, 2, dof_temperature)
         call deck%boundaries%add(request)
      case (3:6)
         valid = abs(request%value) <= 0.0_dp
         if (.not. valid) then
            call deck%error(data%place(4), 'degree of freedom '//to_text(dof)//' can only be 0 '// &
               'in the plane; temperature is 11')
            return
         end if
         call deck%note(ignored)
         if (request%component == 3 .and. dof == 3 .and. data%text(2) == '3') call deck%warning( &
            data%place(2), 'degree of freedom 3 does not exist in a plane model: this support '// &
            'is ignored')
      case default
         call deck%error(data%place(merge(2, 3, to_text(dof) == data%text(2))), 'degree of '// &
            'freedom '//to_text(dof)//'; the plane has 1, 2 and 11')
         valid = .false.
      end select
   end subroutine add_support

   !> Takes a request for reference nodes of sections, which have degrees of freedom 3, 4 and 5.
   subroutine take_along_z(data, dof, request, deck, taken, valid)
      type(data_card_type), intent(in) :: data
      integer, intent(in) :: dof
      type(request_type), intent(in) :: request
      type(deck_type), intent(inout) :: deck
      logical, intent(out) :: taken                    ! also after an error
      logical, intent(inout) :: valid
      type(request_type) :: own
      integer, allocatable :: members(:)
      integer :: i, s

      taken = .false.
      if (all(deck%model%sections%reference(1) == 0)) return
      members = request%members(deck%mesh%node_sets)
      associate (sections => deck%model%sections, known => reference_nodes(deck%model%sections))
         i = findloc([(any(known == members(i)), i=1, size(members))], .true., dim=1)
         taken = i > 0
         if (.not. taken) return
         valid = any(dof == [3, 4, 5])
         if (.not. valid) then
            call deck%error(data%place(2), 'degree of freedom '//to_text(dof)//' of node '// &
               to_text(deck%mesh%node_number(members(i)))//', which is a REF NODE: it has 3, 4 '// &
               'and 5')
            return
         end if
         own = request
         own%set = 0
         own%component = merge(2, 1, dof == 4)
         do i = 1, size(members)
            s = findloc(sections%reference(1), members(i), dim=1)
            valid = s > 0
            if (.not. valid) then
               call deck%error(data%place(1), 'REF NODE and other nodes are in one set; name '// &
                  'them on cards of their own')
               return
            end if
            own%item = sections(s)%reference(merge(2, 1, dof == 5))
            if (own%kind == 0) call deck%boundaries%add(own)
            if (own%kind > 0) call deck%loads%add(own)
         end do
      end associate
   end subroutine take_along_z

   !> The component of a request for a degree of freedom, as axis_in_plane.
   pure integer function place_in_plane(request, model, dof)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      integer, intent(in) :: dof

      place_in_plane = axis_in_plane(model%transforms, model%mesh%node_sets, &
         request%members(model%mesh%node_sets), dof)
   end function place_in_plane

   !> Nodes of the rotations that a degree of freedom of a request is.
   pure function rotations_of(dof, request, model) result(nodes)
      integer, intent(in) :: dof
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      integer, allocatable :: nodes(:)
      integer :: i
      logical :: turns

      allocate (nodes(0))
      associate (members => request%members(model%mesh%node_sets))
         do i = 1, size(model%couplings)
            associate (coupling => model%couplings(i))
               if (coupling%is_section()) cycle
               turns = dof == dof_rotation .and. any(members == coupling%reference)
               if (dof == dof_turn .and. size(members) == 1) turns = members(1) == &
                  coupling%rotation_node
               if (turns) nodes = [nodes, coupling%rotation]
            end associate
         end do
      end associate
   end function rotations_of

end module deck_builder_loads
