!> Balances of heat and force of an increment that can fail: the reactions of each body alone, on
!> the recovered fields, against what the reduced system says crosses the contacts. Of heat, those
!> of the discrete equation (3.4) and of the states at its ends.
module balances
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use connections, only: connections_type
   use contact_operator, only: bar_forces, unstrained_forces
   use contact_system, only: contact_open, contact_slip, contact_state_type, contact_stick
   use edge_heat, only: edge_heat_type, joined_conductance, supplied_heat
   use element_kinds, only: axisymmetric
   use friction_laws, only: friction_bound, friction_law_type
   use heat_equation, only: heat_across, heat_rates_type
   use increment_data, only: increment_data_type
   use kinds, only: dp
   use materials, only: heats_by_work
   use loads, only: loads_type
   use mesh, only: extent_of
   use model, only: model_type
   use overlap_laws, only: overlap_law_type
   use records, only: increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use text, only: to_text
   use transforms, only: on_nodes
   implicit none
   private
   public :: balance_heat, balance_forces, sound_imbalance
   public :: scales_type, force_residual, imbalance, contact_violation

   !> Part of K T, of K u or of the gaps below which a rate, a force or a displacement is no scale
   !> to measure by: where nothing is loaded only rounding is left of them. The sum over a body
   !> collects that of all nodes, for which the norm of T is.
   real(dp), parameter :: noise = 1.0e-6_dp

   !> Part of the heat that bodies hold, over an increment, below which a rate is no scale; with
   !> heat of strains from absolute zero.
   real(dp), parameter :: content_noise = 1.0e-7_dp

   !> Displacement, in the extent of the model, below which it is no scale.
   real(dp), parameter :: least_strain = 1.0e-12_dp

   !> Largest imbalance at the end of an increment of which nothing is said.
   real(dp), parameter :: sound_imbalance = 1.0e-2_dp

   !> Largest imbalance at the start of an increment that counts as none.
   real(dp), parameter :: equilibrium = 1.0e-6_dp

   !> Scales of displacements and forces.
   type :: scales_type
      real(dp) :: length = 1.0_dp   !! largest displacement [length]
      real(dp) :: force = 1.0_dp    !! largest force [force]
   end type scales_type

