!> The run once more with increments of twice the size, on the contact points alone: it is led
!> beside the run and takes one increment where the run has taken two. Of an odd number of
!> increments in a step it takes the first alone, for the last one tells most. Here too: a step as
!> all solutions beside the run solve it.
module doubled_increments
   use contact_definitions, only: brings_friction
   use controls, only: implicit_scheme, start_type
   use errors, only: error_type
   use field_problem, only: solved_loads_type
   use heat_equation, only: heat_equation_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: trial_type
   use increment_solution, only: begin_increment, recover_fields, solve_points
   use increments, only: accept_increment
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use reduced_bodies, only: reduced_bodies_type
   use simulation, only: simulation_type
   use solution_state, only: exchange_state, solution_state_type
   use sparse_matrix, only: sparse_matrix_type
   use state_tables, only: integers, logicals, reals, state_table_type
   use steps, only: planned_increments, solves_heat, solves_mechanics, step_type
   implicit none
   private
   public :: doubled_increments_type, implicit_state, implicit_step

   real(dp), parameter :: almost_none = 1.0e-6_dp   !! of an increment: belongs to the one before
   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

   !> Where the second run stands.
   type :: doubled_increments_type
      logical :: is_led = .false.              !! whether the path of the run matters at all
      logical :: is_lost = .false.             !! whether one of its increments had no solution
      type(solution_state_type) :: state       !! its state
      type(heat_reduction_type) :: heat        !! its own, where that of the run has other films
      type(solved_loads_type), allocatable :: known(:)   !! loads that it has solved
      real(dp) :: time = 0.0_dp                !! total time of it [time]
      integer :: waiting = 0                   !! increments of the run since then
      integer :: step = 0                      !! step of the last of these
      logical :: has_doubled = .false.         !! whether it has taken two for one yet
   contains
      procedure :: start
      procedure :: follow
      procedure :: exchange
      procedure :: release
   end type doubled_increments_type

