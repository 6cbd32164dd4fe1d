!> Responses of the bodies to unit changes at the contact points that grow at a rate, and the
!> answers of the contact to them.
module motion_responses
   use dense, only: eigenvalues, product_of, transposed_product
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   use reduced_bodies, only: reduced_bodies_type
   use shifted_conduction, only: shifted_conduction_type
   use simulation, only: simulation_type
   use linear_perturbations, only: linear_perturbation_type
   implicit none
   private
   public :: motion_response_type

   !> At one rate, n unit changes.
   type :: motion_response_type
      real(dp) :: sigma = 0.0_dp                     !! the rate [1/time]
      type(shifted_conduction_type) :: conduction    !! A + sigma C
      real(dp), allocatable :: temperature(:, :)     !! (nodes, n) W = (A + sigma C)^-1 F
      real(dp), allocatable :: exchange(:, :)        !! (n, n) H = F^T W
      real(dp), allocatable :: answer(:, :)          !! (n, n) N W at constant temperatures
      real(dp), allocatable :: by_rate(:, :)         !! (n, n) and what it has more at unit rate
   contains
      procedure :: make
      procedure :: gain
      procedure :: gain_bound
      procedure :: stored
   end type motion_response_type

contains

   !> Makes the responses.
   !> Errors: as shifted_conduction_type's factor.
   subroutine make(self, model, simulation, motion, sigma, error)
      class(motion_response_type), intent(inout) :: self     !! fresh, or of another rate
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(linear_perturbation_type), intent(in) :: motion
      real(dp), intent(in) :: sigma                          !! > 0 [1/time]
      type(error_type), allocatable, intent(out) :: error

      self%sigma = sigma
      associate (bodies => simulation%bodies, state => simulation%state)
         call self%conduction%factor(model, bodies, state, &
            simulation%heat_reductions(simulation%in_use), &
            sigma, error)
         if (allocated(error)) return
         self%temperature = self%conduction%responses(bodies, motion)
         self%exchange = motion%heats(bodies, self%temperature)
      end associate
      self%answer = motion%answers(self%temperature, 0.0_dp)
      self%by_rate = 0.0_dp*self%answer
      if (motion%takes_rates) self%by_rate = motion%answers(self%temperature, 1.0_dp) - self%answer
   end subroutine make

   !> U'(sigma).
   pure function gain(self)
      class(motion_response_type), intent(in) :: self
      real(dp) :: gain(size(self%answer, 1), size(self%answer, 2))   !! (n, n)

      gain = self%answer + self%sigma*self%by_rate
   end function gain

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

      read = transposed_product(motion%reads, self%conduction%solve(bodies, motion%reads))
      if (motion%takes_rates) read = 2*(read + self%sigma**2*transposed_product( &
         motion%reads_rate, self%conduction%solve(bodies, motion%reads_rate)))
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
