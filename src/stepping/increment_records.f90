!> The record of a solved increment, made from its state, which it leaves as it is.
module increment_records
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use balances, only: balance_forces, balance_heat
   use conductance_laws, only: conductance, conductance_law_type
   use contact_operator, only: touches
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_slip, contact_state_type, contact_stick
   use contact_tractions, only: in_contact, no_gap, pressures, shears
   use discretisation_errors, only: recovery_type
   use due_output, only: needs_recovery, table_is_due
   use equations, only: section_nodes
   use heat_equation, only: heat_across
   use increment_data, only: increment_data_type
   use kinds, only: dp
   use loads, only: loads_type
   use model, only: model_type
   use material_laws, only: law_points_type
   use materials, only: material_axes, melts, varies
   use material_points, only: material_points_type
   use point_histories, only: point_history_type
   use melting, only: solid_fractions
   use point_materials, only: along_axes
   use print_requests, only: print_request_type
   use quadrature, only: most => most_points_of_rule, point_count
   use records, only: contact_record_type, element_points_record_type, increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use sliding_limits, only: worst_slide
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics, step_type
   use temperature_laws, only: face_temperatures_type, law_at
   use text, only: append, to_text
   use transforms, only: on_nodes
   use zone_edges, only: contact_edges, contact_profile, contact_profile_type, edges_kept, &
      stick_edges
   implicit none
   private
   public :: complete_record, contacts_of_state, note_edges

   !> Part of the contact forces that their solution loses by rounding: the spacing of numbers times
   !> the condition of the contact system, some 1e4. A sum of shear forces below it is none.
   real(dp), parameter :: no_shear = 1.0e-12_dp

