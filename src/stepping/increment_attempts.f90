!> An attempt at an increment, stage by stage. It owns what the increment leaves to the next ones;
!> the increment that is accepted hands that over to the run. What it moves to its instant in the
!> run, the loads and the operators, is taken back where it is not accepted.
module increment_attempts
   use clock, only: wall_seconds
   use constraint_checks, only: check_prescribed
   use contact_system, only: closing_law_type, contact_open
   use controls, only: method_newton
   use coupled_increment, only: differ, judge_solution
   use face_wear, only: body_compliance, wear_by_pressure, wear_faces
   use energies, only: add_friction_work
   use errors, only: error_type, set_error, status_internal, status_no_convergence
   use friction_heating, only: nodal_friction_heat
   use heat_storage, only: begin_first_stage, begin_second_stage, measure_changes, measure_strains
   use increment_checks, only: check_record, note_shock, warn_of_choices, warn_of_tables
   use increment_data, only: load_places, stage_type, trial_type
   use increment_records, only: complete_record
   use field_problem, only: solved_loads_type
   use increment_solution, only: begin_increment, carry_to_faces, fill_bodies, recover_fields, &
      solve_points
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: has_friction, model_type
   use records, only: add_attempts, increment_record_type
   use simulation, only: simulation_type
   use sliding_attempts, only: check_arrivals, check_slip, compare_with_drive
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: append, to_text
   use unconstrained_bodies, only: unconstrained_now, undetermined_now
   implicit none
   private
   public :: attempt_type, attempt_increment, begin_record

   !> Growth of plastic strains that no equilibrium has, but with forces that rounding makes
   real(dp), parameter :: of_collapse = 1.0_dp

   integer, parameter :: most_turns = 10   !! in which faces that slide or wear find their place
   real(dp), parameter :: same_place = 1.0e-6_dp     !! part of the spacing of contact points
   real(dp), parameter :: same_law = 1.0e-12_dp      !! the same of a slip by laws of closing
   real(dp), parameter :: same_wear = 1.0e-9_dp      !! relative change of wear that is none
   !> Tolerance on conductances while faces are still where they were placed an increment earlier
   real(dp), parameter :: rough = 1.0e-4_dp

   !> The trial solution of an attempt, or of the stage that it has come to, and what it found.
   type, extends(trial_type) :: attempt_type
      type(stage_type) :: stage
      !> State at the start of the stage; of a first one jumps where a step begins included
      type(solution_state_type) :: before
      type(increment_record_type) :: record
      character(:), allocatable :: undecided       !! what was last warned of
      !> (m) as in the data of the trial that comes next, once a solution slips
      real(dp), allocatable :: wear_by_pressure(:)
      !> (m) conductance of a solution whose contact points lay elsewhere, or wore otherwise
      real(dp), allocatable :: omega_start(:)
      !> (m) its laws of closing contact points, likewise
      type(closing_law_type), allocatable :: closing_start(:)
      !> Whether the present solution only says where faces that slide go, to a rough tolerance
      logical :: is_rough = .false.
   end type attempt_type

