!> Load stepping: one call of advance solves one increment.
module increments
   use contact_operator, only: contact_operator_pass, increment_data_type, &
      law_conductance, residual_floor
   use contact_system, only: closing_law_type, contact_state_type
   use clock, only: wall_seconds
   use closing_instant, only: solve_increment
   use errors, only: error_type, set_error, status_internal, status_no_convergence
   use field_recovery, only: make_points, point_map_type
   use fixed_point, only: accelerator_type, fixed_point_residual, make_accelerator, &
      predicted_conductance
   use increment_records, only: make_record
   use interface_operators, only: interface_operators_type
   use kinds, only: dp
   use load_courses, only: step_clock_type
   use loads, only: loads_type
   use model, only: model_type
   use records, only: increment_record_type, iteration_record_type, status_open
   use solution_state, only: solution_state_type
   use steps, only: analysis_coupled, step_type
   use text, only: to_text
   use thermal_matrix, only: field_history, scheme_load
   implicit none
   private
   public :: simulation_type, run_seconds_type

   real(dp), parameter :: remainder = 1.0e-6_dp !! part of an increment too small for one
   real(dp), parameter :: sound_violation = 1.0e-6_dp !! largest violation of a sound state

   !> Where the time goes.
   type :: run_seconds_type
      real(dp) :: assemble = 0.0_dp   !! pairing and matrices of the bodies [s]
      real(dp) :: reduce = 0.0_dp     !! factors and reduction to the pairs [s]
      real(dp) :: iterate = 0.0_dp    !! increments on the pairs [s]
      real(dp) :: recover = 0.0_dp    !! fields and balances [s]
   end type run_seconds_type

   !> A run: the reduced bodies, the loads and the state, moved on by advance.
   type :: simulation_type
      type(interface_operators_type) :: operators   !! the bodies reduced to their contact unknowns
      type(point_map_type) :: points                !! where averaged fields live
      type(loads_type) :: loads                     !! loads and supports
      type(solution_state_type) :: state            !! state at the end of the last increment
      integer :: step = 0                           !! present step
      real(dp) :: step_time = 0.0_dp                !! time since its start [time]
      real(dp) :: step_start = 0.0_dp               !! total time at its start [time]
      integer :: increments_of_step = 0             !! increments of the present step so far
      integer :: increments = 0                     !! increments so far
      type(run_seconds_type) :: seconds             !! where the time went
      logical :: is_reduced = .false.               !! whether the bodies are reduced for this step
      logical :: with_heat = .false.                !! whether the present step solves heat
   contains
      procedure :: start
      procedure :: reduce
      procedure :: finished
      procedure :: advance
      procedure :: release
   end type simulation_type

