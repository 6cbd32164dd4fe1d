!> The few dense solves of the interface problem: LU factors, eigenvalues and least squares by
!> LAPACK.
module dense
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use blas_lapack, only: dgeev, dgelsy, dgemm, dgemv, dgesvd, dgetrf, dgetrs, dpstrf, &
      dtrtri
   use kinds, only: dp
   implicit none
   private
   public :: lu_type, null_space, column_space, eigenvalues, energy_basis, &
      least_squares, product_of, transposed_product

   !> Pivot, relative to its column, below which it is rounding.
   real(dp), parameter :: lost = 1.0e-14_dp
   real(dp), parameter :: rank_tolerance = 1.0e-9_dp !! of the largest singular value

   !> LU factors of a small general matrix.
   type :: lu_type
      real(dp), allocatable :: factors(:, :)   !! (n, n) as dgetrf leaves them
      integer, allocatable :: pivots(:)        !! (n) row exchanges
   contains
      procedure :: factor
      procedure :: solve
      procedure :: negative_determinant
   end type lu_type

contains

   !> Factors a matrix.
   pure subroutine factor(self, matrix, singular)
      class(lu_type), intent(inout) :: self   !! the factors
      real(dp), intent(in) :: matrix(:, :)    !! (n, n)
      logical, intent(out) :: singular !! a pivot is zero or lost, or the matrix overflowed
      integer :: i, info, n

      n = size(matrix, 1)
      self%factors = matrix
      if (allocated(self%pivots)) deallocate (self%pivots)
      allocate (self%pivots(n), source=[(i, i=1, n)])
      singular = .not. all(ieee_is_finite(matrix))
      if (singular) return
      call dgetrf(n, n, self%factors, max(n, 1), self%pivots, info)
      singular = info /= 0
      do i = 1, n
         singular = singular .or. abs(self%factors(i, i)) <= lost*maxval(abs(matrix(:, i)))
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

   !> Orthonormal basis of the vectors that all rows map to zero.
   pure function null_space(rows) result(basis)
      real(dp), intent(in) :: rows(:, :)        !! (m, n)
      real(dp), allocatable :: basis(:, :)      !! (n, n - rank)
      real(dp) :: copy(max(size(rows, 1), 1), size(rows, 2)), none(1, 1), best(1)
      real(dp) :: values(size(rows, 2)), right(size(rows, 2), size(rows, 2))
      real(dp), allocatable :: work(:)
      integer :: info, m, n

      copy = 0.0_dp
      copy(:size(rows, 1), :) = rows
      m = size(copy, 1)
      n = size(copy, 2)
      call dgesvd('N', 'A', m, n, copy, m, values, none, 1, right, n, best, -1, info)
      allocate (work(int(best(1))))
      call dgesvd('N', 'A', m, n, copy, m, values, none, 1, right, n, work, size(work), info)
      values(min(m, n) + 1:) = 0.0_dp
      associate (rank => count(values > rank_tolerance*values(1)))
         basis = transpose(right(rank + 1:, :))
      end associate
   end function null_space

   !> Orthonormal basis of what some columns span, by Gram and Schmidt, each twice.
   pure function column_space(columns) result(basis)
      real(dp), intent(in) :: columns(:, :)     !! (m, n)
      real(dp), allocatable :: basis(:, :)      !! (m, rank)
      real(dp) :: found(size(columns, 1), size(columns, 2)), x(size(columns, 1))
      integer :: j, pass, rank

      rank = 0
      do j = 1, size(columns, 2)
         x = columns(:, j)
         do pass = 1, 2
            x = x - matmul(found(:, :rank), matmul(x, found(:, :rank)))
         end do
         if (norm2(x) <= rank_tolerance*maxval(norm2(columns, dim=1))) cycle
         rank = rank + 1
         found(:, rank) = x/norm2(x)
      end do
      basis = found(:, :rank)
   end function column_space

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
   subroutine eigenvalues(matrix, real_part, imaginary_part, found, vectors)
      real(dp), intent(in) :: matrix(:, :)                      !! (n, n), n > 0
      real(dp), allocatable, intent(out) :: real_part(:)        !! (n)
      real(dp), allocatable, intent(out) :: imaginary_part(:)   !! (n)
      logical, intent(out) :: found !! LAPACK found them; not where the matrix overflowed
      !> (n, n) eigenvectors of length 1; of a pair, in two columns, real and imaginary part of the
      !> first one's
      real(dp), allocatable, intent(out), optional :: vectors(:, :)
      real(dp), allocatable :: copy(:, :), right(:, :), work(:)
      real(dp) :: left(1, 1), best(1)
      character :: wanted
      integer :: info, n

      n = size(matrix, 1)
      copy = matrix
      allocate (real_part(n), imaginary_part(n), source=0.0_dp)
      found = all(ieee_is_finite(matrix))
      if (.not. found) return
      wanted = merge('V', 'N', present(vectors))
      allocate (right(merge(n, 1, present(vectors)), merge(n, 1, present(vectors))))
      call dgeev('N', wanted, n, copy, n, real_part, imaginary_part, left, 1, right, &
         size(right, 1), best, -1, info)
      allocate (work(max(1, nint(best(1)))))
      call dgeev('N', wanted, n, copy, n, real_part, imaginary_part, left, 1, right, &
         size(right, 1), work, size(work), info)
      found = info == 0
      if (present(vectors)) call move_alloc(right, vectors)
   end subroutine eigenvalues

   !> Combinations V of unit vectors, V^T A V = 1, without those of which A leaves nothing but
   !> rounding beside others.
   subroutine energy_basis(matrix, rounding, basis, found)
      real(dp), intent(in) :: matrix(:, :)                !! (n, n) A, n > 0, diagonal above 0
      real(dp), intent(in) :: rounding                    !! part of a diagonal entry
      real(dp), allocatable, intent(out) :: basis(:, :)   !! (n, rank) V
      logical, intent(out) :: found                       !! not where the matrix overflowed
      real(dp), dimension(size(matrix, 1), size(matrix, 1)) :: factor
      real(dp) :: scale(size(matrix, 1)), work(2*size(matrix, 1))
      integer :: pivot(size(matrix, 1)), i, info, n, rank

      n = size(matrix, 1)
      found = all(ieee_is_finite(matrix))
      if (.not. found) return
      scale = [(1.0_dp/sqrt(max(matrix(i, i), tiny(1.0_dp))), i=1, n)]
      factor = matrix*spread(scale, 1, n)*spread(scale, 2, n)
      call dpstrf('U', n, factor, n, pivot, rank, rounding, work, info)
      call dtrtri('U', 'N', rank, factor, n, info)
      found = info == 0
      allocate (basis(n, rank), source=0.0_dp)
      do i = 1, rank
         basis(pivot(:i), i) = scale(pivot(:i))*factor(:i, i)
      end do
   end subroutine energy_basis

   !> The product of a matrix and some columns.
   pure function product_of(matrix, columns) result(product)
      real(dp), intent(in) :: matrix(:, :)     !! (m, n)
      real(dp), intent(in) :: columns(:, :)    !! (n, columns)
      real(dp) :: product(size(matrix, 1), size(columns, 2))

      call multiply('N', matrix, columns, product)
   end function product_of

   !> matrix^T columns, without a copy of either.
   pure function transposed_product(matrix, columns) result(product)
      real(dp), intent(in) :: matrix(:, :)     !! (n, m)
      real(dp), intent(in) :: columns(:, :)    !! (n, columns)
      real(dp) :: product(size(matrix, 2), size(columns, 2))

      call multiply('T', matrix, columns, product)
   end function transposed_product

   pure subroutine multiply(operation, matrix, columns, product)
      character, intent(in) :: operation       ! N or T, as of BLAS
      real(dp), intent(in) :: matrix(:, :), columns(:, :)
      real(dp), intent(out) :: product(:, :)
      integer :: m, n

      m = size(product, 1)
      n = size(columns, 1)
      product = 0.0_dp
      if (size(product) == 0 .or. n == 0) return
      if (size(columns, 2) == 1) then
         call dgemv(operation, size(matrix, 1), size(matrix, 2), 1.0_dp, matrix, &
            size(matrix, 1), columns, 1, 0.0_dp, product, 1)
      else
         call dgemm(operation, 'N', m, size(columns, 2), n, 1.0_dp, matrix, size(matrix, 1), &
            columns, n, 0.0_dp, product, m)
      end if
   end subroutine multiply

   !> The shortest x for which |matrix x - rhs| is least; columns that depend on others to rounding
   !> do not count. 0 where matrix or right-hand side overflowed.
   function least_squares(matrix, rhs, tolerance) result(x)
      real(dp), intent(in) :: matrix(:, :)   !! (m, n), m and n > 0
      real(dp), intent(in) :: rhs(:)         !! (m)
      real(dp), intent(in), optional :: tolerance !! of the rank, in place of that of rounding
      real(dp) :: x(size(matrix, 2))         !! (n)
      real(dp) :: least, copy(size(matrix, 1), size(matrix, 2)), work(4*size(matrix, 2) + 64)
      real(dp) :: solution(max(size(matrix, 1), size(matrix, 2)), 1)
      integer :: free(size(matrix, 2)), info, rank

      x = 0.0_dp
      if (.not. (all(ieee_is_finite(matrix)) .and. all(ieee_is_finite(rhs)))) return
      least = lost
      if (present(tolerance)) least = tolerance
      copy = matrix
      solution = 0.0_dp
      solution(:size(rhs), 1) = rhs
      free = 0
      call dgelsy(size(matrix, 1), size(matrix, 2), 1, copy, size(matrix, 1), solution, &
         size(solution), free, least, rank, work, size(work), info)
      x = solution(:size(x), 1)
   end function least_squares

end module dense
