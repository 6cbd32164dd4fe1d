!> The record of a solved increment, made from its state, which it leaves as it is.
module increment_records
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use balances, only: contact_violation, force_residual, imbalance, scales_type
   use conductance_laws, only: conductance, conductance_law_type
   use contact_operator, only: kept_contact, unstrained_forces
   use contact_points, only: contact_points_type
   use contact_states, only: contact_state_type, contact_open, contact_slip, contact_stick
   use discretisation_errors, only: recovery_type
   use due_output, only: needs_recovery
   use element_kinds, only: axisymmetric
   use element_points, only: points_of_elements
   use heat_balance, only: balance_heat
   use increment_data, only: increment_data_type
   use friction_laws, only: friction_law_type
   use kinds, only: dp
   use loads, only: loads_type
   use mesh, only: extent_of
   use model, only: model_type
   use contact_tractions, only: in_contact, pressures, shears
   use records, only: contact_record_type, increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics, step_type
   use temperature_laws, only: face_temperatures_type, law_at
   use text, only: to_text
   use thermal_matrix, only: heat_across
   use zone_edges, only: contact_edges, contact_profile, contact_profile_type, stick_edges
   use transforms, only: on_nodes
   implicit none
   private
   public :: complete_record, measure_contact

   !> Part of K u or of the gaps below which a force or a displacement is no scale to measure by:
   !> where nothing is loaded only rounding is left of them.
   real(dp), parameter :: noise = 1.0e-6_dp
   !> Part of the contact forces that their solution loses by rounding: the spacing of numbers times
   !> the condition of the contact system, some 1e4. A sum of shear forces below it is none.
   real(dp), parameter :: no_shear = 1.0e-12_dp
   !> Displacement, in the extent of the model, below which it is no scale.
   real(dp), parameter :: least_strain = 1.0e-12_dp

