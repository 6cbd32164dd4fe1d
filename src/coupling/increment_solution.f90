!> One increment on the contact points: load, fixed-point iteration of section 4, the fields behind
!> it, and from where slip counts at its end.
module increment_solution
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use closing_instant, only: solve_increment
   use contact_heat, only: settle_conductance, temperature_jumps
   use contact_operator, only: contact_operator_pass, law_conductance, law_pressure, touches, &
      unstrained_forces
   use contact_system, only: contact_open, contact_slip, contact_state_type, &
      contact_system_type
   use contact_workspace, only: contact_workspace_type
   use coupled_increment, only: solve_coupled
   use edge_heat, only: edge_heat_type, joined_conductance
   use face_wear, only: worn_overlaps
   use errors, only: check_finite, error_type, set_error, status_no_convergence
   use fixed_point, only: pass_type
   use friction_heating, only: begin_friction, nodal_friction_heat
   use heat_equation, only: heat_equation_type
   use heat_reduction, only: heat_reduction_type
   use held_points, only: tangential_positions
   use increment_data, only: increment_data_type, increment_workspace_type, inside_heat, &
      inside_mechanics, load_places, of_heat, of_mechanics, trial_type
   use kinds, only: dp
   use loads, only: loads_type
   use overlap_laws, only: overlap_law_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_report, only: iteration_record_type, solution_report_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics, step_type
   use sum_lists, only: sum_list_type
   use temperature_laws, only: is_below_zero, law_jumps
   use text, only: to_text
   implicit none
   private
   public :: begin_increment, carry_to_faces, fill_bodies, load_points, solve_points, recover_fields

