!> How large the problems of a run are, and where its time goes.
module run_sizes
   use connections, only: connections_type
   use constraint_checks, only: check_equations, check_prescribed
   use errors, only: error_type
   use field_problem, only: field_reduction_type
   use heat_reduction, only: heat_reduction_type
   use kinds, only: dp, long
   use linear_solver, only: linear_solver_type
   use load_histories, only: end_of_step
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use steps, only: solves_heat, solves_mechanics
   use text, only: to_text
   implicit none
   private
   public :: measure_steps, measure_factors, run_seconds_type, run_size_type

   !> Where the time goes.
   type :: run_seconds_type
      real(dp) :: assemble = 0.0_dp   !! matching and matrices of the bodies [s]
      real(dp) :: reduce = 0.0_dp     !! factors and reduction to the contact points [s]
      real(dp) :: iterate = 0.0_dp    !! what increments take besides, without uncertainties [s]
      real(dp) :: recover = 0.0_dp    !! fields and balances [s]
   end type run_seconds_type

   !> The largest problems of a run.
   type :: run_size_type
      integer :: equations_thermal = 0      !! unknown temperatures, largest of the steps
      integer :: equations_mechanical = 0   !! unknown displacements, largest of the steps
      integer :: contact_unknowns = 0       !! unknowns on the contact points, largest of the steps
      integer(long) :: factor_bytes = 0     !! bytes of factors, largest so far
      integer :: heat_factored = 0          !! how often the matrix of heat was factored
      real(dp) :: smallest_pivot = 1.0_dp   !! over its diagonal entry, smallest so far [-]
   end type run_size_type

contains

   !> Numbers every step in turn, for the largest problems and for mistakes in its supports.
   !> Errors: as check_equations and check_prescribed.
   subroutine measure_steps(model, points, loads, state, sizes, error)
      type(model_type), intent(in) :: model
      type(connections_type), intent(in) :: points   !! contact points of all interfaces
      type(loads_type), intent(in) :: loads                 !! loads before the first step
      type(solution_state_type), intent(in) :: state        !! state before it
      type(run_size_type), intent(inout) :: sizes           !! receives the numbers of unknowns
      type(error_type), allocatable, intent(out) :: error
      type(reduced_bodies_type) :: trial
      type(loads_type) :: given
      integer :: step, unknowns

      ! Supports say which contact points are held; those of later steps must not show in the first.
      trial%points = points
      given = loads
      do step = 1, size(model%steps)
         call given%begin_step(model%steps(step), state%displacement, state%temperature)
         call trial%enter_step(model, step, given)
         call given%move_to(end_of_step(model%steps, step), model)
         call check_equations(model, trial, given, step, error)
         if (.not. allocated(error)) call check_prescribed(model, trial, given, step, error)
         if (allocated(error)) then
            if (size(model%steps) > 1) error%message = 'step '//to_text(step)//': '//error%message
            return
         end if
         unknowns = 0
         associate (analysis => model%steps(step)%analysis, thermal => trial%thermal%map, &
            mechanical => trial%mechanical%map)
            if (solves_heat(analysis)) then
               sizes%equations_thermal = max(sizes%equations_thermal, thermal%equations)
               unknowns = thermal%tail
            end if
            if (solves_mechanics(analysis)) then
               sizes%equations_mechanical = max(sizes%equations_mechanical, mechanical%equations)
               unknowns = unknowns + mechanical%tail
            end if
            sizes%contact_unknowns = max(sizes%contact_unknowns, unknowns)
         end associate
      end do
   end subroutine measure_steps

   !> Notes the memory of the factors that are, and their smallest pivot.
   subroutine measure_factors(bodies, heat_reductions, sizes)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat_reductions(:)         !! those that are kept
      type(run_size_type), intent(inout) :: sizes               !! receives both
      integer(long) :: bytes
      integer :: i

      bytes = 0
      call measure_field(bodies%equilibrium)
      do i = 1, size(heat_reductions)
         call measure_field(heat_reductions(i))
      end do
      sizes%heat_factored = sum(heat_reductions%factored)
      sizes%factor_bytes = max(sizes%factor_bytes, bytes)
   contains
      subroutine measure_field(field)
         class(field_reduction_type), intent(in) :: field
         integer :: k

         if (allocated(field%solver)) call measure(field%solver)
         if (.not. allocated(field%pieces%piece)) return
         do k = 1, size(field%pieces%piece)
            associate (piece => field%pieces%piece(k))
               if (allocated(piece%solver)) call measure(piece%solver)
            end associate
         end do
      end subroutine measure_field

      subroutine measure(solver)
         class(linear_solver_type), intent(in) :: solver

         bytes = bytes + solver%factor_bytes
         sizes%smallest_pivot = min(sizes%smallest_pivot, solver%smallest_pivot)
      end subroutine measure
   end subroutine measure_factors

end module run_sizes
