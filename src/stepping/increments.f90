!> Load stepping: the state before the first increment, and increments, of which one call of advance
!> solves one.
module increments
   use branch_steps, only: branch_type
   use clock, only: wall_seconds
   use contact_operator, only: kept_contact, law_conductance
   use contact_system, only: contact_open
   use controls, only: method_newton, stage_part
   use coupled_increment, only: differ
   use discretisation_errors, only: recovery_type
   use due_output, only: stability_is_due
   use errors, only: error_type, set_error, status_no_convergence
   use field_problem, only: solved_loads_type
   use balances, only: sound_imbalance
   use friction_heating, only: nodal_friction_heat, slips_before
   use heat_reduction, only: heat_reduction_type
   use heat_storage, only: begin_storage, measure_changes, strain_rate
   use increment_checks, only: check_heat, check_record, warn_of_choices, warn_of_tables
   use increment_control, only: increment_control_type
   use increment_data, only: increment_data_type, increment_workspace_type, stage_type
   use increment_records, only: complete_record
   use increment_solution, only: begin_increment, recover_fields, solve_points
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use loads, only: loads_type
   use model, only: model_type
   use operator_corrections, only: corrections_type
   use records, only: add_attempts, increment_record_type, note_failure
   use reduced_bodies, only: reduced_bodies_type
   use run_sizes, only: measure_factors, measure_steps, run_seconds_type, run_size_type
   use shock_checks, only: note_shock
   use solution_state, only: solution_state_type
   use sparse_matrix, only: sparse_matrix_type
   use steps, only: adapts_increments, solves_heat, solves_mechanics
   use text, only: append, counted, to_text
   use thermal_matrix, only: heat_equation_type
   use touch_instants, only: touch_search_type
   use constraint_checks, only: check_prescribed_ties
   use unconstrained_bodies, only: unconstrained_now
   implicit none
   private
   public :: simulation_type, accept_increment, make_initial_state

   integer, parameter :: kept_reductions = 3     !! of heat, by films and increment sizes
   real(dp), parameter :: doubtful = 1.0e-9_dp   !! pivot over its diagonal entry; 1e-6 is left

   !> A run: the reduced bodies, the loads and the state, moved on by advance.
   type :: simulation_type
      type(reduced_bodies_type) :: bodies   !! the bodies reduced to their contact unknowns
      !> Their heat likewise, for films and increment sizes; where no heat is stored the first alone
      type(heat_reduction_type) :: heats(kept_reductions)
      integer :: in_use = 1                 !! which of them the increment has
      type(recovery_type) :: recovery               !! stress and flux with their errors
      type(corrections_type) :: corrections         !! what bodies are beyond their operators
      type(loads_type) :: loads                     !! loads and supports
      type(solution_state_type) :: state            !! state at the end of the last increment
      !> What its solution left, where its stability is analysed
      type(increment_workspace_type), allocatable :: solved
      type(solved_loads_type), allocatable :: known(:)  !! loads of earlier increments, solved
      type(increment_control_type) :: control       !! position in the steps, size of increments
      type(branch_type) :: branch                   !! of *CONTINUATION of the step
      type(run_seconds_type) :: seconds             !! where the time went
      type(run_size_type) :: sizes                  !! sizes over all steps
      character(:), allocatable :: undecided        !! what was last warned of
      real(dp) :: pivot_told = 1.0_dp               !! smallest pivot that was warned of
      character(:), allocatable :: runaway          !! last thermal runaway of an attempt, in words
      real(dp) :: runaway_time = 0.0_dp             !! where this attempt would have ended [time]
   contains
      procedure :: start
      procedure :: enter_step
      procedure :: assemble
      procedure :: reduce
      procedure :: finished
      procedure :: advance
      procedure :: release
   end type simulation_type

   !> A stage that is being solved.
   type :: trial_type
      type(increment_data_type) :: data
      type(increment_workspace_type) :: workspace
      type(solution_state_type) :: next           !! state at its end
      type(increment_record_type) :: record
      !> (m) conductances of a solution with other corrections, where there is one
      real(dp), allocatable :: omega_start(:)
   end type trial_type

