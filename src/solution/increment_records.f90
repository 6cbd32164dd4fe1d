!> The record of an accepted increment, made from its state.
module increment_records
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use balances, only: contact_violation, force_residual, heat_residual, imbalance
   use contact_system, only: contact_system_type
   use field_recovery, only: point_map_type, recover_heat_flux, recover_stress
   use interface_operators, only: interface_operators_type
   use kinds, only: dp
   use loads, only: loads_type
   use model, only: model_type
   use records, only: contact_record_type, increment_record_type, status_open
   use solution_state, only: solution_state_type
   use zone_edges, only: contact_edges, stick_edges
   implicit none
   private
   public :: make_record

   !> Part of K u, of K T or of the gaps below which a force, a rate or a displacement is no scale
   !> to measure by: where nothing is loaded only rounding is left of them.
   real(dp), parameter :: noise = 1.0e-6_dp

contains

   !> Completes the record of an increment with contact state, fields and balances, and settles the
   !> slip memory.
   subroutine make_record(operators, model, points, loads, with_heat, previous, next, record)
      type(interface_operators_type), intent(in) :: operators !! the reduced bodies
      type(model_type), intent(in) :: model                   !! the model
      type(point_map_type), intent(in) :: points              !! where averaged fields live
      type(loads_type), intent(in) :: loads                   !! loads at the end of the increment
      logical, intent(in) :: with_heat                        !! whether heat was solved
      type(solution_state_type), intent(in) :: previous       !! state at the start
      type(solution_state_type), intent(inout) :: next        !! state at the end
      type(increment_record_type), intent(inout) :: record    !! the record
      integer :: i

      call settle_slip(operators, previous, next)
      allocate (record%contacts(size(operators%interfaces)))
      do i = 1, size(operators%interfaces)
         record%contacts(i) = contact_record(operators, with_heat, i, next)
      end do
      call set_fields(model, points, with_heat, next, record)
      call balance_forces(operators, model, loads, next, record)
      if (with_heat) then
         call balance_heat(operators, model, loads, next, record)
      else
         record%heat_in = ieee_value(1.0_dp, ieee_quiet_nan)
         record%heat_out = record%heat_in
         record%heat_imbalance = record%heat_in
         record%contacts%heat_rate = record%heat_in
      end if
   end subroutine make_record

   !> Slip counts from the instant of closing. Tangential positions that the contact system does not
   !> carry, of frictionless pairs, are taken from the recovered displacements, and such a pair
   !> closes where it is at that instant on the straight line between its ends.
   pure subroutine settle_slip(operators, previous, next)
      type(interface_operators_type), intent(in) :: operators
      type(solution_state_type), intent(in) :: previous
      type(solution_state_type), intent(inout) :: next
      real(dp) :: relative(2)
      integer :: k, m, s

      associate (pairs => operators%pairs, contact => next%contact)
         do k = 1, size(pairs%slave)
            if (operators%contact%tangent(k) == 0) then
               s = 2*pairs%slave(k)
               m = 2*pairs%master(k)
               relative = next%displacement(s - 1:s) - next%displacement(m - 1:m)
               contact%tangential(k) = dot_product(relative, pairs%tangent(:, k))
               contact%reference(k) = previous%contact%tangential(k) + &
                  closing_fraction(operators%contact, previous%contact%gap(k), &
                  contact%force(k), operators%contact%normal(k))* &
                  (contact%tangential(k) - previous%contact%tangential(k))
            end if
            if (contact%status(k) == status_open) then
               next%closing(k) = contact%tangential(k)
            else if (previous%contact%status(k) == status_open) then
               next%closing(k) = contact%reference(k)
            end if
         end do
      end associate
   end subroutine settle_slip

   !> Instant at which a pair without a tangential unknown closed, as a fraction of the increment:
   !> relieved of its force alone it would overlap by force/stiffness.
   pure function closing_fraction(system, gap, force, place) result(fraction)
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: gap, force
      integer, intent(in) :: place
      real(dp) :: fraction
      real(dp) :: stiffness(1, 1)

      fraction = 0.0_dp
      if (gap <= 0.0_dp .or. force <= 0.0_dp) return
      stiffness = system%stiffness([place])
      fraction = gap/(gap + force/stiffness(1, 1))
   end function closing_fraction

   !> Contact state of one interface.
   pure function contact_record(operators, with_heat, i, next) result(record)
      type(interface_operators_type), intent(in) :: operators
      logical, intent(in) :: with_heat
      integer, intent(in) :: i
      type(solution_state_type), intent(in) :: next
      type(contact_record_type) :: record
      integer :: first, last

      first = operators%pairs%interface_start(i)
      last = operators%pairs%interface_start(i + 1) - 1
      associate (pairs => operators%interfaces(i), contact => next%contact)
         record%status = contact%status(first:last)
         record%gap = contact%gap(first:last)
         record%pressure = contact%force(first:last)/pairs%weight
         record%shear = contact%shear_force(first:last)/pairs%weight
         record%slip = contact%tangential(first:last) - next%closing(first:last)
         record%normal_force = sum(contact%force(first:last))
         record%shear_force = sum(contact%shear_force(first:last))
         call contact_edges(pairs%arc_length, record%status, record%pressure, record%gap, &
            record%edges_contact, record%edge_contact)
         call stick_edges(pairs%arc_length, pairs%weight, record%status, record%pressure, &
            record%shear, record%gap, operators%pairs%friction(first), record%edges_stick, &
            record%edge_stick)
         if (allocated(operators%thermal%matrix%value)) then
            record%slave_temperature = next%temperature(pairs%slave_node)
            record%master_temperature = next%temperature(pairs%master_node)
         end if
         if (.not. with_heat) return
         record%conductance = next%omega(first:last)
         record%heat_flux = next%omega(first:last)*next%jump(first:last)
         record%heat_rate = sum(pairs%weight*record%heat_flux)
      end associate
   end function contact_record

   !> Fields over nodes and points.
   subroutine set_fields(model, points, with_heat, next, record)
      type(model_type), intent(in) :: model
      type(point_map_type), intent(in) :: points
      logical, intent(in) :: with_heat
      type(solution_state_type), intent(in) :: next
      type(increment_record_type), intent(inout) :: record

      associate (fields => record%fields)
         fields%displacement = reshape(next%displacement, [2, size(next%temperature)])
         fields%temperature = next%temperature
         fields%stress = recover_stress(model%mesh, model%sections, model%materials, &
            model%orientations, points, fields%displacement, &
            next%temperature - model%initial_temperature)
         if (with_heat) fields%heat_flux = recover_heat_flux(model%mesh, model%sections, &
            model%materials, model%orientations, points, next%temperature)
      end associate
   end subroutine set_fields

   !> Reactions, force balance, and the contact conditions on the recovered displacements.
   subroutine balance_forces(operators, model, loads, next, record)
      type(interface_operators_type), intent(in) :: operators
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: next
      type(increment_record_type), intent(inout) :: record
      real(dp), allocatable :: internal(:), residual(:)
      real(dp) :: length, scale

      length = max(maxval(abs(next%displacement)), tiny(1.0_dp))
      if (size(operators%pairs%initial_gap) > 0) then
         length = max(length, noise*maxval(abs(operators%pairs%initial_gap)))
      end if
      internal = operators%mechanical%matrix%multiply(next%displacement) - &
         operators%thermal_load%multiply(next%temperature - model%initial_temperature)
      residual = force_residual(internal, next%force_load, operators%pairs, next%contact)
      associate (held => loads%displacement%active)
         scale = max(maxval(abs(residual), mask=held), maxval(abs(next%force_load)), &
            sum(next%contact%force), noise*maxval(abs(operators%mechanical%matrix%value))* &
            length, tiny(1.0_dp))
         record%force_imbalance = imbalance(internal, residual, held, model%mesh%node_body, scale)
         record%contact_violation = contact_violation(next%displacement, &
            internal - next%force_load, held, operators%pairs, next%contact, &
            operators%contact%tangent > 0, length, scale)
         record%fields%reaction = reshape(merge(residual, 0.0_dp, held), &
            shape(record%fields%displacement))
      end associate
   end subroutine balance_forces

   !> Heat that enters at prescribed temperatures, and the heat balance.
   subroutine balance_heat(operators, model, loads, next, record)
      type(interface_operators_type), intent(in) :: operators
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: next
      type(increment_record_type), intent(inout) :: record
      real(dp), allocatable :: conducted(:), residual(:), pair_heat(:)
      real(dp) :: net(0:maxval(loads%temperature%card)), scale
      integer :: i

      pair_heat = operators%pairs%weight*next%omega*next%jump
      conducted = operators%thermal%matrix%multiply(next%temperature)
      residual = heat_residual(conducted, next%heat_load, operators%pairs, pair_heat)
      net = 0.0_dp
      associate (held => loads%temperature%active, card => loads%temperature%card)
         do i = 1, size(residual)
            if (held(i)) net(card(i)) = net(card(i)) + residual(i)
         end do
         record%heat_in = sum(net, mask=net > 0.0_dp)
         record%heat_out = -sum(net, mask=net < 0.0_dp)
         scale = max(record%heat_in, record%heat_out, abs(sum(pair_heat)), &
            maxval(abs(residual), mask=held), noise*maxval(abs(operators%thermal%matrix%value))* &
            maxval(abs(next%temperature)), tiny(1.0_dp))
         record%heat_imbalance = imbalance(conducted, residual, held, model%mesh%node_body, scale)
         record%fields%reaction_heat = merge(residual, 0.0_dp, held)
      end associate
   end subroutine balance_heat

end module increment_records
