!> The contact operator U = chi H L of section 2, all on the contact points: one pass of it,
!> conductance -> temperature jumps -> contact state -> conductance, and how the openings of the
!> contact points follow their conductances.
!>
!> The jumps follow them by contact_heat, from (3.4) on the tail, (S_T + diag(d)) theta = Q_c -
!> history with d = weight (a2 omega_i + a3 omega)/a1; the condensed load follows by J dtheta, gaps
!> and forces by the contact system with the conditions that hold.
module contact_operator
   use closing_instant, only: contact_change_type, contact_response, solve_increment
   use conductance_graph, only: conductance_graph_type
   use conductance_laws, only: conductance, conductance_derivative, conductance_law_type
   use contact_heat, only: changes_by_temperature, jump_derivatives_type, settle_conductance, &
      take_temperatures, temperature_jumps
   use contact_points, only: contact_points_type
   use contact_system, only: contact_open, contact_state_type
   use contact_tractions, only: pressures
   use contact_workspace, only: contact_workspace_type
   use dense, only: product_of
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use fixed_point, only: pass_type
   use friction_tangent, only: friction_tangent_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use reduced_bodies, only: reduced_bodies_type
   use temperature_laws, only: law_jumps
   use text, only: to_text
   implicit none
   private
   public :: contact_operator_pass, law_conductance, law_pressure, residual_floor, touches, &
      unstrained_forces, bar_forces, make_graph, openings, opening_derivative, opening_changes, &
      load_derivative

   !> Smallest stiffness of a contact point, of the largest one, that scales its overlap: a contact
   !> point alone that holds a body has none.
   real(dp), parameter :: least_stiffness = 1.0e-6_dp

   ! Newton's method for the heat of friction.
   integer, parameter :: most_steps = 100            !! contact states
   !> Part of the largest heat, or of that of positions, that is none
   real(dp), parameter :: rounding = 1.0e-13_dp
   real(dp), parameter :: converged = 1.0e-10_dp     !! the same, where it falls no more
   real(dp), parameter :: shortest = 0.02_dp         !! part of a step below which none is tried

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
      type(increment_workspace_type), intent(inout) :: workspace !! conductance in, factors out
      real(dp), intent(out) :: jump(:)                           !! (m) T_xi - T_eta [temperature]
      type(contact_state_type), intent(inout) :: state           !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error
      logical :: settles

      settles = allocated(workspace%pass%coordinate) .and. bodies%points%vary_with_temperature()
      if (allocated(workspace%friction%heat)) then
         call settle_friction(bodies, heat, data, workspace, jump, state, error)
      else
         call find_contact(bodies, heat, data, workspace, jump, state, error)
      end if
      if (allocated(error)) return
      if (bodies%points%vary_with_temperature() .and. .not. settles) call take_temperatures( &
         bodies, heat, data, jump, workspace)
      workspace%pass%image = conductance(workspace%pass%graph%law, touches(state%contact_state, &
         state%gap), state%gap, law_pressure(bodies, state))
      call check_finite(workspace%pass%image, 'conductances', status_no_convergence, error)
   end subroutine contact_operator_pass

   !> Jumps and contact state of a pass, with the heat that friction makes as it is given.
   !> Errors: as solve_increment; jumps overflow.
   subroutine find_contact(bodies, heat, data, workspace, jump, state, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), intent(out) :: jump(:)
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: load(size(data%no_jump_load))                   ! condensed, with the jumps
      logical :: settles

      settles = allocated(workspace%pass%coordinate) .and. bodies%points%vary_with_temperature()
      if (settles) then
         call settle_conductance(bodies, heat, data, workspace, jump, error)
      else
         call temperature_jumps(bodies, heat, data, workspace%pass%omega, workspace, jump)
         call check_finite(jump, 'temperature jumps', status_no_convergence, error)
      end if
      if (allocated(error)) return
      associate (of_tail => heat%loads_of_tail(bodies, reshape(workspace%on_tail, &
         [size(workspace%on_tail), 1])))
         load = data%no_jump_load + of_tail(:, 1)
      end associate
      if (allocated(workspace%friction%heat) .and. .not. heat%schur%is_sparse()) load = load + &
         matmul(heat%friction_load, workspace%friction%parts(2, :)*workspace%friction%heat)
      call solve_increment(bodies%equilibrium%contact, data%previous, load, workspace%contact, &
         workspace%sticking, state, error)
   end subroutine find_contact

   !> The same where the heat that friction makes is that of the contact state which it leads to, by
   !> Newton's method at the conductances of the pass, with shorter steps where a whole one does not
   !> help; where none does, the heat that was found is taken.
   !> Errors: as find_contact; no convergence.
   subroutine settle_friction(bodies, heat, data, workspace, jump, state, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace !! a guess of the heat in
      real(dp), intent(out) :: jump(:)
      type(contact_state_type), intent(inout) :: state
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(size(workspace%friction%heat)) :: base, found, rest, step
      real(dp) :: last, part, residual
      integer :: i

      part = 1.0_dp
      last = huge(last)
      do i = 1, most_steps
         call find_contact(bodies, heat, data, workspace, jump, state, error)
         if (allocated(error)) return
         associate (friction_heat => workspace%friction%heat)
            rest = workspace%friction%found(bodies, state) - friction_heat
            residual = maxval(abs(rest))/max(maxval(abs(friction_heat)), &
               maxval(abs(friction_heat + rest)), tiny(1.0_dp))
            if (residual <= rounding .or. maxval(abs(rest)) <= rounding* &
               workspace%friction%of_positions(bodies, state, data%displacement_scale)) return
            if (residual <= converged .and. norm2(rest) >= 0.5_dp*last) return
            if (all(workspace%friction%parts(2, :) <= 0.0_dp)) then
               friction_heat = friction_heat + rest
               return
            end if
            if (norm2(rest) < last) then
               base = friction_heat
               found = rest
               step = friction_step(bodies, heat, workspace, state, rest)
               last = norm2(rest)
               part = 1.0_dp
            else if (part > shortest) then
               part = 0.5_dp*part
            else
               ! Contact points change to and fro in the way of any step.
               step = found
               last = huge(last)
               part = 1.0_dp
            end if
            friction_heat = base + part*step
         end associate
      end do
      call set_error(error, status_no_convergence, 'the heat of friction and the contact '// &
         'do not converge together, as where each makes the other grow without limit; last '// &
         'residual '//to_text(residual))
   end subroutine settle_friction

   !> Newton's step of the heats; to those that were found where the derivative does not exist.
   function friction_step(bodies, heat, workspace, state, rest) result(step)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace
      type(contact_state_type), intent(in) :: state
      real(dp), intent(in) :: rest(:)       ! (n) heats found less those given
      real(dp) :: step(size(rest))
      type(friction_tangent_type) :: tangent
      real(dp), allocatable :: change(:, :)

      step = rest
      call tangent%make(bodies, heat, workspace, state)
      if (.not. tangent%exists) return
      change = reshape(rest(tangent%active), [size(tangent%active), 1])
      call tangent%solve(bodies, heat, workspace, change)
      step(tangent%active) = change(:, 1)
   end function friction_step

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
      omega = conductance(law, touches(state%contact_state, state%gap), state%gap, &
         law_pressure(bodies, state))
   end function law_conductance

   !> Pressure by which the closed law goes: the printed one.
   pure function law_pressure(bodies, state) result(pressure)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(in) :: state
      real(dp) :: pressure(size(state%contact_state))           !! (m) [stress]
      type(contact_points_type) :: points
      integer :: first, i, last

      do i = 1, size(bodies%interfaces)
         first = bodies%points%interface_start(i)
         last = bodies%points%interface_start(i + 1) - 1
         call bodies%view(i, points)
         pressure(first:last) = pressures(points, state%force(first:last), &
            state%contact_state(first:last) /= contact_open)
      end do
   end function law_pressure

   !> Contact points that conduct by the closed law. Those without a gap touch and carry no
   !> pressure: before any mechanics, and where nothing presses them.
   elemental logical function touches(contact_state, gap)
      integer, intent(in) :: contact_state
      real(dp), intent(in) :: gap                    !! [length]

      touches = contact_state /= contact_open .or. gap <= 0.0_dp
   end function touches

   !> Nodal forces beside those of the stiffness: of thermal strains, and of all that the bodies
   !> have beyond their operators.
   pure function unstrained_forces(bodies, warming, beyond) result(forces)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: warming(:)         !! (nodes) since the initial state [temperature]
      real(dp), allocatable, intent(in) :: beyond(:)            !! (2 nodes), or none [force]
      real(dp) :: forces(2*size(warming))                       !! (2 nodes) [force]

      forces = 0.0_dp
      if (allocated(bodies%thermal_load%value)) then
         forces = bodies%thermal_load%multiply(warming)
      end if
      if (allocated(beyond)) forces = forces + beyond
   end function unstrained_forces

   !> Nodal forces that elongate the springs and trusses, as they are.
   pure function bar_forces(bodies, displacement, warming) result(forces)
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: displacement(:)    !! (2 nodes) [length]
      real(dp), intent(in) :: warming(:)         !! (nodes) since the initial state [temperature]
      real(dp) :: forces(size(displacement))     !! (2 nodes) [force]

      forces = 0.0_dp
      if (allocated(bodies%bar_stiffness%value)) forces = &
         bodies%bar_stiffness%multiply(displacement)
      if (allocated(bodies%bar_load%value)) forces = forces - bodies%bar_load%multiply(warming)
   end function bar_forces

   !> Relative change of omega by a few units in the last place of the displacements, and at
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

   !> Graphs of the conductance of all contact points.
   pure function make_graph(bodies, heat, length) result(graph)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      real(dp), intent(in) :: length                          !! of a rest, > 0 [length]
      type(conductance_graph_type), allocatable :: graph(:)   !! (m)
      real(dp) :: stiffness(size(bodies%points%weight)), weight(size(bodies%points%weight))
      real(dp), allocatable :: conductor(:)
      integer :: k

      allocate (graph(size(weight)))
      graph%law = bodies%laws%conductance
      weight = bodies%points%weight
      where (weight <= 0.0_dp) weight = maxval(weight)
      associate (alone => bodies%equilibrium%contact%alone)
         stiffness = max(alone, least_stiffness*maxval(alone))
      end associate
      where (stiffness <= 0.0_dp) stiffness = 1.0_dp
      graph%modulus = stiffness/weight
      if (.not. any([(law_jumps(graph(k)%law), k=1, size(graph))])) return
      conductor = heat%conductors(bodies)
      do k = 1, size(weight)
         if (bodies%points%weight(k) <= 0.0_dp .or. bodies%jump_index(k) == 0) cycle
         if (.not. law_jumps(graph(k)%law)) cycle
         graph(k)%width = length
         graph(k)%body = conductor(k)/weight(k)
      end do
   end function make_graph

   !> Openings of the contact points: gaps, or pressures as overlaps.
   pure function openings(bodies, graph, state) result(opening)
      type(reduced_bodies_type), intent(in) :: bodies
      type(conductance_graph_type), intent(in) :: graph(:)    !! (m) graphs of the conductance
      type(contact_state_type), intent(in) :: state
      real(dp) :: opening(size(graph))                        !! (m) [length]

      opening = -law_pressure(bodies, state)/graph%modulus
      where (state%contact_state == contact_open) opening = max(state%gap, 0.0_dp)
   end function openings

   !> Derivative of the openings by the conductances, for the state that the last pass found;
   !> unallocated where it does not exist. Contact points of weight 0 carry no heat: their rows stay
   !> 0.
   subroutine opening_derivative(bodies, heat, workspace, by_omega, state, derivative, body)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_workspace_type), intent(in) :: workspace  !! as the last pass left it
      !> of the last pass; receives how the heat of friction follows
      type(jump_derivatives_type), intent(inout) :: by_omega
      type(contact_state_type), intent(in) :: state
      real(dp), allocatable, intent(out) :: derivative(:, :)  !! (m, m)
      !> (m) conductance that the bodies put in series with each contact point, 1 where that means
      !> nothing
      real(dp), allocatable, intent(out) :: body(:)
      type(friction_tangent_type) :: tangent
      real(dp), allocatable :: change(:, :), load(:, :)
      integer :: k, m, n

      m = size(state%contact_state)
      allocate (derivative(m, m), source=0.0_dp)
      allocate (body(m), source=1.0_dp)
      n = size(by_omega%active)
      if (n == 0) return
      associate (tail_index => bodies%jump_index, active => by_omega%active)
         do k = 1, n
            associate (j => active(k))
               body(j) = (by_omega%heat(k)/by_omega%of_tail(tail_index(j), k) - &
                  workspace%tail%diagonal(tail_index(j)))/bodies%points%weight(j)
            end associate
         end do
         where (body <= 0.0_dp) body = 1.0_dp
         call tangent%make(bodies, heat, workspace, state)
         if (tangent%exists) then
            load = heat%loads_of_tail(bodies, by_omega%of_tail)
            call tangent%follow(bodies, heat, workspace, by_omega%of_tail, load, &
               by_omega%friction_heat)
            allocate (change(m, size(load, 2)))
            call opening_changes(bodies, workspace%pass%graph, tangent%contact, state, load, change)
            derivative(:, active) = change(:, :n)
            if (allocated(by_omega%at_edge)) derivative(:, by_omega%at_edge) = &
               derivative(:, by_omega%at_edge) + change(:, n + 1:)
         else
            deallocate (derivative)
         end if
      end associate
   end subroutine opening_derivative

   !> Derivative of the openings by the load factor at constant coordinates, for the state that the
   !> last pass found, with its derivative by the conductances.
   subroutine load_derivative(bodies, heat, data, state, workspace)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(increment_data_type), intent(in) :: data
      type(contact_state_type), intent(in) :: state
      type(increment_workspace_type), intent(inout) :: workspace !! receives the derivative
      type(jump_derivatives_type) :: by_factor
      type(friction_tangent_type) :: tangent
      real(dp) :: change(size(state%gap), 1)
      real(dp), allocatable :: load(:, :)

      by_factor%of_tail = reshape(data%rate%heat, [size(data%rate%heat), 1])
      call workspace%tail%solve_columns(by_factor%of_tail)
      load = reshape(data%rate%force, [size(data%rate%force), 1]) + &
         product_of(heat%jump_load, by_factor%of_tail)
      call tangent%make(bodies, heat, workspace, state)
      associate (pass => workspace%pass)
         if (.not. tangent%exists) then
            deallocate (pass%derivative)
            return
         end if
         call tangent%follow(bodies, heat, workspace, by_factor%of_tail, load, &
            by_factor%friction_heat)
         call opening_changes(bodies, pass%graph, tangent%contact, state, load, change)
         pass%by_factor = change(:, 1)
         if (.not. bodies%points%vary_with_temperature()) return
         change = changes_by_temperature(bodies, heat, workspace, pass%coordinates(), &
            by_factor%of_tail, by_factor%friction_heat, data%rate%mean)
         pass%by_factor = pass%by_factor + matmul(pass%derivative, change(:, 1))
      end associate
   end subroutine load_derivative

   !> Changes of the openings with the condensed mechanical load.
   pure subroutine opening_changes(bodies, graph, tangent, state, load, change, of_contact)
      type(reduced_bodies_type), intent(in) :: bodies
      type(conductance_graph_type), intent(in) :: graph(:)    !! (m) graphs of the conductance
      type(contact_workspace_type), intent(in) :: tangent     !! of the state, by make_tangent
      type(contact_state_type), intent(in) :: state
      real(dp), intent(in) :: load(:, :)                      !! (mechanical tail, n) [force]
      real(dp), intent(out) :: change(:, :)                   !! (m, n) [length]
      type(contact_change_type), intent(out), optional :: of_contact   !! with slips
      type(contact_change_type) :: found
      integer :: k

      call contact_response(bodies%equilibrium%contact, tangent, state, load, found, &
         present(of_contact))
      change = 0.0_dp
      associate (weight => bodies%points%weight)
         do k = 1, size(graph)
            if (weight(k) <= 0.0_dp) cycle
            if (state%contact_state(k) == contact_open) then
               change(k, :) = found%gap(k, :)
            else
               change(k, :) = -found%force(k, :)/(weight(k)*graph(k)%modulus)
            end if
         end do
      end associate
      if (present(of_contact)) of_contact = found
   end subroutine opening_changes

end module contact_operator
