!> The bodies as a step needs them: unknowns numbered for its supports, fields reduced to the
!> contact points. What is numbered and reduced already is kept from step to step. How large they
!> are, and where the time goes.
module step_reduction
   use all_contact_points, only: all_contact_points_type
   use clock, only: wall_seconds
   use conductance_laws, only: is_constant
   use equation_checks, only: check_equations
   use equilibrium_reduction, only: take_laws
   use errors, only: error_type
   use heat_reduction, only: heat_reduction_type
   use kinds, only: dp, long
   use linear_solver, only: linear_solver_type
   use load_histories, only: end_of_step
   use loads, only: loads_type
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use solution_state, only: solution_state_type
   use sparse_matrix, only: sparse_matrix_type
   use steps, only: load_temperature, solves_heat, solves_mechanics, step_type
   use text, only: to_text
   use tie_checks, only: check_prescribed_ties
   implicit none
   private
   public :: step_reduction_type, assemble_bodies, measure_steps, measure_factors, &
      reduce_bodies, run_seconds_type, run_size_type

   !> Where the time goes.
   type :: run_seconds_type
      real(dp) :: assemble = 0.0_dp   !! matching and matrices of the bodies [s]
      real(dp) :: reduce = 0.0_dp     !! factors and reduction to the contact points [s]
      real(dp) :: iterate = 0.0_dp    !! increments on the contact points [s]
      real(dp) :: recover = 0.0_dp    !! fields and balances [s]
   end type run_seconds_type

   !> The largest problems of a run.
   type :: run_size_type
      integer :: equations_thermal = 0      !! unknown temperatures, largest of the steps
      integer :: equations_mechanical = 0   !! unknown displacements, largest of the steps
      integer :: contact_unknowns = 0       !! unknowns on the contact points, largest of the steps
      integer(long) :: factor_bytes = 0     !! bytes of factors, largest so far
      real(dp) :: smallest_pivot = 1.0_dp   !! over its diagonal entry, smallest so far [-]
   end type run_size_type

   !> What of the bodies is numbered.
   type :: step_reduction_type
      private
      logical, allocatable :: held(:)               !! (2 nodes) supports that are numbered
      logical, allocatable :: has_friction(:)       !! (m) contact points that are numbered with it
      logical, allocatable :: held_temperature(:)   !! (nodes) prescribed nodes that are numbered
   contains
      procedure :: number
   end type step_reduction_type

