!> One pass of the contact operator U = chi H L of section 2: conductance -> temperature jumps ->
!> contact state -> conductance, all on the contact points.
module contact_operator
   use closing_instant, only: solve_increment
   use conductance_laws, only: conductance, conductance_derivative, conductance_law_type
   use contact_heat, only: temperature_jumps
   use contact_states, only: contact_state_type, contact_open, contact_slip
   use errors, only: error_type, status_no_convergence
   use finite_values, only: check_finite
   use fixed_point, only: pass_type
   use gap_temperatures, only: settle_conductance, take_temperatures
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use contact_tractions, only: pressures
   use reduced_bodies, only: reduced_bodies_type
   implicit none
   private
   public :: contact_operator_pass, law_conductance, law_pressure
   public :: kept_contact, residual_floor, unstrained_forces

contains

   !> U: conductance in, workspace%pass%omega, conductance of the resulting contact state out,
   !> workspace%pass%image. Where laws vary with the temperature, their value is that of the
   !> temperatures of the pass; then, with the coordinates of the contact points given,
   !> workspace%pass%coordinate, omega is what these and the temperatures make it.
   !> Errors: as solve_increment; jumps or conductances overflow.
   subroutine contact_operator_pass(bodies, heat, data, workspace, jump, state, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace !! loads in, factors out
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      type(contact_state_type), intent(inout) :: state           !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error
      logical :: settles

      settles = allocated(workspace%pass%coordinate) .and. bodies%points%vary_with_temperature()
      if (settles) then
         call settle_conductance(bodies, heat, data, workspace, jump, error)
      else
         call temperature_jumps(bodies, heat, data, workspace%pass%omega, workspace, jump)
         call check_finite(jump, 'temperature jumps', status_no_convergence, error)
      end if
      if (allocated(error)) return
      call solve_increment(bodies%equilibrium%contact, data%previous, &
         condensed_load(heat, data, workspace%on_tail), workspace%contact, workspace%held, &
         state, error)
      if (allocated(error)) return
      if (bodies%points%vary_with_temperature() .and. .not. settles) call take_temperatures( &
         bodies, heat, data, jump, workspace)
      workspace%pass%image = conductance(workspace%pass%graph%law, state%contact_state /= &
         contact_open, state%gap, law_pressure(bodies, state))
      call check_finite(workspace%pass%image, 'conductances', status_no_convergence, error)
   end subroutine contact_operator_pass

   !> Condensed mechanical load of the increment with a solution of (3.4).
   pure function condensed_load(heat, data, on_tail) result(load)
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: on_tail(:)                        !! (thermal tail)
      real(dp) :: load(size(data%welded_load))                  !! (mechanical tail) [force]
      integer :: k

      load = data%welded_load
      do k = 1, size(on_tail)
         load = load + heat%jump_load(:, k)*on_tail(k)
      end do
   end function condensed_load

   !> chi: the conductance of a contact state, eq. (1.8).
   pure function law_conductance(bodies, temperature, jump, state) result(omega)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: temperature(:)                    !! (nodes)
      real(dp), intent(in) :: jump(:)                           !! (m) T_xi - T_eta
      type(contact_state_type), intent(in) :: state
      real(dp) :: omega(size(state%contact_state))              !! (m)
      type(conductance_law_type), allocatable :: law(:)

      ! gfortran frees the components of an empty function's result within an elemental call.
      law = bodies%laws%conductance_at(bodies%points%means(temperature), jump)
      omega = conductance(law, state%contact_state /= contact_open, state%gap, &
         law_pressure(bodies, state))
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

   !> Nodal forces of the stresses that the bodies have without strains: of temperatures, and the
   !> initial ones.
   pure function unstrained_forces(bodies, warming) result(forces)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: warming(:)         !! (nodes) since the initial state [temperature]
      real(dp) :: forces(2*size(warming))                       !! (2 nodes) [force]

      forces = 0.0_dp
      if (allocated(bodies%thermal_load%value)) then
         forces = bodies%thermal_load%multiply(warming)
      end if
      if (allocated(bodies%initial_force)) forces = forces + bodies%initial_force
   end function unstrained_forces

   !> What a few units in the last place of the displacements change in omega, relative, and at
   !> least the unit in its own last place: no residual can be smaller.
   pure function residual_floor(bodies, data, pass, state) result(floor_value)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(pass_type), intent(in) :: pass
      type(contact_state_type), intent(in) :: state             !! that the pass found
      real(dp) :: floor_value                                   !! relative change of omega
      real(dp) :: change, pressure
      integer :: k
      integer, parameter :: few = 4

      floor_value = epsilon(1.0_dp)
      do k = 1, size(pass%image)
         if (pass%image(k) <= 0.0_dp .or. bodies%points%weight(k) <= 0.0_dp) cycle
         associate (weight => bodies%points%weight(k))
            change = few*epsilon(1.0_dp)*max(data%displacement_scale, abs(state%gap(k)), &
               abs(bodies%points%initial_gap(k) - state%gap(k)))
            if (state%contact_state(k) /= contact_open) then
               change = change*bodies%equilibrium%contact%alone(k)/weight
            end if
            pressure = state%force(k)/weight
         end associate
         floor_value = max(floor_value, change/pass%image(k)*abs(conductance_derivative( &
            pass%graph(k)%law, state%contact_state(k) /= contact_open, state%gap(k), pressure)))
      end do
   end function residual_floor

end module contact_operator
