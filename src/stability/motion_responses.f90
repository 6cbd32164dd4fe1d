!> Responses of the bodies to unit changes at the contact points that grow at a rate, and the
!> answers of the contact to them.
module motion_responses
   use dense, only: product_of
   use errors, only: error_type
   use kinds, only: dp
   use model, only: model_type
   use simulation, only: simulation_type
   use small_motions, only: shifted_conduction_type, small_motion_type
   implicit none
   private
   public :: motion_response_type

   !> At one rate, n unit changes.
   type :: motion_response_type
      real(dp) :: sigma = 0.0_dp                     !! the rate [1/time]
      type(shifted_conduction_type) :: conduction    !! A + sigma C
      real(dp), allocatable :: temperature(:, :)     !! (nodes, n) W = (A + sigma C)^-1 F
      real(dp), allocatable :: answer(:, :)          !! (n, n) N W at constant temperatures
      real(dp), allocatable :: by_rate(:, :)         !! (n, n) and what it has more at unit rate
   contains
      procedure :: make
      procedure :: gain
      procedure :: stored
   end type motion_response_type

contains

   !> Makes the responses.
   !> Errors: as shifted_conduction_type's factor.
   subroutine make(self, model, simulation, motion, sigma, error)
      class(motion_response_type), intent(inout) :: self     !! fresh, or of another rate
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(small_motion_type), intent(in) :: motion
      real(dp), intent(in) :: sigma                          !! > 0 [1/time]
      type(error_type), allocatable, intent(out) :: error

      self%sigma = sigma
      associate (bodies => simulation%bodies, state => simulation%state)
         call self%conduction%factor(model, bodies, state, simulation%heats(simulation%in_use), &
            sigma, error)
         if (allocated(error)) return
         self%temperature = self%conduction%responses(bodies, motion)
         self%answer = motion%answers(bodies, state, self%temperature, 0.0_dp)
         self%by_rate = 0.0_dp*self%answer
         if (motion%takes_rates) self%by_rate = motion%answers(bodies, state, self%temperature, &
            1.0_dp) - self%answer
      end associate
   end subroutine make

   !> U'(sigma).
   pure function gain(self)
      class(motion_response_type), intent(in) :: self
      real(dp) :: gain(size(self%answer, 1), size(self%answer, 2))   !! (n, n)

      gain = self%answer + self%sigma*self%by_rate
   end function gain

   !> W^T C W.
   function stored(self, simulation)
      class(motion_response_type), intent(in) :: self
      type(simulation_type), intent(in) :: simulation
      real(dp) :: stored(size(self%answer, 1), size(self%answer, 2))   !! (n, n)
      real(dp), allocatable :: content(:, :)

      allocate (content, mold=self%temperature)
      call simulation%bodies%capacity%multiply_columns(self%temperature, content)
      stored = product_of(transpose(self%temperature), content)
   end function stored

end module motion_responses