contains

   !> Heat that enters by loads and prescribed temperatures, and both balances of heat. Warns where
   !> heat starts or ends out of balance.
   pure subroutine balance_heat(bodies, model, loads, data, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads                   !! loads at the end of the increment
      type(increment_data_type), intent(in) :: data           !! its start
      type(solution_state_type), intent(in) :: next           !! state at its end
      type(increment_record_type), intent(inout) :: record    !! receives rates and balances
      type(heat_rates_type) :: rates
      real(dp), allocatable :: residual(:)
      real(dp) :: omega(size(next%omega)), scale

      omega = joined_conductance(next%omega, next%edge)
      rates%conducted = bodies%thermal%matrix%multiply(next%temperature)
      if (allocated(data%equation%beyond)) rates%conducted = rates%conducted - data%equation%beyond
      rates%entering = next%sources%net_heat(next%temperature)
      rates%crossing = heat_across(bodies%points%weight, next%flux_conductance, next%jump)
      record%heat_stored = ieee_value(1.0_dp, ieee_quiet_nan)
      record%heat_dilatation = record%heat_stored
      record%heat_friction = record%heat_stored
      if (data%equation%duration > 0.0_dp) then
         rates%stored = next%stored
         record%heat_stored = sum(next%stored)
         if (model%steps(record%step)%dilates .or. any(heats_by_work(model%materials))) then
            record%heat_dilatation = next%dilatation
         end if
         record%heat_stored = record%heat_stored - next%dilatation
      end if
      if (allocated(data%friction%heat)) then
         rates%friction_heat = data%friction%entering()
         record%heat_friction = sum(rates%friction_heat)
      end if
      residual = supplied_heat(bodies, next%edge, rates)
      call sum_rates(loads, next%temperature, residual, record)
      associate (prescribed => loads%temperature%active, body => model%mesh%node_body)
         scale = max(record%heat_in, record%heat_out, abs(sum(rates%crossing)), &
            maxval(abs(residual), mask=prescribed), maxval(abs(rates%entering)), &
            noise*bodies%thermal%largest_entry*norm2(next%temperature), tiny(1.0_dp))
         if (allocated(rates%friction_heat)) scale = max(scale, sum(abs(rates%friction_heat)))
         if (allocated(rates%stored)) scale = max(scale, maxval(abs(rates%stored)), &
            content_noise*norm2(data%equation%content_old)/data%equation%duration)
         if (allocated(data%equation%taken_up)) scale = max(scale, &
            maxval(abs(data%equation%taken_up))/data%equation%duration)
         if (allocated(bodies%dilatation%absolute) .and. data%equation%duration > 0.0_dp) scale = &
            max(scale, content_noise*norm2(bodies%capacity%multiply( &
            bodies%dilatation%absolute))/data%equation%duration)
         record%fields%reaction_heat = merge(residual, 0.0_dp, prescribed)
         record%fields%external_heat = record%fields%reaction_heat + rates%entering
         rates%crossing = heat_across(bodies%points%weight, omega, next%jump)
         record%heat_imbalance_pointwise = imbalance(rates%conducted, &
            supplied_heat(bodies, next%edge, rates), prescribed, body, [.true.], scale)
         rates = data%equation%rates(bodies%thermal%matrix, bodies%capacity, next%temperature, &
            omega, next%jump)
         if (allocated(data%friction%heat)) rates%friction_heat = data%equation%scheme%a(1)* &
               data%friction%load()
         record%heat_imbalance = imbalance(rates%conducted, supplied_heat(bodies, next%edge, &
            rates), prescribed, body, [.true.], scale)
         call warn_of_imbalances(bodies, prescribed, data, next%is_out_of_balance, record)
      end associate
   end subroutine balance_heat

   !> Warns where heat starts out of equilibrium, (K + G) T /= Q, with a scheme that never damps
   !> that; else where the scheme leaves heat out of balance at the end of the increment, once for
   !> as long as it stays so.
   pure subroutine warn_of_imbalances(bodies, prescribed, data, was_out, record)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: prescribed(:) !! (nodes) prescribed temperatures
      type(increment_data_type), intent(in) :: data
      logical, intent(in) :: was_out                          !! whether the last increment was
      type(increment_record_type), intent(inout) :: record
      type(heat_rates_type) :: rates
      real(dp) :: at_start, scale

      ! What a step that stores heat leaves over it stores.
      if (data%equation%duration > 0.0_dp) return
      at_start = 0.0_dp
      if (data%equation%never_damps() .and. .not. data%kept_imbalance) then
         ! In any row that is not prescribed, relative to the largest rate.
         rates = data%equation%rates_at_start(bodies%thermal%matrix)
         scale = max(maxval(abs(rates%conducted)), maxval(abs(data%equation%old%load)), &
            maxval([0.0_dp, abs(rates%crossing)]), noise*bodies%thermal%largest_entry* &
            maxval(abs(data%equation%temperature_old)), tiny(1.0_dp))
         if (allocated(data%friction%old)) then
            rates%friction_heat = data%friction%old
            scale = max(scale, sum(abs(rates%friction_heat)))
         end if
         at_start = maxval([0.0_dp, pack(abs(supplied_heat(bodies, edge_heat_type(), rates)), &
            .not. prescribed)])/scale
      end if
      if (at_start > equilibrium) then
         call record%warn('heat starts out of equilibrium, (K + G) T - Q is ', at_start, &
            ' of the largest rate; the scheme of (3.4), amplification '// &
            to_text(data%equation%amplification())// &
            ', never damps that (*THERMAL SCHEME, TYPE=IMPLICIT does)')
      else if (.not. was_out .and. record%heat_imbalance_pointwise > sound_imbalance) then
         call record%warn('at its end heat is out of balance by ', &
            100.0_dp*record%heat_imbalance_pointwise, ' % of the largest rate '// &
            '(heat_imbalance_pointwise), left by the scheme '//trim(data%equation%scheme%name)// &
            '; *THERMAL SCHEME, TYPE=IMPLICIT leaves none')
      end if
   end subroutine warn_of_imbalances

   !> Net rates, one per load card and per card of prescribed temperatures, summed by their sign.
   pure subroutine sum_rates(loads, temperature, residual, record)
      type(loads_type), intent(in) :: loads
      real(dp), intent(in) :: temperature(:), residual(:)
      type(increment_record_type), intent(inout) :: record
      real(dp) :: net(0:maxval(loads%temperature%card))
      real(dp), allocatable :: rates(:)
      integer :: i

      net = 0.0_dp
      do i = 1, size(residual)
         if (.not. loads%temperature%active(i)) cycle
         associate (rate => net(loads%temperature%card(i)))
            rate = rate + residual(i)
         end associate
      end do
      rates = [net, loads%card_heat(temperature)]
      record%heat_in = sum(rates, mask=rates > 0.0_dp)
      record%heat_out = -sum(rates, mask=rates < 0.0_dp)
   end subroutine sum_rates

   !> Displacement below which none is a scale to measure by. Where bodies are at their initial
   !> temperature, the rounding of that temperature strains them.
   pure real(dp) function least_displacement(bodies, model, temperature)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)

      least_displacement = extent_of(model%mesh%coordinates)*max(least_strain, noise* &
         bodies%largest_expansion*maxval(abs([temperature, model%initial_temperature])))
   end function least_displacement

   !> Reactions, force balance, and the contact conditions on the recovered displacements.
   pure subroutine balance_forces(bodies, model, loads, next, record)
      type(reduced_bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: next
      type(increment_record_type), intent(inout) :: record
      real(dp), allocatable :: even(:), internal(:), residual(:)
      type(friction_law_type) :: friction(size(bodies%points%slave))
      type(scales_type) :: scales
      real(dp) :: dropped, least, positions(2, size(bodies%points%slave)), stiffness
      logical :: along_x

      least = least_displacement(bodies, model, next%temperature)
      scales%length = max(bodies%largest_displacement(next%displacement), least, tiny(1.0_dp), &
         bodies%equilibrium%contact%least_length/noise)
      if (size(bodies%points%initial_gap) > 0) scales%length = max(scales%length, noise*maxval( &
         abs(bodies%points%initial_gap)))
      internal = bodies%mechanical%matrix%multiply(next%displacement) - unstrained_forces(bodies, &
         next%temperature - model%initial_temperature, next%forces_beyond)
      stiffness = bodies%mechanical%largest_entry
      ! What contact points drop as rounding is no imbalance, not even if a body sums all of it.
      dropped = size(next%contact%force)*bodies%equilibrium%contact%least_force()
      residual = force_residual(internal, next%force_load, bodies%points, next%contact)
      call bodies%mechanical%map%carry_over(residual)
      even = bodies%evened(residual)
      ! What bodies have along z balances nothing in the plane.
      if (allocated(bodies%points%along_z)) then
         associate (dofs => bodies%points%along_z)
            internal(dofs) = merge(0.0_dp, even(dofs), loads%displacement%active(dofs))
         end associate
      end if
      associate (prescribed => loads%displacement%active)
         scales%force = max(maxval(abs(even), mask=prescribed), &
            maxval(abs(bodies%evened(next%force_load))), sum(next%contact%force), &
            noise*stiffness*scales%length, least*stiffness, dropped/noise, tiny(1.0_dp))
         along_x = all(model%mesh%element_plane /= axisymmetric)
         record%force_imbalance = imbalance(internal - bar_forces(bodies, next%displacement, &
            next%temperature - model%initial_temperature), even, prescribed, model%mesh%node_body, &
            [along_x, .true.], scales%force)
         positions = bodies%points%relative(next%displacement)
         positions = reshape([loads%present_gaps(bodies%points) - sum(positions* &
            bodies%points%normal, dim=1), sum(positions*bodies%points%tangent, dim=1)], &
            shape(positions), order=[2, 1])
         if (allocated(bodies%laws%overlap)) call add_overlaps(bodies%laws%overlap, &
            bodies%points%weight, next%contact%force, positions(1, :))
         where (bodies%laws%removed) positions(1, :) = 0.0_dp
         friction = bodies%laws%nodal_friction
         where (bodies%equilibrium%contact%tangent == 0) friction%coefficient = 0.0_dp
         record%contact_violation = contact_violation(positions, residual, prescribed, &
            bodies%points, next%contact, friction, scales)
         record%fields%reaction = on_nodes(bodies%points%partners, reshape(merge(residual, &
            0.0_dp, prescribed), [2, size(next%temperature)]))
      end associate
   end subroutine balance_forces

   !> Makes gaps of soft faces those that are left beside the overlap of their law; those without
   !> an area have no law.
   pure subroutine add_overlaps(law, area, force, gap)
      type(overlap_law_type), intent(in) :: law(:)   !! (m)
      real(dp), intent(in) :: area(:)                !! (m) [length^2]
      real(dp), intent(in) :: force(:)               !! (m) compressive [force]
      real(dp), intent(inout) :: gap(:)              !! (m) by the displacements [length]
      integer :: k

      do k = 1, size(law)
         if (.not. law(k)%is_soft()) cycle
         if (area(k) > 0.0_dp) then
            gap(k) = gap(k) + law(k)%overlap_under(force(k)/area(k))
         else
            gap(k) = 0.0_dp
         end if
      end do
   end subroutine add_overlaps

   !> Force that the supports of each degree of freedom must supply: K u - f less the contact forces
   !> of the reduced system.
   pure function force_residual(internal, load, points, state) result(residual)
      real(dp), intent(in) :: internal(:) !! (2 nodes) K u less the thermal load [force]
      real(dp), intent(in) :: load(:)                !! (2 nodes) applied forces [force]
      type(connections_type), intent(in) :: points
      type(contact_state_type), intent(in) :: state  !! contact forces
      real(dp) :: residual(size(internal)) !! (2 nodes) zero where not prescribed [force]
      real(dp) :: from_slave(2, size(points%slave))

      residual = internal - load
      from_slave = spread(state%force, 1, 2)*points%normal - &
         spread(state%shear_force, 1, 2)*points%tangent
      call points%add_forces(from_slave, residual)
   end function force_residual

   !> Largest imbalance, relative: of any single unsupported row, and per body and direction of the
   !> supports' reactions against all that is applied to the body, by loads and through its
   !> contacts. Along the radius of an axisymmetric body there is no such sum: the hoop stress takes
   !> part of it.
   pure function imbalance(internal, residual, supported, node_body, summed, scale) result(relative)
      real(dp), intent(in) :: internal(:)      !! (components*nodes) of the bodies alone, K T or K u
      real(dp), intent(in) :: residual(:)      !! (components*nodes) as from the functions above
      logical, intent(in) :: supported(:)      !! (components*nodes) prescribed rows
      integer, intent(in) :: node_body(:)      !! (nodes) body of each node, 0 for none
      logical, intent(in) :: summed(:)         !! (components) directions with a sum per body
      real(dp), intent(in) :: scale            !! largest rate or force of the increment
      real(dp) :: relative                     !! relative imbalance
      real(dp) :: total(0:maxval(node_body), size(summed)), applied, reaction
      integer :: c, components, i, node

      components = size(summed)
      total = 0.0_dp
      relative = 0.0_dp
      do node = 1, size(node_body)
         do c = 1, components
            i = components*(node - 1) + c
            applied = internal(i) - residual(i)
            reaction = merge(residual(i), 0.0_dp, supported(i))
            total(node_body(node), c) = total(node_body(node), c) + applied + reaction
            if (.not. supported(i)) relative = max(relative, abs(residual(i)))
         end do
      end do
      do c = 1, components
         if (summed(c)) relative = max(relative, maxval(abs(total(:, c))))
      end do
      if (scale > 0.0_dp) relative = relative/scale
   end function imbalance

   !> Largest violation of the contact conditions (1.6) by gaps and tractions computed afresh from
   !> the recovered displacements, relative to the largest displacement and force. Where a row is
   !> supported on one body, the traction is taken from the other; where on both, the reduced
   !> system's is.
   pure function contact_violation(positions, residual, supported, points, state, friction, &
      scales) result(violation)
      !> (2, m) gaps, 0 where an interface is removed, and tangential positions by these
      !> displacements [length]
      real(dp), intent(in) :: positions(:, :)
      !> (2 nodes) as from force_residual, without the forces of ties [force]
      real(dp), intent(in) :: residual(:)
      logical, intent(in) :: supported(:)            !! (2 nodes) prescribed rows
      type(connections_type), intent(in) :: points
      type(contact_state_type), intent(in) :: state  !! the state that is checked
      !> (m) of nodal forces, none where the tangent is no unknown
      type(friction_law_type), intent(in) :: friction(:)
      type(scales_type), intent(in) :: scales
      real(dp) :: violation                          !! relative
      real(dp) :: force(2), gap, normal_force, shear_force, slip, cone
      integer :: c, k, slave_dof, master_dof

      violation = 0.0_dp
      do k = 1, size(points%slave)
         ! A node may be in several contact points: what they leave over goes to each of them.
         force = state%shear_force(k)*points%tangent(:, k) - state%force(k)*points%normal(:, k)
         do c = 1, 2
            slave_dof = 2*points%slave(k) - 2 + c
            master_dof = 2*points%master(k) - 2 + c
            if (.not. supported(slave_dof)) then
               force(c) = force(c) + residual(slave_dof)
            else if (.not. supported(master_dof)) then
               force(c) = force(c) - residual(master_dof)
            end if
         end do
         gap = positions(1, k)/scales%length
         slip = (positions(2, k) - state%reference(k))/scales%length
         normal_force = -dot_product(force, points%normal(:, k))/scales%force
         shear_force = dot_product(force, points%tangent(:, k))/scales%force
         cone = friction_bound(friction(k)%coefficient, friction(k)%largest_shear, &
            normal_force*scales%force)/scales%force
         if (state%contact_state(k) == contact_open) then
            violation = max(violation, -gap, abs(normal_force), abs(shear_force))
            cycle
         end if
         violation = max(violation, abs(gap), -normal_force)
         if (friction(k)%coefficient <= 0.0_dp) cycle
         if (state%contact_state(k) == contact_slip) then
            violation = max(violation, abs(abs(shear_force) - cone))
            violation = max(violation, min(slip*sign(1.0_dp, shear_force), abs(shear_force)))
         end if
         if (state%contact_state(k) == contact_stick) violation = max(violation, abs(shear_force) &
            - cone, abs(slip))
      end do
   end function contact_violation

end module balances
