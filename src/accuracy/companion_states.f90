!> States beside that of a run at the end of a step: in the equilibrium of heat, and without what
!> only the run itself tells.
module companion_states
   use controls, only: implicit_scheme, start_type
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: trial_type
   use increment_solution, only: begin_increment, recover_fields, solve_points
   use kinds, only: dp
   use model, only: model_type
   use simulation, only: simulation_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, step_type
   implicit none
   private
   public :: implicit_state, implicit_step

   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

contains

   !> A step without other starts, the gain and the last digits.
   pure function implicit_step(step) result(companion)
      type(step_type), intent(in) :: step   !! the step of the run
      type(step_type) :: companion          !! the same, cheaper

      companion = step
      companion%start = start_type()
      companion%fixed_point%finds_gain = .false.
      companion%fixed_point%tolerance = max(tolerance, step%fixed_point%tolerance)
      companion%scheme = implicit_scheme
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

end module companion_states
