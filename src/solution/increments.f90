!> Load stepping: one call of advance solves one increment.
module increments
   use clock, only: wall_seconds
   use contact_operator, only: law_conductance
   use contact_system, only: contact_state_type
   use errors, only: error_type, set_error, status_internal, status_no_convergence
   use field_recovery, only: make_points, point_map_type
   use increment_records, only: make_record
   use increment_solution, only: recover_fields, solve_pairs
   use films, only: left_films
   use interface_operators, only: interface_operators_type
   use kinds, only: dp, long
   use increment_instants, only: next_instant, step_is_over
   use load_courses, only: step_clock_type
   use loads, only: loads_type
   use loose_bodies, only: bodies_heated_by_no_pair, bodies_held_by_no_pair
   use model, only: model_type
   use records, only: increment_record_type, status_open
   use solution_state, only: solution_state_type
   use steps, only: load_temperature, solves_heat, solves_mechanics
   use text, only: to_text
   use thermal_matrix, only: contact_diagonal
   implicit none
   private
   public :: simulation_type, run_seconds_type, run_size_type

   real(dp), parameter :: sound_violation = 1.0e-6_dp !! largest violation of a sound state

   !> Where the time goes.
   type :: run_seconds_type
      real(dp) :: assemble = 0.0_dp   !! pairing and matrices of the bodies [s]
      real(dp) :: reduce = 0.0_dp     !! factors and reduction to the pairs [s]
      real(dp) :: iterate = 0.0_dp    !! increments on the pairs [s]
      real(dp) :: recover = 0.0_dp    !! fields and balances [s]
   end type run_seconds_type

   !> The largest problems of a run.
   type :: run_size_type
      integer :: equations_thermal = 0      !! unknown temperatures, largest of the steps
      integer :: equations_mechanical = 0   !! unknown displacements, largest of the steps
      integer :: contact_unknowns = 0       !! unknowns on the pairs, largest of the steps
      integer(long) :: factor_bytes = 0     !! bytes of factors, largest so far
   end type run_size_type

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
      type(run_size_type) :: sizes                  !! sizes over all steps
      logical :: with_heat = .false.                !! whether the present step solves heat
      logical :: with_mechanics = .false.           !! whether the present step solves mechanics
      logical, allocatable :: held(:)               !! (2 nodes) supports that are numbered
      logical, allocatable :: held_temperature(:)   !! (nodes) prescribed nodes that are numbered
      logical :: heat_is_reduced = .false.          !! whether heat is reduced as numbered
      logical :: mechanics_is_reduced = .false.     !! whether mechanics is reduced as numbered
   contains
      procedure :: start
      procedure :: reduce
      procedure :: finished
      procedure :: advance
      procedure :: release
   end type simulation_type

