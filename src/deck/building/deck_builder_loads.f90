!> *BOUNDARY, *CLOAD, *DLOAD, ... -> requests, applied when all is read.
module deck_builder_loads
   use card_parameters, only: choice
   use card_values, only: check_extra, need_field, read_row, take_field
   use cards, only: data_card_type, keyword_card_type
   use deck_builder_element_loads, only: build_element_load, build_surface_load
   use deck_context, only: deck_type
   use kinds, only: dp
   use load_requests, only: request_type
   use model, only: model_type
   use spelling, only: is_slip
   use steps, only: dof_temperature, load_body_force, load_body_heat, load_centrifugal, &
      load_face_heat, load_film_coefficient, load_force, load_gravity, load_nodal_heat, &
      load_pressure, load_temperature, load_traction, step_type
   use text, only: read_real, to_text, to_upper
   use transforms, only: axis_in_plane
   implicit none
   private
   public :: build_load_card

   integer, parameter :: dof_rotation = 6   !! about z, of the reference node of a coupling
   integer, parameter :: dof_turn = 3       !! the same, of CalculiX' node of the rotation
   real(dp), parameter :: large_turn = 0.1_dp   !! [rad]; the motion errs by half of it

   character(*), parameter :: out_of_plane = &
      '*BOUNDARY: 0 on degrees of freedom 3 to 6 is ignored'

   !> Supports that are known by a name, and the degrees of freedom that each holds at 0, rotations
   !> about x, y and z as 4 to 6 among them.
   character(8), parameter :: support_names(8) = [character(8) :: 'ENCASTRE', 'PINNED', &
      'XSYMM', 'YSYMM', 'ZSYMM', 'XASYMM', 'YASYMM', 'ZASYMM']
   character(6), parameter :: support_degrees(8) = [character(6) :: '123456', '123', &
      '156', '246', '345', '234', '135', '126']

