!> Small motions that grow fastest, or decay slowest, by Arnoldi's method on
!>
!>    (A - F N + sigma (C - F N'))^-1 (C - F N'),
!>
!> N' being what N has more at unit rate. Its eigenvalues are 1/(sigma - s). A product with T is
!>
!>    z + W y,   z = (A + sigma C)^-1 C T,   (I - N W) y = N z - N' T,   W = (A + sigma C)^-1 F,
!>
!> N taken at the rate sigma.
module leading_modes
   use arnoldi, only: arnoldi_type
   use dense, only: lu_type, product_of
   use kinds, only: dp
   use linear_perturbations, only: linear_perturbation_type
   use motion_responses, only: motion_response_type
   use simulation, only: simulation_type
   implicit none
   private
   public :: leading_modes_type

   integer, parameter :: most_products = 80
   integer, parameter :: most_of_many = 250    !! where many bodies have nearly the same motions
   real(dp), parameter :: sharp = 1.0e-8_dp    !! residual of an eigenvalue, relative
   real(dp), parameter :: nothing = 1.0e-6_dp  !! of the largest one, that is none

   !> Motions in the space of the products.
   type :: leading_modes_type
      type(arnoldi_type) :: space
      complex(dp), allocatable :: rate(:)      !! (k) of all of them [1/time]
      logical, allocatable :: is_sharp(:)      !! (k)
      integer, allocatable :: leading(:)       !! the fastest ones, the fastest first
   contains
      procedure :: find
   end type leading_modes_type

contains

   !> Finds them near the rate of a response, until those that are faster are sharp too.
   subroutine find(self, simulation, motion, response, neutral, growing, wanted)
      class(leading_modes_type), intent(out) :: self
      type(simulation_type), intent(in) :: simulation        !! the run at its end
      type(linear_perturbation_type), intent(in) :: motion
      type(motion_response_type), intent(in) :: response     !! at a rate above them
      real(dp), intent(in) :: neutral                        !! a rate that is no growth [1/time]
      integer, intent(in) :: growing                         !! motions that are known to grow
      integer, intent(in) :: wanted                          !! leading motions
      type(lu_type) :: coupling
      logical :: singular
      integer :: i

      singular = .false.
      if (.not. simulation%bodies%thermal%division%is_tail()) then
         associate (n => size(response%answer, 1))
            call coupling%factor(reshape([1.0_dp, (spread(0.0_dp, 1, n), 1.0_dp, i=2, n)], &
               [n, n]) - (response%answer + response%sigma*response%by_rate), singular)
         end associate
      end if
      self%rate = [complex(dp) ::]
      self%is_sharp = [logical ::]
      self%leading = [integer ::]
      associate (modes => self%space)
         call modes%begin(size(simulation%state%temperature), 0.0_dp, merge(most_of_many, &
            most_products, simulation%bodies%thermal%division%is_tail()))
         do while (modes%wants_product .and. .not. singular)
            call modes%take(inverse_product(simulation, motion, response, coupling, modes%vector))
            if (.not. modes%is_checked) cycle
            self%rate = rates_of(modes%value, response%sigma)
            self%is_sharp = modes%residual <= sharp*abs(modes%value)
            self%leading = fastest_of(self%rate, self%is_sharp, wanted)
            if (size(self%leading) == 0) cycle
            associate (last => self%rate(self%leading(size(self%leading))))
               if (count(self%is_sharp .and. real(self%rate) > neutral) >= growing .and. &
                  size(self%leading) == wanted .and. all(self%is_sharp .or. &
                  real(self%rate) <= min(0.0_dp, real(last)))) exit
            end associate
         end do
      end associate
   end subroutine find

   !> The fastest ones of sharp rates, the fastest first; of two that swing together one.
   pure function fastest_of(rates, is_sharp, wanted) result(leading)
      complex(dp), intent(in) :: rates(:)
      logical, intent(in) :: is_sharp(:)
      integer, intent(in) :: wanted            ! most of them
      integer, allocatable :: leading(:)       ! indexes into rates
      logical :: is_left(size(rates))
      integer :: i

      is_left = is_sharp .and. aimag(rates) >= 0.0_dp .and. real(rates) > -huge(1.0_dp)
      leading = [integer ::]
      do i = 1, min(wanted, count(is_left))
         leading = [leading, maxloc(real(rates), mask=is_left, dim=1)]
         is_left(leading(i)) = .false.
      end do
   end function fastest_of

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
         changes = motion%answers(bodies, columns, response%sigma)
         if (motion%takes_rates) changes = changes - motion%answers_to_rates(bodies, &
            reshape(vector, [size(vector), 1]))
         if (bodies%thermal%division%is_tail()) then
            columns = columns + response%response_to(bodies, motion, response%settled(bodies, &
               motion, changes(:, 1)))
         else
            call coupling%solve(changes)
            columns = columns + product_of(response%temperature, changes)
         end if
      end associate
      temperature = columns(:, 1)
   end function inverse_product

end module leading_modes
