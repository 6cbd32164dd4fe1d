!> A step as solutions beside the run solve it.
module companion_steps
   use controls, only: implicit_scheme, start_type
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use increment_solution, only: begin_increment, solve_points
   use increments, only: simulation_type
   use kinds, only: dp
   use model, only: model_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, step_type
   implicit none
   private
   public :: companion_step, implicit_state, implicit_step

   real(dp), parameter :: tolerance = 1.0e-6_dp   !! of the fixed point; errors are far larger

contains

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

   !> Solves the end of an increment on the contact points; the displacements stay.
   !> Error: it has no solution.
   subroutine implicit_state(simulation, own, model, step, previous, state, error)
      type(simulation_type), intent(in) :: simulation
      type(heat_reduction_type), intent(inout) :: own        !! where the run has other films
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step                    !! from implicit_step
      type(solution_state_type), intent(in) :: previous      !! at the start of the increment
      type(solution_state_type), intent(inout) :: state      !! guess in, solution out
      type(error_type), allocatable, intent(out) :: error

      associate (bodies => simulation%bodies)
         if (simulation%heat%serves(bodies, state%sources%film) .or. &
            .not. solves_heat(step%analysis)) then
            call solve_end(simulation%heat)
         else
            call own%share_order(simulation%heat, bodies)
            call own%reduce(model, bodies, state%sources%film, error)
            if (.not. allocated(error)) call solve_end(own)
         end if
      end associate
   contains
      subroutine solve_end(heat)
         type(heat_reduction_type), intent(in) :: heat
         type(increment_data_type) :: data
         type(increment_workspace_type) :: workspace

         call begin_increment(simulation%bodies, step, previous, state, data)
         call solve_points(simulation%bodies, heat, simulation%loads, data, workspace, state, error)
      end subroutine solve_end
   end subroutine implicit_state

end module companion_steps
