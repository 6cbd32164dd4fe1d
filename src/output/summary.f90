!> Results of a run in a few lines: the quantities of every interface at the last accepted
!> increment, with their numerical uncertainties.
module summary
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use contact_extents, only: is_end_of_face, rises_to_end
   use contact_points, only: contact_points_type
   use contact_quantities, only: contact_table, contact_values, end_words, estimated, &
      has_quantity, zone_words
   use contact_system, only: contact_open, contact_stick
   use increment_quantities, only: history_estimated, leading_words, stability_words
   use equations, only: section_nodes
   use field_quantities, only: maxima
   use kinds, only: dp
   use mesh, only: mesh_type
   use mesh_bodies, only: body_name
   use model, only: model_type
   use model_words, only: has_many
   use no_estimates, only: at_corner, mark_of, no_finer_value, no_reason, &
      reason_inside_step, reason_of_run, reason_without_check
   use quantity_types, only: find_quantity, needs_wear, of_interface, quantity_type
   use records, only: body_uncertainty_type, contact_record_type, increment_outcome_type, &
      increment_record_type, uncertainty_type
   use steps, only: solves_heat
   use text, only: append, few_digits, listed, or_blank, share_words, string_type, to_text
   use unit_labels, only: unit_label
   implicit none
   private
   public :: summary_type, words_of, place_words, corner_words, largest_at, heat_quantities, &
      heat_units

   integer, parameter :: most_folds = 8     !! that are listed
   integer, parameter :: most_corners = 3   !! that are named
   integer, parameter :: name_width = 17    !! columns of the name of a quantity
   integer, parameter :: value_width = 13   !! of its value
   integer, parameter :: uncertainty_width = 25   !! and of its uncertainty
   integer, parameter :: field_width = 20   !! of the name of a field's range
   integer, parameter :: step_width = 400   !! longest line of a step
   integer, parameter :: step_column = 15   !! columns of each of its numbers
   integer, parameter :: heat_column = 7 + 2*step_column   !! first column of the heat rates
   character(*), parameter :: step_quantities(3) = [character(13) :: 'normal_force', 'heat_rate', &
      'peak_pressure']
   character(*), parameter :: step_head = '  step           time   normal force      heat rate'// &
      '  peak pressure  closed'
   character(field_width), parameter :: displacement_name = 'displacement up to'
   character(*), parameter :: strain_names(2) = [character(field_width) :: &
      'plastic strain up to', 'creep strain up to']
   integer, parameter :: first_strain = size(maxima) - size(strain_names)   !! before it in maxima
   !> Volumes that the faces of an interface have lost, that of the slave first
   type(quantity_type), parameter :: worn(2) = pack(contact_table, contact_table%kind == &
      of_interface .and. contact_table%needs == needs_wear)
   character(*), parameter :: worn_faces(2) = [character(6) :: 'slave', 'master']
   !> Extremes of the temperature, and rates of heat, in the order of summary_type
   character(*), parameter :: heat_quantities(4) = [character(19) :: 'lowest_temperature', &
      'highest_temperature', 'heat_in', 'heat_out']
   character(*), parameter :: heat_units(4) = [character(11) :: 'temperature', 'temperature', &
      'power', 'power']

   integer, parameter :: many_rows = 10000

   !> Results of the last accepted increment.
   type :: summary_type
      type(increment_outcome_type) :: last                    !! its number is 0 before the first
      real(dp), allocatable :: heat(:)                        !! by heat_quantities
      !> The largest magnitude of a displacement [length]
      real(dp), allocatable :: displacement
      integer, private :: least_solid_node = 0                !! 0 where all is solid
      real(dp), private :: least_solid = 1.0_dp               !! its solid fraction [-]
      character(:), allocatable, private :: cycle             !! what the last cycle did, or none
      character(:), allocatable, private :: many_increments   !! why a step had so many, or nothing
      integer :: printed = 0                                  !! rows of tables that were asked for
      type(string_type), allocatable, private :: steps(:)     !! a line for each step and interface
      !> Load factors of the folds so far; unallocated for none
      type(string_type), allocatable, private :: folds(:)
   contains
      procedure :: take
      procedure :: add_lines
   end type summary_type

