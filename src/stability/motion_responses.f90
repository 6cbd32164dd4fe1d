!> Responses of the bodies to unit changes at the contact points that grow at a rate, and the
!> answers of the contact to them: the conduction of bodies, films and contact at the conductances
!> of a state, A, and their heat capacity at the rate are factored together. On a sparse tail the
!> responses are not formed, but found of the changes that are asked for.
module motion_responses
   use arnoldi, only: arnoldi_type
   use contact_heat, only: temperature_jumps
   use controls, only: implicit_scheme
   use dense, only: eigenvalues, product_of, transposed_product
   use errors, only: error_type
   use gmres, only: gmres_type
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
      procedure :: response_to
      procedure :: settled
      procedure :: gain_bound
      procedure :: stored
      procedure :: release
   end type motion_response_type

   integer, parameter :: most_products = 300
   real(dp), parameter :: converged = 1.0e-12_dp     !! residual of changes, relative
   real(dp), parameter :: rough = 1.0e-3_dp          !! residual of a bound, beside 1

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
      if (allocated(error) .or. self%heat%schur%is_sparse()) return
      associate (bodies => simulation%bodies, a => size(motion%active))
         call motion%heat_loads(bodies, on_tail, nodal)
         call self%tail%solve_columns(on_tail)
         allocate (temperature(size(nodal, 1), a + size(nodal, 2)))
         temperature(:, :a) = self%heat%extended(bodies%thermal, on_tail)
         temperature(:, a + 1:) = self%solve(bodies, nodal)
         self%exchange = motion%heats(bodies, temperature)
         call move_alloc(temperature, self%temperature)
         self%answer = motion%answers(bodies, self%temperature, 0.0_dp)
         self%by_rate = 0.0_dp*self%answer
         if (motion%takes_rates) self%by_rate = motion%answers(bodies, self%temperature, &
            1.0_dp) - self%answer
      end associate
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

   !> Temperatures W y under changes of a sparse tail.
   function response_to(self, bodies, motion, changes) result(temperature)
      class(motion_response_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), intent(in) :: changes(:)                       !! (n) y
      real(dp) :: temperature(bodies%thermal%matrix%row_count, 1)   !! [temperature]

      temperature = self%solve(bodies, reshape(motion%nodal_heat(bodies, changes), &
         shape(temperature)))
   end function response_to

   !> Changes of a sparse tail with those that temperatures make: (I - N W)^-1 of the latter.
   function settled(self, bodies, motion, changes)
      class(motion_response_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), intent(in) :: changes(:)                       !! (n)
      real(dp) :: settled(size(changes)), answer(size(changes), 1)
      type(gmres_type) :: gmres

      call gmres%begin(changes, converged, max(min(size(changes), most_products), 1))
      do while (gmres%wants_product)
         answer = motion%answers(bodies, self%response_to(bodies, motion, gmres%vector), self%sigma)
         call gmres%take(gmres%vector - answer(:, 1))
      end do
      settled = gmres%solution()
   end function settled

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

      if (self%heat%schur%is_sparse()) then
         bound = sqrt(2*largest_product(self, bodies, motion))
         return
      end if
      read = transposed_product(motion%reads, self%solve(bodies, motion%reads))
      if (motion%takes_rates) read = 2*(read + self%sigma**2*transposed_product( &
         motion%reads_rate, self%solve(bodies, motion%reads_rate)))
      call eigenvalues(product_of(self%exchange, read), real_part, imaginary_part, found)
      bound = huge(bound)
      if (found) bound = sqrt(2*maxval(hypot(real_part, imaginary_part)))
   end function gain_bound

   !> Largest eigenvalue of (F^T R F) (N R N^T) on a sparse tail, and what is not known of it.
   real(dp) function largest_product(self, bodies, motion) result(largest)
      class(motion_response_type), intent(in) :: self
      type(reduced_bodies_type), intent(in) :: bodies
      type(linear_perturbation_type), intent(in) :: motion
      real(dp) :: exchanged(motion%changes, 1)
      real(dp), allocatable :: read(:)
      type(arnoldi_type) :: products

      largest = 0.0_dp
      if (motion%changes == 0) return
      call products%begin(motion%changes, 0.0_dp, enough=rough)
      do while (products%wants_product)
         read = read_alone()
         if (motion%takes_rates) read = 2*(read + read_by_rates())
         exchanged = motion%heats(bodies, self%response_to(bodies, motion, read))
         call products%take(exchanged(:, 1))
      end do
      largest = huge(largest)
      if (products%found) largest = abs(products%largest) + rough
   contains
      !> N R N^T y at constant temperatures.
      function read_alone() result(changes)
         real(dp) :: changes(motion%changes), sums(bodies%thermal%matrix%row_count, 1)

         sums(:, 1) = motion%sums_of_answers(bodies, products%vector, 0.0_dp)
         changes = reshape(motion%answers(bodies, self%solve(bodies, sums), 0.0_dp), &
            [motion%changes])
      end function read_alone

      !> The same with what rates add to N at the rate of the response.
      function read_by_rates() result(changes)
         real(dp) :: changes(motion%changes), sums(bodies%thermal%matrix%row_count, 1)

         sums(:, 1) = motion%sums_of_answers(bodies, products%vector, 1.0_dp) - &
            motion%sums_of_answers(bodies, products%vector, 0.0_dp)
         changes = self%sigma**2*reshape(motion%answers_to_rates(bodies, self%solve(bodies, &
            sums)), [motion%changes])
      end function read_by_rates
   end function largest_product

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
