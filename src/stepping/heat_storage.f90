!> What a step that stores heat, (1.2), asks of its increments: the stages of the scheme, the heat
!> that is stored when the step begins, and how far an increment goes and errs in time.
!>
!> The error of an increment is that of its scheme beside one of first order, smoothed by the
!> matrix that is factored anyway, as Hosea and Shampine do: with the rates of stored heat S_1 and
!> S_2 of both stages, (K + C/(gamma dt)) e = S_2 - S_1. A scheme of one stage has S_i and S_i+1,
!> and half of their difference. E is no error of the result, which is of second order; it says how
!> fast temperatures change their course.
!>
!> R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006; M. E. Hosea, L. F. Shampine, Appl. Numer.
!> Math. 20 (1996) 21.
module heat_storage
   use controls, only: stage_part
   use edge_heat, only: supplied_heat
   use friction_heating, only: friction_at_start, slips_before
   use heat_equation, only: heat_across, heat_rates_type
   use increment_data, only: stage_type
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   implicit none
   private
   public :: begin_first_stage, begin_second_stage, begin_storage, measure_changes, measure_strains

   real(dp), parameter :: own = 2.0_dp   !! growth of the range that an increment makes itself
   !> Part of the largest temperature below which a range is that of rounding.
   real(dp), parameter :: unresolved = 1.0e-8_dp

