!> One pass of the contact operator U = chi H L of section 2: conductance -> temperature jumps ->
!> contact state -> conductance, all on the contact points.
module contact_operator
   use closing_instant, only: solve_increment
   use conductance_laws, only: conductance, conductance_derivative
   use contact_states, only: contact_state_type, contact_open, contact_slip
   use errors, only: error_type, status_no_convergence
   use finite_values, only: check_finite
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use contact_tractions, only: pressures
   use reduced_bodies, only: reduced_bodies_type
   use tail_factors, only: tail_flops
   use thermal_matrix, only: contact_diagonal, contact_history
   implicit none
   private
   public :: contact_operator_pass, temperature_jumps, law_conductance, law_pressure
   public :: kept_contact, residual_floor, thermal_forces

contains

   !> U: conductance in, workspace%pass%omega, conductance of the resulting contact state out,
   !> workspace%pass%image.
   !> Errors: as solve_increment; jumps or conductances overflow.
   subroutine contact_operator_pass(bodies, data, workspace, jump, state, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace !! loads in, factors out
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      type(contact_state_type), intent(inout) :: state           !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      call temperature_jumps(bodies, data, workspace%pass%omega, workspace, jump)
      call check_finite(jump, 'temperature jumps', status_no_convergence, error)
      if (allocated(error)) return
      call solve_increment(bodies%contact, data%previous, &
         condensed_load(bodies, data, jump), workspace%contact, state, error)
      if (allocated(error)) return
      workspace%pass%image = law_conductance(bodies, state)
      call check_finite(workspace%pass%image, 'conductances', status_no_convergence, error)
   end subroutine contact_operator_pass

   !> L: the jumps for a given conductance, eq. (3.4) on the tail. Only the columns from the first
   !> changed one on are factored again.
   subroutine temperature_jumps(bodies, data, omega, workspace, jump)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: omega(:)                           !! (m) omega*
      type(increment_workspace_type), intent(inout) :: workspace !! heat in, factors out
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      real(dp) :: x(bodies%thermal%map%tail), diagonal(bodies%thermal%map%tail)
      real(dp) :: of_point(size(omega)), history(size(omega))
      integer :: k

      associate (tail_index => bodies%jump_index, weight => bodies%points%weight, &
         solver => bodies%thermal%solver, tail => workspace%tail, work => workspace%record%work)
         of_point = contact_diagonal(data%scheme, weight, data%omega_old, omega)
         history = contact_history(data%scheme, weight, data%omega_old, omega, data%jump_old)
         x = workspace%heat%condensed
         diagonal = 0.0_dp
         do k = 1, size(omega)
            if (tail_index(k) == 0) cycle
            diagonal(tail_index(k)) = of_point(k)
            x(tail_index(k)) = x(tail_index(k)) + history(k)
         end do
         call tail%refactor(solver%schur, diagonal)
         work%columns_again = work%columns_again + size(x) + 1 - tail%first_changed
         work%columns_full = work%columns_full + solver%order
         work%flops_again = work%flops_again + tail_flops(size(x), tail%first_changed)
         work%flops_full = work%flops_full + solver%full_flops + tail_flops(size(x), 1)
         call tail%solve(x)
         jump = data%held_jump
         do k = 1, size(omega)
            if (tail_index(k) > 0) jump(k) = x(tail_index(k))
         end do
      end associate
   end subroutine temperature_jumps

   !> Condensed mechanical load of the increment with given jumps.
   pure function condensed_load(bodies, data, jump) result(load)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      real(dp) :: load(size(data%welded_load))                  !! (mechanical tail) [force]
      integer :: k

      load = data%welded_load
      do k = 1, size(jump)
         if (bodies%jump_index(k) > 0) then
            load = load + bodies%jump_load(:, bodies%jump_index(k))*jump(k)
         end if
      end do
   end function condensed_load

   !> chi: the conductance of a contact state, eq. (1.8).
   pure function law_conductance(bodies, state) result(omega)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: state
      real(dp) :: omega(size(state%contact_state))              !! (m)
      real(dp) :: pressure(size(state%contact_state))
      integer :: k

      pressure = law_pressure(bodies, state)
      do k = 1, size(omega)
         omega(k) = conductance(bodies%points%law(k), state%contact_state(k) /= contact_open, &
            state%gap(k), pressure(k))
      end do
   end function law_conductance

   !> Pressure by which the closed law goes: the printed one.
   pure function law_pressure(bodies, state) result(pressure)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: state
      real(dp) :: pressure(size(state%contact_state))           !! (m) [stress]
      integer :: first, i, last

      do i = 1, size(bodies%interfaces)
         first = bodies%points%interface_start(i)
         last = bodies%points%interface_start(i + 1) - 1
         pressure(first:last) = pressures(bodies%interfaces(i), state%force(first:last), &
            state%contact_state(first:last) /= contact_open)
      end do
   end function law_pressure

   !> Contact state that a step without mechanics finds. Before any mechanics contact points without
   !> a gap touch: they are closed and carry no pressure.
   pure function kept_contact(state, has_mechanics) result(kept)
      type(contact_state_type), intent(in) :: state  !! contact state of the last increment
      logical, intent(in) :: has_mechanics           !! whether mechanics was solved before
      type(contact_state_type) :: kept

      kept = state
      if (has_mechanics) return
      where (kept%gap <= 0.0_dp) kept%contact_state = contact_slip
   end function kept_contact

   !> Nodal forces that temperatures cause; none where no temperature strains.
   pure function thermal_forces(bodies, temperature) result(forces)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:)                    !! (nodes) [temperature]
      real(dp) :: forces(2*size(temperature))                   !! (2 nodes) [force]

      forces = 0.0_dp
      if (allocated(bodies%thermal_load%value)) then
         forces = bodies%thermal_load%multiply(temperature - bodies%initial_temperature)
      end if
   end function thermal_forces

   !> What a few units in the last place of the displacements change in omega, relative: no residual
   !> can be smaller.
   pure function residual_floor(bodies, data, state, omega) result(floor_value)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(contact_state_type), intent(in) :: state
      real(dp), intent(in) :: omega(:)                          !! (m) its conductance
      real(dp) :: floor_value                                   !! relative change of omega
      real(dp) :: change, pressure
      integer :: k
      integer, parameter :: few = 4

      floor_value = 0.0_dp
      do k = 1, size(omega)
         if (omega(k) <= 0.0_dp .or. bodies%points%weight(k) <= 0.0_dp) cycle
         associate (weight => bodies%points%weight(k))
            change = few*epsilon(1.0_dp)*max(data%displacement_scale, abs(state%gap(k)), &
               abs(bodies%points%initial_gap(k) - state%gap(k)))
            if (state%contact_state(k) /= contact_open) then
               change = change*bodies%contact%alone(k)/weight
            end if
            pressure = state%force(k)/weight
         end associate
         floor_value = max(floor_value, change/omega(k)*abs(conductance_derivative( &
            bodies%points%law(k), state%contact_state(k) /= contact_open, state%gap(k), pressure)))
      end do
   end function residual_floor

end module contact_operator
