!> One increment on the contact points: load, fixed-point iteration of section 4, and the fields
!> behind it.
module increment_solution
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use closing_instant, only: solve_increment
   use conductance_laws, only: law_jumps
   use contact_operator, only: contact_operator_pass, kept_contact, law_conductance, &
      temperature_jumps, thermal_forces
   use contact_states, only: contact_state_type, contact_open
   use contact_workspace, only: contact_workspace_type
   use coupled_increment, only: solve_coupled
   use errors, only: error_type, status_no_convergence
   use field_problem, only: field_load_type
   use films, only: film_history
   use finite_values, only: check_finite
   use friction_memory, only: remember_slip
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use loads, only: loads_type
   use all_contact_points, only: held_approach
   use reduced_bodies, only: reduced_bodies_type
   use scheme_properties, only: is_explicit
   use scheme_start, only: warn_of_imbalance
   use solution_report, only: solution_report_type, iteration_record_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics, step_type
   use thermal_matrix, only: field_history, scheme_load
   use unconstrained_motions, only: balanced_load, least_drive
   implicit none
   private
   public :: solve_points, recover_fields

contains

   !> Jumps, contact state and conductance at the end of an increment, and the temperatures that
   !> belong to welded contacts. A field that the step does not solve stays.
   !> Errors: no convergence of the fixed point or of the contact zones, unconstrained bodies,
   !> loads that overflow.
   subroutine solve_points(bodies, loads, step, previous, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads                      !! loads at the end
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(in) :: previous          !! state at the start
      type(increment_workspace_type), intent(inout) :: workspace !! a fresh one
      !> guess and loads at the end in, solution out
      type(solution_state_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error
      type(increment_data_type) :: data

      data%scheme = step%scheme
      data%previous = previous%contact
      data%omega_old = previous%omega
      data%jump_old = previous%jump
      next%omega_start = data%omega_old
      next%keeps_imbalance = .false.
      workspace%record%coupling_gain = ieee_value(1.0_dp, ieee_quiet_nan)
      workspace%record%coupling_gain_max = workspace%record%coupling_gain
      if (solves_heat(step%analysis)) then
         call load_heat(bodies, loads, previous, data, workspace, next)
         call check_finite([workspace%heat%condensed, next%temperature], &
            'heat and temperatures', status_no_convergence, error)
         if (allocated(error)) return
         call warn_of_imbalance(bodies, loads, data, previous, next, workspace%record)
         if (size(next%omega) > 0 .and. .not. bodies%is_coupled) then
            call conduct(bodies, previous, data, workspace, next)
         end if
      end if
      if (.not. solves_mechanics(step%analysis)) return
      data%displacement_scale = maxval(abs(previous%displacement))
      data%expansion = bodies%largest_expansion
      next%contact%reference = previous%contact%tangential
      if (.not. solves_heat(step%analysis)) call give_temperatures(bodies, loads, previous, next)
      call load_mechanics(bodies, loads, next, workspace, data%welded_load)
      call check_finite([workspace%force%rhs(:, 1), data%welded_load], 'forces', &
         status_no_convergence, error)
      if (allocated(error)) return
      if (.not. bodies%is_coupled) then
         call solve_mechanics(bodies, step, data, workspace, next, error)
      else if (is_explicit(step%scheme)) then
         call pass_once(bodies, previous, data, workspace, next, error)
      else
         call solve_coupled(bodies, step, previous, data, workspace, next, error)
      end if
      if (.not. allocated(error)) call settle_idle_points(bodies, workspace%contact%idle, next)
      next%has_mechanics = .true.
   end subroutine solve_points

   !> Idle contact points count as open without a gap; where their law jumps they rest. For the next
   !> increment they are closed still: the body stays where it touches.
   pure subroutine settle_idle_points(bodies, idle, next)
      type(reduced_bodies_type), intent(in) :: bodies
      logical, intent(in) :: idle(:)
      type(solution_state_type), intent(inout) :: next

      next%idle = idle
      next%resting = next%resting .or. (next%idle .and. law_jumps(bodies%points%law))
   end subroutine settle_idle_points

   !> Contact of an increment whose temperatures do not depend on it.
   subroutine solve_mechanics(bodies, step, data, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(step_type), intent(in) :: step
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error

      call solve_increment(bodies%contact, data%previous, data%welded_load, workspace%contact, &
         next%contact, error)
      if (allocated(error)) return
      next%omega = law_conductance(bodies, next%contact)
      next%omega_before = next%omega
      next%resting = .false.
      if (.not. solves_heat(step%analysis) .or. size(next%omega) == 0) return
      ! U is constant, and so are its fixed point and its derivative, zero.
      workspace%record%coupling_gain = 0.0_dp
      workspace%record%coupling_gain_max = 0.0_dp
      workspace%record%iterations = [only_pass(workspace%record, data%previous, next%contact)]
   end subroutine solve_mechanics

   !> Temperatures that a step without heat gives, and the jumps between them.
   subroutine give_temperatures(bodies, loads, previous, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: previous
      type(solution_state_type), intent(inout) :: next

      real(dp), dimension(size(next%jump)) :: jump, before

      call loads%set_temperatures(next%temperature)
      jump = bodies%points%jumps(next%temperature)
      before = bodies%points%jumps(previous%temperature)
      where (abs(jump - before) > 0.0_dp) next%jump = jump
   end subroutine give_temperatures

   !> Jumps and temperatures of an increment whose mechanics they do not depend on, for want of it
   !> or because the conductance is constant: it is that of the contact state that stays, at both
   !> ends of the increment.
   subroutine conduct(bodies, previous, data, workspace, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: previous
      type(increment_data_type), intent(inout) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next

      next%omega = law_conductance(bodies, kept_contact(previous%contact, &
         previous%has_mechanics))
      where (previous%resting) next%omega = previous%omega
      data%omega_old = next%omega
      call temperature_jumps(bodies, data, next%omega, workspace, next%jump)
      next%omega_before = next%omega
      next%omega_start = next%omega
      next%temperature = temperatures(bodies, workspace%heat, next%jump)
   end subroutine conduct

   !> Temperatures of the whole bodies with these jumps.
   function temperatures(bodies, load, jump) result(values)
      type(reduced_bodies_type), intent(in) :: bodies
      type(field_load_type), intent(in) :: load
      real(dp), intent(in) :: jump(:)
      real(dp) :: values(bodies%thermal%matrix%row_count)
      real(dp) :: on_tail(bodies%thermal%map%tail)
      integer :: k

      ! Forces of links act on jumps only, nothing is recovered from them.
      on_tail = 0.0_dp
      do k = 1, size(jump)
         if (bodies%jump_index(k) > 0) on_tail(bodies%jump_index(k)) = jump(k)
      end do
      values = bodies%thermal%recover(load, on_tail)
   end function temperatures

   !> An increment explicit in omega: temperatures by the conductance at its start, then mechanics,
   !> then the conductance at its end. Nothing is iterated.
   subroutine pass_once(bodies, previous, data, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: previous
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error

      workspace%pass%omega = previous%omega
      call contact_operator_pass(bodies, data, workspace, next%jump, next%contact, error)
      if (allocated(error)) return
      next%omega = workspace%pass%image
      next%omega_before = previous%omega
      next%resting = .false.
      workspace%record%iterations = [only_pass(workspace%record, previous%contact, next%contact)]
   end subroutine pass_once

   !> Record of the only pass of an increment.
   pure function only_pass(record, before, after) result(pass)
      type(solution_report_type), intent(in) :: record
      type(contact_state_type), intent(in) :: before, after
      type(iteration_record_type) :: pass

      pass = iteration_record_type(increment=record%increment, iteration=1, &
         pairs_changed=count(after%contact_state /= before%contact_state))
   end function only_pass

   !> Thermal load of the increment, and the temperatures that it gives with all jumps zero.
   subroutine load_heat(bodies, loads, previous, data, workspace, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: previous
      type(increment_data_type), intent(inout) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      real(dp), allocatable :: forces(:), zero(:)

      associate (given => loads%temperature%value)
         forces = field_history(data%scheme, bodies%thermal%matrix, previous%temperature) + &
            film_history(data%scheme, previous%film, next%film, previous%temperature) + &
            scheme_load(data%scheme, previous%heat_load, next%heat_load)
         workspace%heat = bodies%thermal%load_of(forces, given)
         call bodies%thermal%condense_load(workspace%heat)
         data%held_jump = bodies%points%jumps(given)
         where (bodies%jump_index > 0) data%held_jump = 0.0_dp
         allocate (zero(bodies%thermal%map%tail), source=0.0_dp)
         next%temperature = bodies%thermal%recover(workspace%heat, zero)
      end associate
   end subroutine load_heat

   !> Mechanical load of the increment, with the temperatures of load_heat or those that stay; and
   !> what it makes on the contact without jumps.
   subroutine load_mechanics(bodies, loads, next, workspace, welded_load)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads
      type(solution_state_type), intent(in) :: next
      type(increment_workspace_type), intent(inout) :: workspace
      real(dp), allocatable, intent(out) :: welded_load(:)
      real(dp) :: thermal(2*size(next%temperature))

      thermal = thermal_forces(bodies, next%temperature)
      workspace%force = bodies%mechanical%load_of(next%force_load + thermal, &
         loads%displacement%value)
      call bodies%mechanical%condense_load(workspace%force)
      workspace%contact = contact_workspace_type(bodies%contact, bodies%points%initial_gap - &
         held_approach(bodies%points, loads%displacement%value))
      workspace%contact%load_scale = max(maxval(abs(next%force_load)), maxval(abs(thermal)))
      associate (applied => next%force_load, rigid => bodies%rigid)
         workspace%contact%least_drive = least_drive(bodies%contact%rigid, &
            matmul(abs(applied), abs(rigid)))
         welded_load = balanced_load(workspace%force%condensed, bodies%contact%rigid, &
            bodies%contact%motion, matmul(applied, rigid))
      end associate
   end subroutine load_mechanics

   !> Fields of the whole bodies, from the solution on the contact points, and what contact points
   !> remember of it.
   subroutine recover_fields(bodies, loads, step, workspace, previous, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(loads_type), intent(in) :: loads                      !! loads at the end
      type(step_type), intent(in) :: step
      type(increment_workspace_type), intent(inout) :: workspace !! of the solution
      type(solution_state_type), intent(in) :: previous          !! state at the start
      type(solution_state_type), intent(inout) :: next           !! as solve_points left it
      real(dp), allocatable :: on_tail(:)
      integer :: k

      next%smallest_gap = min(previous%smallest_gap, next%contact%gap)
      if (.not. solves_mechanics(step%analysis)) return
      if (bodies%is_coupled) then
         next%temperature = temperatures(bodies, workspace%heat, next%jump)
         workspace%force = bodies%mechanical%load_of(next%force_load + &
            thermal_forces(bodies, next%temperature), loads%displacement%value)
      end if
      allocate (on_tail(bodies%mechanical%map%tail))
      associate (contact => bodies%contact)
         on_tail(contact%normal) = merge(next%contact%approach, &
            workspace%contact%initial_gap - next%contact%gap, next%contact%contact_state == &
            contact_open)
         do k = 1, size(next%contact%contact_state)
            if (contact%tangent(k) > 0) on_tail(contact%tangent(k)) = next%contact%tangential(k)
         end do
         on_tail(contact%link) = next%contact%link
      end associate
      next%displacement = bodies%mechanical%recover(workspace%force, on_tail)
      next%stress_temperature = next%temperature
      call remember_slip(bodies, workspace%contact, previous, next)
   end subroutine recover_fields

end module increment_solution
