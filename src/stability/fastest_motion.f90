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
   use dense, only: lu_type, product_of, transposed_product
   use kinds, only: dp
   use motion_responses, only: motion_response_type
   use records, only: increment_record_type
   use simulation, only: simulation_type
   use linear_perturbations, only: linear_perturbation_type
   use text, only: counted, to_text
   implicit none
   private
   public :: find_fastest

   integer, parameter :: most_products = 80
   real(dp), parameter :: sharp = 1.0e-8_dp    !! residual of an eigenvalue, relative
   real(dp), parameter :: nothing = 1.0e-6_dp  !! of the largest one, that is none
   real(dp), parameter :: alike = 0.05_dp      !! relative difference of both fastest rates
   real(dp), parameter :: nearly_real = 1.0e-6_dp !! imaginary part of a rate that is none, relative
   real(dp), parameter :: full_turn = 8*atan(1.0_dp)

contains

   !> Finds it, and sees whether as many motions grow as among the projected ones.
   subroutine find_fastest(simulation, motion, response, projected, neutral, record)
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(linear_perturbation_type), intent(in) :: motion
      type(motion_response_type), intent(in) :: response     !! at a rate above it
      complex(dp), intent(in) :: projected(:)                !! rates of the projected bodies
      real(dp), intent(in) :: neutral                        !! a rate that is no growth [1/time]
      type(increment_record_type), intent(inout) :: record   !! receives it
      type(arnoldi_type) :: modes
      type(lu_type) :: coupling
      complex(dp), allocatable :: rates(:)
      logical, allocatable :: is_sharp(:)
      logical :: singular
      integer :: fastest, growing

      call coupling%factor(unit_matrix(size(response%answer, 1)) - response%gain(), singular)
      call modes%begin(size(simulation%state%temperature), 0.0_dp, most_products)
      rates = [complex(dp) ::]
      is_sharp = [logical ::]
      do while (modes%wants_product .and. .not. singular)
         call modes%take(inverse_product(simulation, motion, response, coupling, modes%vector))
         if (.not. modes%is_checked) cycle
         rates = rates_of(modes%value, response%sigma)
         is_sharp = modes%residual <= sharp*abs(modes%value)
         if (.not. any(is_sharp)) cycle
         fastest = maxloc(real(rates), mask=is_sharp, dim=1)
         if (count(is_sharp .and. real(rates) > neutral) >= record%stability%unstable_modes .and. &
            all(is_sharp .or. real(rates) <= min(0.0_dp, real(rates(fastest))))) exit
      end do
      fastest = maxloc(real(rates), mask=is_sharp, dim=1)
      if (fastest == 0) then
         call record%stability%add_doubt('Arnoldi''s method finds no motion')
         return
      end if
      call take_motion(modes%eigenvector(fastest), rates(fastest), simulation, motion, record)
      growing = count(is_sharp .and. real(rates) > neutral)
      associate (found => record%stability)
         if (abs(rates(fastest)) <= neutral) found%growth_rate = 0.0_dp
         if (growing /= found%unstable_modes) then
            call found%add_doubt('the projected bodies have '//counted(found%unstable_modes, &
               'growing motion')//', Arnoldi''s method finds '//to_text(growing))
            ! Those that it finds are motions of the bodies themselves.
            found%unstable_modes = max(growing, found%unstable_modes)
         else if (growing > 0) then
            if (minval(abs(projected - rates(fastest))) > alike*abs(rates(fastest))) then
               call found%add_doubt('the rate of the projected bodies is another one')
            end if
         end if
      end associate
   end subroutine find_fastest

   pure function unit_matrix(n) result(matrix)
      integer, intent(in) :: n
      real(dp) :: matrix(n, n)
      integer :: i

      matrix = 0.0_dp
      do i = 1, n
         matrix(i, i) = 1.0_dp
      end do
   end function unit_matrix

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
      type(linear_perturbation_type), intent(in) :: motion
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

   !> A product with the inverse.
   function inverse_product(simulation, motion, response, coupling, vector) result(temperature)
      type(simulation_type), intent(in) :: simulation
      type(linear_perturbation_type), intent(in) :: motion
      type(motion_response_type), intent(in) :: response
      type(lu_type), intent(in) :: coupling                  ! I - N W
      real(dp), intent(in) :: vector(:)                      ! (nodes)
      real(dp) :: temperature(size(vector))                  ! (nodes)
      real(dp), allocatable :: changes(:, :), columns(:, :)

      associate (bodies => simulation%bodies)
         columns = reshape(bodies%capacity%multiply(vector), [size(vector), 1])
         columns = response%solve(bodies, columns)
         changes = motion%answers(columns, response%sigma)
         if (motion%takes_rates) changes = changes - transposed_product( &
            motion%reads_rate, reshape(vector, [size(vector), 1]))
         call coupling%solve(changes)
         columns = columns + product_of(response%temperature, changes)
      end associate
      temperature = columns(:, 1)
   end function inverse_product

end module fastest_motion