contains

   !> Takes one card of loads or prescribed values.
   subroutine build_load_card(card, step, deck)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: step                          !! index of the step, 0 before the first
      type(deck_type), intent(inout) :: deck
      type(request_type) :: request
      character(:), allocatable :: kind
      integer :: j, errors, film_amplitude

      if (step == 0 .and. card%name /= 'BOUNDARY') return
      errors = deck%error_count()
      request%step = step
      film_amplitude = 0
      kind = choice(card, 'TYPE', 'DISPLACEMENT', deck, 'DISPLACEMENT')
      call read_operation(card, step, deck)
      call deck%take_named(card, 'AMPLITUDE', 'amplitude', request%amplitude)
      request%keeps = card%has('FIXED')
      if (request%keeps .and. request%amplitude > 0) call deck%error(card%place_of('AMPLITUDE'), &
         'FIXED holds the values at the start of the step, which no amplitude changes; leave '// &
         'one of the two out')
      call deck%take_named(card, 'FILM AMPLITUDE', 'amplitude', film_amplitude)
      if (film_amplitude > 0) then
         associate (film => deck%model%amplitudes(film_amplitude))
            if (any(film%values < 0.0_dp)) call deck%error(card%place_of('FILM AMPLITUDE'), &
               'amplitude '//film%name//' becomes negative ('//to_text(minval(film%values))// &
               '), but a film coefficient must not; give factors of at least 0')
         end associate
      end if
      if (any(card%name == ['FILM ', 'SFILM'])) call note_film(card, &
         deck%model%steps(step)%ramped, deck)
      do j = 1, size(card%data)
         request%place = card%data(j)%place(1)
         if (card%name == 'BOUNDARY') then
            call build_boundary(card%data(j), request, deck)
            cycle
         end if
         deck%load_cards = deck%load_cards + 1
         request%card = deck%load_cards
         select case (card%name)
         case ('DSLOAD', 'DSFLUX', 'SFILM')
            call build_surface_load(card%name, card%data(j), request, film_amplitude, deck)
         case ('DLOAD', 'DFLUX', 'FILM')
            call build_element_load(card%name, card%data(j), request, film_amplitude, deck)
         case default
            call build_nodal_load(card%name, card%data(j), request, deck)
         end select
      end do
      if (card%name == 'BOUNDARY' .and. (card%flawed .or. deck%error_count() > errors)) then
         deck%boundaries_sound = .false.
      end if
   end subroutine build_load_card

   !> OP=NEW on the first card of its keyword in a step ends what former steps gave by it.
   subroutine read_operation(card, step, deck)
      type(keyword_card_type), intent(in) :: card
      integer, intent(in) :: step
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: operation
      logical :: first

      operation = choice(card, 'OP', 'MOD/NEW', deck, 'MOD')
      first = deck%load_step(card%known) < step
      deck%load_step(card%known) = step
      if (operation /= 'NEW' .or. step == 0) return
      if (.not. first) then
         call deck%warning(card%place_of('OP'), 'OP=NEW is ignored: it must be on the first *'// &
            card%name//' of a step')
         return
      end if
      call end_loads(card%name, deck%model%steps(step))
   end subroutine read_operation

   pure subroutine end_loads(keyword, step)
      character(*), intent(in) :: keyword
      type(step_type), intent(inout) :: step

      associate (ends => step%ends_loads)
         select case (keyword)
         case ('BOUNDARY')
            step%ends_boundaries = .true.
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
   end subroutine end_loads

   !> Notes what coefficient and sink of a film do where the card gives no amplitude.
   subroutine note_film(card, ramped, deck)
      type(keyword_card_type), intent(in) :: card
      logical, intent(in) :: ramped
      type(deck_type), intent(inout) :: deck
      character(:), allocatable :: coefficient

      if (card%has('AMPLITUDE') .and. card%has('FILM AMPLITUDE')) return
      coefficient = 'the coefficient acts fully at once'
      if (ramped) coefficient = 'the coefficient ramps over the step'
      if (card%has('AMPLITUDE')) then
         call deck%note('*'//card%name//', AMPLITUDE='//to_upper(card%text('AMPLITUDE'))// &
            ': the sink temperature follows it, '//coefficient)
      else if (card%has('FILM AMPLITUDE')) then
         call deck%note('*'//card%name//', FILM AMPLITUDE='// &
            to_upper(card%text('FILM AMPLITUDE'))// &
            ': the coefficient follows it, the sink temperature acts fully at once')
      else
         call deck%note('*'//card%name//' without amplitudes: '//coefficient//', the sink '// &
            'temperature acts fully at once')
      end if
   end subroutine note_film

   !> *CLOAD, *CFLUX: node or set, degree of freedom, value; *TEMPERATURE: node or set, value.
   subroutine build_nodal_load(keyword, data, request, deck)
      character(*), intent(in) :: keyword
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      real(dp) :: given(3)
      integer :: dof
      logical :: valid

      select case (keyword)
      case ('TEMPERATURE')
         request%kind = load_temperature
         call read_row(data, '@node or set/temperature', deck, given(:2), valid)
         request%value = given(2)
      case ('CLOAD')
         request%kind = load_force
         call read_row(data, '@node or set/#degree of freedom/force', deck, given, valid)
         request%value = given(3)
      case default
         request%kind = load_nodal_heat
         call read_row(data, '@node or set/#degree of freedom/power', deck, given, valid)
         request%value = given(3)
      end select
      call deck%need_nodes(data, 1, request%target_type, valid)
      dof = 1
      if (keyword /= 'TEMPERATURE') dof = nint(given(2))
      if (.not. valid) return
      request%component = dof
      if (keyword == 'CLOAD') request%component = place_in_plane(request, deck%model, dof)
      if (keyword == 'CLOAD' .and. (dof == dof_rotation .or. (dof == dof_turn .and. &
         names_rotation(request, deck%model)))) then
         call add_moment(data, request, deck)
      else if (keyword == 'CLOAD' .and. all(request%component /= [1, 2])) then
         call deck%error(data%place(2), 'a force acts on degree of freedom 1 or 2')
      else if (keyword == 'CFLUX' .and. dof /= dof_temperature) then
         call deck%error(data%place(2), 'heat acts on degree of freedom 11')
      else
         if (keyword == 'CFLUX') request%component = 1
         call deck%loads%add(request)
      end if
   end subroutine build_nodal_load

   !> Puts a moment on the rotation of the reference node of a coupling.
   subroutine add_moment(data, request, deck)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      integer :: i, node

      node = single_node(request, deck%model)
      i = findloc((deck%model%couplings%reference == node .or. deck%model%couplings%rotation_node &
         == node) .and. .not. deck%model%couplings%is_section(), .true., dim=1)
      if (i == 0 .or. node == 0) then
         call deck%error(data%place(2), 'a moment acts on the reference node of a *COUPLING or '// &
            '*RIGID BODY; forces act on 1 and 2')
         return
      end if
      request%set = 0
      request%item = deck%model%couplings(i)%rotation
      request%component = 1
      call deck%loads%add(request)
   end subroutine add_moment

   !> Takes one data card: node or set, first and last degree of freedom, value; or node or set and
   !> the name of a support. 0 on the degrees 3 to 6, which a plane does not have, is ignored.
   subroutine build_boundary(data, request, deck)
      type(data_card_type), intent(in) :: data
      type(request_type), intent(inout) :: request         !! step, amplitude, place
      type(deck_type), intent(inout) :: deck
      integer :: first, last, dof, support
      logical :: valid

      request%card = 1
      if (deck%boundaries%count > 0) request%card = &
         deck%boundaries%items(deck%boundaries%count)%card + 1
      valid = .true.
      request%value = 0.0_dp
      call deck%need_nodes(data, 1, request%target_type, valid)
      if (valid) then
         if (place_in_plane(request, deck%model, 1) == 0) then
            call deck%error(data%place(1), 'these nodes have axes by *TRANSFORM that differ in '// &
               'which one is out of the plane; name the nodes of each on a card')
            return
         end if
      end if
      support = findloc(support_names == to_upper(data%text(2)), .true., dim=1)
      if (support > 0) then
         call check_extra(data, 2, 'node or set, '//trim(support_names(support)), deck)
         if (valid) call hold(trim(support_degrees(support)), request, deck)
         return
      end if
      call check_name(data, deck, valid)
      if (.not. valid) return
      call read_degrees(data, deck, first, last, request%value, valid)
      if (.not. valid) return
      do dof = first, last
         if (is_rotation(dof, request, deck%model)) then
            call add_rotations(request, deck)
            call warn_of_turn(data, request%value, deck)
            cycle
         else if (names_rotation(request, deck%model)) then
            call deck%note(out_of_plane)
            cycle
         end if
         request%component = place_in_plane(request, deck%model, dof)
         select case (request%component)
         case (1, 2, dof_temperature)
            call deck%boundaries%add(request)
         case (3:6)
            if (abs(request%value) > 0.0_dp) then
               call deck%error(data%place(4), 'degree of freedom '//to_text(dof)//' can only '// &
                  'be 0 in the plane')
               return
            end if
            call deck%note(out_of_plane)
            if (place_in_plane(request, deck%model, first) /= 3) cycle
            if (first == 3 .and. dof == last) call deck%warning(data%place(2), 'degree of '// &
               'freedom 3 does not exist in a plane model: this support is ignored')
         case default
            call deck%error(data%place(merge(2, 3, dof == first)), 'degree of freedom '// &
               to_text(dof)//'; the plane has 1, 2 and 11')
            return
         end select
      end do
   end subroutine build_boundary

   !> First and last degree of freedom, and the value.
   subroutine read_degrees(data, deck, first, last, value, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      integer, intent(out) :: first, last
      real(dp), intent(inout) :: value
      logical, intent(inout) :: valid

      first = 0
      call need_field(data, 2, 'first degree of freedom, such as 1, 2 or, of the temperature, 11', &
         deck, first, valid)
      last = first
      if (.not. valid) return
      call take_field(data, 3, 'last degree of freedom'//value_advice(data), deck, last, valid)
      call take_field(data, 4, 'value', deck, value, valid)
      call check_extra(data, 4, 'node or set, first and last degree of freedom, value', deck)
      if (last >= first .or. .not. valid) return
      call deck%error(data%place(3), 'the last degree of freedom is below the first')
      valid = .false.
   end subroutine read_degrees

   !> Shows where a value belongs that stands in the place of the last degree of freedom.
   pure function value_advice(data) result(advice)
      type(data_card_type), intent(in) :: data
      character(:), allocatable :: advice
      real(dp) :: value
      logical :: is_number

      advice = ''
      call read_real(data%text(3), value, is_number)
      if (is_number .and. size(data%fields) == 3) advice = '; the value is the fourth field: '// &
         data%text(1)//', '//data%text(2)//', '//data%text(2)//', '//data%text(3)
   end function value_advice

   !> Reports a likely misspelling of the name of a support.
   subroutine check_name(data, deck, valid)
      type(data_card_type), intent(in) :: data
      type(deck_type), intent(inout) :: deck
      logical, intent(inout) :: valid
      character(:), allocatable :: name
      integer :: i

      name = to_upper(data%text(2))
      do i = 1, size(support_names)
         if (.not. is_slip(name, trim(support_names(i)))) cycle
         call deck%error(data%place(2), 'unknown support '//name//'; the nearest known is '// &
            trim(support_names(i)))
         valid = .false.
         return
      end do
   end subroutine check_name

   !> Requests those of some degrees of freedom at 0 that the plane has.
   subroutine hold(degrees, request, deck)
      character(*), intent(in) :: degrees                  ! a digit for each
      type(request_type), intent(inout) :: request
      type(deck_type), intent(inout) :: deck
      integer :: dof, i

      do i = 1, len(degrees)
         dof = index('123456', degrees(i:i))
         request%component = place_in_plane(request, deck%model, dof)
         if (dof == dof_rotation .and. turns(request, deck%model)) then
            call add_rotations(request, deck)
         else if (request%component > 2) then
            call deck%note(out_of_plane)
         else
            call deck%boundaries%add(request)
         end if
      end do
   end subroutine hold

   !> The component of a request for a degree of freedom, as axis_in_plane.
   pure integer function place_in_plane(request, model, dof)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      integer, intent(in) :: dof

      place_in_plane = axis_in_plane(model%transforms, model%mesh%node_sets, &
         request%members(model%mesh%node_sets), dof)
   end function place_in_plane

   !> Whether the reference node of a coupling is among the nodes of a request.
   pure logical function turns(request, model)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      turns = any(is_target(model%couplings%reference, request, model) .and. .not. &
         model%couplings%is_section())
   end function turns

   !> Whether a degree of freedom of a request is the rotation of a coupling.
   pure logical function is_rotation(dof, request, model)
      integer, intent(in) :: dof
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      is_rotation = dof == dof_rotation .and. turns(request, model)
      if (names_rotation(request, model)) is_rotation = dof == dof_turn
   end function is_rotation

   !> Whether a request is for the ROT NODE= of a rigid body.
   pure logical function names_rotation(request, model)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model
      integer :: node

      node = single_node(request, model)
      names_rotation = node > 0 .and. any(model%couplings%rotation_node == node)
   end function names_rotation

   !> The node of a request for no other; else 0.
   pure integer function single_node(request, model) result(node)
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      node = 0
      associate (members => request%members(model%mesh%node_sets))
         if (size(members) == 1) node = members(1)
      end associate
   end function single_node

   elemental logical function is_target(node, request, model)
      integer, intent(in) :: node
      type(request_type), intent(in) :: request
      type(model_type), intent(in) :: model

      is_target = node > 0 .and. node == request%item
      if (request%set > 0) is_target = any(model%mesh%node_sets(request%set)%members == node)
   end function is_target

   !> Warns of a rotation that is not small.
   subroutine warn_of_turn(data, angle, deck)
      type(data_card_type), intent(in) :: data
      real(dp), intent(in) :: angle                        ! [rad]
      type(deck_type), intent(inout) :: deck

      if (abs(angle) > large_turn) call deck%warning(data%place(4), 'a rotation of '// &
         to_text(angle)//' rad is large: points move along their tangents, and gaps and '// &
         'normals stay those of the undeformed model; turn the drawing, and let the rotation '// &
         'be below '//to_text(large_turn))
   end subroutine warn_of_turn

   !> Requests the rotations of reference nodes.
   subroutine add_rotations(request, deck)
      type(request_type), intent(in) :: request
      type(deck_type), intent(inout) :: deck
      type(request_type) :: rotation
      integer :: i

      rotation = request
      rotation%set = 0
      rotation%component = 1
      do i = 1, size(deck%model%couplings)
         if (deck%model%couplings(i)%is_section()) cycle
         if (.not. (is_target(deck%model%couplings(i)%reference, request, deck%model) .or. &
            is_target(deck%model%couplings(i)%rotation_node, request, deck%model))) cycle
         rotation%item = deck%model%couplings(i)%rotation
         call deck%boundaries%add(rotation)
      end do
   end subroutine add_rotations

end module deck_builder_loads
