!> Crout's LDL^T on a skyline whose last columns, the tail, can be factored again without touching
!> the rest: what the paper asks for below eq. (3.4).
!>
!> Columns are stored from their first non-zero row to the diagonal. The leading columns are
!> factored once. A tail column keeps its leading rows from that factorisation; its tail rows start
!> each time from the Schur complement of the leading block, plus what is added to the diagonal.
module skyline
   use blas_lapack, only: daxpy, ddot
   use kinds, only: dp, long
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: skyline_type

   !> A skyline matrix and, after factor_leading, its factors.
   type :: skyline_type
      integer :: order = 0                        !! number of columns
      integer :: leading = 0                      !! columns before the tail
      integer, allocatable :: first_row(:)        !! (order) first stored row of a column
      integer(long), allocatable :: offset(:)     !! (order) entry (i, j) is value(offset(j) + i)
      real(dp), allocatable :: value(:)           !! unit upper factor, its diagonal replaced by D
      real(dp), allocatable :: schur(:, :) !! (tail, tail) upper triangle of the Schur complement
      integer(long) :: leading_flops = 0          !! operations of factor_leading
      real(dp) :: smallest_pivot = 1.0_dp         !! of factor_leading, over its diagonal entry
   contains
      procedure :: set_matrix
      procedure :: set_schur
      procedure :: full_schur
      procedure :: factor_leading
      procedure :: refactor_tail
      procedure :: condense
      procedure :: solve_tail
      procedure :: recover
      procedure :: tail_flops
   end type skyline_type

