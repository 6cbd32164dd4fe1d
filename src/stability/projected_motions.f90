!> Small motions of the bodies projected on their responses to unit changes at several rates: how
!> many of them grow.
!>
!> With W_i = (A + sigma_i C)^-1 F the projection of C dT/dt = -A T + F N T on T = sum of W_i z_i is
!>
!>    E dz/dt = -A' z + G P z,   G_i = H_i,   P_j = N W_j,   H_i = F^T W_i,
!>
!> with E_ij = W_i^T C W_j = (H_i - H_j)/(sigma_j - sigma_i) and A'_ij = H_j - sigma_i E_ij, so that
!> nothing but W_i^T C W_i asks for fields. Its heat exchange agrees with that of the bodies at each
!> sigma_i, and so does its derivative: it is a Hermite interpolation of H, whose poles are decay
!> rates. Responses at low rates that those at higher ones foretell are left out: a slow body that
!> does not matter to the contact would bring rates so far from the others that rounding hides
!> these. Its growing motions are the zeros of det(I - U'(s)) in the right half-plane, which the
!> change of the argument along the imaginary axis counts; they are found as eigenvalues.
!>
!> K. Gallivan, E. Grimme, P. Van Dooren, Numer. Algorithms 12 (1996) 33; A. C. Antoulas,
!> Approximation of Large-Scale Dynamical Systems, SIAM 2005.
module projected_motions
   use dense, only: eigenvalues, energy_basis, lu_type, product_of, transposed_product
   use kinds, only: dp
   implicit none
   private
   public :: projected_motions_type

   !> Part of the energy A'/sigma + E of a response, beside others, that is rounding.
   real(dp), parameter :: rounding = 1.0e-8_dp
   real(dp), parameter :: beyond = 3.0_dp   !! times the largest sigma: no rates farther from it
   !> Largest difference of both U', in I - U', where the projection answers like the bodies.
   real(dp), parameter :: agreed = 1.0e-2_dp

   !> The projection, rate by rate.
   type :: projected_motions_type
      private
      real(dp), allocatable :: sigma(:)           !! (p) rates, all different [1/time]
      real(dp), allocatable :: exchange(:, :, :)  !! (n, n, p) H
      real(dp), allocatable :: stored(:, :, :)    !! (n, n, p) W_i^T C W_i
      real(dp), allocatable :: answer(:, :, :)    !! (n, n, p) N W_i at constant temperatures
      real(dp), allocatable :: by_rate(:, :, :)   !! (n, n, p) and what it has more at unit rate
      logical, allocatable :: is_in(:)            !! (p) whether the bodies are projected on it
   contains
      procedure :: add
      procedure :: choose
      procedure :: rates
   end type projected_motions_type

   !> The projected bodies, on r motions.
   type :: projected_bodies_type
      real(dp), allocatable :: conduction(:, :), capacity(:, :)   ! (r, r) A', E
      real(dp), allocatable :: heats(:, :)                        ! (r, n) G
      real(dp), allocatable :: answers(:, :), by_rate(:, :)       ! (n, r) P, P'
   end type projected_bodies_type

contains

   !> Adds the responses at another rate.
   pure subroutine add(self, sigma, exchange, stored, answer, by_rate)
      class(projected_motions_type), intent(inout) :: self
      real(dp), intent(in) :: sigma                !! [1/time]
      real(dp), intent(in) :: exchange(:, :), stored(:, :), answer(:, :), by_rate(:, :)  !! (n, n)

      if (.not. allocated(self%sigma)) then
         allocate (self%sigma(0), self%is_in(0))
         associate (n => size(exchange, 1))
            allocate (self%exchange(n, n, 0), self%stored(n, n, 0), self%answer(n, n, 0), &
               self%by_rate(n, n, 0))
         end associate
      end if
      self%sigma = [self%sigma, sigma]
      self%is_in = [self%is_in, .true.]
      self%exchange = with(self%exchange, 0.5_dp*(exchange + transpose(exchange)))
      self%stored = with(self%stored, 0.5_dp*(stored + transpose(stored)))
      self%answer = with(self%answer, answer)
      self%by_rate = with(self%by_rate, by_rate)
   contains
      pure function with(blocks, block) result(more)
         real(dp), intent(in) :: blocks(:, :, :), block(:, :)
         real(dp) :: more(size(block, 1), size(block, 2), size(blocks, 3) + 1)

         more(:, :, :size(blocks, 3)) = blocks
         more(:, :, size(more, 3)) = block
      end function with
   end subroutine add

   !> Projects on the responses at the two highest rates, and on each at a lower one that those at
   !> higher ones do not foretell.
   subroutine choose(self)
      class(projected_motions_type), intent(inout) :: self    !! rates in ascending order
      type(projected_bodies_type) :: bodies
      logical :: found
      integer :: i

      self%is_in = .false.
      do i = size(self%sigma), 1, -1
         self%is_in(i) = i > size(self%sigma) - 2
         if (self%is_in(i)) cycle
         call project(self, bodies, found)
         self%is_in(i) = .not. found
         if (found) self%is_in(i) = misfit(self, bodies, i) > agreed
      end do
   end subroutine choose

   !> Rates of all projected motions, complex ones in pairs.
   subroutine rates(self, values, found)
      class(projected_motions_type), intent(in) :: self
      complex(dp), allocatable, intent(out) :: values(:)    !! [1/time]
      !> not where matrices overflow or bodies answer otherwise at a rate that was added
      logical, intent(out) :: found
      type(projected_bodies_type) :: bodies
      real(dp), allocatable :: capacity(:, :), real_part(:), imaginary_part(:)
      type(lu_type) :: lu
      real(dp) :: shift
      integer :: i
      logical :: singular

      allocate (values(0))
      call project(self, bodies, found)
      if (.not. found) return
      ! 1/(shift - s) are the eigenvalues of (A' - G P + shift (E - G P'))^-1 (E - G P').
      shift = maxval(self%sigma, mask=self%is_in)
      capacity = bodies%capacity - product_of(bodies%heats, bodies%by_rate)
      call lu%factor(bodies%conduction - product_of(bodies%heats, bodies%answers) + &
         shift*capacity, singular)
      found = .not. singular
      if (.not. found) return
      call lu%solve(capacity)
      call eigenvalues(capacity, real_part, imaginary_part, found)
      if (.not. found) return
      values = cmplx(real_part, imaginary_part, dp)
      values = shift - 1.0_dp/pack(values, abs(values) > 1.0_dp/(beyond*shift))
      found = all([(misfit(self, bodies, i), i=1, size(self%sigma))] <= agreed)
   end subroutine rates

   !> How much the answer of the projected bodies at a rate differs from that of the bodies: the
   !> largest modulus of the eigenvalues of (I - U')^-1 (U' - P (A' + sigma E)^-1 G).
   real(dp) function misfit(self, bodies, i)
      type(projected_motions_type), intent(in) :: self
      type(projected_bodies_type), intent(in) :: bodies
      integer, intent(in) :: i                              ! which of the rates
      real(dp), dimension(size(bodies%heats, 2), size(bodies%heats, 2)) :: difference, gain
      real(dp), allocatable :: motions(:, :), real_part(:), imaginary_part(:)
      type(lu_type) :: lu
      integer :: k
      logical :: found, singular

      misfit = huge(misfit)
      motions = bodies%heats
      call lu%factor(bodies%conduction + self%sigma(i)*bodies%capacity, singular)
      if (singular) return
      call lu%solve(motions)
      gain = self%answer(:, :, i) + self%sigma(i)*self%by_rate(:, :, i)
      difference = gain - product_of(bodies%answers + self%sigma(i)*bodies%by_rate, motions)
      do k = 1, size(gain, 1)
         gain(k, k) = gain(k, k) - 1.0_dp
      end do
      call lu%factor(gain, singular)
      if (singular) return
      call lu%solve(difference)
      call eigenvalues(difference, real_part, imaginary_part, found)
      if (found) misfit = maxval(hypot(real_part, imaginary_part))
   end function misfit

   !> The bodies projected on motions that are orthonormal in the energy A'/sigma + E at the
   !> smallest rate.
   subroutine project(self, bodies, found)
      type(projected_motions_type), intent(in) :: self
      type(projected_bodies_type), intent(out) :: bodies
      logical, intent(out) :: found
      real(dp), allocatable :: block(:, :), vectors(:, :)
      integer, allocatable :: which(:)
      integer :: i, j, n, r

      n = size(self%exchange, 1)
      which = pack([(i, i=1, size(self%sigma))], self%is_in)
      r = n*size(which)
      allocate (bodies%conduction(r, r), bodies%capacity(r, r), bodies%heats(r, n))
      do i = 1, size(which)
         bodies%heats(n*(i - 1) + 1:n*i, :) = self%exchange(:, :, which(i))
         do j = 1, size(which)
            associate (h => self%exchange(:, :, which([i, j])), &
               sigma => self%sigma(which([i, j])), rows => n*(i - 1), columns => n*(j - 1))
               block = self%stored(:, :, which(i))   ! W_i^T C W_j
               if (i /= j) block = (h(:, :, 1) - h(:, :, 2))/(sigma(2) - sigma(1))
               bodies%capacity(rows + 1:rows + n, columns + 1:columns + n) = block
               bodies%conduction(rows + 1:rows + n, columns + 1:columns + n) = h(:, :, 2) - &
                  sigma(1)*block
            end associate
         end do
      end do
      call energy_basis(bodies%conduction/minval(self%sigma, mask=self%is_in) + bodies%capacity, &
         rounding, vectors, found)
      if (.not. found) return
      bodies%conduction = transposed_product(vectors, product_of(bodies%conduction, vectors))
      bodies%capacity = transposed_product(vectors, product_of(bodies%capacity, vectors))
      bodies%heats = transposed_product(vectors, bodies%heats)
      bodies%answers = product_of(reshape(self%answer(:, :, which), [n, r]), vectors)
      bodies%by_rate = product_of(reshape(self%by_rate(:, :, which), [n, r]), vectors)
   end subroutine project

end module projected_motions