contains

   !> Prepares a run, sees whether its steps can all be numbered, and enters the first.
   !> Errors: as reduced_bodies' prepare and enter_step.
   subroutine start(self, model, error)
      class(simulation_type), intent(inout) :: self       !! a fresh run
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: since

      since = wall_seconds()
      self%undecided = ''
      call self%bodies%prepare(model, error)
      if (allocated(error)) return
      call self%recovery%prepare(model, spread(.true., 1, size(model%mesh%element_kind)))
      call self%corrections%prepare(model)
      call self%loads%prepare(model)
      self%state = make_initial_state(model, self%bodies)
      self%seconds%assemble = (wall_seconds() - since)
      call measure_steps(model, self%bodies%points, self%loads, self%state, self%sizes, error)
      if (.not. allocated(error)) call enter_step(self, model, error)
   end subroutine start

   !> Enters the next step.
   !> Errors: as reduced_bodies' enter_step.
   subroutine enter_step(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      call self%control%enter_step(model)
      call self%branch%begin_step(self%control%step, self%control%start_of_step(model))
      call self%loads%begin_step(model%steps(self%control%step), self%state%displacement, &
         self%state%temperature)
      call self%bodies%enter_step(model, self%control%step, self%loads, error)
   end subroutine enter_step

   !> Assembles the bodies, where that is not done.
   subroutine assemble(self, model)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      real(dp) :: since

      since = wall_seconds()
      call self%bodies%assemble_steps(model)
      self%seconds%assemble = self%seconds%assemble + (wall_seconds() - since)
   end subroutine assemble

   !> Assembles and reduces the bodies for the present step, where that is not done.
   !> Errors: as reduced_bodies' and heat_reduction's reduce.
   subroutine reduce(self, model, error)
      class(simulation_type), intent(inout) :: self       !! the run, started
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: of_elimination
      type(heat_equation_type) :: equation
      type(sparse_matrix_type) :: film
      type(step_clock_type) :: clock
      real(dp) :: since

      call self%assemble(model)
      since = wall_seconds()
      associate (analysis => model%steps(self%control%step)%analysis, bodies => self%bodies, &
         heat => self%heats(self%in_use))
         film = heat%added
         if (solves_heat(analysis) .and. (heat%numbering /= bodies%thermal%numbering .or. &
            .not. allocated(heat%solver))) then
            call self%loads%move_to(self%control%next_instant(model), model)
            equation = heat_equation_type(model%steps(self%control%step)%scheme, &
               self%state%sources)
            equation%new%film = self%loads%film_matrix()
            clock = self%control%next_instant(model)
            associate (step => model%steps(self%control%step))
               if (step%is_transient) equation%duration = equation%scheme%a(1)* &
                  self%control%size_to(clock)*merge(stage_part, 1.0_dp, step%scheme%stages == 2)
            end associate
            film = equation%left_film(bodies%capacity)
         end if
         call heat%renumber_both(bodies)
         ! Both fields are eliminated while neither has factors, for their memory. Where that fails,
         ! heat%reduce fails again and says so.
         if (solves_mechanics(analysis)) call bodies%equilibrium%renumber( &
            bodies%mechanical)
         if (solves_heat(analysis)) call heat%eliminate(model, bodies, film, of_elimination)
         if (solves_mechanics(analysis)) call bodies%reduce(model, heat%node_rank, error)
         if (solves_heat(analysis) .and. .not. allocated(error)) call heat%reduce(model, bodies, &
            film, error)
      end associate
      self%seconds%reduce = self%seconds%reduce + (wall_seconds() - since)
      call measure_factors(self%bodies, self%heats, self%sizes)
   end subroutine reduce

   !> Whether all steps are solved.
   pure function finished(self, model) result(done)
      class(simulation_type), intent(in) :: self   !! the run
      type(model_type), intent(in) :: model
      logical :: done                              !! nothing is left

      done = self%control%step == size(model%steps) .and. self%control%step_is_over(model)
   end function finished

   !> Solves the next increment, cut back as often as it takes. On failure the state is that of the
   !> last good increment and the record holds the attempts at the failing one with their passes.
   !> Errors: no convergence with the smallest increment, more increments than INC allows, bodies
   !> that nothing holds, a failed self-check.
   subroutine advance(self, model, record, error)
      class(simulation_type), intent(inout) :: self         !! the run
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      type(increment_record_type) :: before
      type(solution_state_type) :: next
      type(step_clock_type) :: clock
      type(touch_search_type) :: touch
      real(dp) :: increment_size
      logical :: can_shorten

      if (self%control%step_is_over(model)) then
         call enter_step(self, model, error)
         if (allocated(error)) return
      end if
      associate (control => self%control, step => model%steps(self%control%step))
         ! Attempts that failed do not count.
         if (control%increments_of_step >= step%max_increments .and. .not. &
            step%continuation%is_on) call set_error(error, &
            status_no_convergence, 'step '//to_text(control%step)//' is not finished after INC='// &
            counted(step%max_increments, 'increment')//', at '//to_text(control%step_time)// &
            ' of its period '//to_text(step%period))
      end associate
      if (allocated(error)) return
      call self%reduce(model, error)
      if (allocated(error)) return
      do
         clock = self%control%next_instant(model)
         if (self%branch%points > 0) then
            call begin_record(self, model, clock, record)
            call self%branch%find_point(model, self%bodies, self%heats(self%in_use), self%loads, &
               self%state, error)
            if (.not. allocated(error)) clock = self%branch%clock_at(self%branch%point%factor)
         end if
         if (touch%interface > 0) call self%control%end_at(touch%ending, clock)
         increment_size = clock%step_time - self%control%step_time
         if (.not. allocated(error)) call attempt(self, model, clock, next, record, error)
         call add_attempts(before, record)
         if (.not. allocated(error)) then
            if (keeps(self, model, clock, next, touch, record)) exit
            before = record
            cycle
         end if
         touch = touch_search_type()
         if (error%status == status_no_convergence) then
            call note_failure(record, increment_size, error%message)
            if (allocated(record%runaway)) then
               self%runaway = record%runaway
               self%runaway_time = record%time
            end if
            if (self%branch%points > 0) then
               call self%branch%shorten(can_shorten)
            else
               can_shorten = self%control%can_cut_back(model, increment_size)
               if (can_shorten) call self%control%cut_back(model, increment_size)
            end if
            if (can_shorten) then
               deallocate (error)
               before = record
               cycle
            end if
            if (self%branch%points == 0) error%message = error%message//'; '// &
               self%control%why_not_again(model, increment_size)//runaway_ahead(self, record)
         end if
         error%message = 'increment '//to_text(record%increment)//' (time '// &
            to_text(record%time)//'): '//error%message
         return
      end do
      call warn_of_pivot(self, record)
      self%sizes%corrections = self%sizes%corrections + record%corrections
      self%sizes%most_corrections = max(self%sizes%most_corrections, record%corrections)
      call accept_increment(next, model, self%state, record)
      call self%control%accept(model, clock, record)
      if (.not. model%steps(self%control%step)%continuation%is_on) return
      call self%branch%accept(model, record%load_factor)
      self%control%branch_ended = self%branch%is_last
      if (self%branch%is_last) call append(record%notes, 'the branch ends here: '// &
         self%branch%ending)
   end subroutine advance

   !> Whether an attempt that was solved is the increment: in a transient whose increments are free
   !> it is not where it errs too much, or an interface first touches or parts within it; the next
   !> attempt is shorter.
   logical function keeps(self, model, clock, next, touch, record)
      type(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock            ! its end
      type(solution_state_type), intent(in) :: next         ! state there
      type(touch_search_type), intent(inout) :: touch
      type(increment_record_type), intent(inout) :: record
      real(dp) :: increment_size

      keeps = .true.
      if (.not. adapts_increments(model%steps(self%control%step))) return
      increment_size = clock%step_time - self%control%step_time
      if (self%control%goes_too_far(model, increment_size, record)) then
         keeps = .false.
         touch = touch_search_type()
         call note_failure(record, increment_size, self%control%shorten(model, increment_size, &
            record))
      else if (self%bodies%is_coupled) then
         keeps = touch%ends_behind(self%bodies, self%state, next, [self%control%step_time, &
            clock%step_time])
         if (.not. keeps) call note_failure(record, increment_size, 'contact pair '// &
            self%bodies%interfaces(touch%interface)%name//' touches or parts within it')
      end if
   end function keeps

   !> Makes the end of an increment the state of a run, the only place where that changes. A
   !> companion run, of which nothing is reported, has no record.
   pure subroutine accept_increment(next, model, state, record)
      type(solution_state_type), intent(in) :: next         !! state at the end of the increment
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(inout) :: state     !! state of the run
      type(increment_record_type), optional, intent(in) :: record

      state = next
      if (.not. present(record)) return
      if (allocated(record%fields%reaction)) state%reaction = record%fields%reaction
      if (solves_heat(model%steps(record%step)%analysis)) state%is_out_of_balance = &
         record%heat_imbalance_pointwise > sound_imbalance
   end subroutine accept_increment

   !> Says of a failed increment that one that goes further ends in thermal runaway.
   pure function runaway_ahead(self, record) result(words)
      class(simulation_type), intent(in) :: self
      type(increment_record_type), intent(in) :: record
      character(:), allocatable :: words

      words = ''
      if (.not. allocated(self%runaway) .or. record%time >= self%runaway_time) return
      words = '; an increment to time '//to_text(self%runaway_time)//' ended in '//self%runaway
   end function runaway_ahead

   !> Warns of pivots so small that digits are lost which results need, again where it is a tenth.
   subroutine warn_of_pivot(self, record)
      class(simulation_type), intent(inout) :: self
      type(increment_record_type), intent(inout) :: record

      if (self%sizes%smallest_pivot >= min(doubtful, 0.1_dp*self%pivot_told)) return
      self%pivot_told = self%sizes%smallest_pivot
      call record%warn('the smallest pivot of the bodies is '//to_text(self%pivot_told)// &
         ' of its diagonal entry, so results may be accurate to '// &
         to_text(10*epsilon(1.0_dp)/self%pivot_told)// &
         ' only: are bodies held by others that are far softer?')
   end subroutine warn_of_pivot

   !> Tries an increment that ends at an instant, stage by stage. The state of the run stays; what
   !> else an attempt leaves behind, loads and factors, the next one sets anew.
   subroutine attempt(self, model, clock, next, record, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock
      type(solution_state_type), intent(out) :: next
      type(increment_record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: before
      type(stage_type) :: stage
      type(trial_type) :: first, last

      before = self%state
      stage%clock = clock
      stage%of_increment = clock
      stage%size = clock%step_time - self%control%step_time
      associate (step => model%steps(self%control%step))
         if (step%is_transient) call begin_storing(self, model, stage, before)
         if (.not. stage%is_last) then
            call solve_stage(self, model, stage, before, first, error)
            if (allocated(error)) then
               record = first%record
               return
            end if
            call begin_second_stage(self, model, first%next, before, stage)
            before = first%next
         end if
         call solve_stage(self, model, stage, before, last, error)
         next = last%next
         record = last%record
         if (first%record%increment > 0) call add_attempts(first%record, record)
         if (self%branch%is_followed .and. .not. allocated(error)) then
            if (any(differ(next%omega, self%branch%point%omega))) call set_error(error, &
               status_no_convergence, 'the increment leads to another branch')
         end if
         if (.not. step%is_transient .or. allocated(error)) return
         if (first%record%increment > 0) before%temperature = self%state%temperature + stage%jump
         call measure_changes(model, self%bodies, self%heats(self%in_use), &
            self%loads%temperature%active, before, next, record)
         if (self%control%increments_of_step == 0) call note_shock(model, stage%jump, &
            self%control%size_to(clock), record)
      end associate
   end subroutine attempt

   !> The first stage of an increment that stores heat, and the state that it finds.
   subroutine begin_storing(self, model, stage, before)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stage_type), intent(inout) :: stage              ! with the clock of the increment
      type(solution_state_type), intent(inout) :: before    ! state of the run

      associate (step => model%steps(self%control%step))
         stage%size = self%control%size_to(stage%clock)
         stage%duration = stage%size
         stage%dilates = step%dilates
         if (self%control%increments_of_step == 0) call begin_storage(model, self%bodies, &
            self%corrections, self%loads, self%control%start_of_step(model), before)
         if (self%corrections%corrects) stage%content = self%corrections%true_contents(model, &
            before%temperature)
         stage%jump = before%temperature - self%state%temperature
         stage%temperature = before%temperature
         stage%displacement = before%displacement
         stage%is_last = step%scheme%stages /= 2
      end associate
      if (stage%is_last) return
      stage%duration = stage_part*stage%size
      stage%size = stage%duration
      stage%clock%step_time = self%control%step_time + stage%size
      stage%clock%total_time = self%control%step_start + stage%clock%step_time
   end subroutine begin_storing

   !> The second stage of an increment: C (T_i+1 - T_i)/dt is (1 - gamma) of the first stage's rate
   !> and gamma of its own.
   subroutine begin_second_stage(self, model, next, before, stage)
      class(simulation_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: next         ! state at the end of the first one
      type(solution_state_type), intent(in) :: before       ! and at its start
      type(stage_type), intent(inout) :: stage
      real(dp), parameter :: weight = 1/stage_part - 1

      stage%temperature = before%temperature + weight*(next%temperature - before%temperature)
      stage%displacement = before%displacement + weight*(next%displacement - before%displacement)
      if (self%corrections%corrects) stage%content = stage%content + weight* &
         (self%corrections%true_contents(model, next%temperature) - stage%content)
      if (allocated(self%bodies%points%heated)) stage%slip_before = slips_before(self%bodies, &
         next%contact)
      stage%size = stage%of_increment%step_time - stage%clock%step_time
      stage%clock = stage%of_increment
      stage%is_last = .true.
   end subroutine begin_second_stage

   !> Solves a stage of an increment, mostly the only one; the last one is recorded.
   subroutine solve_stage(self, model, stage, before, trial, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stage_type), intent(in) :: stage
      type(solution_state_type), intent(in) :: before
      type(trial_type), intent(out) :: trial
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: since

      call self%loads%move_to(stage%clock, model)
      call check_prescribed_ties(model, self%bodies, self%loads, self%control%step, error)
      call begin_record(self, model, stage%of_increment, trial%record)
      if (allocated(error)) return
      trial%next = before
      associate (step => model%steps(self%control%step), bodies => self%bodies, &
         next => trial%next, record => trial%record)
         next%increment_size = stage%size
         ! (3.4) asks for them at the start of the next increment, whether this one solves heat or
         ! not.
         if (any(solves_heat(model%steps%analysis))) then
            next%sources%load = self%loads%heat_load()
            next%sources%film = self%loads%film_matrix()
         end if
         next%force_load = self%loads%nodal_forces()
         call solve_corrected(self, model, stage, before, trial, error)
         if (allocated(error)) return
         if (solves_mechanics(step%analysis)) call warn_of_choices(model, bodies, &
            trial%workspace%contact, self%loads, next, record, self%undecided)
         if (step%dilates) next%dilatation = strain_rate(bodies, stage, before, next)
         if (stage%is_last) then
            since = wall_seconds()
            call complete_record(bodies, model, self%recovery, self%loads, trial%data, next, record)
            self%seconds%recover = self%seconds%recover + (wall_seconds() - since)
            call warn_of_tables(model, record)
            if (stability_is_due(record, model)) self%solved = trial%workspace%of_motions()
            call check_record(record, step%analysis, error)
            if (allocated(error)) return
         end if
         call move_alloc(trial%workspace%known, self%known)
      end associate
   end subroutine solve_stage

   !> Solves the fields of a stage until its corrections are those of its solution.
   subroutine solve_corrected(self, model, stage, before, trial, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stage_type), intent(in) :: stage
      type(solution_state_type), intent(in) :: before
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: fresh
      type(increment_workspace_type) :: fresh_workspace

      associate (corrections => self%corrections, step => model%steps(self%control%step))
         if (.not. corrections%corrects) then
            call solve_fields(self, model, stage, before, trial, error)
            return
         end if
         fresh = trial%next
         call corrections%begin(model, self%bodies, stage, before, &
            takes_past=abs(step%scheme%b(1)) > 0.0_dp)
         do
            call solve_fields(self, model, stage, before, trial, error)
            if (allocated(error)) return
            call corrections%correct(model, self%bodies, stage, trial%next, error)
            if (allocated(error)) return
            if (corrections%is_settled) exit
            if (corrections%asks_operators) then
               call renew_operators(self, model, stage, before, trial%next, error)
               if (allocated(error)) return
            end if
            trial%omega_start = trial%next%omega
            trial%next = fresh
            trial%workspace = fresh_workspace
         end do
         call corrections%keep(self%bodies, before, trial%next)
         trial%record%corrections = corrections%passes
         trial%record%has_new_operators = corrections%is_renewed
      end associate
   end subroutine solve_corrected

   !> Forms the operators at the solution of a stage, and goes on from it.
   !> Errors: as reduce.
   subroutine renew_operators(self, model, stage, before, next, error)
      type(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stage_type), intent(in) :: stage
      type(solution_state_type), intent(in) :: before, next
      type(error_type), allocatable, intent(out) :: error

      associate (bodies => self%bodies)
         call bodies%move_operators(model, next%temperature)
         call self%corrections%renew(model, bodies, stage, before, next)
         if (solves_mechanics(model%steps(self%control%step)%analysis)) call bodies%reduce(model, &
            self%heats(self%in_use)%node_rank, error)
      end associate
   end subroutine renew_operators

   !> Solves the fields of a stage with the present corrections of its operators.
   subroutine solve_fields(self, model, stage, before, trial, error)
      class(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(stage_type), intent(in) :: stage
      type(solution_state_type), intent(in) :: before
      type(trial_type), intent(inout) :: trial
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: since

      associate (step => model%steps(self%control%step), bodies => self%bodies, &
         data => trial%data, workspace => trial%workspace, next => trial%next)
         workspace%record%increment = trial%record%increment
         call begin_increment(bodies, step, before, next, data)
         if (step%is_transient) then
            call data%equation%hold_heat(bodies%capacity, stage%duration, stage%temperature, &
               before%stored)
            data%friction%duration = stage%duration
            if (allocated(stage%slip_before)) data%friction%slip_before = stage%slip_before
         end if
         if (self%corrections%corrects) call self%corrections%give(data%equation, next)
         if (allocated(trial%omega_start)) data%omega_start = trial%omega_start
         if (self%branch%is_followed) then
            data%omega_start = self%branch%point%omega
            data%fixed_point%method = method_newton
         end if
         if (solves_heat(step%analysis)) then
            call reduce_heat(self, model, data%equation%left_film(bodies%capacity), error)
            if (allocated(error)) return
         end if
         since = wall_seconds()
         ! An increment that fails leaves nothing behind, not even in the last digits.
         if (allocated(self%known)) workspace%known = self%known
         call solve_points(bodies, self%heats(self%in_use), self%loads, data, workspace, next, &
            error)
         trial%record%solution_report_type = workspace%record
         self%seconds%iterate = self%seconds%iterate + (wall_seconds() - since)
         if (solves_heat(step%analysis)) then
            call check_heat(model, bodies, self%loads, self%control%step, &
               data%equation%contact_diagonal(next%omega) > 0.0_dp, error)
         end if
         if (allocated(error)) then
            if (workspace%contact%driven) error%message = error%message// &
               unconstrained_now(model, bodies%points, bodies%laws%friction%coefficient > 0.0_dp, &
               self%loads%displacement%active, next%contact%contact_state)
            return
         end if
         since = wall_seconds()
         call recover_fields(bodies, self%heats(self%in_use), self%loads, data, workspace, next)
         if (step%is_transient) then
            next%stored = data%equation%stored_rate(bodies%capacity, next%temperature)
            associate (a => data%equation%scheme%a, b => data%equation%scheme%b)
               if (allocated(data%friction%made)) next%stored = next%stored - b(1)/a(1)* &
                  nodal_friction_heat(bodies, data%friction%late_start(before%friction_heat))
            end associate
         end if
         self%seconds%recover = self%seconds%recover + (wall_seconds() - since)
      end associate
   end subroutine solve_fields

   !> Reduces heat, unless a reduction of a former increment serves; a new one takes the place of
   !> the oldest.
   !> Errors: as heat_reduction's reduce.
   subroutine reduce_heat(self, model, film, error)
      type(simulation_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(sparse_matrix_type), intent(in) :: film          ! and C/(a1 dt), beside K
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. self%heats(self%in_use)%serves(self%bodies, film) .and. &
         model%steps(self%control%step)%is_transient) then
         do i = 1, size(self%heats)
            if (self%heats(i)%serves(self%bodies, film)) exit
         end do
         if (i > size(self%heats)) then
            i = 1 + modulo(self%in_use, size(self%heats))
            call self%heats(i)%share_order(self%heats(self%in_use), self%bodies)
         end if
         self%in_use = i
      end if
      call self%heats(self%in_use)%reduce(model, self%bodies, film, error)
      if (.not. allocated(error)) call measure_factors(self%bodies, self%heats, self%sizes)
   end subroutine reduce_heat

   !> Which increment a record is of.
   subroutine begin_record(self, model, clock, record)
      type(simulation_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock
      type(increment_record_type), intent(inout) :: record

      record%increment = self%control%increments + 1
      record%step = self%control%step
      record%increment_in_step = self%control%increments_of_step + 1
      record%last_of_step = clock%step_time >= clock%period
      record%cut_backs = self%control%cut_backs
      record%time = clock%total_time
      associate (continuation => model%steps(self%control%step)%continuation)
         if (continuation%is_on) then
            record%last_of_step = self%branch%is_last
            record%load_factor = clock%step_time/clock%period
            record%is_fold = self%branch%is_fold
            ! The load factor may fall, time does not.
            record%time = self%control%step_start + clock%period*record%increment_in_step/ &
               continuation%most_points
         end if
      end associate
      record%load = self%loads%axis_value(model, record%time)
   end subroutine begin_record

   !> Frees the factors.
   subroutine release(self)
      class(simulation_type), intent(inout) :: self   !! the run
      integer :: i

      call self%bodies%equilibrium%release()
      do i = 1, size(self%heats)
         call self%heats(i)%release()
      end do
   end subroutine release

   !> State before the first increment.
   pure function make_initial_state(model, bodies) result(state)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies     !! the bodies, matched
      type(solution_state_type) :: state                          !! see above

      associate (m => size(bodies%points%slave), n => size(model%mesh%node_number), &
         contact => state%contact)
         allocate (contact%contact_state(m), source=contact_open)
         allocate (contact%direction(m), source=0)
         allocate (contact%reference(m), contact%tangential(m), contact%slip_origin(m), &
            contact%force(m), contact%shear_force(m), source=0.0_dp)
         contact%gap = bodies%points%initial_gap - bodies%laws%reach
         state%smallest_gap = contact%gap
         allocate (state%resting(m), state%idle(m), source=.false.)
         state%jump = bodies%points%jumps(model%initial_temperature)
         state%omega = law_conductance(bodies, model%initial_temperature, state%jump, &
            kept_contact(contact, has_mechanics=.false.))
         state%omega_before = state%omega
         state%carrying = state%omega
         allocate (state%displacement(2*n), state%sources%load(n), source=0.0_dp)
         state%temperature = model%initial_temperature
      end associate
   end function make_initial_state

end module increments