contains

   !> Numbers the unknowns of a step. A field is numbered again only where it is solved and its
   !> supports or frictions differ from those that were numbered last; only then are its factors
   !> formed again.
   !> Error: as reduced_bodies' number.
   subroutine number(self, model, step, loads, bodies, error)
      class(step_reduction_type), intent(inout) :: self          !! what is numbered
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(loads_type), intent(in) :: loads                      !! supports of the step
      type(reduced_bodies_type), intent(inout) :: bodies
      type(error_type), allocatable, intent(out) :: error
      logical :: heat, mechanics

      associate (held => loads%displacement%active, held_temperature => loads%temperature%active)
         mechanics = solves_mechanics(step%analysis)
         if (mechanics .and. allocated(self%held)) mechanics = any(self%held .neqv. held) .or. &
            any(self%has_friction .neqv. bodies%points%has_friction())
         heat = solves_heat(step%analysis)
         if (heat .and. allocated(self%held_temperature)) then
            heat = any(self%held_temperature .neqv. held_temperature)
         end if
         if (mechanics) then
            self%held = held
            self%has_friction = bodies%points%has_friction()
         end if
         if (heat) self%held_temperature = held_temperature
         bodies%is_coupled = solves_heat(step%analysis) .and. solves_mechanics(step%analysis) &
            .and. .not. all(is_constant(bodies%points%law))
         call bodies%number(model, held, held_temperature, mechanics, heat, error)
      end associate
   end subroutine number

   !> Numbers every step in turn, for the largest problems and for mistakes in its supports.
   !> Error: as number.
   subroutine measure_steps(model, points, loads, state, sizes, error)
      type(model_type), intent(in) :: model
      type(all_contact_points_type), intent(in) :: points   !! contact points of all interfaces
      type(loads_type), intent(in) :: loads                 !! loads before the first step
      type(solution_state_type), intent(in) :: state        !! state before it
      type(run_size_type), intent(inout) :: sizes           !! receives the numbers of unknowns
      type(error_type), allocatable, intent(out) :: error
      type(reduced_bodies_type) :: trial
      type(loads_type) :: given
      type(step_reduction_type) :: reduction
      integer :: step, unknowns

      ! Supports say which contact points are held; those of later steps must not show in the first.
      trial%points = points
      given = loads
      do step = 1, size(model%steps)
         call given%begin_step(model%steps(step), state%displacement, state%temperature)
         call trial%points%enter_step(model, step)
         call reduction%number(model, model%steps(step), given, trial, error)
         if (.not. allocated(error)) then
            call given%move_to(end_of_step(model%steps, step), model)
            call check_equations(model, trial, given, step, error)
            if (.not. allocated(error)) call check_prescribed_ties(model, trial, given, step, &
               error)
         end if
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

   !> Assembles the bodies, where that is not done.
   subroutine assemble_bodies(model, bodies, seconds)
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(inout) :: bodies
      type(run_seconds_type), intent(inout) :: seconds           !! receives the time it took
      real(dp) :: since

      if (allocated(bodies%mechanical%matrix%value)) return
      if (allocated(bodies%thermal%matrix%value)) return
      since = wall_seconds()
      call bodies%assemble(model, any(solves_mechanics(model%steps%analysis)), &
         any(solves_heat(model%steps%analysis)), temperatures_strain(model))
      seconds%assemble = seconds%assemble + (wall_seconds() - since)
   end subroutine assemble_bodies

   !> Assembles the bodies, where that is not done, and reduces the fields of a step to their
   !> contact unknowns, where that is not done.
   !> Errors: as reduced_bodies' and heat_reduction's reduce.
   subroutine reduce_bodies(model, step, film, bodies, heat, seconds, error)
      type(model_type), intent(in) :: model
      type(step_type), intent(in) :: step
      type(sparse_matrix_type), intent(in) :: film !! left-hand side of (3.4) [power/temperature]
      type(reduced_bodies_type), intent(inout) :: bodies         !! numbered for the step
      type(heat_reduction_type), intent(inout) :: heat
      type(run_seconds_type), intent(inout) :: seconds           !! receives the time it took
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: of_elimination
      logical :: mechanics
      real(dp) :: since

      call assemble_bodies(model, bodies, seconds)
      since = wall_seconds()
      mechanics = solves_mechanics(step%analysis) .and. &
         bodies%equilibrium%numbering /= bodies%mechanical%numbering
      if (mechanics) call bodies%equilibrium%release()
      call heat%renumber_both(bodies)
      ! Where it fails, heat%reduce fails again and says so.
      if (solves_heat(step%analysis)) call heat%eliminate(model, bodies, film, of_elimination)
      if (mechanics) call bodies%reduce(model, heat%node_rank, error)
      if (allocated(error)) return
      if (solves_mechanics(step%analysis)) call take_laws(bodies%points, bodies%equilibrium%contact)
      if (solves_heat(step%analysis)) call heat%reduce(model, bodies, film, error)
      seconds%reduce = seconds%reduce + (wall_seconds() - since)
   end subroutine reduce_bodies

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

   !> Notes the memory of the factors that are, and their smallest pivot.
   subroutine measure_factors(bodies, heat, sizes)
      type(reduced_bodies_type), intent(in) :: bodies
      type(heat_reduction_type), intent(in) :: heat
      type(run_size_type), intent(inout) :: sizes               !! receives both
      integer(long) :: bytes

      bytes = 0
      if (allocated(bodies%equilibrium%solver)) call measure(bodies%equilibrium%solver)
      if (allocated(heat%solver)) call measure(heat%solver)
      sizes%factor_bytes = max(sizes%factor_bytes, bytes)
   contains
      subroutine measure(solver)
         class(linear_solver_type), intent(in) :: solver

         bytes = bytes + solver%factor_bytes
         sizes%smallest_pivot = min(sizes%smallest_pivot, solver%smallest_pivot)
      end subroutine measure
   end subroutine measure_factors

end module step_reduction
