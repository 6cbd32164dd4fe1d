!> Responses of the bodies to unit changes at the contact points that grow at a rate, and the
!> answers of the contact to them: the conduction of bodies, films and contact at the conductances
!> of a state, A, and their heat capacity at the rate are factored together.
module motion_responses
   use contact_heat, only: temperature_jumps
   use controls, only: implicit_scheme
   use dense, only: eigenvalues, product_of, transposed_product
   use errors, only: error_type
   use heat_equation, only: heat_equation_type
   use heat_reduction, only: heat_reduction_type
   use increment_data, only: increment_data_type, increment_workspace_type
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use simulation, only: simulation_type
   use linear_perturbations, only: linear_perturbation_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   use tail_factors, only: tail_factors_type
   implicit none
   private
   public :: motion_response_type

   !> At one rate, n unit changes.
   type :: motion_response_type
      real(dp) :: sigma = 0.0_dp                     !! the rate [1/time]
      type(heat_reduction_type), private :: heat     !! factors of A + sigma C
      type(tail_factors_type), private :: tail       !! and those of the contact points
      real(dp), allocatable :: temperature(:, :)     !! (nodes, n) W = (A + sigma C)^-1 F
      real(dp), allocatable :: exchange(:, :)        !! (n, n) H = F^T W
      real(dp), allocatable :: answer(:, :)          !! (n, n) N W at constant temperatures
      real(dp), allocatable :: by_rate(:, :)         !! (n, n) and what it has more at unit rate
   contains
      procedure :: make
      procedure :: solve
      procedure :: gain_bound
      procedure :: stored
      procedure :: release
   end type motion_response_type

contains

   !> Makes the responses.
   !> Errors: as heat_reduction's reduce.
   subroutine make(self, model, simulation, motion, sigma, error)
      class(motion_response_type), intent(inout) :: self     !! fresh, or of another rate
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), intent(in) :: sigma                          !! > 0 [1/time]
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: nodal(:, :), on_tail(:, :), temperature(:, :)

      self%sigma = sigma
      call factor(self, model, simulation, error)
      if (allocated(error)) return
      associate (bodies => simulation%bodies, a => size(motion%active))
         call motion%heat_loads(bodies, on_tail, nodal)
         call self%tail%solve_columns(on_tail)
         allocate (temperature(size(nodal, 1), a + size(nodal, 2)))
         temperature(:, :a) = self%heat%extended(bodies%thermal, on_tail)
         temperature(:, a + 1:) = self%solve(bodies, nodal)
         self%exchange = motion%heats(bodies, temperature)
      end associate
      call move_alloc(temperature, self%temperature)
      self%answer = motion%answers(self%temperature, 0.0_dp)
      self%by_rate = 0.0_dp*self%answer
      if (motion%takes_rates) self%by_rate = motion%answers(self%temperature, 1.0_dp) - self%answer
   end subroutine make

   !> Factors A + sigma C.
   subroutine factor(self, model, simulation, error)
      class(motion_response_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: film
      type(increment_data_type) :: data
      type(increment_workspace_type) :: workspace
      real(dp), allocatable :: jump(:), none(:)

      associate (bodies => simulation%bodies, state => simulation%state)
         film = bodies%capacity
         film%value = self%sigma*film%value
         if (allocated(state%sources%film%value)) film = linear_combination(1.0_dp, &
            state%sources%film, self%sigma, bodies%capacity)
         self%heat%forms_on_demand = .true.
         ! The order of the run serves here, too.
         call self%heat%share_order(simulation%heat_reductions(simulation%in_use), bodies)
         call self%heat%reduce(model, bodies, film, error)
         if (allocated(error)) return
         none = 0.0_dp*state%temperature
         jump = 0.0_dp*state%jump
         data%equation = heat_equation_type(implicit_scheme, state%sources, state%sources, &
            state%temperature, bodies%points%weight, state%omega, state%jump)
         data%held_jump = jump
         data%heat = self%heat%load_of(bodies%thermal, none, none)
         allocate (data%heat%condensed(bodies%thermal%map%tail), source=0.0_dp)
         workspace%edge = state%edge
         call temperature_jumps(bodies, self%heat, data, state%omega, workspace, jump)
         self%tail = workspace%tail
      end associate
   end subroutine factor

   !> Frees the factors, of which a library keeps some.
   subroutine release(self)
      class(motion_response_type), intent(inout) :: self

      call self%heat%release()
   end subroutine release

   !> Temperatures under nodal heats: (A + sigma C)^-1.
   function solve(self, bodies, nodal) result(temperature)
      class(motion_response_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      real(dp), intent(in) :: nodal(:, :)                      !! (nodes, n) [power]
      real(dp) :: temperature(size(nodal, 1), size(nodal, 2))  !! [temperature]
      real(dp) :: on_tail(bodies%thermal%map%tail, size(nodal, 2))

      call self%heat%condense_forces(bodies%thermal, nodal, on_tail, temperature)
      call self%tail%solve_columns(on_tail)
      temperature = temperature + self%heat%extended(bodies%thermal, on_tail)
   end function solve

   !> Bound of the moduli of the eigenvalues of U'(s) for all s of this modulus on the right of the
   !> imaginary axis, and, unless the contact takes rates, of all larger moduli. A decay rate l of
   !> the bodies has |s + l| >= (|s| + l)/sqrt(2) there, so that with R = (A + |s| C)^-1
   !>
   !>    |eigenvalue of N (A + s C)^-1 F|^2 <= 2 largest eigenvalue of (F^T R F) (N R N^T),
   !>
   !> which decreases with |s| as R does. N = N_0 + s N_1 has N R N^T <= 2 (N_0 R N_0^T +
   !> |s|^2 N_1 R N_1^T).
   real(dp) function gain_bound(self, bodies, motion) result(bound)
      class(motion_response_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), allocatable :: read(:, :), real_part(:), imaginary_part(:)
      logical :: found

      read = transposed_product(motion%reads, self%solve(bodies, motion%reads))
      if (motion%takes_rates) read = 2*(read + self%sigma**2*transposed_product( &
         motion%reads_rate, self%solve(bodies, motion%reads_rate)))
      call eigenvalues(product_of(self%exchange, read), real_part, imaginary_part, found)
      bound = huge(bound)
      if (found) bound = sqrt(2*maxval(hypot(real_part, imaginary_part)))
   end function gain_bound

   !> W^T C W.
   function stored(self, simulation)
      class(motion_response_type), intent(in) :: self
      type(simulation_type), intent(in) :: simulation
      real(dp) :: stored(size(self%answer, 1), size(self%answer, 2))   !! (n, n)
      real(dp), allocatable :: content(:, :)

      allocate (content, mold=self%temperature)
      call simulation%bodies%capacity%multiply_columns(self%temperature, content)
      stored = transposed_product(self%temperature, content)
   end function stored

end module motion_responses