contains

   !> The first stage of an increment in real time, and the state that it finds.
   subroutine begin_first_stage(run, model, stage, start)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(stage_type), intent(inout) :: stage            !! with the clock of the increment
      type(solution_state_type), intent(inout) :: start    !! state of the run

      associate (step => model%steps(run%control%step))
         stage%size = run%control%size_to(stage%clock)
         stage%duration = stage%size
         stage%is_last = step%scheme%stages /= 2
         stage%passing%real_part = merge(merge(1.0_dp, stage_part, stage%is_last), 0.0_dp, &
            step%creeps)
         if (step%is_transient) then
            stage%stores_heat = .true.
            stage%dilates = step%dilates
            if (run%control%increments_of_step == 0) call begin_storage(run, model, start)
            if (run%corrections%corrects) stage%content = run%corrections%true_contents(model, &
               start%temperature)
            if (run%corrections%heats) stage%worked = run%corrections%inelastic_heat(model, &
               start%history)
            stage%jump = start%temperature - run%state%temperature
            stage%temperature = start%temperature
            stage%displacement = start%displacement
         end if
      end associate
      if (stage%is_last) return
      stage%passing%is_last = .false.
      stage%duration = stage_part*stage%size
      stage%size = stage%duration
      stage%clock = run%control%instant_at(model, run%control%step_time + stage%size)
   end subroutine begin_first_stage

   !> The second stage of an increment: C (T_i+1 - T_i)/dt is (1 - gamma) of the first stage's rate
   !> and gamma of its own.
   subroutine begin_second_stage(run, model, start, middle, stage)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: start        !! state at the start of the increment
      type(solution_state_type), intent(in) :: middle       !! and at the end of the first stage
      type(stage_type), intent(inout) :: stage
      real(dp), parameter :: weight = 1/stage_part - 1

      if (allocated(stage%history)) stage%history = run%corrections%points%second_start( &
         model%mesh, start%history, middle%history, weight, run%control%increments_of_step == 0)
      stage%passing%is_last = .true.
      if (stage%stores_heat) then
         stage%temperature = start%temperature + weight*(middle%temperature - start%temperature)
         stage%displacement = start%displacement + weight*(middle%displacement - start%displacement)
         if (run%corrections%corrects) stage%content = stage%content + weight* &
            (run%corrections%true_contents(model, middle%temperature) - stage%content)
         if (allocated(stage%worked)) stage%worked = stage%worked + weight* &
            (run%corrections%inelastic_heat(model, middle%history) - stage%worked)
      end if
      if (allocated(run%bodies%points%heated) .and. stage%strains) stage%slip_before = &
         slips_before(run%bodies, middle%contact)
      stage%size = stage%of_increment%step_time - stage%clock%step_time
      stage%clock = stage%of_increment
      stage%is_last = .true.
   end subroutine begin_second_stage

   !> The state as its first increment finds it: temperatures that the step prescribes, with those
   !> that ties, equations and hanging nodes give by them, its loads and its films act as at its
   !> start, jumps included, and what they leave over is stored.
   subroutine begin_storage(run, model, state)
      type(simulation_type), intent(inout) :: run            !! its loads move there
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(inout) :: state      !! before the first increment
      type(heat_rates_type) :: rates
      real(dp) :: temperature(size(state%temperature))
      logical :: stores(size(state%temperature))
      integer :: i

      call run%loads%move_to(run%control%instant_at(model, 0.0_dp), model)
      associate (bodies => run%bodies, loads => run%loads, by => run%bodies%thermal%map%by_unknowns)
         temperature = bodies%thermal%map%carried_along(state%temperature, merge( &
            loads%temperature%value, 0.0_dp, loads%temperature%active))
         state%jump = state%jump + bodies%points%jumps(temperature - state%temperature)
         state%temperature = temperature
         state%sources%load = loads%heat_load()
         state%sources%film = loads%film_matrix()
         rates%conducted = bodies%thermal%matrix%multiply(state%temperature)
         if (run%corrections%corrects) rates%conducted = rates%conducted - &
            run%corrections%heat_beyond(model, bodies, state%temperature)
         rates%entering = state%sources%net_heat(state%temperature)
         rates%crossing = heat_across(bodies%points%weight, state%flux_conductance, state%jump)
         if (allocated(bodies%points%heated)) then
            rates%friction_heat = friction_at_start(bodies, state%contact, state%friction_heat)
            state%friction_heat = rates%friction_heat
         end if
         do i = 1, bodies%capacity%row_count
            stores(i) = by%start(i + 1) > by%start(i)
            associate (row => bodies%capacity%value(bodies%capacity%row_start(i): &
               bodies%capacity%row_start(i + 1) - 1))
               stores(i) = stores(i) .and. any(abs(row) > 0.0_dp)
            end associate
         end do
         state%stored = merge(-supplied_heat(bodies, state%edge, rates), 0.0_dp, stores)
      end associate
      state%extremes = extremes_of(model, state%temperature)
   end subroutine begin_storage

   !> Measures an increment of two stages: error of its inelastic strains and difference of their
   !> rates. Strains that jump with the loads have no rate.
   subroutine measure_strains(run, model, stage, middle, next, record)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      type(stage_type), intent(in) :: stage                  !! the second one
      type(solution_state_type), intent(in) :: middle        !! state at its start
      type(solution_state_type), intent(in) :: next          !! and at its end
      type(increment_record_type), intent(inout) :: record
      real(dp) :: largest(2)

      largest = run%corrections%points%difference_of_stages(model%mesh, middle%history - &
         run%state%history, next%history - stage%history)
      if (run%control%increments_of_step == 0) largest(1) = largest(2)
      record%strain_error = largest(1)/max(run%corrections%elastic_strain, tiny(largest))
      record%creep_difference = largest(2)/stage_part
   end subroutine measure_strains

   !> Measures an increment: error and largest change of its temperatures.
   subroutine measure_changes(run, model, start, stored, next, record)
      type(simulation_type), intent(in) :: run               !! heat reduced as in the increment
      type(model_type), intent(in) :: model
      type(solution_state_type), intent(in) :: start         !! state at its start
      real(dp), intent(in) :: stored(:)                      !! (nodes) before its last stage
      type(solution_state_type), intent(inout) :: next       !! state at the end
      type(increment_record_type), intent(inout) :: record
      real(dp) :: here(2), part, range

      here = extremes_of(model, next%temperature)
      next%extremes = [min(start%extremes(1), here(1)), max(start%extremes(2), here(2))]
      record%makes_range = next%extremes(2) - next%extremes(1) > own*(start%extremes(2) - &
         start%extremes(1))
      range = max(next%extremes(2) - next%extremes(1), unresolved*maxval(abs(next%extremes)), &
         tiny(range))
      associate (scheme => model%steps(record%step)%scheme)
         part = merge(1.0_dp, 0.5_dp/scheme%a(1), scheme%stages == 2)
      end associate
      record%local_error = maxval(abs(run%heat_reductions(run%in_use)%welded_response( &
         run%bodies%thermal, part*(next%stored - stored))))/range
      ! 0 where all are prescribed.
      record%largest_change = max(0.0_dp, maxval(abs(next%temperature - start%temperature), &
         mask=.not. run%loads%temperature%active))
   end subroutine measure_changes

   !> Lowest and highest temperature of the bodies.
   pure function extremes_of(model, temperature) result(extremes)
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: temperature(:)                 !! (nodes)
      real(dp) :: extremes(2)

      associate (used => model%mesh%node_body > 0)
         extremes = [minval(temperature, mask=used), maxval(temperature, mask=used)]
      end associate
   end function extremes_of

end module heat_storage
