!> The few dense solves of the interface problem, by LAPACK.
module dense
   use blas_lapack, only: dgetrf, dgetrs
   use kinds, only: dp
   implicit none
   private
   public :: lu_type

   !> Pivot, relative to its column, below which it is rounding: the Schur complements that are
   !> factored here carry some digits of rounding themselves.
   real(dp), parameter :: lost = 1.0e-11_dp

   !> LU factors of a small general matrix.
   type :: lu_type
      real(dp), allocatable :: factors(:, :)   !! (n, n) as dgetrf leaves them
      integer, allocatable :: pivots(:)        !! (n) row exchanges
   contains
      procedure :: factor
      procedure :: solve
   end type lu_type

contains

   !> Factors a matrix.
   subroutine factor(self, matrix, singular)
      class(lu_type), intent(inout) :: self   !! the factors
      real(dp), intent(in) :: matrix(:, :)    !! (n, n)
      logical, intent(out) :: singular        !! a pivot is zero or lost to rounding
      integer :: i, info, n

      n = size(matrix, 1)
      self%factors = matrix
      if (allocated(self%pivots)) deallocate (self%pivots)
      allocate (self%pivots(n))
      call dgetrf(n, n, self%factors, max(n, 1), self%pivots, info)
      singular = info /= 0
      do i = 1, n
         if (abs(self%factors(i, i)) <= lost*maxval(abs(matrix(:, i)))) then
            singular = .true.
         end if
      end do
   end subroutine factor

   !> Solves with the factors.
   pure subroutine solve(self, x)
      class(lu_type), intent(in) :: self    !! the factors
      real(dp), intent(inout) :: x(:, :)    !! (n, right-hand sides) in, solutions out
      integer :: info, n

      n = size(x, 1)
      call dgetrs('N', n, size(x, 2), self%factors, max(n, 1), self%pivots, x, max(n, 1), info)
   end subroutine solve

end module dense
