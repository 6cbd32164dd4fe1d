!> Crout's LDL^T of the leading block of a skyline, and its Schur complement on the last columns,
!> the tail, which tail_factors factors again and again.
!>
!> Columns are stored from their first non-zero row to the diagonal, those of the tail to the last
!> leading row.
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
      real(dp), allocatable :: schur(:, :) !! (tail, tail) Schur complement, both triangles
      integer(long) :: leading_flops = 0          !! operations of factor_leading
      real(dp) :: smallest_pivot = 1.0_dp         !! of factor_leading, over its diagonal entry
   contains
      procedure :: set_matrix
      procedure :: factor_leading
      procedure :: condense
      procedure :: recover
   end type skyline_type

contains

   !> Takes over a symmetric matrix.
   pure subroutine set_matrix(self, lower, tail)
      class(skyline_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower  !! lower triangle by rows, in the final order
      integer, intent(in) :: tail                    !! number of tail columns, the last ones
      integer :: i, j, k
      integer(long) :: total

      self%order = lower%row_count
      self%leading = self%order - tail
      allocate (self%first_row(self%order), self%offset(self%order))
      total = 0
      do j = 1, self%order
         self%first_row(j) = min(lower%column(lower%row_start(j)), j, self%leading + 1)
         self%offset(j) = total - self%first_row(j) + 1
         total = total + min(j, self%leading) - self%first_row(j) + 1
      end do
      allocate (self%value(total), self%schur(tail, tail), source=0.0_dp)
      do j = 1, self%order
         do k = lower%row_start(j), lower%row_start(j + 1) - 1
            i = lower%column(k)
            if (i <= self%leading) then
               self%value(self%offset(j) + i) = lower%value(k)
            else
               self%schur(i - self%leading, j - self%leading) = lower%value(k)
            end if
         end do
      end do
   end subroutine set_matrix

   !> Factors the leading block and forms its Schur complement on the tail.
   pure subroutine factor_leading(self, bad_column)
      class(skyline_type), intent(inout) :: self  !! matrix in, factors out
      integer, intent(out) :: bad_column !! column whose pivot is lost to rounding, 0 for none
      integer :: i, j, low, high
      integer(long) :: column_i, column_j
      real(dp) :: original, pivot, reduced

      bad_column = 0
      self%leading_flops = 0
      self%smallest_pivot = 1.0_dp
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
         if (j > self%leading) then
            call eliminate(self, j)
            pivot = self%schur(j - self%leading, j - self%leading)
         else
            pivot = self%value(column_j + j)
         end if
         original = pivot
         do i = self%first_row(j), high
            reduced = self%value(column_j + i)
            self%value(column_j + i) = reduced/self%value(self%offset(i) + i)
            pivot = pivot - self%value(column_j + i)*reduced
         end do
         self%leading_flops = self%leading_flops + 3*max(high - self%first_row(j) + 1, 0)
         if (j > self%leading) then
            self%schur(j - self%leading, j - self%leading) = pivot
            cycle
         end if
         self%value(column_j + j) = pivot
         if (pivot > 64*epsilon(1.0_dp)*abs(original)) then
            self%smallest_pivot = min(self%smallest_pivot, pivot/original)
         else
            bad_column = j
            return
         end if
      end do
   end subroutine factor_leading

   !> Takes from the tail rows of a tail column what the leading ones eliminate.
   pure subroutine eliminate(self, j)
      type(skyline_type), intent(inout) :: self
      integer, intent(in) :: j
      integer :: i, low
      integer(long) :: column_i, column_j

      column_j = self%offset(j)
      do i = self%leading + 1, j - 1
         column_i = self%offset(i)
         low = max(self%first_row(i), self%first_row(j))
         associate (left => self%schur(i - self%leading, j - self%leading))
            left = left - ddot(self%leading - low + 1, self%value(column_i + low:), 1, &
               self%value(column_j + low:), 1)
            self%schur(j - self%leading, i - self%leading) = left
         end associate
         self%leading_flops = self%leading_flops + 2*max(self%leading - low + 1, 0)
      end do
   end subroutine eliminate

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

end module skyline
