!> The few dense solves of the interface problem, by LAPACK.
module dense
   use blas_lapack, only: dgeev, dgelsy, dgetrf, dgetrs
   use kinds, only: dp
   implicit none
   private
   public :: lu_type, eigenvalues, least_squares

   !> Pivot, relative to its column, below which it is rounding: the Schur complements that are
   !> factored here carry some digits of rounding themselves.
   real(dp), parameter :: lost = 1.0e-11_dp

   !> LU factors of a small general matrix.
   type :: lu_type
      real(dp), allocatable :: factors(:, :)   !! (n, n) as dgetrf leaves them
      integer, allocatable :: pivots(:)        !! (n) row exchanges
      integer :: lost_pivot = 0                !! first pivot that is lost, 0 for none
   contains
      procedure :: factor
      procedure :: solve
      procedure :: null_vector
      procedure :: negative_determinant
   end type lu_type

contains

   !> Factors a matrix.
   pure subroutine factor(self, matrix, singular)
      class(lu_type), intent(inout) :: self   !! the factors
      real(dp), intent(in) :: matrix(:, :)    !! (n, n)
      logical, intent(out) :: singular        !! a pivot is zero or lost to rounding
      integer :: i, info, n

      n = size(matrix, 1)
      self%factors = matrix
      if (allocated(self%pivots)) deallocate (self%pivots)
      allocate (self%pivots(n))
      call dgetrf(n, n, self%factors, max(n, 1), self%pivots, info)
      self%lost_pivot = 0
      do i = n, 1, -1
         if (abs(self%factors(i, i)) <= lost*maxval(abs(matrix(:, i)))) self%lost_pivot = i
      end do
      singular = info /= 0 .or. self%lost_pivot > 0
   end subroutine factor

   !> Solves with the factors.
   pure subroutine solve(self, x)
      class(lu_type), intent(in) :: self    !! the factors
      real(dp), intent(inout) :: x(:, :)    !! (n, right-hand sides) in, solutions out
      integer :: info, n

      n = size(x, 1)
      call dgetrs('N', n, size(x, 2), self%factors, max(n, 1), self%pivots, x, max(n, 1), info)
   end subroutine solve

   !> A vector that a singular matrix maps to zero, from the factors up to the first lost pivot.
   pure function null_vector(self) result(z)
      class(lu_type), intent(in) :: self         !! the factors of a singular matrix
      real(dp) :: z(size(self%factors, 1))       !! (n) scaled by its component at the lost pivot
      integer :: i, last

      last = self%lost_pivot
      z = 0.0_dp
      z(last) = 1.0_dp
      do i = last - 1, 1, -1
         z(i) = -dot_product(self%factors(i, i + 1:last), z(i + 1:last))/self%factors(i, i)
      end do
   end function null_vector

   !> Whether the determinant of the matrix is negative.
   pure function negative_determinant(self) result(negative)
      class(lu_type), intent(in) :: self   !! the factors
      logical :: negative                  !! det < 0
      integer :: i

      negative = .false.
      do i = 1, size(self%pivots)
         negative = negative .neqv. (self%factors(i, i) < 0.0_dp)
         negative = negative .neqv. (self%pivots(i) /= i)
      end do
   end function negative_determinant

   !> Eigenvalues of a general matrix.
   subroutine eigenvalues(matrix, real_part, imaginary_part, found)
      real(dp), intent(in) :: matrix(:, :)                      !! (n, n), n > 0
      real(dp), allocatable, intent(out) :: real_part(:)        !! (n)
      real(dp), allocatable, intent(out) :: imaginary_part(:)   !! (n)
      logical, intent(out) :: found                             !! LAPACK found them
      real(dp), allocatable :: copy(:, :), work(:)
      real(dp) :: left(1, 1), right(1, 1), best(1)
      integer :: info, n

      n = size(matrix, 1)
      copy = matrix
      allocate (real_part(n), imaginary_part(n))
      call dgeev('N', 'N', n, copy, n, real_part, imaginary_part, left, 1, right, 1, best, -1, info)
      allocate (work(max(1, nint(best(1)))))
      call dgeev('N', 'N', n, copy, n, real_part, imaginary_part, left, 1, right, 1, work, &
         size(work), info)
      found = info == 0
   end subroutine eigenvalues

   !> The shortest x for which |matrix x - rhs| is least; columns that depend on others to rounding
   !> do not count.
   function least_squares(matrix, rhs) result(x)
      real(dp), intent(in) :: matrix(:, :)   !! (m, n), m and n > 0
      real(dp), intent(in) :: rhs(:)         !! (m)
      real(dp) :: x(size(matrix, 2))         !! (n)
      real(dp) :: copy(size(matrix, 1), size(matrix, 2)), work(4*size(matrix, 2) + 64)
      real(dp) :: solution(max(size(matrix, 1), size(matrix, 2)), 1)
      integer :: free(size(matrix, 2)), info, rank

      copy = matrix
      solution = 0.0_dp
      solution(:size(rhs), 1) = rhs
      free = 0
      call dgelsy(size(matrix, 1), size(matrix, 2), 1, copy, size(matrix, 1), solution, &
         size(solution), free, lost, rank, work, size(work), info)
      x = solution(:size(x), 1)
   end function least_squares

end module dense