contains

   !> Prepares a run, sees whether its steps can all be numbered, and enters the first.
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
         self%state%omega_start = self%state%omega
         self%state%smallest_gap = untouched%gap
         allocate (self%state%resting(m), source=.false.)
         allocate (self%state%closing(m), source=0.0_dp)
         allocate (self%state%displacement(2*n), self%state%heat_load(n), source=0.0_dp)
         self%state%temperature = model%initial_temperature
         self%state%jump = model%initial_temperature(self%operators%pairs%slave) - &
            model%initial_temperature(self%operators%pairs%master)
      end associate
      self%seconds%assemble = (wall_seconds() - since)
      call measure_steps(self, model, error)
      if (.not. allocated(error)) call enter_step(self, model, error)
   end subroutine start

   !> Numbers every step in turn, for the largest problems and for mistakes in its supports.
   subroutine measure_steps(self, model, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(simulation_type) :: trial
      integer :: unknowns

      ! Supports turn the frames of pairs; those of later steps must not show in the first.
      trial%operators%pairs = self%operators%pairs
      trial%loads = self%loads
      trial%state = self%state
      do while (trial%step < size(model%steps))
         call enter_step(trial, model, error)
         if (allocated(error)) then
            if (size(model%steps) > 1) error%message = 'step '//to_text(trial%step)//': '// &
               error%message
            return
         end if
         unknowns = 0
         associate (sizes => self%sizes, thermal => trial%operators%thermal%map, &
            mechanical => trial%operators%mechanical%map)
            if (trial%with_heat) then
               sizes%equations_thermal = max(sizes%equations_thermal, thermal%equations)
               unknowns = thermal%tail
            end if
            if (trial%with_mechanics) then
               sizes%equations_mechanical = max(sizes%equations_mechanical, mechanical%equations)
               unknowns = unknowns + mechanical%tail
            end if
            sizes%contact_unknowns = max(sizes%contact_unknowns, unknowns)
         end associate
      end do
   end subroutine measure_steps

   !> Whether all steps are solved.
   pure function finished(self, model) result(done)
      class(simulation_type), intent(in) :: self   !! the run
      type(model_type), intent(in) :: model        !! the model
      logical :: done                              !! nothing is left

      done = self%step == size(model%steps) .and. step_is_over(model%steps(self%step), &
         self%step_time)
   end function finished

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

      if (step_is_over(model%steps(self%step), self%step_time)) then
         self%step_start = self%step_start + model%steps(self%step)%period
         call enter_step(self, model, error)
         if (allocated(error)) return
      end if
      clock = next_instant(model, model%steps(self%step), self%step_start, &
         self%step_time)
      call self%loads%move_to(clock, model)
      call self%reduce(model, error)
      if (allocated(error)) return
      next = self%state
      ! (3.4) asks for them at the start of the next increment, whether this one solves heat or not.
      if (any(solves_heat(model%steps%analysis))) then
         next%heat_load = self%loads%heat_load()
         next%film = self%loads%film_matrix()
      end if
      if (self%with_heat) then
         call self%operators%set_film(left_films(model%steps(self%step)%scheme, &
            self%state%film, next%film), model, error)
         if (allocated(error)) return
      end if
      associate (step => model%steps(self%step))
         record%increment = self%increments + 1
         record%step = self%step
         record%time = clock%total_time
         record%load = self%loads%axis_value(model, record%time)
         if (self%increments_of_step == step%max_increments) then
            call set_error(error, status_no_convergence, 'step '//to_text(self%step)// &
               ' is not over after INC='//to_text(step%max_increments)//' increments')
            return
         end if
         next%increment_size = clock%step_time - self%step_time
         since = wall_seconds()
         call solve_pairs(self%operators, self%loads, model, step, self%state, next, record, error)
         self%seconds%iterate = self%seconds%iterate + (wall_seconds() - since)
         if (self%with_heat) call check_heat(self, model, next, error)
         if (allocated(error)) then
            if (self%operators%contact%loose) error%message = error%message// &
               bodies_held_by_no_pair(model, self%operators%pairs, &
               self%loads%displacement%active, next%contact%status)
            error%message = 'increment '//to_text(record%increment)//' (time '// &
               to_text(record%time)//'): '//error%message
            return
         end if
         since = wall_seconds()
         call recover_fields(self%operators, self%loads, model, step, next)
         call make_record(self%operators, model, self%points, self%loads, step, self%state, next, &
            record)
         self%seconds%recover = self%seconds%recover + (wall_seconds() - since)
         if (self%with_mechanics) call check_violation(record, error)
         if (allocated(error)) return
         self%state = next
         self%step_time = clock%step_time
         self%increments = self%increments + 1
         self%increments_of_step = self%increments_of_step + 1
         record%last_of_step = step_is_over(step, self%step_time)
      end associate
   end subroutine advance

   !> The recovered displacements keep the contact conditions.
   subroutine check_violation(record, error)
      type(increment_record_type), intent(in) :: record
      type(error_type), allocatable, intent(out) :: error

      if (record%contact_violation <= sound_violation) return
      call set_error(error, status_internal, 'increment '//to_text(record%increment)// &
         ': the recovered displacements violate the contact conditions by '// &
         to_text(record%contact_violation))
   end subroutine check_violation

   !> Names the bodies whose temperature the conductances of an increment leave undetermined, in
   !> place of whatever error followed from it.
   subroutine check_heat(self, model, next, error)
      class(simulation_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: next
      type(error_type), allocatable, intent(inout) :: error
      character(:), allocatable :: words

      associate (pairs => self%operators%pairs)
         words = bodies_heated_by_no_pair(model, pairs, self%loads%temperature%active, self%step, &
            contact_diagonal(model%steps(self%step)%scheme, pairs%weight, next%omega_start, &
            next%omega) > 0.0_dp)
      end associate
      if (len(words) == 0) return
      if (allocated(error)) deallocate (error)
      call set_error(error, status_no_convergence, words)
   end subroutine check_heat

   !> Assembles the bodies, where that is not done, and reduces the fields of the present step to
   !> their contact unknowns, where that is not done.
   !> Errors: as interface_operators' reduce.
   subroutine reduce(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model               !! the model
      type(error_type), allocatable, intent(out) :: error !! see above
      logical :: heat, mechanics
      real(dp) :: since

      since = wall_seconds()
      mechanics = self%with_mechanics .and. .not. self%mechanics_is_reduced
      heat = self%with_heat .and. .not. self%heat_is_reduced
      if (.not. (allocated(self%operators%mechanical%matrix%value) .or. &
         allocated(self%operators%thermal%matrix%value))) then
         call self%operators%assemble(model, any(solves_mechanics(model%steps%analysis)), &
            any(solves_heat(model%steps%analysis)), temperatures_strain(model))
      end if
      self%seconds%assemble = self%seconds%assemble + (wall_seconds() - since)
      since = wall_seconds()
      if (heat) then
         call self%loads%move_to(next_instant(model, model%steps(self%step), self%step_start, &
            self%step_time), model)
         self%operators%thermal%added = left_films(model%steps(self%step)%scheme, &
            self%state%film, self%loads%film_matrix())
      end if
      call self%operators%reduce(model, mechanics, heat, self%with_heat .and. &
         self%with_mechanics, error)
      self%mechanics_is_reduced = self%mechanics_is_reduced .or. (mechanics .and. &
         .not. allocated(error))
      self%heat_is_reduced = self%heat_is_reduced .or. (heat .and. .not. allocated(error))
      self%sizes%factor_bytes = max(self%sizes%factor_bytes, bytes_of_factors(self))
      self%seconds%reduce = self%seconds%reduce + (wall_seconds() - since)
   end subroutine reduce

   !> Whether temperatures that differ from the initial ones ever meet mechanics.
   pure function temperatures_strain(model) result(strain)
      type(model_type), intent(in) :: model
      logical :: strain
      integer :: i

      strain = any(solves_heat(model%steps%analysis))
      do i = 1, size(model%steps)
         if (.not. allocated(model%steps(i)%loads)) cycle
         strain = strain .or. any(model%steps(i)%loads%kind == load_temperature)
      end do
      strain = strain .and. any(solves_mechanics(model%steps%analysis))
   end function temperatures_strain

   pure function bytes_of_factors(self) result(bytes)
      class(simulation_type), intent(in) :: self
      integer(long) :: bytes

      bytes = 0
      if (allocated(self%operators%mechanical%solver)) then
         bytes = bytes + self%operators%mechanical%solver%factor_bytes
      end if
      if (allocated(self%operators%thermal%solver)) then
         bytes = bytes + self%operators%thermal%solver%factor_bytes
      end if
   end function bytes_of_factors

   !> Enters the next step. A field is numbered again only where it is solved and its supports
   !> differ from those that were numbered last; only then are its factors formed again.
   subroutine enter_step(self, model, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical :: heat, mechanics

      self%step = self%step + 1
      self%step_time = 0.0_dp
      self%increments_of_step = 0
      call self%loads%begin_step(model%steps(self%step), self%state%displacement, &
         self%state%temperature)
      self%with_heat = solves_heat(model%steps(self%step)%analysis)
      self%with_mechanics = solves_mechanics(model%steps(self%step)%analysis)
      associate (held => self%loads%displacement%active, &
         held_temperature => self%loads%temperature%active)
         mechanics = self%with_mechanics
         if (mechanics .and. allocated(self%held)) mechanics = any(self%held .neqv. held)
         heat = self%with_heat
         if (heat .and. allocated(self%held_temperature)) then
            heat = any(self%held_temperature .neqv. held_temperature)
         end if
         if (mechanics) self%held = held
         if (heat) self%held_temperature = held_temperature
         self%mechanics_is_reduced = self%mechanics_is_reduced .and. .not. mechanics
         self%heat_is_reduced = self%heat_is_reduced .and. .not. heat
         call self%operators%number(model, held, held_temperature, mechanics, heat, error)
      end associate
   end subroutine enter_step

   !> Frees the factors.
   subroutine release(self)
      class(simulation_type), intent(inout) :: self   !! the run

      call self%operators%release()
   end subroutine release

end module increments