contains

   !> Takes an accepted increment.
   subroutine take(self, model, interfaces, record)
      class(summary_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      type(increment_record_type), intent(in) :: record
      character(:), allocatable :: zone
      integer :: i
      logical :: counts(size(record%fields%temperature))

      if (.not. allocated(self%steps)) allocate (self%steps(0))
      if (record%last_of_step .and. size(model%steps) > 1) then
         ! A line for each interface; of many, one of the largest values.
         if (has_many(size(interfaces))) then
            call append(self%steps, step_line(record, [(largest_at(step_quantities(i), &
               record%contacts), i=1, size(step_quantities))], closed_words(record%contacts)))
         else
            do i = 1, size(interfaces)
               zone = zone_words('edge_contact', record%contacts(i))
               if (zone == '') zone = zones('edge_contact', interfaces(i), record%contacts(i))
               call append(self%steps, step_line(record, spread(i, 1, size(step_quantities)), &
                  interfaces(i)%name//': '//zone))
            end do
         end if
      end if
      self%last = record%increment_outcome_type
      if (allocated(record%cycle)) self%cycle = record%cycle
      if (allocated(record%many_increments)) self%many_increments = record%many_increments
      if (record%is_fold) call append(self%folds, to_text(record%load_factor))
      if (allocated(self%heat)) deallocate (self%heat)
      if (allocated(self%displacement)) deallocate (self%displacement)
      associate (fields => record%fields)
         counts = model%mesh%node_body > 0
         if (allocated(fields%reaction_heat)) self%heat = [minval(fields%temperature, &
            mask=counts), maxval(fields%temperature, mask=counts), record%heat_in, record%heat_out]
         if (allocated(fields%stress)) self%displacement = maxval(norm2(fields%displacement, &
            dim=1), mask=counts)
         if (allocated(fields%solid_fraction)) then
            self%least_solid_node = minloc(fields%solid_fraction, dim=1, &
               mask=fields%solid_fraction < 1)
            self%least_solid = minval(fields%solid_fraction)
         end if
      end associate
   end subroutine take

   !> The interface with the largest magnitude of a quantity; 0 where none has a value.
   pure integer function largest_at(name, contacts)
      character(*), intent(in) :: name                        !! of a quantity of interfaces
      type(contact_record_type), intent(in) :: contacts(:)    !! all interfaces
      real(dp) :: values(size(contacts)), value(1)
      integer :: i

      do i = 1, size(contacts)
         value = contact_values(name, contacts(i))
         values(i) = abs(value(1))
      end do
      largest_at = maxloc(values, dim=1, mask=.not. ieee_is_nan(values))
   end function largest_at

   !> The end of a step: its quantities, each of an interface, and what is closed.
   function step_line(record, interface_of, closed) result(line)
      type(increment_record_type), intent(in) :: record
      integer, intent(in) :: interface_of(:)    ! (step_quantities) index, 0 where none has a value
      character(*), intent(in) :: closed
      character(:), allocatable :: line
      character(step_column) :: columns(size(step_quantities) + 1)
      real(dp) :: value(1)
      integer :: k

      columns = '-'
      columns(1) = to_text(record%time)
      do k = 1, size(step_quantities)
         if (interface_of(k) == 0) cycle
         associate (contact => record%contacts(interface_of(k)))
            if (step_quantities(k) == 'heat_rate' .and. .not. allocated(contact%heat_flux)) cycle
            value = contact_values(step_quantities(k), contact)
         end associate
         if (.not. ieee_is_nan(value(1))) columns(k + 1) = to_text(value(1))
      end do
      allocate (character(step_width) :: line)
      write (line, '(i6, *(a))') record%step, adjustr(columns), '  ', closed
      line = trim(line)
   end function step_line

   !> How many of many interfaces are closed, closed in part and open.
   pure function closed_words(contacts) result(words)
      type(contact_record_type), intent(in) :: contacts(:)
      character(:), allocatable :: words
      integer :: closed(size(contacts)), i, points(size(contacts))

      closed = [(count(contacts(i)%contact_state /= contact_open), i=1, size(contacts))]
      points = [(size(contacts(i)%contact_state), i=1, size(contacts))]
      words = to_text(count(closed == points))//' closed, '//to_text(count(closed > 0 .and. &
         closed < points))//' in part, '//to_text(count(closed == 0))//' open'
   end function closed_words

   !> Adds when that increment was and where a branch turned, then each interface with a line for
   !> each quantity that it has; none before the first increment. Without an interface, and with
   !> many, the ranges of the fields are there.
   subroutine add_lines(self, model, interfaces, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(:), allocatable :: words
      integer :: i

      if (self%last%increment == 0) return
      if (size(self%steps) > 0 .and. has_many(size(interfaces))) call append(lines, &
         'largest of all interfaces at the end of each step:')
      if (size(self%steps) > 0) call append(lines, in_columns(step_head))
      do i = 1, size(self%steps)
         call append(lines, in_columns(self%steps(i)%value))
      end do
      if (size(self%steps) > 0 .and. reason_of_run(model) == no_reason) call append(lines, &
         'the listing has their uncertainties')
      call append(lines, 'at '//when(self, or_blank(model%load_label))//':')
      if (allocated(self%folds)) call append(lines, 'the branch turns at load factor'// &
         trim(merge('s', ' ', size(self%folds) > 1))//' '//listed(self%folds, most_folds)// &
         mark_of(reason_of_run(model)))
      if (has_many(size(interfaces))) then
         call add_largest(self, model, interfaces, lines)
         call add_fields(self, model, lines)
      else
         do i = 1, size(interfaces)
            call append(lines, interfaces(i)%name)
            call add_quantities(self, model, interfaces(i), i, lines)
         end do
      end if
      if (size(interfaces) == 0) call add_fields(self, model, lines)
      if (allocated(self%last%body_uncertainties)) then
         if (has_many(size(self%last%body_uncertainties))) then
            call add_largest_maxima(model, self%last%body_uncertainties, lines)
         else
            do i = 1, size(self%last%body_uncertainties)
               call add_maxima(model, self%last%body_uncertainties(i), i, lines)
            end do
         end if
      end if
      if (allocated(self%last%pre_tension)) call add_pre_tensions(self, model, lines)
      if (allocated(self%last%inelastic_strain)) call add_strains(self, model, lines)
      if (.not. ieee_is_nan(self%last%heat_friction)) call append(lines, summary_line( &
         'heat of friction', self%last%heat_friction, history_words(self, model, &
         'heat_friction'), unit_label('power', model%units), trim(merge('in all', '      ', &
         size(interfaces) > 1))))
      if (allocated(self%last%solid_time)) call append(lines, summary_line('all solid at', &
         self%last%solid_time(1), history_words(self, model, 'solid_time'), or_blank( &
         model%units%time), ''))
      if (self%least_solid_node > 0) call append(lines, summary_line('solid fraction', &
         self%least_solid, '', '-', 'least at '//place_words(model%mesh, self%least_solid_node)))
      if (allocated(self%cycle)) call append(lines, self%cycle)
      if (allocated(self%many_increments)) call append(lines, self%many_increments)
      if (self%printed > many_rows) call append(lines, to_text(self%printed)//' rows of *NODE '// &
         'PRINT and *EL PRINT in listing and result file; FREQUENCY= prints fewer')
      words = stability_words(self%last, or_blank(model%units%time))
      if (words /= '') call append(lines, words)
      words = leading_words(self%last, or_blank(model%units%time))
      if (words /= '') call append(lines, words)
   contains
      !> A line of steps, without the column of heat rates where no step solves heat.
      pure function in_columns(line) result(told)
         character(*), intent(in) :: line
         character(:), allocatable :: told

         told = line
         if (.not. any(solves_heat(model%steps%analysis))) told = &
            line(:heat_column - 1)//line(heat_column + step_column:)
      end function in_columns
   end subroutine add_lines

   !> The forces of all pre-tension sections.
   subroutine add_pre_tensions(self, model, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(string_type), allocatable, intent(inout) :: lines(:)
      integer :: nodes(size(self%last%pre_tension)), i, reason
      real(dp) :: uncertainty

      nodes = section_nodes(model%couplings)
      if (size(nodes) == 0) return
      reason = reason_inside_step(model)
      call append(lines, 'pre-tension')
      do i = 1, size(nodes)
         uncertainty = ieee_value(1.0_dp, ieee_quiet_nan)
         if (allocated(self%last%pre_tension_uncertainties)) uncertainty = &
            self%last%pre_tension_uncertainties(i)
         if (reason == no_reason .and. ieee_is_nan(uncertainty)) reason = no_finer_value
         associate (force => self%last%pre_tension(i))
            call append(lines, summary_line('force', force, words_within(force, &
               uncertainty, reason), unit_label('stress length^2', model%units), 'node '// &
               to_text(model%mesh%node_number(nodes(i)))))
         end associate
      end do
   end subroutine add_pre_tensions

   !> The uncertainty of a quantity of the increment, or why there is none; nothing of others.
   pure function history_words(self, model, name) result(words)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      character(*), intent(in) :: name
      character(:), allocatable :: words
      integer :: q

      words = ''
      q = find_quantity(history_estimated, name)
      if (q == 0) return
      words = mark_of(reason_inside_step(model))
      if (allocated(self%last%history_uncertainties)) words = uncertainty_words( &
         self%last%history_uncertainties(q))
   end function history_words

   !> The largest inelastic strains where they are not among the maxima of bodies.
   subroutine add_strains(self, model, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(string_type), allocatable, intent(inout) :: lines(:)
      integer :: b, i, reason

      do i = 1, size(strain_names)
         b = maxloc(self%last%inelastic_strain(i, :), dim=1)
         if (self%last%inelastic_strain(i, b) <= 0.0_dp) cycle
         reason = reason_inside_step(model)
         if (allocated(self%last%body_uncertainties)) then
            if (.not. ieee_is_nan( &
               self%last%body_uncertainties(b)%maxima(first_strain + i)%value)) cycle
            if (reason == no_reason) reason = at_corner
         end if
         call append(lines, summary_line(strain_names(i), self%last%inelastic_strain(i, b), &
            mark_of(reason), '', 'body '//to_text(b)//', at integration points'))
      end do
   end subroutine add_strains

   !> The maxima of a body.
   subroutine add_maxima(model, errors, body, lines)
      type(model_type), intent(in) :: model
      type(body_uncertainty_type), intent(in) :: errors
      integer, intent(in) :: body
      type(string_type), allocatable, intent(inout) :: lines(:)
      integer :: q

      if (all(errors%node == 0) .and. size(errors%corners) == 0) return
      call append(lines, 'largest in '//body_name(model, body))
      do q = 1, size(maxima)
         if (errors%node(q) > 0) call append(lines, summary_line(trim(maxima(q)%label), &
            errors%maxima(q)%value, uncertainty_words(errors%maxima(q)), &
            unit_label(maxima(q)%unit, model%units), place_words(model%mesh, errors%node(q))))
      end do
      if (size(errors%corners) > 0) call append(lines, '  '//corner_words(model%mesh, errors))
   end subroutine add_maxima

   !> The largest maxima of many bodies, and how many have singular corners.
   subroutine add_largest_maxima(model, errors, lines)
      type(model_type), intent(in) :: model
      type(body_uncertainty_type), intent(in) :: errors(:)      ! of all bodies
      type(string_type), allocatable, intent(inout) :: lines(:)
      real(dp) :: values(size(errors))
      integer :: b, q

      call append(lines, 'largest in '//to_text(size(errors))//' bodies')
      do q = 1, size(maxima)
         values = [(errors(b)%maxima(q)%value, b=1, size(errors))]
         b = maxloc(values, dim=1, mask=.not. ieee_is_nan(values))
         if (b > 0) call append(lines, summary_line(trim(maxima(q)%label), values(b), &
            uncertainty_words(errors(b)%maxima(q)), unit_label(maxima(q)%unit, model%units), &
            'body '//to_text(b)//', '//place_words(model%mesh, errors(b)%node(q))))
      end do
      associate (cornered => count([(size(errors(b)%corners) > 0, b=1, size(errors))]))
         if (cornered > 0) call append(lines, '  '//to_text(cornered)//' of them with singular '// &
            'corners, where stress has no estimate'//trim(merge('; the listing names them', &
            '                        ', reason_of_run(model) == no_reason)))
      end associate
   end subroutine add_largest_maxima

   !> Where the maxima are.
   pure function place_words(mesh, node) result(words)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: node                  !! index
      character(:), allocatable :: words           !! such as 'node 12 (2, 0)'

      words = 'node '//to_text(mesh%node_number(node))//' ('//to_text(mesh%coordinates(1, node))// &
         ', '//to_text(mesh%coordinates(2, node))//')'
   end function place_words

   !> The singular corners round which stress is larger; nothing without any.
   pure function corner_words(mesh, errors) result(words)
      type(mesh_type), intent(in) :: mesh
      type(body_uncertainty_type), intent(in) :: errors
      character(:), allocatable :: words
      type(string_type), allocatable :: places(:)
      integer :: i

      words = ''
      if (size(errors%corners) == 0) return
      words = 'singular corner, round which stress '//trim(merge('or strain is', 'is          ', &
         any(errors%node(first_strain + 1:) > 0)))//' larger, may have no limit and has no '// &
         'estimate: '
      do i = 1, size(errors%corners)
         call append(places, place_words(mesh, errors%corners(i)))
      end do
      words = words//listed(places, most_corners)
   end function corner_words

   !> A line of the summary: a quantity, its value, its uncertainty, its unit, and where or how that
   !> is.
   pure function summary_line(name, number, uncertainty, unit, words) result(line)
      character(*), intent(in) :: name, uncertainty, unit, words
      real(dp), intent(in) :: number
      character(:), allocatable :: line
      character(max(name_width, len(name))) :: label
      character(value_width) :: value

      label = name
      value = to_text(number)
      line = trim('  '//label//adjustr(value)//uncertainty)
      if (unit /= '-') line = trim('  '//label//adjustr(value)//uncertainty//' '//unit)
      if (words /= '') line = line//', '//words
   end function summary_line

   !> The temperatures, the heat and the displacement of a deck without contact.
   subroutine add_fields(self, model, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(field_width) :: name
      integer :: i

      if (allocated(self%heat)) then
         do i = 1, size(heat_quantities)
            name = words_of(heat_quantities(i))
            call append(lines, summary_line(name, self%heat(i), history_words(self, model, &
               heat_quantities(i)), unit_label(heat_units(i), model%units), ''))
         end do
      end if
      if (allocated(self%displacement)) call append(lines, summary_line(displacement_name, &
         self%displacement, '', unit_label('length', model%units), ''))
   end subroutine add_fields

   pure function when(self, load_label) result(words)
      class(summary_type), intent(in) :: self
      character(*), intent(in) :: load_label
      character(:), allocatable :: words

      words = 'time '//to_text(self%last%time)//' (increment '//to_text(self%last%increment)//')'
      if (load_label /= '' .and. load_label /= 'time') words = words//', '//load_label//' '// &
         to_text(self%last%load)
      if (allocated(self%last%load_factor)) words = words//', load factor '//to_text( &
         self%last%load_factor)
   end function when

   !> The largest quantities of many interfaces, each with its interface.
   subroutine add_largest(self, model, interfaces, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: interfaces(:)
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(:), allocatable :: uncertainty
      real(dp) :: values(1)
      integer :: i, q

      call append(lines, 'largest in '//to_text(size(interfaces))//' interfaces ('// &
         closed_words(self%last%contacts)//'); /contact of '// &
         'the result file has every one, the listing those at the end of each step')
      do q = 1, size(estimated)
         if (estimated(q)%resolution > 0.0_dp) cycle   ! an edge, which is at its own face
         i = largest_at(estimated(q)%name, self%last%contacts)
         if (i == 0) cycle
         if (.not. is_had(estimated(q), model, i, self%last%contacts(i))) cycle
         values = contact_values(estimated(q)%name, self%last%contacts(i))
         uncertainty = mark_of(reason_inside_step(model))
         if (allocated(self%last%uncertainties)) uncertainty = uncertainty_words( &
            self%last%uncertainties(q, i))
         call append(lines, summary_line(words_of(estimated(q)%name), values(1), uncertainty, &
            unit_label(estimated(q)%unit, model%units), interfaces(i)%name))
      end do
      do q = 1, size(worn)
         i = largest_at(worn(q)%name, self%last%contacts)
         if (i > 0) call add_worn(model, self%last%contacts(i), q, ' of '//interfaces(i)%name, &
            lines)
      end do
   end subroutine add_largest

   !> The volume that a face has lost, where it has.
   subroutine add_worn(model, contact, q, of, lines)
      type(model_type), intent(in) :: model
      type(contact_record_type), intent(in) :: contact
      integer, intent(in) :: q                       ! index of `worn`
      character(*), intent(in) :: of                 ! in words, which interface
      type(string_type), allocatable, intent(inout) :: lines(:)
      real(dp) :: volume(1)

      if (.not. has_quantity(contact, needs_wear)) return
      volume = contact_values(worn(q)%name, contact)
      if (volume(1) > 0.0_dp) call append(lines, summary_line('worn volume', volume(1), &
         mark_of(reason_without_check(model)), unit_label(worn(q)%unit, model%units), &
         trim(worn_faces(q))//of))
   end subroutine add_worn

   subroutine add_quantities(self, model, points, i, lines)
      class(summary_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i                       ! number of the interface
      type(string_type), allocatable, intent(inout) :: lines(:)
      character(:), allocatable :: uncertainty, line, zone
      character(name_width) :: name
      real(dp) :: values(1)
      integer :: q

      do q = 1, size(estimated)
         if (.not. is_had(estimated(q), model, i, self%last%contacts(i))) cycle
         values = contact_values(estimated(q)%name, self%last%contacts(i))
         zone = zone_words(estimated(q)%name, self%last%contacts(i))
         name = words_of(estimated(q)%name)
         if (ieee_is_nan(values(1))) then
            if (zone /= '') call append(lines, '  '//name//repeat(' ', value_width - 4)//zone)
            cycle
         end if
         if (is_end_of_face(estimated(q), points, values(1))) then
            uncertainty = repeat(' ', uncertainty_width)
            zone = end_words(estimated(q)%name, self%last%contacts(i))
         else if (allocated(self%last%uncertainties)) then
            uncertainty = uncertainty_words(self%last%uncertainties(q, i))
         else
            uncertainty = mark_of(reason_inside_step(model))
         end if
         line = summary_line(name, values(1), uncertainty, unit_label(estimated(q)%unit, &
            model%units), zone)
         if (allocated(self%last%uncertainties) .and. estimated(q)%name == 'peak_pressure') then
            if (self%last%uncertainties(q, i)%no_estimate == no_reason .and. rises_to_end(points, &
               self%last%contacts(i))) line = line//', at an end, where it may have no limit'
         end if
         zone = zones(estimated(q)%name, points, self%last%contacts(i))
         if (zone /= '' .and. zone_words(estimated(q)%name, self%last%contacts(i)) == '') line = &
            line//', '//trim(merge('closed', 'stick ', estimated(q)%name == 'edge_contact'))// &
            ' '//zone
         call append(lines, line)
      end do
      do q = 1, size(worn)
         call add_worn(model, self%last%contacts(i), q, '', lines)
      end do
   end subroutine add_quantities

   !> The zones that an edge ends, such as 'from 0 to 7.4, width 7.4'; nothing for other quantities.
   pure function zones(name, points, contact) result(words)
      character(*), intent(in) :: name               ! of a quantity
      type(contact_points_type), intent(in) :: points
      type(contact_record_type), intent(in) :: contact
      character(:), allocatable :: words
      real(dp), allocatable :: edges(:), ends(:)
      integer, allocatable :: pieces(:)
      logical :: is_in(size(points%arc_length))
      integer :: i, k

      words = ''
      if (name == 'edge_contact') then
         is_in = contact%contact_state /= contact_open
         edges = contact%edges_contact
      else if (name == 'edge_stick') then
         is_in = contact%contact_state == contact_stick
         edges = contact%edges_stick
      else
         return
      end if
      edges = pack(edges, .not. ieee_is_nan(edges))
      pieces = points%ends()
      do i = 1, size(pieces), 2
         associate (first => pieces(i), last => pieces(i + 1), s => points%arc_length)
            ends = pack(edges, edges >= s(first) .and. edges <= s(last))
            if (is_in(first)) ends = [s(first), ends]
            if (is_in(last) .and. mod(size(ends), 2) == 1) ends = [ends, s(last)]
         end associate
         do k = 2, size(ends), 2
            if (ends(k) > ends(k - 1)) then
               words = words//', from '//to_text(ends(k - 1))//' to '//to_text(ends(k))// &
                  ', width '//to_text(ends(k) - ends(k - 1))
            else
               words = words//', at '//to_text(ends(k))
            end if
         end do
      end do
      words = words(3:)
   end function zones

   !> Whether the deck has a quantity: heat that it solves, friction in this interface.
   pure logical function is_had(quantity, model, i, contact)
      type(quantity_type), intent(in) :: quantity
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                       ! number of the interface
      type(contact_record_type), intent(in) :: contact

      is_had = has_quantity(contact, quantity%needs)
      if (quantity%is_of_friction) is_had = abs(contact%shear_force) > 0.0_dp
      if (quantity%name == 'edge_stick') is_had = abs(contact%shear_force) > 0.0_dp .or. &
         model%interactions(model%contacts(i)%interaction)%friction%coefficient > 0.0_dp
   end function is_had

   !> A name as one speaks it.
   pure function words_of(name) result(words)
      character(*), intent(in) :: name
      character(:), allocatable :: words
      integer :: k

      words = trim(name)
      k = index(words, 'edge_')
      if (k == 1) words = 'edge of '//words(6:)
      do k = 1, len(words)
         if (words(k:k) == '_') words(k:k) = ' '
      end do
   end function words_of

   !> The uncertainty of a quantity, or why there is none.
   pure function uncertainty_words(own) result(words)
      type(uncertainty_type), intent(in) :: own
      character(:), allocatable :: words

      words = words_within(own%value, own%total, own%no_estimate)
   end function uncertainty_words

   !> An uncertainty with two digits, and in per cent of a value that is not small beside it, or why
   !> there is none.
   pure function words_within(value, total, why) result(words)
      real(dp), intent(in) :: value, total
      integer, intent(in) :: why
      character(:), allocatable :: words
      character(uncertainty_width) :: column
      character(9) :: number

      if (why /= no_reason) then
         words = mark_of(why)
         return
      end if
      number = few_digits(total)
      column = ' +- '//number//share_words(total, value)
      words = column
   end function words_within

end module summary