contains

   !> Tries an increment that ends at an instant, stage by stage.
   !> Errors: no convergence, bodies that nothing holds, a failed self-check.
   subroutine attempt_increment(run, model, clock, attempt, error)
      type(simulation_type), intent(inout) :: run           !! its loads and operators move
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock            !! its end
      type(attempt_type), intent(out) :: attempt
      type(error_type), allocatable, intent(out) :: error
      type(solution_state_type) :: start    ! state at its start
      type(increment_record_type) :: first  ! record of the first of two stages
      real(dp), allocatable :: none(:)

      ! An attempt that fails leaves nothing behind, not even in the last digits.
      if (allocated(run%known)) attempt%known = run%known
      attempt%undecided = run%undecided
      attempt%before = run%state
      associate (step => model%steps(run%control%step), stage => attempt%stage)
         stage%clock = clock
         stage%of_increment = clock
         stage%size = clock%step_time - run%control%step_time
         stage%duration = stage%size
         stage%strains = solves_mechanics(step%analysis)
         stage%begins_step = run%control%increments_of_step == 0
         ! Without the tangents of laws where loads may turn round, as a step begins, and behind an
         ! attempt that failed: bodies that unload are far stiffer than their tangents.
         if (allocated(run%bodies%tangent) .and. (stage%begins_step .or. run%control%cut_backs > &
            0)) then
            call run%bodies%move_operators(model, run%bodies%operators_at, none)
            call run%reduce(model, error)
            if (allocated(error)) return
         end if
         stage%passing%instants = run%control%step_start + [run%control%step_time, clock%step_time]
         if (allocated(run%state%history)) stage%history = run%state%history
         if (step%is_transient .or. step%is_viscous) then
            call begin_first_stage(run, model, stage, attempt%before)
            start = attempt%before
         end if
         call solve_stage(run, model, attempt, error)
         if (.not. (stage%is_last .or. allocated(error))) then
            first = attempt%record
            attempt%before = attempt%next
            call begin_second_stage(run, model, start, attempt%before, stage)
            call solve_stage(run, model, attempt, error)
            call add_attempts(first, attempt%record)
            if (allocated(stage%history) .and. .not. allocated(error)) call measure_strains(run, &
               model, stage, attempt%before, attempt%next, attempt%record)
         end if
         if (.not. allocated(error)) call check_strains(run, model, attempt, error)
         if (run%branch%is_followed .and. .not. allocated(error)) then
            if (any(differ(attempt%next%omega, run%branch%point%omega))) call set_error(error, &
               status_no_convergence, 'the increment leads to another branch')
         end if
         if (.not. step%is_transient .or. allocated(error)) return
         call measure_changes(run, model, start, attempt%data%equation%stored_old, attempt%next, &
            attempt%record)
         if (run%control%increments_of_step == 0) call note_shock(model, stage%jump, &
            run%control%size_to(clock), attempt%record)
      end associate
   end subroutine attempt_increment

   !> Whether plastic strains grow by no more than the step allows an increment; where increments
   !> are fixed they may, unless forces are those of rounding.
   subroutine check_strains(run, model, attempt, error)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words

      associate (step => model%steps(run%control%step), growth => attempt%record%strain_growth)
         growth = run%corrections%largest_growth(model, attempt%next, run%state)
         if (growth(1) <= step%strain_limit) return
         ! A growth that is not carried, as beyond collapse, has no meaning.
         words = 'plastic strains grow in an increment by more than STRAIN LIMIT='// &
            to_text(step%strain_limit)
         if (step%direct .and. growth(1) < of_collapse) then
            call attempt%record%warn(words//', which DIRECT does not allow to be cut back')
         else
            call set_error(error, status_no_convergence, words)
         end if
      end associate
   end subroutine check_strains

   !> Solves a stage of an increment, mostly the only one; the last one is recorded.
   subroutine solve_stage(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: since

      call run%loads%move_to(attempt%stage%clock, model)
      call check_prescribed(model, run%bodies, run%loads, run%control%step, error)
      call begin_record(run, model, attempt%stage%of_increment, attempt%record)
      if (allocated(error)) return
      attempt%next = attempt%before
      associate (step => model%steps(run%control%step), bodies => run%bodies, &
         next => attempt%next, record => attempt%record, clock => attempt%stage%of_increment)
         next%increment_size = attempt%stage%size
         ! (3.4) asks for them at the start of the next increment, whether this one solves heat or
         ! not.
         if (any(solves_heat(model%steps%analysis))) then
            next%sources%load = run%loads%heat_load()
            next%sources%film = run%loads%film_matrix()
         end if
         next%force_load = run%loads%nodal_forces()
         call solve_on_faces(run, model, attempt, error)
         if (allocated(error)) return
         if ((run%corrections%has_laws .or. has_friction(model)) .and. &
            solves_mechanics(step%analysis)) call add_friction_work(run, next)
         if (solves_mechanics(step%analysis)) call warn_of_choices(run, model, &
            attempt%workspace%contact, next, attempt%undecided, record)
         ! Heat that strains take up, T0 beta:eps' over all bodies. Loads that act at once strain
         ! bodies within the first stage.
         next%dilatation = 0.0_dp
         if (allocated(attempt%stage%worked)) next%dilatation = -sum( &
            run%corrections%inelastic_heat(model, next%history) - attempt%stage%worked)/ &
            attempt%stage%duration
         if (step%dilates) next%dilatation = sum(bodies%dilatation%of_strains(bodies%thermal_load, &
            next%displacement - attempt%before%displacement))/attempt%stage%size
         if (attempt%stage%is_last) then
            if (attempt%stage%stores_heat .and. run%corrections%melting%acts) then
               call run%corrections%melting%find_solid_time(model, reshape([ &
                  run%state%temperature, next%temperature], [size(next%temperature), 2]), &
                  attempt%stage%passing%instants, next%solid_time)
               if (allocated(next%solid_time) .and. .not. allocated(run%state%solid_time)) call &
                  append(record%notes, 'the last point is solid at time '//to_text( &
                  next%solid_time(1)))
            end if
            since = wall_seconds()
            call complete_record(bodies, model, run%recovery, run%loads, attempt%data, next, record)
            run%seconds%recover = run%seconds%recover + (wall_seconds() - since)
            call warn_of_tables(model, bodies%points, record)
            if (attempt%stage%strains .and. allocated(bodies%faces_at) .and. &
               allocated(attempt%data%friction%heat)) call compare_with_drive(bodies, &
               attempt%data%friction%entering(), reshape(next%displacement - &
               run%state%displacement, shape(record%fields%displacement))/(clock%step_time - &
               run%control%step_time), record)
            call check_record(record, step%analysis, error)
            if (allocated(error)) return
         end if
      end associate
   end subroutine solve_stage

   !> Solves a stage until contact points of faces that slide lie where its solution has these, and
   !> faces wear by its slip.
   !> Errors: no such place is found, faces slide too far at once; as follow_faces.
   subroutine solve_on_faces(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      integer :: turn
      logical :: is_placed, is_worn

      if (allocated(attempt%omega_start)) deallocate (attempt%omega_start)
      if (allocated(attempt%closing_start)) deallocate (attempt%closing_start)
      do turn = 1, most_turns
         attempt%is_rough = turn == 1 .and. run%bodies%is_coupled .and. &
            allocated(run%bodies%faces_at)
         call solve_corrected(run, model, attempt, error)
         if (allocated(error)) return
         if (.not. solves_mechanics(model%steps(run%control%step)%analysis)) return
         is_placed = .true.
         if (allocated(run%bodies%faces_at)) is_placed = &
            run%bodies%displaced_by(attempt%next%displacement) <= same_place
         is_worn = .true.
         if (allocated(run%bodies%worn)) call follow_wear(run, attempt, is_worn)
         if (is_placed .and. is_worn .and. .not. attempt%is_rough) then
            call end_turns(run, model, attempt, error)
            return
         end if
         attempt%next%contact%slip_origin = attempt%before%contact%slip_origin
         attempt%omega_start = attempt%next%omega
         if (is_placed) cycle
         call run%place_faces(model, attempt%next%displacement, error)
         if (.not. allocated(error)) call check_arrivals(run%bodies, model, attempt%before, &
            attempt%next%displacement, error)
         if (allocated(error)) return
         call run%loads%move_to(attempt%stage%clock, model)   ! reducing bodies moves them
         call carry_to_faces(run%bodies, attempt%before)
         attempt%closing_start = attempt%workspace%contact%closing
         attempt%closing_start%start = attempt%before%contact%tangential
         attempt%next%contact%slip_origin = attempt%before%contact%slip_origin
      end do
      call set_error(error, status_no_convergence, trim(merge( &
         'contact points of faces that slide find no place in ', &
         'wear and the slip that makes it do not settle in    ', is_worn))//' '// &
         to_text(most_turns)//' turns')
   end subroutine solve_on_faces

   !> Completes the last solution of a stage that is solved in turns, and finds its gain.
   subroutine end_turns(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error

      if (run%bodies%is_coupled .and. solves_repeatedly(run) .and. .not. &
         attempt%data%equation%is_explicit() .and. &
         model%steps(run%control%step)%fixed_point%finds_gain) then
         call judge_solution(run%bodies, run%heat_reductions(run%in_use), attempt%trial_type)
         attempt%record%solution_report_type = attempt%workspace%record
      end if
      if (allocated(run%bodies%worn)) then
         call wear_faces(run%bodies, attempt%before, attempt%wear_by_pressure, attempt%next)
         call run%bodies%wear_to(attempt%next%wear)
      end if
      if (.not. allocated(run%bodies%faces_at)) return
      call fill_bodies(run%bodies, run%heat_reductions(run%in_use), run%loads, attempt%trial_type)
      call find_stored(run, model, attempt)
      attempt%next%faces_at = run%bodies%faces_at
      call check_slip(run%bodies, model, attempt%before, attempt%next, attempt%record, error)
   end subroutine end_turns

   !> Whether a stage is solved again until what it was solved with is that of its solution.
   pure logical function solves_repeatedly(run)
      type(simulation_type), intent(in) :: run

      solves_repeatedly = run%corrections%corrects .or. allocated(run%bodies%faces_at) .or. &
         allocated(run%bodies%worn)
   end function solves_repeatedly

   !> Takes the slip of a solution for its wear, and whether this is what it was solved with.
   subroutine follow_wear(run, attempt, is_same)
      type(simulation_type), intent(in) :: run
      type(attempt_type), intent(inout) :: attempt
      logical, intent(out) :: is_same
      real(dp) :: by_pressure(size(attempt%next%omega))

      by_pressure = wear_by_pressure(run%bodies, attempt%before, attempt%next, attempt%stage%size)
      is_same = allocated(attempt%wear_by_pressure)
      ! An open contact point does not wear; that of the solution before it waits.
      if (is_same) by_pressure = merge(attempt%wear_by_pressure, by_pressure, &
         attempt%next%contact%contact_state == contact_open)
      ! Beside the bodies' own compliance that of little wear is rounding.
      if (is_same) is_same = all(abs(by_pressure - attempt%wear_by_pressure) <= &
         same_wear*max(maxval(by_pressure), body_compliance(run%bodies)))
      attempt%wear_by_pressure = by_pressure
   end subroutine follow_wear

   !> Solves the fields of a stage until its corrections are those of its solution.
   subroutine solve_corrected(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      type(solved_loads_type), allocatable :: known(:)   ! before the stage
      logical :: melts

      melts = run%corrections%melting%acts .and. attempt%stage%stores_heat
      if (melts) call run%bodies%set_melting(0.0_dp*attempt%before%temperature)
      call begin_trial(run, model, attempt)
      associate (corrections => run%corrections, step => model%steps(run%control%step))
         if (.not. corrections%corrects) then
            call reduce_heat(run, model, attempt, error)
            if (.not. allocated(error)) call solve_fields(run, model, attempt, error)
            return
         end if
         allocate (known(load_places))
         if (allocated(attempt%known)) known = attempt%known
         ! Conductances to start from are those of an earlier turn of the stage.
         if (allocated(attempt%omega_start) .and. .not. melts) then
            call corrections%begin_again()
         else
            call corrections%begin(model, run%bodies, attempt%stage, attempt%before, &
               takes_past=abs(step%scheme%b(1)) > 0.0_dp)
         end if
         ! Where the slopes of melting stand beside the matrix, fronts are foreseen by it.
         if (melts .and. .not. run%bodies%thermal%changes) call foresee_melting(run, model, attempt)
         call reduce_heat(run, model, attempt, error)
         if (allocated(error)) return
         if (melts .and. run%bodies%thermal%changes) call foresee_melting(run, model, attempt)
         do
            call corrections%give(attempt%data%equation, attempt%next)
            call solve_fields(run, model, attempt, error)
            if (allocated(error)) return
            call corrections%correct(model, run%bodies, attempt%next, merge(rough, 0.0_dp, &
               attempt%is_rough), error)
            if (allocated(error)) return
            if (corrections%is_settled) exit
            attempt%known = known
            if (corrections%asks_operators .or. corrections%asks_capacity) then
               call renew_operators(run, model, attempt, error)
               if (allocated(error)) return
               call begin_trial(run, model, attempt)
               if (corrections%asks_operators .or. .not. run%bodies%thermal%changes) call &
                  reduce_heat(run, model, attempt, error)
               if (allocated(error)) return
            end if
            call attempt%begin_again(attempt%before)
         end do
         call corrections%keep(run%bodies, attempt%before, attempt%next)
         attempt%record%corrections = corrections%passes
         attempt%record%has_new_operators = corrections%renewed_at > 0
      end associate
   end subroutine solve_corrected

   !> Forms the operators, or C alone, at the solution of a stage, and goes on from it.
   !> Errors: as reduce.
   subroutine renew_operators(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: tangent(:)

      if (run%corrections%goes_back) call run%corrections%go_back(attempt%next)
      if (run%corrections%asks_capacity) then
         call run%bodies%set_melting(run%corrections%melting%slopes(model))
         call run%corrections%renew(model, run%bodies, attempt%before, attempt%next)
         return
      end if
      call run%corrections%find_tangents(model, attempt%next, tangent)
      associate (bodies => run%bodies)
         call bodies%move_operators(model, attempt%next%temperature, tangent)
         call run%corrections%renew(model, bodies, attempt%before, attempt%next)
         if (solves_mechanics(model%steps(run%control%step)%analysis)) call bodies%reduce(model, &
            run%heat_reductions(run%in_use)%node_rank, error)
      end associate
      if (.not. (allocated(error) .and. run%corrections%has_laws)) return
      if (error%status == status_internal) return
      call set_error(error, status_no_convergence, 'bodies yield without resistance')
   end subroutine renew_operators

   !> Foresees which nodes melt at the end of a stage, and gives C and corrections what they have.
   subroutine foresee_melting(run, model, attempt)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt           !! begun without melting
      real(dp) :: rhs(size(attempt%before%temperature)), temperature(size(rhs)), &
         change(size(rhs))

      associate (bodies => run%bodies, melting => run%corrections%melting, start => &
         attempt%before%temperature, equation => attempt%data%equation, stage => attempt%stage, &
         terms => run%bodies%thermal%map%by_unknowns%start)
         temperature = start
         change = 0.0_dp
         ! The equation of heat alone does not have that of contact points.
         if (.not. bodies%thermal%changes) then
            call melting%begin(model, change, attempt%before%stored*stage%size, temperature)
         else
            if (allocated(attempt%before%temperature_before)) change = stage%size/ &
               attempt%before%increment_size*(start - attempt%before%temperature_before)
            call melting%begin(model, change, 0.0_dp*start, temperature)
            call run%corrections%give(equation, attempt%next)
            rhs = equation%history(bodies%thermal%matrix) + melting%contents(model, start)/ &
               equation%duration
            temperature = merge(run%loads%temperature%value, temperature, &
               run%loads%temperature%active)
            call melting%foresee(model, run%heat_reductions(run%in_use)%whole, rhs, &
               equation%duration, terms(2:size(start) + 1) - terms(:size(start)) == 1, temperature)
         end if
         attempt%next%temperature = temperature
         call bodies%set_melting(melting%slopes(model))
         call run%corrections%foresee_melting(model, bodies%melting, start)
         call equation%hold_heat(bodies%capacity, stage%duration, stage%temperature, &
            attempt%before%stored)
      end associate
   end subroutine foresee_melting

   !> Begins the trial of a stage.
   subroutine begin_trial(run, model, attempt)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt

      associate (step => model%steps(run%control%step), bodies => run%bodies, data => attempt%data)
         call begin_increment(bodies, step, attempt%before, attempt%trial_type)
         data%is_corrected = run%corrections%corrects
         if (allocated(attempt%omega_start)) data%omega_start = attempt%omega_start
         if (allocated(attempt%closing_start)) data%closing_start = attempt%closing_start
         if (allocated(attempt%wear_by_pressure)) data%wear_by_pressure = attempt%wear_by_pressure
         if (attempt%is_rough) data%fixed_point%tolerance = max(rough, data%fixed_point%tolerance)
         if (allocated(bodies%faces_at)) data%same_slip = same_law*bodies%least_spacing()
         ! The last of several solutions is judged alone.
         data%fixed_point%finds_gain = data%fixed_point%finds_gain .and. .not. &
            solves_repeatedly(run)
         if (step%is_transient) then
            associate (stage => attempt%stage)
               call data%equation%hold_heat(bodies%capacity, stage%duration, stage%temperature, &
                  attempt%before%stored)
               if (bodies%thermal%changes .and. .not. stage%begins_step) data%stored_norm = &
                  norm2(attempt%before%stored)
               data%friction%duration = stage%duration
               if (allocated(stage%slip_before)) data%friction%slip_before = stage%slip_before
            end associate
         end if
         if (run%branch%is_followed) then
            data%omega_start = run%branch%point%omega
            data%fixed_point%method = method_newton
         end if
      end associate
   end subroutine begin_trial

   !> Reduces heat as the equation of a stage asks for; without melting where that stands beside it.
   !> Errors: as reduce_heat.
   subroutine reduce_heat(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(in) :: attempt
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: slopes(:)

      if (.not. solves_heat(model%steps(run%control%step)%analysis)) return
      associate (bodies => run%bodies)
         if (allocated(bodies%melting)) slopes = bodies%melting
         if (bodies%thermal%changes .and. allocated(slopes)) call bodies%set_melting(0.0_dp*slopes)
         call run%reduce_heat(model, attempt%data%equation%left_film(bodies%capacity), error)
         if (allocated(slopes)) call bodies%set_melting(slopes)
      end associate
   end subroutine reduce_heat

   !> Solves the fields of a stage with the present corrections of its operators.
   subroutine solve_fields(run, model, attempt, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: words
      real(dp) :: since

      associate (step => model%steps(run%control%step), bodies => run%bodies, &
         data => attempt%data, workspace => attempt%workspace, next => attempt%next)
         workspace%record%increment = attempt%record%increment
         if (bodies%thermal%changes .and. data%equation%duration > 0.0_dp) call &
            run%heat_reductions(run%in_use)%add_diagonal(bodies%thermal, bodies%melting/ &
            data%equation%duration, error)
         if (allocated(error)) return
         call solve_points(bodies, run%heat_reductions(run%in_use), run%loads, &
            attempt%trial_type, error)
         attempt%record%solution_report_type = workspace%record
         if (solves_heat(step%analysis)) then
            ! Bodies whose temperature is undetermined stand in place of whatever followed from it.
            words = undetermined_now(model, bodies%points, run%loads%temperature%active, &
               run%control%step, data%equation%contact_diagonal(next%omega) > 0.0_dp)
            if (len(words) > 0 .and. allocated(error)) deallocate (error)
            if (len(words) > 0) call set_error(error, status_no_convergence, words)
         end if
         if (allocated(error)) then
            if (workspace%contact%driven) error%message = error%message// &
               unconstrained_now(model, bodies%points, bodies%laws%friction%coefficient > 0.0_dp, &
               run%loads%displacement%active, next%contact%contact_state)
            return
         end if
         since = wall_seconds()
         call recover_fields(bodies, run%heat_reductions(run%in_use), run%loads, &
            attempt%before, attempt%trial_type)
         call find_stored(run, model, attempt)
         run%seconds%recover = run%seconds%recover + (wall_seconds() - since)
      end associate
   end subroutine solve_fields

   !> The rate of stored heat of a solution in real time.
   subroutine find_stored(run, model, attempt)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(attempt_type), intent(inout) :: attempt

      if (.not. model%steps(run%control%step)%is_transient) return
      associate (data => attempt%data, next => attempt%next)
         next%stored = data%equation%stored_rate(run%bodies%capacity, next%temperature)
         associate (a => data%equation%scheme%a, b => data%equation%scheme%b)
            ! Heat of slip has its mean rate from just behind the start on: so much more enters.
            if (allocated(data%friction%heat)) next%stored = next%stored - b(1)/a(1)* &
               nodal_friction_heat(run%bodies, merge(data%friction%old, data%friction%heat, &
               data%friction%parts(1, :) > 0.0_dp) - attempt%before%friction_heat)
         end associate
      end associate
   end subroutine find_stored

   !> Which increment a record is of.
   subroutine begin_record(run, model, clock, record)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock            !! its end
      type(increment_record_type), intent(out) :: record

      record%increment = run%control%increments + 1
      record%step = run%control%step
      record%increment_in_step = run%control%increments_of_step + 1
      record%last_of_step = clock%step_time >= clock%period
      record%cut_backs = run%control%cut_backs
      record%time = clock%total_time
      associate (continuation => model%steps(run%control%step)%continuation)
         if (continuation%is_on) then
            record%last_of_step = run%branch%is_last
            record%load_factor = clock%step_time/clock%period
            record%is_fold = run%branch%is_fold
            ! The load factor may fall, time does not.
            record%time = run%control%step_start + clock%period*record%increment_in_step/ &
               continuation%most_points
         end if
      end associate
      record%load = run%loads%axis_value(model, record%time)
   end subroutine begin_record

end module increment_attempts
