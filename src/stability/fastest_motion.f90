!> The small motion of the bodies that grows fastest, or decays slowest, by Arnoldi's method on
!>
!>    (A - F N + sigma (C - F N'))^-1 (C - F N'),
!>
!> N' being what N has more at unit rate. Its eigenvalues are 1/(sigma - s). A product with T is
!>
!>    z + W y,   z = (A + sigma C)^-1 C T,   (I - N W) y = N z - N' T,   W = (A + sigma C)^-1 F,
!>
!> N taken at the rate sigma.
module fastest_motion
   use arnoldi, only: arnoldi_type
   use dense, only: lu_type, product_of
   use errors, only: error_type, set_error, status_no_convergence
   use increments, only: simulation_type
   use kinds, only: dp
   use model, only: model_type
   use records, only: increment_record_type
   use small_motions, only: shifted_conduction_type, small_motion_type
   use text, only: counted, to_text
   implicit none
   private
   public :: find_fastest, neutral

   real(dp), parameter :: above = 1.5_dp       !! the fastest projected rate: sigma
   integer, parameter :: most_products = 80
   real(dp), parameter :: neutral = 1.0e-8_dp  !! part of the slowest conduction that is no growth
   real(dp), parameter :: sharp = 1.0e-8_dp    !! residual of an eigenvalue, relative
   real(dp), parameter :: nothing = 1.0e-6_dp  !! of the largest one, that is none
   real(dp), parameter :: alike = 0.05_dp      !! relative difference of both fastest rates
   real(dp), parameter :: nearly_real = 1.0e-6_dp !! imaginary part of a rate that is none, relative
   real(dp), parameter :: full_turn = 8*atan(1.0_dp)

   !> The operator at its sigma.
   type :: resolvent_type
      type(shifted_conduction_type) :: conduction    !! A + sigma C
      real(dp), allocatable :: response(:, :)        !! (nodes, changes) W
      type(lu_type) :: coupling                      !! I - N W
      real(dp) :: sigma = 0.0_dp                     !! [1/time]
   contains
      procedure :: make
      procedure :: product
   end type resolvent_type

contains

   !> Finds it, and sees whether as many motions grow as among the projected ones.
   !> Errors: as shifted_conduction_type's factor.
   subroutine find_fastest(model, simulation, motion, projected, slowest, record, error)
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(small_motion_type), intent(in) :: motion
      complex(dp), intent(in) :: projected(:)                !! rates of the projected bodies
      real(dp), intent(in) :: slowest                        !! conduction of a body [1/time]
      type(increment_record_type), intent(inout) :: record   !! receives it
      type(error_type), allocatable, intent(out) :: error
      type(resolvent_type) :: resolvent
      type(arnoldi_type) :: modes
      complex(dp), allocatable :: rates(:)
      logical, allocatable :: is_sharp(:)
      integer :: fastest

      resolvent%sigma = slowest
      if (size(projected) > 0) resolvent%sigma = above*abs(projected(maxloc(real(projected), &
         dim=1)))
      call resolvent%make(model, simulation, motion, error)
      if (allocated(error)) return
      call modes%begin(size(simulation%state%temperature), 0.0_dp, most_products)
      rates = [complex(dp) ::]
      is_sharp = [logical ::]
      do while (modes%wants_product)
         call modes%take(resolvent%product(simulation, motion, modes%vector))
         if (.not. modes%is_checked) cycle
         rates = rates_of(modes%value, resolvent%sigma)
         is_sharp = modes%residual <= sharp*abs(modes%value)
         if (.not. any(is_sharp)) cycle
         if (all(is_sharp .or. real(rates) <= min(0.0_dp, maxval(real(rates), mask=is_sharp)))) &
            exit
      end do
      fastest = maxloc(real(rates), mask=is_sharp, dim=1)
      if (fastest == 0) then
         record%stability%doubt = 'Arnoldi''s method finds no motion'
         return
      end if
      call take_motion(modes%eigenvector(fastest), rates(fastest), simulation, motion, record)
      if (abs(rates(fastest)) <= neutral*slowest) record%stability%growth_rate = 0.0_dp
      associate (found => record%stability, growing => count(is_sharp .and. &
         real(rates) > neutral*slowest))
         if (growing /= found%unstable_modes) then
            found%doubt = 'the projected bodies have '//counted(found%unstable_modes, &
               'growing motion')//', Arnoldi''s method finds '//to_text(growing)
         else if (growing > 0) then
            if (minval(abs(projected - rates(fastest))) > alike*abs(rates(fastest))) &
               found%doubt = 'the rate of the projected bodies is another one'
         end if
      end associate
   end subroutine find_fastest

   !> Rates of eigenvalues; those that are none decay at once.
   pure function rates_of(values, sigma) result(rates)
      complex(dp), intent(in) :: values(:)
      real(dp), intent(in) :: sigma
      complex(dp) :: rates(size(values))
      integer :: i

      rates = -huge(sigma)
      do i = 1, size(values)
         if (abs(values(i)) > nothing*maxval(abs(values))) rates(i) = sigma - 1.0_dp/values(i)
      end do
   end function rates_of

   !> The motion, with a largest temperature of 1.
   subroutine take_motion(vector, rate, simulation, motion, record)
      real(dp), intent(in) :: vector(:, :)                   ! (nodes, 2) real and imaginary part
      complex(dp), intent(in) :: rate
      type(simulation_type), intent(in) :: simulation
      type(small_motion_type), intent(in) :: motion
      type(increment_record_type), intent(inout) :: record
      complex(dp) :: largest

      associate (found => record%stability)
         found%is_known = .true.
         found%growth_rate = real(rate)
         if (abs(aimag(rate)) > nearly_real*abs(rate)) found%period = full_turn/abs(aimag(rate))
      end associate
      associate (k => maxloc(hypot(vector(:, 1), vector(:, 2)), dim=1))
         largest = cmplx(vector(k, 1), vector(k, 2), dp)
      end associate
      associate (temperature => real(cmplx(vector(:, 1), vector(:, 2), dp)/largest))
         record%fields%mode_temperature = temperature
         record%fields%mode_displacement = reshape(motion%displacement(simulation%bodies, &
            simulation%state, temperature), [2, size(temperature)])
      end associate
   end subroutine take_motion

   !> Makes the operator.
   !> Errors: as shifted_conduction_type's factor.
   subroutine make(self, model, simulation, motion, error)
      class(resolvent_type), intent(inout) :: self           !! with its sigma
      type(model_type), intent(in) :: model
      type(simulation_type), intent(in) :: simulation
      type(small_motion_type), intent(in) :: motion
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: matrix(:, :)
      logical :: singular
      integer :: i

      associate (bodies => simulation%bodies, state => simulation%state)
         call self%conduction%factor(model, bodies, state, simulation%heats(simulation%in_use), &
            self%sigma, error)
         if (allocated(error)) return
         self%response = self%conduction%responses(bodies, motion)
         matrix = -motion%answers(bodies, state, self%response, self%sigma)
      end associate
      do i = 1, size(matrix, 1)
         matrix(i, i) = matrix(i, i) + 1.0_dp
      end do
      call self%coupling%factor(matrix, singular)
      if (singular) call set_error(error, status_no_convergence, &
         'the coupling has no inverse at the rate '//to_text(self%sigma))
   end subroutine make

   !> A product.
   function product(self, simulation, motion, vector) result(temperature)
      class(resolvent_type), intent(in) :: self
      type(simulation_type), intent(in) :: simulation
      type(small_motion_type), intent(in) :: motion
      real(dp), intent(in) :: vector(:)                      !! (nodes)
      real(dp) :: temperature(size(vector))                  !! (nodes)
      real(dp), allocatable :: changes(:, :), columns(:, :)

      associate (bodies => simulation%bodies, state => simulation%state)
         columns = reshape(bodies%capacity%multiply(vector), [size(vector), 1])
         columns = self%conduction%solve(bodies, columns)
         changes = motion%answers(bodies, state, columns, self%sigma)
         if (motion%takes_rates) changes = changes - by_rate(simulation, motion, vector)
         call self%coupling%solve(changes)
         columns = columns + product_of(self%response, changes)
      end associate
      temperature = columns(:, 1)
   end function product

   !> N' T.
   function by_rate(simulation, motion, vector) result(changes)
      type(simulation_type), intent(in) :: simulation
      type(small_motion_type), intent(in) :: motion
      real(dp), intent(in) :: vector(:)
      real(dp), allocatable :: changes(:, :), columns(:, :)

      columns = reshape(vector, [size(vector), 1])
      changes = motion%answers(simulation%bodies, simulation%state, columns, 1.0_dp) - &
         motion%answers(simulation%bodies, simulation%state, columns, 0.0_dp)
   end function by_rate

end module fastest_motion
