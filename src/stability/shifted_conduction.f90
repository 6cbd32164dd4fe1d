!> A + sigma C: the conduction of bodies, films and contact at the conductances of a state, and
!> their heat capacity at a rate, factored.
module shifted_conduction
   use contact_heat, only: temperature_jumps
   use controls, only: implicit_scheme
   use tail_factors, only: tail_factors_type
   use errors, only: error_type
   use heat_equation, only: heat_equation_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use linear_perturbations, only: linear_perturbation_type
   use solution_state, only: solution_state_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: shifted_conduction_type

   !> Its factors.
   type :: shifted_conduction_type
      type(heat_reduction_type) :: heat
      type(tail_factors_type) :: tail
   contains
      procedure :: factor
      procedure :: solve
      procedure :: responses
   end type shifted_conduction_type

contains

   !> Factors it.
   !> Errors: as heat_reduction's reduce.
   subroutine factor(self, model, bodies, state, heat, sigma, error)
      class(shifted_conduction_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(reduced_bodies_type), intent(in) :: bodies
      type(solution_state_type), intent(in) :: state
      type(heat_reduction_type), intent(in) :: heat            !! of the run, for its order
      real(dp), intent(in) :: sigma                            !! > 0 [1/time]
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: film
      type(increment_data_type) :: data
      type(increment_workspace_type) :: workspace
      real(dp) :: jump(size(state%jump)), none(size(state%temperature))

      film = bodies%capacity
      film%value = sigma*film%value
      if (allocated(state%sources%film%value)) film = linear_combination(1.0_dp, &
         state%sources%film, sigma, bodies%capacity)
      self%heat%forms_on_demand = .true.
      call self%heat%share_order(heat, bodies)
      call self%heat%reduce(model, bodies, film, error)
      if (allocated(error)) return
      none = 0.0_dp
      data%equation = heat_equation_type(implicit_scheme, state%sources, state%sources, &
         state%temperature, bodies%points%weight, state%omega, state%jump)
      data%held_jump = 0.0_dp*state%jump
      data%heat = self%heat%load_of(bodies%thermal, none, none)
      allocate (data%heat%condensed(bodies%thermal%map%tail), source=0.0_dp)
      workspace%edge = state%edge
      call temperature_jumps(bodies, self%heat, data, state%omega, workspace, jump)
      self%tail = workspace%tail
   end subroutine factor

   !> Temperatures under nodal heats.
   function solve(self, bodies, nodal) result(temperature)
      class(shifted_conduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: nodal(:, :)                      !! (nodes, n) [power]
      real(dp) :: temperature(size(nodal, 1), size(nodal, 2))  !! [temperature]
      real(dp) :: on_tail(bodies%thermal%map%tail, size(nodal, 2))

      call self%heat%condense_forces(bodies%thermal, nodal, on_tail, temperature)
      call self%tail%solve_columns(on_tail)
      temperature = temperature + self%heat%extended(bodies%thermal, on_tail)
   end function solve

   !> (A + sigma C)^-1 F.
   function responses(self, bodies, motion) result(temperature)
      class(shifted_conduction_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), allocatable :: temperature(:, :)               !! (nodes, changes)
      real(dp), allocatable :: nodal(:, :), on_tail(:, :)

      call motion%heat_loads(bodies, on_tail, nodal)
      call self%tail%solve_columns(on_tail)
      associate (a => size(motion%active), nodes => size(nodal, 1))
         allocate (temperature(nodes, a + size(nodal, 2)))
         temperature(:, :a) = self%heat%extended(bodies%thermal, on_tail)
         temperature(:, a + 1:) = self%solve(bodies, nodal)
      end associate
   end function responses

end module shifted_conduction
