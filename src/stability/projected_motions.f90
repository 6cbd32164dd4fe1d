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
!> rates. Its growing motions are the zeros of det(I - U'(s)) in the right half-plane, which the
!> change of the argument along the imaginary axis counts; they are found as eigenvalues.
!>
!> K. Gallivan, E. Grimme, P. Van Dooren, Numer. Algorithms 12 (1996) 33; A. C. Antoulas,
!> Approximation of Large-Scale Dynamical Systems, SIAM 2005.
module projected_motions
   use dense, only: eigenvalues, energy_basis, lu_type, product_of
   use kinds, only: dp
   implicit none
   private
   public :: projected_motions_type

   !> Part of the energy A'/sigma + E of a response, beside others, that is rounding.
   real(dp), parameter :: rounding = 1.0e-8_dp
   real(dp), parameter :: beyond = 3.0_dp   !! times the largest sigma: no rates farther from it

   !> The projection, rate by rate.
   type :: projected_motions_type
      private
      real(dp), allocatable :: sigma(:)           !! (p) rates, all different [1/time]
      real(dp), allocatable :: exchange(:, :, :)  !! (n, n, p) H
      real(dp), allocatable :: stored(:, :, :)    !! (n, n, p) W_i^T C W_i
      real(dp), allocatable :: answer(:, :, :)    !! (n, n, p) N W_i at constant temperatures
      real(dp), allocatable :: by_rate(:, :, :)   !! (n, n, p) and what it has more at unit rate
   contains
      procedure :: add
      procedure :: rates
   end type projected_motions_type

contains

   !> Adds the responses at another rate.
   pure subroutine add(self, sigma, exchange, stored, answer, by_rate)
      class(projected_motions_type), intent(inout) :: self
      real(dp), intent(in) :: sigma                !! [1/time]
      real(dp), intent(in) :: exchange(:, :), stored(:, :), answer(:, :), by_rate(:, :)  !! (n, n)

      if (.not. allocated(self%sigma)) then
         allocate (self%sigma(0))
         associate (n => size(exchange, 1))
            allocate (self%exchange(n, n, 0), self%stored(n, n, 0), self%answer(n, n, 0), &
               self%by_rate(n, n, 0))
         end associate
      end if
      self%sigma = [self%sigma, sigma]
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

   !> Rates of all projected motions, complex ones in pairs.
   subroutine rates(self, values, found)
      class(projected_motions_type), intent(in) :: self
      complex(dp), allocatable, intent(out) :: values(:)    !! [1/time]
      logical, intent(out) :: found                         !! not where matrices overflow
      real(dp), allocatable :: conduction(:, :), capacity(:, :), by_rate(:, :)
      real(dp), allocatable :: real_part(:), imaginary_part(:)
      type(lu_type) :: lu
      real(dp) :: shift
      logical :: singular

      allocate (values(0))
      call project(self, conduction, capacity, by_rate, found)
      if (.not. found) return
      ! 1/(shift - s) are the eigenvalues of (A' - G P + shift (E - G P'))^-1 (E - G P').
      shift = maxval(self%sigma)
      capacity = capacity - by_rate
      call lu%factor(conduction + shift*capacity, singular)
      found = .not. singular
      if (.not. found) return
      call lu%solve(capacity)
      call eigenvalues(capacity, real_part, imaginary_part, found)
      if (.not. found) return
      values = cmplx(real_part, imaginary_part, dp)
      values = shift - 1.0_dp/pack(values, abs(values) > 1.0_dp/(beyond*shift))
   end subroutine rates

   !> W_i^T C W_j.
   pure function stored_between(self, i, j) result(block)
      type(projected_motions_type), intent(in) :: self
      integer, intent(in) :: i, j
      real(dp) :: block(size(self%stored, 1), size(self%stored, 1))

      if (i == j) then
         block = self%stored(:, :, i)
      else
         block = (self%exchange(:, :, i) - self%exchange(:, :, j))/(self%sigma(j) - self%sigma(i))
      end if
   end function stored_between

   !> A' - G P, E and G P' on motions that are orthonormal in the energy A'/sigma + E at the
   !> smallest rate.
   subroutine project(self, conduction, capacity, by_rate, found)
      type(projected_motions_type), intent(in) :: self
      real(dp), allocatable, intent(out) :: conduction(:, :), capacity(:, :), by_rate(:, :)
      logical, intent(out) :: found
      real(dp), allocatable :: vectors(:, :), exchange(:, :)
      integer :: i, j, n, r

      n = size(self%exchange, 1)
      r = n*size(self%sigma)
      allocate (conduction(r, r), capacity(r, r), exchange(r, n))
      do i = 1, size(self%sigma)
         exchange(n*(i - 1) + 1:n*i, :) = self%exchange(:, :, i)
         do j = 1, size(self%sigma)
            associate (block => stored_between(self, i, j), rows => n*(i - 1), columns => n*(j - 1))
               capacity(rows + 1:rows + n, columns + 1:columns + n) = block
               conduction(rows + 1:rows + n, columns + 1:columns + n) = &
                  self%exchange(:, :, j) - self%sigma(i)*block
            end associate
         end do
      end do
      call energy_basis(conduction/minval(self%sigma) + capacity, rounding, vectors, found)
      if (.not. found) return
      exchange = product_of(transpose(vectors), exchange)
      conduction = product_of(transpose(vectors), product_of(conduction, vectors)) - &
         product_of(exchange, product_of(reshape(self%answer, [n, r]), vectors))
      capacity = product_of(transpose(vectors), product_of(capacity, vectors))
      by_rate = product_of(exchange, product_of(reshape(self%by_rate, [n, r]), vectors))
   end subroutine project

end module projected_motions
