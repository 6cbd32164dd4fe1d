!> Increments, of which one call of advance solves one, and their acceptance.
module increments
   use balances, only: sound_imbalance
   use branch_steps, only: accept_point, find_point, shorten_step
   use cycles, only: close_cycle
   use due_output, only: is_nth
   use energies, only: measure_energies
   use errors, only: error_type, set_error, status_no_convergence
   use increment_attempts, only: attempt_increment, attempt_type, begin_record
   use kinds, only: dp
   use load_histories, only: step_clock_type
   use model, only: model_type
   use records, only: add_attempts, increment_record_type, note_failure
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: adapts_increments, boundary_type, dof_temperature, solves_heat, solves_mechanics
   use text, only: append, counted, percent, to_text
   use touch_instants, only: touch_search_type
   implicit none
   private
   public :: advance, accept_increment

   real(dp), parameter :: doubtful = 1.0e-9_dp   !! pivot over its diagonal entry; 1e-6 is left

contains

   !> Solves the next increment, cut back as often as it takes. On failure the state is that of the
   !> last good increment and the record holds the attempts at the failing one with their passes.
   !> Errors: no convergence with the smallest increment, more increments than INC allows, bodies
   !> that nothing holds, a failed self-check.
   subroutine advance(run, model, record, error)
      type(simulation_type), intent(inout) :: run         !! the run
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      type(attempt_type) :: attempt
      type(increment_record_type) :: earlier
      type(step_clock_type) :: clock
      type(touch_search_type) :: touch
      real(dp) :: increment_size

      if (run%control%step_is_over(model)) call run%enter_step(model)
      associate (control => run%control, step => model%steps(run%control%step))
         ! Attempts that failed do not count.
         if (control%increments_of_step >= step%max_increments .and. .not. &
            step%continuation%is_on) call set_error(error, &
            status_no_convergence, 'step '//to_text(control%step)//' is not finished after INC='// &
            counted(step%max_increments, 'increment')//', at '//to_text(control%step_time)// &
            ' of its period '//to_text(step%period)//'; a larger INC= allows more')
         if (allocated(error) .and. adapts_increments(step)) error%message = error%message// &
            ', a larger LOCAL ERROR=, CETOL= or DELTMX= takes fewer'
      end associate
      if (allocated(error)) return
      call run%reduce(model, error)
      if (allocated(error)) return
      do
         clock = run%control%next_instant(model)
         if (run%branch%points > 0) then
            call begin_record(run, model, clock, record)
            call find_point(run%branch, model, run%bodies, run%heat_reductions(run%in_use), &
               run%loads, run%state, error)
            if (.not. allocated(error)) clock = run%branch%clock_at(run%branch%point%factor)
         end if
         if (touch%interface > 0) clock = run%control%instant_at(model, touch%ending)
         increment_size = clock%step_time - run%control%step_time
         if (.not. allocated(error)) then
            call attempt_increment(run, model, clock, attempt, error)
            record = attempt%record
         end if
         call add_attempts(earlier, record)
         if (allocated(error)) then
            touch = touch_search_type()
            call try_again(run, model, increment_size, record, error)
            if (allocated(error)) return
         else
            if (keeps(run, model, clock, attempt%next, touch, record)) exit
         end if
         earlier = record
         call run%take_back(model, error)
         if (allocated(error)) return
      end do
      call warn_of_pivot(run, record)
      if (solves_mechanics(model%steps(record%step)%analysis)) call measure_energies(run, model, &
         attempt%next, record)
      call accept_increment(attempt%next, model, run%state, record)
      call move_alloc(attempt%known, run%known)
      call move_alloc(attempt%undecided, run%undecided)
      if (is_nth(model%steps(record%step)%stability_frequency, record)) run%solved = &
         attempt%workspace%of_motions()
      if (record%last_of_step) call run%control%explain_many(model, clock, record)
      call run%control%warn_of_smallest(model, increment_size, record)
      call run%control%accept(model, clock, record)
      call close_cycle(run, model, record)
      if (allocated(run%is_beyond)) call note_ends(run, model, record)
      if (.not. model%steps(run%control%step)%continuation%is_on) return
      call accept_point(run%branch, record%load_factor)
      run%control%branch_ended = run%branch%is_last
      if (run%branch%is_last) call append(record%notes, 'the branch ends here: '//run%branch%ending)
   end subroutine advance

   !> Makes the next attempt shorter than one that failed, if that is possible; else the error says
   !> where the run ends.
   subroutine try_again(run, model, increment_size, record, error)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      real(dp), intent(in) :: increment_size                   ! of the attempt [time]
      type(increment_record_type), intent(inout) :: record     ! of it
      type(error_type), allocatable, intent(inout) :: error
      logical :: can_shorten

      if (error%status == status_no_convergence) then
         call note_failure(record, increment_size, error%message)
         if (allocated(record%runaway)) then
            run%runaway = record%runaway
            run%runaway_time = record%time
         end if
         if (run%branch%points > 0) then
            call shorten_step(run%branch, can_shorten)
         else
            can_shorten = run%control%can_cut_back(model, increment_size)
            if (can_shorten) call run%control%cut_back(model, increment_size)
         end if
         if (can_shorten) then
            deallocate (error)
            return
         end if
         if (run%branch%points == 0) error%message = error%message//'; '// &
            run%control%why_not_again(model, increment_size)
         error%message = error%message//words_of_collapse(run, model)
         if (run%branch%points == 0 .and. allocated(run%runaway) .and. &
            record%time < run%runaway_time) error%message = error%message// &
            '; an increment to time '//to_text(run%runaway_time)//' ended in '//run%runaway
      end if
      error%message = 'increment '//to_text(record%increment)//' (time '// &
         to_text(record%time)//'): '//error%message
   end subroutine try_again

   !> How forces on bodies that yield, or displacements, would grow where they act at once; what a
   !> run was carrying last before such bodies found no equilibrium under forces that grow; nothing
   !> for others.
   function words_of_collapse(run, model) result(words)
      type(simulation_type), intent(in) :: run
      type(model_type), intent(in) :: model
      character(:), allocatable :: words
      logical :: acts_at_once, grows

      words = ''
      grows = any(abs(run%loads%nodal_forces()) > 0.0_dp)
      if (allocated(run%state%force_load)) grows = any(abs(run%loads%nodal_forces()) > &
         abs(run%state%force_load))
      grows = grows .and. run%corrections%yields(model)
      associate (control => run%control, step => model%steps(run%control%step))
         acts_at_once = control%step_time <= 0.0_dp .and. .not. step%ramped
         if (acts_at_once .and. (grows .or. any(moves(step%boundaries)))) then
            words = '; loads and displacements without an amplitude act at once, in the '// &
               'shortest increment, too: *STEP, AMPLITUDE=RAMP ramps them'
            return
         end if
         if (.not. grows) return
         words = '; collapse: the last load that was carried is that of time '// &
            to_text(control%step_start + control%step_time)//', '//percent(control%step_time/ &
            model%steps(control%step)%period, 4)//' of step '//to_text(control%step)
      end associate
   end function words_of_collapse

   !> Whether it prescribes a displacement, without an amplitude, that is not zero.
   elemental logical function moves(boundary)
      type(boundary_type), intent(in) :: boundary

      moves = boundary%dof /= dof_temperature .and. boundary%amplitude == 0 .and. &
         abs(boundary%value) > 0.0_dp .and. .not. boundary%keeps
   end function moves

   !> Whether an attempt that was solved is the increment: in a transient whose increments are free
   !> it is not where it errs too much, or an interface first touches or parts within it; the next
   !> attempt is shorter.
   logical function keeps(run, model, clock, next, touch, record)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(step_clock_type), intent(in) :: clock            ! its end
      type(solution_state_type), intent(in) :: next         ! state there
      type(touch_search_type), intent(inout) :: touch
      type(increment_record_type), intent(inout) :: record
      real(dp) :: increment_size

      keeps = .true.
      if (.not. adapts_increments(model%steps(run%control%step))) return
      increment_size = clock%step_time - run%control%step_time
      if (run%control%goes_too_far(model, increment_size, record)) then
         keeps = .false.
         touch = touch_search_type()
         call note_failure(record, increment_size, run%control%shorten(model, increment_size, &
            record))
      else if (run%bodies%is_coupled) then
         keeps = touch%ends_behind(run%bodies, run%state, next, [run%control%step_time, &
            clock%step_time])
         if (.not. keeps) call note_failure(record, increment_size, 'contact pair '// &
            run%bodies%interfaces(touch%interface)%name//' touches or parts within it')
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

   !> Notes, once for each interface, that contact points have left their master or reached one.
   subroutine note_ends(run, model, record)
      type(simulation_type), intent(inout) :: run
      type(model_type), intent(in) :: model
      type(increment_record_type), intent(inout) :: record
      logical :: goes(size(run%is_beyond))
      integer :: i, k, way

      do way = 1, 2
         goes = (run%bodies%points%is_beyond .neqv. run%is_beyond) .and. &
            (run%bodies%points%is_beyond .eqv. way == 1)
         do i = 1, size(run%bodies%interfaces)
            associate (first => run%bodies%points%interface_start(i), &
               last => run%bodies%points%interface_start(i + 1) - 1)
               k = first - 1 + findloc(goes(first:last), .true., dim=1)
               if (k < first .or. run%sliding_told(2*i - 2 + way)) cycle
               run%sliding_told(2*i - 2 + way) = .true.
               call append(record%notes, 'contact pair '//run%bodies%interfaces(i)%name//': '// &
                  trim(merge('the first contact points leave the master', &
                  'the first contact points reach the master', way == 1))//', at slave node '// &
                  to_text(model%mesh%node_number(run%bodies%points%slave(k))))
            end associate
         end do
      end do
      run%is_beyond = run%bodies%points%is_beyond
   end subroutine note_ends

   !> Warns of pivots so small that digits are lost which results need, again where it is a tenth.
   subroutine warn_of_pivot(run, record)
      type(simulation_type), intent(inout) :: run
      type(increment_record_type), intent(inout) :: record

      if (run%sizes%smallest_pivot >= min(doubtful, 0.1_dp*run%pivot_told)) return
      run%pivot_told = run%sizes%smallest_pivot
      call record%warn('the smallest pivot of the bodies is '//to_text(run%pivot_told)// &
         ' of its diagonal entry, so results may be accurate to '// &
         to_text(10*epsilon(1.0_dp)/run%pivot_told)// &
         ' only: are bodies held by others that are far softer?')
   end subroutine warn_of_pivot

end module increments