contains

   !> Takes over a symmetric matrix. Tail columns are stored in full height over the tail, which
   !> fills anyway.
   pure subroutine set_matrix(self, lower, tail)
      class(skyline_type), intent(inout) :: self     !! the skyline
      type(sparse_matrix_type), intent(in) :: lower  !! lower triangle by rows, in the final order
      integer, intent(in) :: tail                    !! number of tail columns, the last ones
      integer :: j, k
      integer(long) :: total

      self%order = lower%row_count
      self%leading = self%order - tail
      allocate (self%first_row(self%order), self%offset(self%order))
      total = 0
      do j = 1, self%order
         self%first_row(j) = min(lower%column(lower%row_start(j)), j)
         if (j > self%leading) self%first_row(j) = min(self%first_row(j), self%leading + 1)
         self%offset(j) = total - self%first_row(j) + 1
         total = total + j - self%first_row(j) + 1
      end do
      allocate (self%value(total), source=0.0_dp)
      do j = 1, self%order
         do k = lower%row_start(j), lower%row_start(j + 1) - 1
            self%value(self%offset(j) + lower%column(k)) = lower%value(k)
         end do
      end do
   end subroutine set_matrix

   !> Takes over a Schur complement as a matrix that is all tail.
   pure subroutine set_schur(self, schur)
      class(skyline_type), intent(inout) :: self  !! the skyline
      real(dp), intent(in) :: schur(:, :)         !! (tail, tail) upper triangle
      integer :: j, n

      n = size(schur, 1)
      self%order = n
      self%leading = 0
      self%first_row = [(1, j=1, n)]
      self%offset = [(int(j, long)*(j - 1)/2, j=1, n)]
      allocate (self%value(n*(n + 1)/2), source=0.0_dp)
      self%schur = schur
   end subroutine set_schur

   !> The Schur complement with both triangles.
   pure function full_schur(self) result(schur)
      class(skyline_type), intent(in) :: self                   !! factors of the leading block
      real(dp) :: schur(size(self%schur, 1), size(self%schur, 2)) !! (tail, tail)
      integer :: j

      do j = 1, size(schur, 1)
         schur(:j, j) = self%schur(:j, j)
         schur(j, :j) = self%schur(:j, j)
      end do
   end function full_schur

   !> Factors the leading block and forms its Schur complement on the tail.
   pure subroutine factor_leading(self, bad_column)
      class(skyline_type), intent(inout) :: self  !! matrix in, factors out
      integer, intent(out) :: bad_column !! column whose pivot is lost to rounding, 0 for none
      integer :: i, j, low, high
      integer(long) :: column_i, column_j
      real(dp) :: original, reduced

      bad_column = 0
      self%leading_flops = 0
      self%smallest_pivot = 1.0_dp
      allocate (self%schur(self%order - self%leading, self%order - self%leading), source=0.0_dp)
      do j = 1, self%order
         column_j = self%offset(j)
         high = min(j - 1, self%leading)
         do i = self%first_row(j) + 1, high
            column_i = self%offset(i)
            low = max(self%first_row(i), self%first_row(j))
            if (low >= i) cycle
            self%value(column_j + i) = self%value(column_j + i) - ddot(i - low, &
               self%value(column_i + low:), 1, self%value(column_j + low:), 1)
            self%leading_flops = self%leading_flops + 2*(i - low)
         end do
         do i = self%leading + 1, j - 1
            column_i = self%offset(i)
            low = max(self%first_row(i), self%first_row(j))
            self%schur(i - self%leading, j - self%leading) = self%value(column_j + i) - ddot( &
               self%leading - low + 1, self%value(column_i + low:), 1, &
               self%value(column_j + low:), 1)
            self%leading_flops = self%leading_flops + 2*max(self%leading - low + 1, 0)
         end do
         original = self%value(column_j + j)
         do i = self%first_row(j), high
            reduced = self%value(column_j + i)
            self%value(column_j + i) = reduced/self%value(self%offset(i) + i)
            self%value(column_j + j) = self%value(column_j + j) - self%value(column_j + i)*reduced
         end do
         self%leading_flops = self%leading_flops + 3*max(high - self%first_row(j) + 1, 0)
         if (j > self%leading) then
            self%schur(j - self%leading, j - self%leading) = self%value(column_j + j)
         else if (self%value(column_j + j) > 64*epsilon(1.0_dp)*abs(original)) then
            self%smallest_pivot = min(self%smallest_pivot, self%value(column_j + j)/original)
         else
            bad_column = j
            return
         end if
      end do
   end subroutine factor_leading

   !> Factors the tail again, from the first column that changed: tail = Schur complement +
   !> diagonal. No stored entry before that column, and none in the leading rows, is written.
   pure subroutine refactor_tail(self, diagonal, first_changed)
      class(skyline_type), intent(inout) :: self  !! the factors
      real(dp), intent(in) :: diagonal(:)         !! (tail) added to the diagonal of the tail
      integer, intent(in) :: first_changed        !! first tail column that changed, 1..tail
      integer :: i, j, n
      integer(long) :: column_i, column_j
      real(dp) :: reduced

      n = self%leading
      do j = first_changed, self%order - n
         column_j = self%offset(n + j) + n
         do i = 1, j - 1
            column_i = self%offset(n + i) + n
            self%value(column_j + i) = self%schur(i, j)
            if (i > 1) self%value(column_j + i) = self%value(column_j + i) - ddot(i - 1, &
               self%value(column_i + 1:), 1, self%value(column_j + 1:), 1)
         end do
         self%value(column_j + j) = self%schur(j, j) + diagonal(j)
         do i = 1, j - 1
            reduced = self%value(column_j + i)
            self%value(column_j + i) = reduced/self%value(self%offset(n + i) + n + i)
            self%value(column_j + j) = self%value(column_j + j) - self%value(column_j + i)*reduced
         end do
      end do
   end subroutine refactor_tail

   !> Right-hand sides condensed on the tail: the leading rows are eliminated forward.
   pure subroutine condense(self, x)
      class(skyline_type), intent(in) :: self  !! factors of the leading block
      real(dp), intent(inout) :: x(:, :)       !! (order, right-hand sides)
      integer :: j, low, length, column

      do j = 1, self%order
         low = self%first_row(j)
         length = min(j - 1, self%leading) - low + 1
         if (length < 1) cycle
         do column = 1, size(x, 2)
            x(j, column) = x(j, column) - ddot(length, self%value(self%offset(j) + low:), 1, &
               x(low:, column), 1)
         end do
      end do
   end subroutine condense

   !> Solves on the tail with the factors of refactor_tail.
   pure subroutine solve_tail(self, x)
      class(skyline_type), intent(in) :: self  !! factors of the tail
      real(dp), intent(inout) :: x(:)          !! (tail) condensed right-hand side in, solution out
      integer :: j, n
      integer(long) :: column_j

      n = self%leading
      do j = 2, size(x)
         column_j = self%offset(n + j) + n
         x(j) = x(j) - ddot(j - 1, self%value(column_j + 1:), 1, x, 1)
      end do
      do j = 1, size(x)
         x(j) = x(j)/self%value(self%offset(n + j) + n + j)
      end do
      do j = size(x), 2, -1
         column_j = self%offset(n + j) + n
         call daxpy(j - 1, -x(j), self%value(column_j + 1:), 1, x, 1)
      end do
   end subroutine solve_tail

   !> Leading rows of the solutions, from condensed right-hand sides whose tail rows hold the tail's
   !> solution.
   pure subroutine recover(self, x)
      class(skyline_type), intent(in) :: self  !! factors of the leading block
      real(dp), intent(inout) :: x(:, :)       !! (order, right-hand sides)
      integer :: j, low, length, column

      do j = 1, self%leading
         x(j, :) = x(j, :)/self%value(self%offset(j) + j)
      end do
      do j = self%order, 1, -1
         low = self%first_row(j)
         length = min(j - 1, self%leading) - low + 1
         if (length < 1) cycle
         do column = 1, size(x, 2)
            call daxpy(length, -x(j, column), self%value(self%offset(j) + low:), 1, &
               x(low:, column), 1)
         end do
      end do
   end subroutine recover

   !> Operations of refactor_tail.
   pure function tail_flops(self, first_changed) result(flops)
      class(skyline_type), intent(in) :: self  !! the skyline
      integer, intent(in) :: first_changed     !! first tail column that changed
      integer(long) :: flops                   !! floating-point operations
      integer :: j

      flops = 0
      do j = first_changed, self%order - self%leading
         flops = flops + int(j - 1, long)*(j - 2) + 3*(j - 1)
      end do
   end function tail_flops

end module skyline