contains

   !> Prepares a run and enters its first step.
   !> Errors: as interface_operators' prepare and number.
   subroutine start(self, model, error)
      class(simulation_type), intent(inout) :: self       !! a fresh run
      type(model_type), intent(in) :: model               !! the model
      type(error_type), allocatable, intent(out) :: error !! see above
      type(contact_state_type) :: untouched
      real(dp) :: since

      since = wall_seconds()
      call self%operators%prepare(model, error)
      if (allocated(error)) return
      self%points = make_points(model%mesh)
      call self%loads%prepare(model)
      associate (m => size(self%operators%pairs%slave), n => size(model%mesh%node_number))
         allocate (untouched%status(m), source=status_open)
         allocate (untouched%direction(m), source=0)
         allocate (untouched%reference(m), untouched%tangential(m), untouched%force(m), &
            untouched%shear_force(m), source=0.0_dp)
         untouched%gap = self%operators%pairs%initial_gap
         self%state%contact = untouched
         self%state%omega = law_conductance(self%operators, untouched)
         self%state%omega_before = self%state%omega
         allocate (self%state%closing(m), self%state%jump(m), source=0.0_dp)
         allocate (self%state%displacement(2*n), self%state%heat_load(n), source=0.0_dp)
         self%state%temperature = model%initial_temperature
      end associate
      self%seconds%assemble = (wall_seconds() - since)
      call enter_step(self, model, error)
   end subroutine start

   !> Whether all steps are solved.
   pure function finished(self, model) result(done)
      class(simulation_type), intent(in) :: self   !! the run
      type(model_type), intent(in) :: model        !! the model
      logical :: done                              !! nothing is left

      done = self%step == size(model%steps) .and. step_is_over(self, model%steps(self%step))
   end function finished

   pure function step_is_over(self, step) result(over)
      class(simulation_type), intent(in) :: self
      type(step_type), intent(in) :: step
      logical :: over

      over = self%step_time >= step%period - remainder*step%first_increment
   end function step_is_over

   !> Solves the next increment. On failure the state is that of the last good increment and the
   !> record holds the iterations of the failing one.
   !> Errors: no convergence, more increments than INC allows, bodies that nothing holds, a failed
   !> self-check.
   subroutine advance(self, model, record, error)
      class(simulation_type), intent(inout) :: self         !! the run
      type(model_type), intent(in) :: model                 !! the model
      type(increment_record_type), intent(out) :: record    !! the increment
      type(error_type), allocatable, intent(out) :: error   !! see above
      type(solution_state_type) :: next
      type(step_clock_type) :: clock
      real(dp) :: since

      if (step_is_over(self, model%steps(self%step))) then
         self%step_start = self%step_start + model%steps(self%step)%period
         call enter_step(self, model, error)
         if (allocated(error)) return
      end if
      if (.not. self%is_reduced) call self%reduce(model, error)
      if (allocated(error)) return
      associate (step => model%steps(self%step))
         record%increment = self%increments + 1
         record%step = self%step
         clock = next_instant(self, model, step)
         record%time = clock%total_time
         call self%loads%move_to(clock, model)
         record%load = self%loads%axis_value(model, record%time)
         if (self%increments_of_step == step%max_increments) then
            call set_error(error, status_no_convergence, 'step '//to_text(self%step)// &
               ' is not over after INC='//to_text(step%max_increments)//' increments')
            return
         end if
         next = self%state
         next%increment_size = clock%step_time - self%step_time
         call solve_state(self, model, step, next, record, error)
         if (allocated(error)) then
            error%message = 'increment '//to_text(record%increment)//' (time '// &
               to_text(record%time)//'): '//error%message
            return
         end if
         since = wall_seconds()
         call make_record(self%operators, model, self%points, self%loads, self%with_heat, &
            self%state, next, record)
         self%seconds%recover = self%seconds%recover + (wall_seconds() - since)
         if (record%contact_violation > sound_violation) then
            call set_error(error, status_internal, 'increment '//to_text(record%increment)// &
               ': the recovered displacements violate the contact conditions by '// &
               to_text(record%contact_violation))
            return
         end if
         self%state = next
         self%step_time = clock%step_time
         self%increments = self%increments + 1
         self%increments_of_step = self%increments_of_step + 1
         record%last_of_step = step_is_over(self, step)
      end associate
   end subroutine advance

   !> Assembles the bodies, where that is not done, and reduces them to their contact unknowns.
   !> Errors: as interface_operators' reduce.
   subroutine reduce(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model               !! the model
      type(error_type), allocatable, intent(out) :: error !! see above
      real(dp) :: since

      since = wall_seconds()
      if (.not. allocated(self%operators%mechanical%matrix%value)) then
         call self%operators%assemble(model, any(model%steps%analysis == analysis_coupled))
      end if
      self%seconds%assemble = self%seconds%assemble + (wall_seconds() - since)
      since = wall_seconds()
      call self%operators%reduce(model, self%with_heat, error)
      self%is_reduced = .not. allocated(error)
      self%seconds%reduce = self%seconds%reduce + (wall_seconds() - since)
   end subroutine reduce

   !> Enters the next step; the bodies must be reduced again only where supports changed.
   subroutine enter_step(self, model, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, allocatable :: held(:), held_temperature(:)
      logical :: heat

      self%step = self%step + 1
      self%step_time = 0.0_dp
      self%increments_of_step = 0
      held = self%loads%displacement%active
      held_temperature = self%loads%temperature%active
      call self%loads%begin_step(model%steps(self%step))
      heat = model%steps(self%step)%analysis == analysis_coupled
      if (self%step > 1 .and. (heat .eqv. self%with_heat)) then
         if (all(held .eqv. self%loads%displacement%active) .and. &
            all(held_temperature .eqv. self%loads%temperature%active)) return
      end if
      self%with_heat = heat
      self%is_reduced = .false.
      call self%operators%number(model, self%loads%displacement%active, &
         self%loads%temperature%active, heat, error)
   end subroutine enter_step

   !> The end of the next increment: the next multiple of the first increment, reckoned and not
   !> added up, or without DIRECT an earlier instant on which the step must land.
   pure function next_instant(self, model, step) result(clock)
      class(simulation_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(step_clock_type) :: clock
      real(dp) :: least, offset
      integer :: i, k

      least = self%step_time + remainder*step%first_increment
      clock%step_time = (floor(least/step%first_increment) + 1)*step%first_increment
      if (.not. step%direct) then
         do i = 1, size(model%verifications)
            if (model%verifications(i)%at_last) cycle
            clock%step_time = earlier(clock%step_time, least, &
               model%verifications(i)%when - self%step_start)
         end do
         do i = 1, size(model%amplitudes)
            associate (curve => model%amplitudes(i))
               offset = merge(self%step_start, 0.0_dp, curve%total_time)
               do k = 1, size(curve%times)
                  clock%step_time = earlier(clock%step_time, least, curve%times(k) - offset)
               end do
            end associate
         end do
      end if
      if (clock%step_time > step%period - remainder*step%first_increment) then
         clock%step_time = step%period
      end if
      clock%period = step%period
      clock%total_time = self%step_start + clock%step_time
      clock%ramped = step%ramped
   end function next_instant

   !> The earlier of an instant and another one that lies behind the least.
   pure function earlier(instant, least, other) result(first)
      real(dp), intent(in) :: instant, least, other
      real(dp) :: first

      first = instant
      if (other > least .and. other < instant) first = other
   end function earlier

   !> Temperatures, displacements and contact state at the end of an increment.
   subroutine solve_state(self, model, step, next, record, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(solution_state_type), intent(inout) :: next
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(increment_data_type) :: data
      real(dp) :: since

      since = wall_seconds()
      data%scheme = step%scheme
      data%previous = self%state%contact
      data%omega_old = self%state%omega
      data%jump_old = self%state%jump
      data%displacement_scale = maxval(abs(self%state%displacement))
      next%contact%reference = self%state%contact%tangential
      self%operators%contact%closing = closing_law_type()
      call self%operators%contact%forget_factors()
      if (self%with_heat) call load_heat(self, data, next)
      call load_mechanics(self, model, data, next)
      if (self%with_heat .and. size(next%omega) > 0) then
         call iterate(self, step, data, next, record, error)
      else
         call solve_increment(self%operators%contact, data%previous, data%welded_load, &
            next%contact, error)
         if (allocated(error)) return
         next%omega = law_conductance(self%operators, next%contact)
         next%omega_before = next%omega
      end if
      self%seconds%iterate = self%seconds%iterate + (wall_seconds() - since)
      if (allocated(error)) return
      since = wall_seconds()
      call recover_fields(self, model, next)
      self%seconds%recover = self%seconds%recover + (wall_seconds() - since)
   end subroutine solve_state

   !> Thermal load of the increment, and the temperatures that it gives with all jumps zero.
   subroutine load_heat(self, data, next)
      class(simulation_type), intent(inout) :: self
      type(increment_data_type), intent(inout) :: data
      type(solution_state_type), intent(inout) :: next
      real(dp), allocatable :: forces(:), zero(:)

      associate (operators => self%operators, given => self%loads%temperature%value)
         forces = field_history(data%scheme, operators%thermal%matrix, self%state%temperature) + &
            scheme_load(data%scheme, self%state%heat_load, next%heat_load)
         call operators%thermal%set_load(forces, given)
         data%held_jump = given(operators%pairs%slave) - given(operators%pairs%master)
         where (operators%jump_place > 0) data%held_jump = 0.0_dp
         allocate (data%diagonal(operators%thermal%map%tail), source=-1.0_dp)
         allocate (zero(operators%thermal%map%tail), source=0.0_dp)
         next%temperature = operators%thermal%recover(zero)
      end associate
   end subroutine load_heat

   !> Mechanical load of the increment, with the temperatures of load_heat or those that stay.
   subroutine load_mechanics(self, model, data, next)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(increment_data_type), intent(inout) :: data
      type(solution_state_type), intent(inout) :: next

      associate (operators => self%operators)
         next%force_load = self%loads%nodal_forces(model)
         call operators%mechanical%set_load(next%force_load + operators%thermal_load%multiply( &
            next%temperature - model%initial_temperature), self%loads%displacement%value)
         data%welded_load = operators%mechanical%condensed
      end associate
   end subroutine load_mechanics

   !> The fixed-point iteration omega = U(omega) of an increment, section 4.
   subroutine iterate(self, step, data, next, record, error)
      class(simulation_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      type(increment_data_type), intent(inout) :: data
      type(solution_state_type), intent(inout) :: next
      type(increment_record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      class(accelerator_type), allocatable :: accelerator
      type(iteration_record_type) :: passes(step%fixed_point%max_iterations)
      real(dp) :: image(size(next%omega)), ratio
      integer :: status_before(size(next%omega)), i

      ratio = 1.0_dp
      if (self%increments > 0) ratio = next%increment_size/self%state%increment_size
      next%omega = predicted_conductance(self%state%omega, self%state%omega_before, ratio)
      call make_accelerator(step%fixed_point, size(next%omega), accelerator)
      do i = 1, step%fixed_point%max_iterations
         status_before = next%contact%status
         call contact_operator_pass(self%operators, data, next%omega, next%jump, next%contact, &
            image, record%work, error)
         if (allocated(error)) exit
         record%residual_floor = residual_floor(self%operators, data, next%contact, image)
         passes(i) = iteration_record_type(increment=record%increment, iteration=i, &
            residual=fixed_point_residual(next%omega, image), g_min=minval(accelerator%g), &
            g_max=maxval(accelerator%g), g_kept=accelerator%kept, &
            pairs_changed=count(next%contact%status /= status_before))
         if (passes(i)%residual <= max(step%fixed_point%tolerance, record%residual_floor)) exit
         call accelerator%next(i, next%omega, image)
      end do
      next%omega_before = self%state%omega
      record%iterations = passes(:min(i, size(passes)))
      if (allocated(error)) then
         record%iterations = passes(:i - 1)
      else if (i > size(passes)) then
         call set_error(error, status_no_convergence, 'the conductance does not converge in '// &
            to_text(size(passes))//' iterations; last residual '// &
            to_text(passes(size(passes))%residual)//', wanted '// &
            to_text(max(step%fixed_point%tolerance, record%residual_floor)))
      end if
   end subroutine iterate

   !> Fields of the whole bodies, from the solution on the pairs.
   subroutine recover_fields(self, model, next)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(inout) :: next
      real(dp), allocatable :: on_tail(:)
      integer :: k

      associate (operators => self%operators)
         if (self%with_heat) then
            allocate (on_tail(operators%thermal%map%tail))
            do k = 1, size(next%jump)
               if (operators%jump_place(k) > 0) on_tail(operators%jump_place(k)) = next%jump(k)
            end do
            next%temperature = operators%thermal%recover(on_tail)
            deallocate (on_tail)
            call operators%mechanical%set_load(next%force_load + &
               operators%thermal_load%multiply(next%temperature - model%initial_temperature), &
               self%loads%displacement%value)
         end if
         allocate (on_tail(operators%mechanical%map%tail))
         on_tail(operators%contact%normal) = operators%pairs%initial_gap - next%contact%gap
         do k = 1, size(next%contact%status)
            if (operators%contact%tangent(k) > 0) then
               on_tail(operators%contact%tangent(k)) = next%contact%tangential(k)
            end if
         end do
         next%displacement = operators%mechanical%recover(on_tail)
      end associate
   end subroutine recover_fields

   !> Frees the factors.
   subroutine release(self)
      class(simulation_type), intent(inout) :: self   !! the run

      call self%operators%release()
   end subroutine release

end module increments