contains

   !> Jumps, contact state and conductance at the end of an increment, and the temperatures that
   !> belong to welded contacts. A field that the step does not solve stays.
   !> Errors: no convergence of the fixed point or of the contact zones, unconstrained bodies,
   !> loads that overflow.
   subroutine solve_points(bodies, heat, loads, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads            !! loads at the end
      !> data as begun and a fresh workspace in; data completed, solution out
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error

      if (.not. allocated(trial%known)) allocate (trial%known(load_places))
      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         next%edge = data%edge
         next%keeps_imbalance = solves_heat(data%analysis) .and. data%equation%never_damps()
         call adapt_contact(bodies, next%contact)
         workspace%record%coupling_gain = ieee_value(1.0_dp, ieee_quiet_nan)
         workspace%record%coupling_gain_max = workspace%record%coupling_gain
         if (solves_heat(data%analysis)) then
            call load_heat(bodies, heat, loads, trial, error)
            if (allocated(error)) return
            if (size(next%omega) > 0 .and. .not. bodies%is_coupled) then
               call conduct(bodies, heat, trial, error)
               if (.not. allocated(error)) call check_absolute_zero(bodies, workspace, error)
               if (allocated(error)) return
            end if
         end if
         if (solves_heat(data%analysis) .and. bodies%is_coupled) workspace%friction = data%friction
         if (solves_mechanics(data%analysis)) call solve_equilibrium(bodies, heat, loads, trial, &
            error)
         if (allocated(error)) return
         if (allocated(workspace%friction%heat)) data%friction%heat = workspace%friction%heat
         if (allocated(data%friction%heat)) next%friction_heat = data%friction%heat
         next%flux_conductance = data%equation%flux_conductance(joined_conductance(next%omega, &
            next%edge))
      end associate
   end subroutine solve_points

   !> Loads of an increment in which heat and mechanics are coupled, as solve_points has them.
   !> Errors: they overflow; as condense_load.
   subroutine load_points(bodies, heat, loads, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads            !! loads at the end
      type(trial_type), intent(inout) :: trial         !! data as begun, places for known loads in
      type(error_type), allocatable, intent(out) :: error

      call adapt_contact(bodies, trial%next%contact)
      call load_heat(bodies, heat, loads, trial, error)
      if (allocated(error)) return
      trial%workspace%friction = trial%data%friction
      call load_mechanics(bodies, heat, loads, trial, error)
   end subroutine load_points

   !> Heat load of an increment, condensed, and the temperatures that belong to welded contacts.
   !> Errors: they overflow; as condense_load.
   subroutine load_heat(bodies, heat, loads, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: inside(:), left(:)
      real(dp), allocatable :: sources(:)   ! (nodes) right-hand side of (3.4) over a1 [power]
      integer :: k

      sources = trial%data%equation%history(bodies%thermal%matrix)
      ! Heat of friction is known as far as it is made at the start.
      if (allocated(trial%data%friction%heat)) sources = sources + nodal_friction_heat(bodies, &
         trial%data%friction%parts(1, :)*trial%data%friction%old)
      associate (data => trial%data, temperature => trial%next%temperature, &
         given => loads%temperature%value)
         if (only_places(bodies, heat, trial)) call heat%condense_inside(bodies%thermal, sources, &
            given, trial%known(inside_heat), left, inside)
         data%heat = heat%load_of(bodies%thermal, sources, given, left)
         data%heat%rates = data%stored_norm
         call heat%condense_load(bodies%thermal, data%heat, trial%known(of_heat), error, &
            temperature, inside)
         if (allocated(error)) return
         ! Nodes of no element, to which bars are held, keep theirs.
         do k = 1, size(temperature)
            if (bodies%thermal%map%moves(k) .or. bodies%thermal%map%is_given(k)) cycle
            if (bodies%thermal%division%keeps(k)) temperature(k) = data%equation%temperature_old(k)
         end do
         data%held_jump = bodies%points%jumps(given)
         where (bodies%jump_index > 0) data%held_jump = 0.0_dp
         if (bodies%points%vary_with_temperature()) data%welded_mean = &
            bodies%points%means(temperature)
         call check_finite([data%heat%condensed, temperature], 'heat and temperatures', &
            status_no_convergence, error)
      end associate
   end subroutine load_heat

   !> Contact and conductance of an increment whose heat is loaded or solved.
   !> Errors: as solve_points.
   subroutine solve_equilibrium(bodies, heat, loads, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: jump(size(trial%next%jump))

      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         if (.not. solves_heat(data%analysis)) then
            call loads%set_temperatures(next%temperature)
            jump = bodies%points%jumps(next%temperature)
            where (abs(jump - bodies%points%jumps(data%equation%temperature_old)) > 0.0_dp) &
               next%jump = jump
         end if
         call load_mechanics(bodies, heat, loads, trial, error)
         if (allocated(error)) return
         if (.not. bodies%is_coupled) then
            call solve_mechanics(bodies, data, workspace, next, error)
         else if (data%equation%is_explicit()) then
            call pass_once(bodies, heat, trial, error)
         else
            call solve_coupled(bodies, heat, trial, error)
         end if
         next%has_mechanics = .true.
         if (allocated(error)) return
         ! Idle contact points count as open without a gap; where their law jumps they rest. For the
         ! next increment they are closed still: the body stays where it touches.
         next%idle = workspace%contact%idle
         next%resting = next%resting .or. (next%idle .and. law_jumps(bodies%laws%conductance))
         if (bodies%is_coupled) call check_absolute_zero(bodies, workspace, error)
      end associate
   end subroutine solve_equilibrium

   !> Begins a trial: the start of its increment under the laws of its step, whose contact points
   !> that it removes or adds have other conductances, and a fresh workspace.
   pure subroutine begin_increment(bodies, step, before, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(in) :: before      !! state at the start
      !> loads and size of the increment in its next state in; that and known loads stay
      type(trial_type), intent(inout) :: trial
      real(dp) :: omega(size(before%omega))
      logical :: is_new(size(before%omega))

      call trial%clear()
      associate (data => trial%data)
         data%analysis = step%analysis
         data%start = step%start
         data%fixed_point = step%fixed_point
         data%follows_branch = step%continuation%is_on
         data%kept_imbalance = before%keeps_imbalance
         data%displacement_scale = bodies%largest_displacement(before%displacement)
         data%previous = before%contact
         call adapt_contact(bodies, data%previous)
         omega = law_conductance(bodies, before%temperature, before%jump, data%previous)
         is_new = bodies%laws%removed .or. before%omega <= 0.0_dp
         data%equation = heat_equation_type(step%scheme, before%sources, trial%next%sources, &
            before%temperature, bodies%points%weight, merge(omega, before%omega, is_new), &
            before%jump)
         data%omega_before = merge(omega, before%omega_before, is_new)
         data%resting = before%resting .and. .not. bodies%laws%removed
         if (.not. data%equation%takes_past_conductance()) data%edge = &
            before%edge%without(bodies%laws%removed)
         if (before%increment_size > 0.0_dp) data%size_ratio = &
            trial%next%increment_size/before%increment_size
         if (.not. allocated(bodies%points%heated)) return
         call begin_friction(bodies, data%equation, step%analysis, data%previous, &
            before%friction_heat, data%friction)
         data%friction%duration = trial%next%increment_size
      end associate
   end subroutine begin_increment

   !> Carries a state over to contact points that were placed anew on faces that slide: what they
   !> have of its displacements and temperatures where they are now. Slip counts on, and a force
   !> keeps its direction along the face.
   pure subroutine carry_to_faces(bodies, state)
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(inout) :: state
      real(dp), dimension(size(state%omega)) :: jump, normal, tangential
      logical :: moves(size(state%omega))

      moves = bodies%interfaces(bodies%points%interface)%follows_sliding
      tangential = tangential_positions(bodies%points, bodies%held_direction, state%displacement)
      normal = sum(bodies%points%normal*bodies%points%relative(state%displacement), dim=1)
      jump = bodies%points%jumps(state%temperature)
      state%edge = edge_heat_type()
      associate (contact => state%contact)
         where (moves)
            state%jump = jump
            contact%reference = contact%reference + tangential - contact%tangential
            contact%slip_origin = contact%slip_origin + tangential - contact%tangential
            contact%tangential = tangential
            contact%gap = bodies%points%initial_gap - normal - bodies%laws%reach
         end where
         if (allocated(contact%approach)) then
            where (moves) contact%approach = normal
         end if
      end associate
   end subroutine carry_to_faces

   !> Contact points that the step removes are open, those without friction slip freely.
   pure subroutine adapt_contact(bodies, contact)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_state_type), intent(inout) :: contact

      associate (removed => bodies%laws%removed)
         where (removed)
            contact%contact_state = contact_open
            contact%force = 0.0_dp
         end where
         where (.not. bodies%laws%friction%coefficient > 0.0_dp)
            contact%direction = 0
            contact%shear_force = 0.0_dp
            contact%contact_state = min(contact%contact_state, contact_slip)
         end where
      end associate
   end subroutine adapt_contact

   !> Contact of an increment whose temperatures do not depend on it.
   subroutine solve_mechanics(bodies, data, workspace, next, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      type(increment_workspace_type), intent(inout) :: workspace
      type(solution_state_type), intent(inout) :: next
      type(error_type), allocatable, intent(out) :: error

      call solve_increment(bodies%equilibrium%contact, data%previous, data%no_jump_load, &
         workspace%contact, workspace%sticking, next%contact, error)
      if (allocated(error)) return
      next%omega = law_conductance(bodies, next%temperature, next%jump, next%contact)
      next%omega_before = next%omega
      next%resting = .false.
      if (.not. solves_heat(data%analysis) .or. size(next%omega) == 0) return
      ! U is constant, and so are its fixed point and its derivative, zero.
      workspace%record%coupling_gain = 0.0_dp
      workspace%record%coupling_gain_max = 0.0_dp
      workspace%record%iterations = [only_pass(workspace%record, data%previous, next%contact)]
   end subroutine solve_mechanics

   !> Jumps and temperatures of an increment whose mechanics they do not depend on, for want of it
   !> or because the conductance is constant: it is that of the contact state that stays, at both
   !> ends of the increment; or it follows the temperatures.
   !> Error: no convergence to these.
   subroutine conduct(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error

      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         next%omega = law_conductance(bodies, data%equation%temperature_old, &
            data%equation%jump_old, data%previous)
         where (data%resting) next%omega = data%equation%omega_old
         data%equation%omega_old = next%omega
         workspace%edge = data%edge
         if (bodies%points%vary_with_temperature()) then
            call begin_graphs(bodies, data, next%omega, workspace%pass)
            call settle_conductance(bodies, heat, data, workspace, next%jump, error)
            if (allocated(error)) return
            next%omega = workspace%pass%omega
         else
            call temperature_jumps(bodies, heat, data, next%omega, workspace, next%jump)
         end if
         next%omega_before = next%omega
         next%temperature = next%temperature + [heat%extended(bodies%thermal, &
            reshape(workspace%on_tail, [size(workspace%on_tail), 1]))]
      end associate
   end subroutine conduct

   !> A pass with given conductances, the graphs of the laws, and the coordinates of a contact state
   !> that stays.
   subroutine begin_graphs(bodies, data, omega, pass)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_data_type), intent(in) :: data
      real(dp), intent(in) :: omega(:)
      type(pass_type), intent(out) :: pass

      pass%omega = omega
      allocate (pass%graph(size(omega)))
      pass%graph%law = bodies%laws%conductance_at( &
         bodies%points%means(data%equation%temperature_old), data%equation%jump_old)
      where (law_jumps(bodies%laws%conductance)) pass%graph%width = 1.0_dp
      associate (contact => data%previous)
         pass%coordinate = merge(-pass%graph%width - law_pressure(bodies, contact), contact%gap, &
            touches(contact%contact_state, contact%gap))
      end associate
      where (data%resting) pass%coordinate = pass%graph%coordinate_of_omega(omega, 0.0_dp)
   end subroutine begin_graphs

   !> Radiation has no meaning below absolute zero.
   !> Error: a face that radiates is below it.
   subroutine check_absolute_zero(bodies, workspace, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(increment_workspace_type), intent(in) :: workspace
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      if (.not. allocated(workspace%faces)) return
      k = findloc(is_below_zero(bodies%laws%conductance, workspace%faces), .true., dim=1)
      if (k == 0) return
      call set_error(error, status_no_convergence, 'contact pair '// &
         bodies%interfaces(bodies%points%interface(k))%name//' radiates below absolute zero, '// &
         to_text(bodies%laws%conductance(k)%by_temperature%absolute_zero)// &
         '; check ABSOLUTE ZERO= of *PHYSICAL CONSTANTS and the temperatures of the deck')
   end subroutine check_absolute_zero

   !> An increment explicit in omega: temperatures by the conductance at its start, then mechanics,
   !> then the conductance at its end. Nothing is iterated.
   subroutine pass_once(bodies, heat, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error

      associate (data => trial%data, workspace => trial%workspace, next => trial%next)
         workspace%pass%omega = data%equation%omega_old
         allocate (workspace%pass%graph(size(workspace%pass%omega)))
         workspace%pass%graph%law = bodies%laws%conductance
         call contact_operator_pass(bodies, heat, data, workspace, next%jump, next%contact, error)
         if (allocated(error)) return
         next%omega = workspace%pass%image
         next%omega_before = data%equation%omega_old
         next%resting = .false.
         workspace%record%iterations = [only_pass(workspace%record, data%previous, next%contact)]
      end associate
   end subroutine pass_once

   !> Record of the only pass of an increment.
   pure function only_pass(record, before, after) result(pass)
      type(solution_report_type), intent(in) :: record
      type(contact_state_type), intent(in) :: before, after
      type(iteration_record_type) :: pass

      pass = iteration_record_type(increment=record%increment, iteration=1, &
         pairs_changed=count(after%contact_state /= before%contact_state))
   end function only_pass

   !> Mechanical load of the increment, with the temperatures of welded contacts or those that stay;
   !> and what it makes on the contact without jumps.
   !> Error: it overflows.
   subroutine load_mechanics(bodies, heat, loads, trial, error)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(2*size(trial%next%temperature)) :: kept, thermal
      real(dp), dimension(bodies%rigid%count) :: along, sums   ! resultants, and without signs
      real(dp), allocatable :: left(:)
      type(overlap_law_type), allocatable :: overlap(:)
      type(sum_list_type) :: sizes

      trial%next%contact%reference = trial%data%previous%tangential
      associate (applied => trial%next%force_load, force => trial%data%force, &
         temperature => trial%next%temperature, given => loads%displacement%value, &
         work => trial%workspace%contact, contact => bodies%equilibrium%contact)
         kept = 0.0_dp
         if (only_places(bodies, heat, trial)) then
            ! Only what pieces keep of the temperatures depends on where faces are.
            thermal = unstrained_forces(bodies, merge(0.0_dp, temperature, &
               bodies%thermal%division%piece == 0) - loads%temperature%rest, &
               trial%next%forces_beyond)
            call bodies%equilibrium%condense_inside(bodies%mechanical, applied + thermal, given, &
               trial%known(inside_mechanics), left)
            call heat%add_kept_forces(temperature, kept)
            left = left + kept
         else
            thermal = unstrained_forces(bodies, temperature - loads%temperature%rest, &
               trial%next%forces_beyond)
         end if
         force = bodies%equilibrium%load_of(bodies%mechanical, applied + thermal, given, left)
         call bodies%equilibrium%condense_load(bodies%mechanical, force, &
            trial%known(of_mechanics), error)
         if (allocated(error)) return
         ! A solution with other corrections has the factors of the one before.
         if (.not. allocated(work%initial_gap)) then
            if (allocated(trial%data%wear_by_pressure)) then
               overlap = worn_overlaps(bodies, trial%data%wear_by_pressure)
            else if (allocated(bodies%laws%overlap)) then
               overlap = bodies%laws%overlap
            end if
            work = contact_workspace_type(contact, loads%present_gaps(bodies%points), &
               bodies%laws%nodal_friction, bodies%laws%removed, overlap, bodies%points%weight)
            if (allocated(trial%data%closing_start)) work%closing = trial%data%closing_start
            work%same_slip = trial%data%same_slip
         end if
         work%load_scale = max(maxval(abs(applied)), maxval(abs(thermal)), maxval(abs(kept)))
         along = 0.0_dp
         call bodies%rigid%add_totals(applied, along)
         sums = 0.0_dp
         sizes = bodies%rigid%without_signs()
         call sizes%add_totals(abs(applied), sums)
         work%least_drive = contact%motions%least_drive(sums)
         trial%data%no_jump_load = contact%motions%balanced(force%condensed, along)
         call check_finite([force%rhs(:, 1), trial%data%no_jump_load], 'forces', &
            status_no_convergence, error)
      end associate
   end subroutine load_mechanics

   !> Fields of the whole bodies, from the solution on the contact points, and what contact points
   !> remember of it.
   subroutine recover_fields(bodies, heat, loads, before, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads            !! loads at the end
      type(solution_state_type), intent(in) :: before  !! state at the start
      type(trial_type), intent(inout) :: trial         !! as solve_points left it
      real(dp), allocatable :: on_tail(:)
      real(dp) :: kept(2*size(trial%next%temperature))
      integer :: k

      associate (data => trial%data, workspace => trial%workspace, next => trial%next, &
         contact => bodies%equilibrium%contact)
         next%smallest_gap = min(before%smallest_gap, next%contact%gap)
         if (.not. solves_mechanics(data%analysis)) return
         if (only_places(bodies, heat, trial)) then
            kept = 0.0_dp
            call heat%add_kept_forces([heat%extended_to_kept(bodies%thermal, &
               reshape(workspace%on_tail, [size(workspace%on_tail), 1]))], kept)
            data%force%rhs(:, 1) = data%force%rhs(:, 1) + bodies%mechanical%map%restrict(kept)
         else if (bodies%is_coupled) then
            call complete_temperatures(bodies, heat, loads, trial)
         end if
         allocate (on_tail(bodies%mechanical%map%tail))
         on_tail(contact%normal) = merge(next%contact%approach, &
            workspace%contact%initial_gap - next%contact%gap, next%contact%contact_state == &
            contact_open .or. workspace%contact%soft%is_soft)
         do k = 1, size(next%contact%contact_state)
            if (contact%tangent(k) > 0) on_tail(contact%tangent(k)) = next%contact%tangential(k)
         end do
         on_tail(contact%link) = next%contact%link
         next%displacement = bodies%equilibrium%recover_kept(bodies%mechanical, data%force, on_tail)
         ! A sparse tail keeps of faces that slide what touches now, not what comes to touch.
         if ((data%is_corrected .or. .not. allocated(bodies%faces_at) .or. &
            bodies%mechanical%division%is_tail()) .and. allocated(data%force%forces)) then
            call bodies%equilibrium%pieces%fill(next%displacement, data%force%forces)
         end if
         next%stress_temperature = next%temperature
         call remember_slip(bodies, workspace%contact, before, next)
      end associate
   end subroutine recover_fields

   !> Whether a solution that only places faces that slide, and needs no values inside of bodies,
   !> has the forces of its jumps without them.
   pure logical function only_places(bodies, heat, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(trial_type), intent(in) :: trial

      only_places = bodies%is_coupled .and. allocated(bodies%faces_at) .and. .not. &
         (trial%data%is_corrected .or. allocated(bodies%worn))
      if (only_places) only_places = heat%has_tail_forces(bodies)
   end function only_places

   !> Temperatures that belong to the jumps of a solution, and the forces that they make.
   subroutine complete_temperatures(bodies, heat, loads, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads
      type(trial_type), intent(inout) :: trial         ! with the temperatures of welded contacts

      associate (workspace => trial%workspace, next => trial%next)
         next%temperature = next%temperature + [heat%extended(bodies%thermal, &
            reshape(workspace%on_tail, [size(workspace%on_tail), 1]))]
         if (allocated(workspace%friction%heat)) next%temperature = next%temperature + &
            heat%welded_response(bodies%thermal, nodal_friction_heat(bodies, &
            workspace%friction%parts(2, :)*workspace%friction%heat))
         trial%data%force = bodies%equilibrium%load_of(bodies%mechanical, next%force_load + &
            unstrained_forces(bodies, next%temperature - loads%temperature%rest, &
            next%forces_beyond), loads%displacement%value)
      end associate
   end subroutine complete_temperatures

   !> Values inside of bodies that are divided, of the last of the solutions that placed faces.
   subroutine fill_bodies(bodies, heat, loads, trial)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(loads_type), intent(in) :: loads            !! loads at the end
      type(trial_type), intent(inout) :: trial         !! as recover_fields left it
      real(dp) :: inside(size(trial%next%temperature))

      if (trial%data%is_corrected) return
      associate (next => trial%next, force => trial%data%force)
         if (only_places(bodies, heat, trial)) then
            inside = merge(next%temperature, 0.0_dp, bodies%thermal%division%piece > 0)
            next%temperature = next%temperature + [heat%extended_to_kept(bodies%thermal, &
               reshape(trial%workspace%on_tail, [size(trial%workspace%on_tail), 1]))]
            call heat%pieces%fill(next%temperature)
            next%temperature = next%temperature + inside
            force%forces = bodies%equilibrium%forces_inside(bodies%mechanical, next%force_load + &
               unstrained_forces(bodies, next%temperature - loads%temperature%rest, &
               next%forces_beyond), loads%displacement%value)
         end if
         next%stress_temperature = next%temperature
         if (allocated(force%forces)) call bodies%equilibrium%pieces%fill(next%displacement, &
            force%forces)
      end associate
   end subroutine fill_bodies

   !> Slip counts from the instant of closing. Tangential positions that the contact system does not
   !> carry, of contact points that are frictionless or held, are taken from the recovered
   !> displacements, and such a contact point closes where it is at that instant on the straight
   !> line between its ends.
   pure subroutine remember_slip(bodies, solved, before, next)
      type(reduced_bodies_type), intent(in) :: bodies
      type(contact_workspace_type), intent(in) :: solved      !! factors of the solution
      type(solution_state_type), intent(in) :: before         !! state at the start
      type(solution_state_type), intent(inout) :: next        !! state at the end, with its fields
      real(dp), dimension(size(next%contact%gap)) :: at_start, at_end
      integer :: k

      at_start = tangential_positions(bodies%points, bodies%held_direction, before%displacement)
      at_end = tangential_positions(bodies%points, bodies%held_direction, next%displacement)
      associate (contact => next%contact)
         do k = 1, size(at_end)
            if (bodies%equilibrium%contact%tangent(k) == 0) then
               contact%tangential(k) = at_end(k)
               contact%reference(k) = at_start(k) + &
                  closing_fraction(bodies%equilibrium%contact, solved, k, before%contact%gap(k), &
                  contact%force(k))*(at_end(k) - at_start(k))
            end if
            if (contact%contact_state(k) == contact_open .or. next%idle(k)) then
               contact%slip_origin(k) = contact%tangential(k)
            else if (before%contact%contact_state(k) == contact_open) then
               contact%slip_origin(k) = contact%reference(k)
            end if
         end do
      end associate
   end subroutine remember_slip

   !> Instant at which a contact point without a tangential unknown closed, as a fraction of the
   !> increment: relieved of its force alone it would overlap by force/stiffness; a soft face has
   !> its own overlap in series with the bodies. One that carries
   !> no force, as at rest, closes at the end.
   pure function closing_fraction(system, solved, k, gap, force) result(fraction)
      type(contact_system_type), intent(in) :: system
      type(contact_workspace_type), intent(in) :: solved
      integer, intent(in) :: k
      real(dp), intent(in) :: gap, force
      real(dp) :: fraction
      real(dp) :: response(system%schur%order, 1), stiffness(1, 1)

      fraction = merge(1.0_dp, 0.0_dp, gap > 0.0_dp)
      if (gap <= 0.0_dp .or. force <= 0.0_dp) return
      ! Zero where the contact point alone holds a body, but for rounding: it then closes at once.
      if (solved%soft%is_soft(k)) then
         response = 0.0_dp
         response(system%normal(k), 1) = 1.0_dp
         call solved%solve_free(response)
         stiffness = max(1.0_dp/response(system%normal(k), 1) - solved%soft%stiffness(k), 0.0_dp)
         stiffness = stiffness/(1.0_dp + stiffness*solved%soft%compliance(k, force))
      else
         stiffness = max(solved%stiffness(system, [system%normal(k)]), 0.0_dp)
      end if
      fraction = gap*stiffness(1, 1)/(gap*stiffness(1, 1) + force)
   end function closing_fraction

end module increment_solution