contains

   !> Completes the record of an increment, which has its position in the steps and its passes, with
   !> contact state, fields and balances. What the step does not solve is as the last step that
   !> did left it; stress and flux with their errors are made where needed.
   pure subroutine complete_record(bodies, model, recovery, loads, data, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(recovery_type), intent(in) :: recovery             !! stress and flux with their errors
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
            if (recovers) call recovery%recover_stress(model, record%fields%displacement, &
               next%stress_temperature - model%initial_temperature, record%fields%stress, &
               record%stress_error)
         end if
         call warn_of_floor(step, record)
         if (solves_heat(step%analysis)) then
            if (recovers) call recovery%recover_heat_flux(model, next%temperature, &
               record%fields%heat_flux, record%heat_flux_error)
            call balance_heat(bodies, model, loads, data, next, record)
         else
            record%heat_in = ieee_value(1.0_dp, ieee_quiet_nan)
            record%heat_out = record%heat_in
            record%heat_imbalance = record%heat_in
            record%heat_imbalance_pointwise = record%heat_in
            record%contacts%heat_rate = record%heat_in
         end if
         if (allocated(step%element_prints)) then
            record%element_points = points_of_elements(model, step, next, record)
         end if
      end associate
   end subroutine complete_record

   !> Warns where the last places of the displacements change omega by more than the tolerance: the
   !> fixed point was then met no better than this.
   pure subroutine warn_of_floor(step, record)
      type(step_type), intent(in) :: step
      type(increment_record_type), intent(inout) :: record

      if (.not. allocated(record%iterations)) return
      if (record%residual_floor <= step%fixed_point%tolerance) return
      call record%warn('the contact conductance is accurate to ', record%residual_floor, &
         ' only, not TOL='//to_text(step%fixed_point%tolerance)//': gaps are differences of '// &
         'far larger displacements, whose rounding changes it')
   end subroutine warn_of_floor

   !> Contact state of one interface.
   pure function contact_record(bodies, with_heat, i, next) result(record)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: with_heat
      integer, intent(in) :: i
      type(solution_state_type), intent(in) :: next
      type(contact_record_type) :: record
      type(contact_state_type) :: contact
      type(conductance_law_type) :: law
      logical :: closed(size(bodies%interfaces(i)%slave)), touches(size(closed))
      integer :: first, k, last

      first = bodies%points%interface_start(i)
      last = bodies%points%interface_start(i + 1) - 1
      contact = kept_contact(next%contact, next%has_mechanics)
      associate (points => bodies%interfaces(i))
         record%contact_state = contact%contact_state(first:last)
         where (next%idle(first:last)) record%contact_state = merge(contact_slip, contact_open, &
            next%resting(first:last))
         record%gap = contact%gap(first:last)
         record%smallest_gap = next%smallest_gap(first:last)
         closed = record%contact_state /= contact_open
         if (next%has_mechanics) closed = in_contact(points, closed, record%gap, &
            contact%force(first:last), bodies%equilibrium%contact%alone(first:last))
         touches = closed .and. record%contact_state == contact_open
         where (touches)
            record%contact_state = merge(contact_stick, contact_slip, &
               bodies%laws%friction(first:last)%coefficient > 0.0_dp)
            record%gap = 0.0_dp
         end where
         call measure_contact(points, bodies%laws%friction(first), closed, &
            contact%force(first:last), contact%shear_force(first:last), record)
         record%movement = contact%tangential(first:last)
         record%slip = record%movement - contact%slip_origin(first:last)
         if (allocated(bodies%thermal%matrix%value)) then
            allocate (record%slave_temperature(size(closed)), record%master_temperature( &
               size(closed)), source=0.0_dp)
            call points%slave_mean%add_totals(next%temperature, record%slave_temperature)
            call points%master_mean%add_totals(next%temperature, record%master_temperature)
         end if
         if (.not. with_heat) return
         record%conductance = next%carrying(first:last)
         do k = 1, size(touches)
            if (.not. touches(k)) cycle
            law = law_at(bodies%laws%conductance(first - 1 + k), face_temperatures_type( &
               0.5_dp*(record%slave_temperature(k) + record%master_temperature(k)), &
               next%jump(first - 1 + k)))
            record%conductance(k) = conductance(law, .true., 0.0_dp, record%pressure(k))
         end do
         associate (jump => next%jump(first:last))
            record%heat_flux = heat_across(1.0_dp, record%conductance, jump)
            record%heat_rate = sum(heat_across(points%weight, record%conductance, jump))
         end associate
      end associate
   end function contact_record

   !> Tractions, sums and edges of an interface from its nodal forces.
   pure subroutine measure_contact(points, friction, closed, force, shear_force, record)
      type(contact_points_type), intent(in) :: points      !! the contact points of the interface
      type(friction_law_type), intent(in) :: friction      !! the law of all of them
      logical, intent(in) :: closed(:)                    !! (m) contact points that have a traction
      real(dp), intent(in) :: force(:)                     !! (m) 0 at the others [force]
      real(dp), intent(in) :: shear_force(:)               !! (m) on the slave [force]
      type(contact_record_type), intent(inout) :: record   !! has states and gaps
      type(contact_profile_type) :: profile

      record%pressure = pressures(points, force, closed)
      record%shear = shears(points, shear_force, closed, friction, record%pressure)
      record%normal_force = sum(force)
      record%shear_force = sum(shear_force)
      if (abs(record%shear_force) <= no_shear*sum(abs(force) + abs(shear_force))) then
         record%shear_force = 0.0_dp
      end if
      profile = contact_profile(points, record%contact_state, record%pressure, record%shear, &
         record%gap)
      call contact_edges(profile, record%edges_contact, record%edge_contact)
      call stick_edges(profile, friction, record%edges_stick, record%edge_stick)
   end subroutine measure_contact

   !> Displacement below which none is a scale to measure by. Where bodies are at their initial
   !> temperature, the rounding of that temperature strains them.
   pure real(dp) function least_displacement(model, temperature)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)
      real(dp) :: expansion
      integer :: i

      expansion = 0.0_dp
      do i = 1, size(model%materials)
         expansion = max(expansion, maxval(abs(model%materials(i)%expansion)))
      end do
      least_displacement = extent_of(model%mesh%coordinates)*max(least_strain, noise*expansion* &
         max(maxval(abs(temperature)), maxval(abs(model%initial_temperature))))
   end function least_displacement

   !> Reactions, force balance, and the contact conditions on the recovered displacements.
   pure subroutine balance_forces(bodies, model, loads, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: next
      type(increment_record_type), intent(inout) :: record
      real(dp), allocatable :: internal(:), residual(:)
      type(friction_law_type) :: friction(size(bodies%points%slave))
      type(scales_type) :: scales
      real(dp) :: least, positions(2, size(bodies%points%slave)), stiffness
      logical :: along_x

      least = least_displacement(model, next%temperature)
      scales%length = max(maxval(abs(next%displacement)), least, tiny(1.0_dp), &
         bodies%equilibrium%contact%least_length/noise)
      if (size(bodies%points%initial_gap) > 0) then
         scales%length = max(scales%length, noise*maxval(abs(bodies%points%initial_gap)))
      end if
      internal = bodies%mechanical%matrix%multiply(next%displacement) - &
         unstrained_forces(bodies, next%temperature - model%initial_temperature)
      stiffness = bodies%mechanical%largest_entry
      residual = force_residual(internal, next%force_load, bodies%points, next%contact)
      call bodies%mechanical%map%carry_over(residual)
      associate (held => loads%displacement%active)
         scales%force = max(maxval(abs(residual), mask=held), maxval(abs(next%force_load)), &
            sum(next%contact%force), noise*stiffness*scales%length, &
            least*stiffness, tiny(1.0_dp))
         along_x = all(model%mesh%element_plane /= axisymmetric)
         record%force_imbalance = imbalance(internal, residual, held, model%mesh%node_body, &
            [along_x, .true.], scales%force)
         positions = bodies%points%relative(next%displacement)
         positions = reshape([loads%present_gaps(bodies%points) - sum(positions* &
            bodies%points%normal, dim=1), sum(positions*bodies%points%tangent, dim=1)], &
            shape(positions), order=[2, 1])
         where (bodies%laws%removed) positions(1, :) = 0.0_dp
         friction = bodies%laws%nodal_friction
         where (bodies%equilibrium%contact%tangent == 0) friction%coefficient = 0.0_dp
         record%contact_violation = contact_violation(positions, residual, held, bodies%points, &
            next%contact, friction, scales)
         record%fields%reaction = on_nodes(bodies%points%partners, reshape(merge(residual, &
            0.0_dp, held), [2, size(next%temperature)]))
      end associate
   end subroutine balance_forces

end module increment_records