contains

   !> Starts beside a run. The path matters with friction, and with schemes of (3.4) that take
   !> anything from the start of an increment.
   subroutine start(self, model, bodies, state)
      class(doubled_increments_type), intent(out) :: self        !! the second run
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies    !! the bodies, matched
      type(solution_state_type), intent(in) :: state             !! state before the first increment
      type(heat_equation_type) :: equation
      integer :: s

      self%is_led = any(model%interactions%friction%coefficient > 0.0_dp)
      do s = 1, size(model%steps)
         self%is_led = self%is_led .or. brings_friction(model%steps(s)%changes)
         equation = heat_equation_type(model%steps(s)%scheme)
         self%is_led = self%is_led .or. (solves_heat(model%steps(s)%analysis) .and. &
            .not. equation%is_steady() .and. size(bodies%points%slave) > 0)
      end do
      if (self%is_led) self%state = state
   end subroutine start

   !> Takes note of an accepted increment; at every second one, and at the end of a step, the second
   !> run moves on to its end.
   subroutine follow(self, model, run, record)
      class(doubled_increments_type), intent(inout) :: self      !! the second run
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: run                   !! the run at its end
      type(increment_record_type), intent(in) :: record          !! its position in the steps
      type(error_type), allocatable :: error
      type(solution_state_type) :: before
      type(sparse_matrix_type) :: film
      type(step_type) :: step
      type(trial_type) :: trial
      type(heat_equation_type) :: equation

      if (.not. self%is_led .or. self%is_lost) return
      if (record%step /= self%step) self%waiting = &
         modulo(ceiling(planned_increments(model%steps(record%step)) - almost_none), 2)
      self%step = record%step
      self%waiting = self%waiting + 1
      if (self%waiting < 2 .and. .not. record%last_of_step) return
      self%has_doubled = self%has_doubled .or. &
         record%time - self%time > 1.5_dp*run%state%increment_size
      step = companion_step(model%steps(record%step))
      equation = heat_equation_type(step%scheme)
      before = self%state
      associate (next => trial%next)
         next = self%state
         next%increment_size = record%time - self%time
         next%contact = run%state%contact
         next%contact%tangential = self%state%contact%tangential
         next%sources = run%state%sources
         next%force_load = run%state%force_load
      end associate
      if (equation%is_steady()) then
         ! The run's solution is nearly right as a guess; nothing else is taken of omega.
         before%omega = run%state%omega
         before%omega_before = run%state%omega
      end if
      call begin_increment(run%bodies, step, before, trial)
      film = trial%data%equation%left_film(run%bodies%capacity)
      if (run%heat_reductions(1)%serves(run%bodies, film) .or. &
         .not. solves_heat(step%analysis)) then
         call solve_with(run%heat_reductions(1))
      else
         call self%heat%share_order(run%heat_reductions(1), run%bodies)
         call self%heat%reduce(model, run%bodies, film, error)
         if (.not. allocated(error)) call solve_with(self%heat)
      end if
      self%is_lost = allocated(error)
      if (self%is_lost) return
      call accept_increment(trial%next, model, self%state)
      self%time = record%time
      self%waiting = 0
   contains
      subroutine solve_with(heat)
         type(heat_reduction_type), intent(in) :: heat

         call move_alloc(self%known, trial%known)
         call solve_points(run%bodies, heat, run%loads, trial, error)
         call move_alloc(trial%known, self%known)
         if (allocated(error)) return
         if (.not. (equation%is_steady() .and. solves_mechanics(step%analysis))) call &
            recover_fields(run%bodies, heat, run%loads, before, trial)
      end subroutine solve_with
   end subroutine follow

   !> Where the second run stands, in either direction; it forgets the loads that it has solved.
   subroutine exchange(self, table)
      class(doubled_increments_type), intent(inout) :: self
      type(state_table_type), intent(inout) :: table
      integer, allocatable :: counts(:), extents(:)
      logical, allocatable :: flags(:)
      real(dp), allocatable :: time(:)

      if (.not. self%is_led) return
      table%prefix = 'doubled_'
      call exchange_state(table, self%state)
      counts = [self%waiting, self%step]
      flags = [self%is_lost, self%has_doubled]
      time = [self%time]
      call integers(table, 'counts', counts)
      call logicals(table, 'marks', flags)
      call reals(table, 'time', time)
      self%waiting = counts(1)
      self%step = counts(2)
      self%is_lost = flags(1)
      self%has_doubled = flags(2)
      self%time = time(1)
      ! Its sources are those of an earlier instant than the run's.
      associate (sources => self%state%sources, film => self%state%sources%film)
         call reals(table, 'heat_load', sources%load)
         extents = [film%row_count, film%column_count]
         call integers(table, 'film_extents', extents)
         film%row_count = extents(1)
         film%column_count = extents(2)
         call integers(table, 'film_start', film%row_start)
         call integers(table, 'film_column', film%column)
         call reals(table, 'film_value', film%value)
      end associate
      table%prefix = ''
      if (allocated(self%known)) deallocate (self%known)
   end subroutine exchange

   !> Frees the factors.
   subroutine release(self)
      class(doubled_increments_type), intent(inout) :: self

      call self%heat%release()
   end subroutine release

   !> The step without what only the run itself tells: other starts, the gain, the last digits.
   pure function companion_step(step) result(companion)
      type(step_type), intent(in) :: step   !! the step of the run
      type(step_type) :: companion          !! the same, cheaper

      companion = step
      companion%start = start_type()
      companion%fixed_point%finds_gain = .false.
      companion%fixed_point%tolerance = max(tolerance, step%fixed_point%tolerance)
   end function companion_step

   !> The same in the equilibrium of heat.
   pure function implicit_step(step)
      type(step_type), intent(in) :: step
      type(step_type) :: implicit_step

      implicit_step = companion_step(step)
      implicit_step%scheme = implicit_scheme
   end function implicit_step

   !> Solves the end of an increment, with all of its fields.
   !> Error: it has no solution.
   subroutine implicit_state(simulation, own, model, step, before, state, error)
      type(simulation_type), intent(in) :: simulation
      type(heat_reduction_type), intent(inout) :: own        !! where the run has other films
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step                    !! from implicit_step
      type(solution_state_type), intent(in) :: before        !! at the start of the increment
      type(solution_state_type), intent(inout) :: state      !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      associate (bodies => simulation%bodies)
         if (simulation%heat_reductions(1)%serves(bodies, state%sources%film) .or. &
            .not. solves_heat(step%analysis)) then
            call solve_end(simulation%heat_reductions(1))
         else
            call own%share_order(simulation%heat_reductions(1), bodies)
            call own%reduce(model, bodies, state%sources%film, error)
            if (.not. allocated(error)) call solve_end(own)
         end if
      end associate
   contains
      subroutine solve_end(heat)
         type(heat_reduction_type), intent(in) :: heat
         type(trial_type) :: trial

         trial%next = state
         call begin_increment(simulation%bodies, step, before, trial)
         call solve_points(simulation%bodies, heat, simulation%loads, trial, error)
         if (.not. allocated(error)) call recover_fields(simulation%bodies, heat, &
            simulation%loads, before, trial)
         state = trial%next
      end subroutine solve_end
   end subroutine implicit_state

end module doubled_increments