contains

   !> Completes the record of an increment, which has its position in the steps and its passes, with
   !> contact state, fields and balances. What the step does not solve is as the last step that
   !> did left it; stress and flux with their errors are made where needed.
   subroutine complete_record(bodies, model, recovery, loads, data, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(recovery_type), intent(inout) :: recovery          !! stress and flux with their errors
      type(loads_type), intent(in) :: loads                   !! loads at the end of the increment
      type(increment_data_type), intent(in) :: data           !! its start
      type(solution_state_type), intent(in) :: next           !! state at the end
      type(increment_record_type), intent(inout) :: record
      logical :: recovers
      integer :: i

      associate (step => model%steps(record%step))
         recovers = needs_recovery(record, model)
         allocate (record%contacts(size(bodies%interfaces)))
         do i = 1, size(bodies%interfaces)
            record%contacts(i) = contact_record(bodies, solves_heat(step%analysis), i, next)
         end do
         record%fields%temperature = next%temperature
         if (any(melts(model%materials))) record%fields%solid_fraction = solid_fractions(model, &
            next%temperature)
         if (allocated(next%solid_time)) record%solid_time = next%solid_time
         if (solves_mechanics(step%analysis)) then
            call balance_forces(bodies, model, loads, next, record)
         else
            record%force_imbalance = ieee_value(1.0_dp, ieee_quiet_nan)
            record%contact_violation = record%force_imbalance
            if (next%has_mechanics) record%fields%reaction = next%reaction
         end if
         if (next%has_mechanics) then
            record%fields%displacement = reshape(next%displacement, [2, size(next%temperature)])
            record%fields%external_force = record%fields%reaction + on_nodes( &
               bodies%points%partners, reshape(next%force_load, shape(record%fields%reaction)))
            if (allocated(model%couplings)) record%pre_tension = &
               record%fields%external_force(1, section_nodes(model%couplings))
            if (allocated(bodies%points%along_z)) call take_along_z(bodies%points%along_z, record)
            if (recovers) call recovery%recover_stress(model, record%fields%displacement, &
               next%stress_temperature - model%initial_temperature, next%history, &
               record%fields%stress, record%stress_error)
            if (allocated(next%history)) then
               record%inelastic_strain = recovery%integration%largest_growth(model%mesh, &
                  next%history)
               if (recovers) call recovery%recover_strains(model, next%history, &
                  record%fields%inelastic_strain)
            end if
         end if
         ! The last places of the displacements change omega by more than the tolerance.
         if (allocated(record%iterations) .and. record%residual_floor > &
            step%fixed_point%tolerance) call record%warn('the contact conductance is accurate '// &
            'to ', record%residual_floor, ' only, not TOL='//to_text(step%fixed_point%tolerance)// &
            ': gaps are differences of far larger displacements, whose rounding changes it')
         call warn_of_slides(model, bodies, record)
         do i = 1, size(record%contacts)
            call note_edges(bodies%interfaces(i), record%contacts(i)%contact_state, record)
         end do
         if (solves_heat(step%analysis)) then
            if (recovers) call recovery%recover_heat_flux(model, next%temperature, &
               record%fields%heat_flux, record%heat_flux_error)
            call balance_heat(bodies, model, loads, data, next, record)
         else
            record%heat_in = ieee_value(1.0_dp, ieee_quiet_nan)
            record%heat_stored = record%heat_in
            record%heat_dilatation = record%heat_in
            record%heat_friction = record%heat_in
            record%heat_out = record%heat_in
            record%heat_imbalance = record%heat_in
            record%heat_imbalance_pointwise = record%heat_in
            record%contacts%heat_rate = record%heat_in
         end if
         if (allocated(step%element_prints)) record%element_points = points_of_elements(model, &
            recovery, step, next, record)
      end associate
   end subroutine complete_record

   !> Takes what reference nodes have from the fields.
   pure subroutine take_along_z(dofs, record)
      integer, intent(in) :: dofs(:)                         !! three a node
      type(increment_record_type), intent(inout) :: record   !! with displacements and forces
      real(dp), dimension(2*size(record%fields%displacement, 2)) :: force, displacement

      displacement = [record%fields%displacement]
      force = [record%fields%external_force]
      allocate (record%along_z(6, size(dofs)/3))
      record%along_z(:3, :) = reshape(displacement(dofs), [3, size(dofs)/3])
      record%along_z(4:, :) = reshape(force(dofs), [3, size(dofs)/3])
   end subroutine take_along_z

   !> Notes zones with more edges than are kept.
   subroutine note_edges(points, states, record)
      type(contact_points_type), intent(in) :: points        !! contact points of the interface
      integer, intent(in) :: states(:)                       !! (contact points)
      type(increment_record_type), intent(inout) :: record

      call note('contact', states /= contact_open)
      call note('stick', states == contact_stick)
   contains
      subroutine note(zone, in_zone)
         character(*), intent(in) :: zone
         logical, intent(in) :: in_zone(:)
         integer :: edges, k

         edges = count([((in_zone(k) .neqv. in_zone(k + 1)) .and. points%on_one_piece(k, k + 1), &
            k=1, size(in_zone) - 1)])
         if (edges > edges_kept) call append(record%notes, 'contact pair '//points%name// &
            ': edges of '//zone//': '//to_text(edges)//'; edges_'//zone// &
            ' of the result file and the summary have the first '//to_text(edges_kept))
      end subroutine note
   end subroutine note_edges

   !> Warns of interfaces that slide farther than their contact points allow, of many by name of the
   !> worst alone.
   pure subroutine warn_of_slides(model, bodies, record)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_record_type), intent(inout) :: record   ! with its contacts
      integer, parameter :: most_named = 5
      real(dp) :: excess(size(record%contacts)), least
      integer :: i

      excess = merge(record%contacts%slide%excess, -huge(1.0_dp), record%contacts%slide%point > 0)
      least = -huge(1.0_dp)
      do i = 1, count(record%contacts%slide%point > 0) - most_named
         least = minval(excess, mask=excess > least)
      end do
      do i = 1, size(record%contacts)
         associate (slide => record%contacts(i)%slide)
            if (slide%point == 0 .or. excess(i) <= least) cycle
            call record%warn('contact pair '//bodies%interfaces(i)%name//' slides by ', &
               slide%slip, ', too far for contact points of the undeformed mesh: slave node '// &
               to_text(model%mesh%node_number(bodies%points%slave(bodies%points%interface_start(i) &
               - 1 + slide%point)))//' '//slide%words, slide%excess)
         end associate
      end do
      associate (others => count(record%contacts%slide%point > 0 .and. excess <= least))
         if (others > 0) call record%warn('further contact pairs slide too far for contact '// &
            'points of the undeformed mesh: ', real(others, dp), '; the result file has their slip')
      end associate
   end subroutine warn_of_slides

   !> Contact state of one interface.
   pure function contact_record(bodies, with_heat, i, next) result(record)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: with_heat
      integer, intent(in) :: i
      type(solution_state_type), intent(in) :: next
      type(contact_record_type) :: record
      type(contact_points_type) :: points
      logical, allocatable :: closed(:), rests(:)
      integer :: first, last

      first = bodies%points%interface_start(i)
      last = bodies%points%interface_start(i + 1) - 1
      call bodies%view(i, points)
      associate (contact => next%contact)
         record%contact_state = contact%contact_state(first:last)
         record%gap = contact%gap(first:last)
         where (touches(record%contact_state, record%gap) .and. .not. &
            bodies%laws%removed(first:last)) record%contact_state = max(record%contact_state, &
            contact_slip)
         where (next%idle(first:last)) record%contact_state = merge(contact_slip, contact_open, &
            next%resting(first:last))
         record%smallest_gap = next%smallest_gap(first:last)
         closed = record%contact_state /= contact_open
         if (next%has_mechanics) closed = in_contact(points, closed, record%gap, &
            contact%force(first:last), bodies%equilibrium%contact%alone(first:last))
         rests = closed .and. record%contact_state == contact_open
         where (rests)
            record%contact_state = merge(contact_stick, contact_slip, &
               bodies%laws%friction(first:last)%coefficient > 0.0_dp)
            record%gap = 0.0_dp
         end where
         call measure_contact(bodies, points, contact, first, closed, record)
         record%movement = contact%tangential(first:last)
         record%slip = record%movement - contact%slip_origin(first:last)
      end associate
      if (allocated(next%wear)) then
         associate (share => bodies%laws%wear_share(first:last))
            record%wear_slave = share*next%wear(first:last)
            record%wear_master = (1.0_dp - share)*next%wear(first:last)
            record%worn_volume = [sum(share*next%worn_volume(first:last)), &
               sum((1.0_dp - share)*next%worn_volume(first:last))]
         end associate
      end if
      if (allocated(points%is_beyond)) record%is_beyond = points%is_beyond
      if (.not. points%follows_sliding) record%slide = worst_slide(points, closed, record%movement)
      if (allocated(bodies%thermal%matrix%value)) then
         allocate (record%slave_temperature(size(closed)), record%master_temperature( &
            size(closed)), source=0.0_dp)
         call points%slave_mean%add_totals(next%temperature, record%slave_temperature)
         call points%master_mean%add_totals(next%temperature, record%master_temperature)
      end if
      if (.not. with_heat) return
      record%conductance = next%flux_conductance(first:last)
      if (next%has_mechanics) call conduct_on_axis(bodies, points, next, first, closed, rests, &
         record)
      associate (jump => next%jump(first:last))
         record%heat_flux = heat_across(1.0_dp, record%conductance, jump)
         record%heat_rate = sum(heat_across(points%weight, record%conductance, jump))
      end associate
   end function contact_record

   !> Conductance of closed contact points without weight, which carry no heat: that of a resting
   !> one beside it, or the closed law's.
   pure subroutine conduct_on_axis(bodies, points, next, first, closed, rests, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_points_type), intent(in) :: points      ! of the interface
      type(solution_state_type), intent(in) :: next
      integer, intent(in) :: first                         ! its first contact point
      logical, intent(in) :: closed(:), rests(:)           ! (m) closed at all; only by its gap
      type(contact_record_type), intent(inout) :: record   ! with the conductances of the others
      type(conductance_law_type) :: law
      real(dp) :: rounding
      integer, allocatable :: around(:)
      integer :: beside, k, n

      do k = 1, size(rests)
         if (points%weight(k) > 0.0_dp .or. .not. closed(k)) cycle
         beside = 0
         associate (row => first - 1 + k)
            ! A force that a gap of rounding takes away is none.
            rounding = no_gap*points%edge(k)*bodies%equilibrium%contact%alone(row)
            if (next%contact%force(row) <= rounding) then
               ! None beside it presses. Where the law jumps, both conduct the same, between the
               ! values of the open and the closed law.
               around = points%beside(k)
               n = findloc(next%resting(first - 1 + around), .true., dim=1)
               if (n > 0 .and. .not. any(record%pressure(around) > 0.0_dp)) beside = around(n)
            end if
            if (beside > 0) then
               record%conductance(k) = record%conductance(beside)
            else if (rests(k)) then
               law = law_at(bodies%laws%conductance(row), face_temperatures_type(0.5_dp*( &
                  record%slave_temperature(k) + record%master_temperature(k)), next%jump(row)))
               record%conductance(k) = conductance(law, .true., 0.0_dp, record%pressure(k))
            end if
         end associate
      end do
   end subroutine conduct_on_axis

   !> The interfaces in a state, without slip, temperatures, conductance and heat flux.
   subroutine contacts_of_state(bodies, state, contacts)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      type(contact_record_type), allocatable, intent(out) :: contacts(:)
      type(contact_points_type) :: points
      integer :: first, i, last

      allocate (contacts(size(bodies%points%interface_start) - 1))
      associate (start => bodies%points%interface_start, contact => state%contact)
         do i = 1, size(contacts)
            first = start(i)
            last = start(i + 1) - 1
            call bodies%view(i, points)
            contacts(i)%contact_state = contact%contact_state(first:last)
            contacts(i)%gap = contact%gap(first:last)
            call measure_contact(bodies, points, contact, first, contacts(i)%contact_state /= &
               contact_open, contacts(i))
            contacts(i)%heat_rate = sum(heat_across(points%weight, &
               state%flux_conductance(first:last), state%jump(first:last)))
         end do
      end associate
   end subroutine contacts_of_state

   !> Tractions, sums and edges of an interface from its nodal forces.
   pure subroutine measure_contact(bodies, points, contact, first, closed, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_points_type), intent(in) :: points      ! the contact points of the interface
      type(contact_state_type), intent(in) :: contact      ! of all interfaces
      integer, intent(in) :: first                         ! its first contact point
      logical, intent(in) :: closed(:)                     ! (m) contact points that have a traction
      type(contact_record_type), intent(inout) :: record   ! has states and gaps
      type(contact_profile_type) :: profile
      real(dp) :: overlap(size(closed))                    ! if its nodes yielded alone [length]
      integer :: last

      last = first + size(closed) - 1
      associate (friction => bodies%laws%friction(first), &
         forces => contact%force(first:last), shear_forces => contact%shear_force(first:last))
         record%pressure = pressures(points, forces, closed)
         record%shear = shears(points, shear_forces, closed, friction, record%pressure)
         record%normal_force = sum(forces)
         record%shear_force = sum(shear_forces)
         if (abs(record%shear_force) <= no_shear*sum(abs(forces) + abs(shear_forces))) then
            record%shear_force = 0.0_dp
         end if
         overlap = 0.0_dp
         if (allocated(bodies%equilibrium%contact%nodal_stiffness)) then
            associate (stiffness => bodies%equilibrium%contact%nodal_stiffness(first:last))
               where (forces > 0.0_dp .and. stiffness > 0.0_dp) overlap = forces/stiffness
            end associate
         end if
         profile = contact_profile(points, record%contact_state, record%pressure, record%shear, &
            record%gap - overlap)
         call contact_edges(profile, record%edges_contact, record%edge_contact)
         call stick_edges(profile, friction, record%edges_stick, record%edge_stick)
      end associate
   end subroutine measure_contact

   !> One record for each *EL PRINT of a step; empty where its table is not due.
   function points_of_elements(model, recovery, step, state, increment) result(records)
      type(model_type), intent(in) :: model
      type(recovery_type), intent(inout) :: recovery
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(in) :: state            !! state at the end
      type(increment_record_type), intent(in) :: increment      !! position of the increment
      type(element_points_record_type), allocatable :: records(:)
      integer :: i

      allocate (records(size(step%element_prints)))
      do i = 1, size(records)
         if (.not. table_is_due(step%element_prints(i)%frequency, &
            step%element_prints(i)%points, increment, model)) cycle
         records(i) = points_of_set(model, recovery%integration, step%element_prints(i), &
            solves_heat(step%analysis), state)
      end do
   end function points_of_elements

   !> The points of the elements of a set. Stress belongs to the temperatures with which equilibrium
   !> was solved last.
   function points_of_set(model, fields, request, with_heat, state) result(record)
      type(model_type), intent(in) :: model
      type(material_points_type), intent(inout) :: fields       ! points of integration
      type(print_request_type), intent(in) :: request
      logical, intent(in) :: with_heat
      type(solution_state_type), intent(in) :: state
      type(element_points_record_type) :: record
      type(point_history_type) :: history
      type(law_points_type) :: response
      real(dp) :: flux(most, 2), strains(most, 10)
      integer, allocatable :: elements(:)                       ! (points)
      integer :: e, first, i, last, n

      if (allocated(state%history)) then
         history%before = state%history
         history%after = state%history
      end if
      associate (mesh => model%mesh, members => request%members(model%mesh%element_sets, &
         size(model%mesh%element_kind)))
         elements = [(spread(members(i), 1, point_count(mesh%element_kind(members(i)))), &
            i=1, size(members))]
         allocate (record%position(2, size(elements)))
         if (state%has_mechanics) allocate (record%fields%stress(4, size(elements)))
         if (with_heat) allocate (record%fields%heat_flux(2, size(elements)))
         if (allocated(state%history)) allocate (record%fields%inelastic_strain(10, size(elements)))
         if (state%has_mechanics .and. any(varies(model%materials))) call fields%set_temperature( &
            mesh, state%stress_temperature, model%initial_temperature)
         last = 0
         do while (last < size(elements))
            call next_element()
            record%position(:, first:last) = fields%positions(mesh, e)
            if (allocated(state%history)) then
               call fields%take_strains(mesh, e, state%history, strains)
               record%fields%inelastic_strain(:, first:last) = transpose(strains(:n, :))
            end if
            if (.not. state%has_mechanics) cycle
            call fields%respond(mesh, e, reshape(state%displacement, [2, &
               size(state%temperature)]), state%stress_temperature - model%initial_temperature, &
               history, response)
            record%fields%stress(:, first:last) = transpose(response%stress(:n, :))
         end do
         if (with_heat .and. any(varies(model%materials))) call fields%set_temperature(mesh, &
            state%temperature, model%initial_temperature)
         last = merge(0, size(elements), with_heat)
         do while (last < size(elements))
            call next_element()
            call fields%heat_flux(mesh, e, state%temperature, flux)
            record%fields%heat_flux(:, first:last) = transpose(flux(:n, :))
         end do
      end associate
      if (request%local_axes) call turn(model, elements, record)
   contains
      !> Goes on to the points of the element behind the last one.
      subroutine next_element()
         first = last + 1
         e = elements(first)
         n = point_count(model%mesh%element_kind(e))
         last = last + n
      end subroutine next_element
   end function points_of_set

   !> Replaces the components along x and y by those along the axes of the material.
   pure subroutine turn(model, elements, record)
      type(model_type), intent(in) :: model
      integer, intent(in) :: elements(:)                        ! (points)
      type(element_points_record_type), intent(inout) :: record
      real(dp), parameter :: of_tensor(4) = [1.0_dp, 1.0_dp, 1.0_dp, 0.5_dp]   ! angles are twice it
      real(dp) :: axes(2, 2)
      integer :: first, k

      associate (fields => record%fields)
         do k = 1, size(elements)
            axes = material_axes(model%orientations, model%sections( &
               model%mesh%element_section(elements(k)))%orientation, record%position(:, k))
            if (allocated(fields%stress)) fields%stress(:, k) = along_axes(axes, &
               fields%stress(:, k))
            if (allocated(fields%heat_flux)) fields%heat_flux(:, k) = &
               matmul(fields%heat_flux(:, k), axes)
            do first = 1, merge(6, 0, allocated(fields%inelastic_strain)), 5
               associate (strain => fields%inelastic_strain(first:first + 3, k))
                  strain = along_axes(axes, strain*of_tensor)/of_tensor
               end associate
            end do
         end do
      end associate
   end subroutine turn

end module increment_records
