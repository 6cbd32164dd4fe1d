!> Crout's U^T D U of the leading block of a skyline, and its Schur complement on the last columns,
!> the tail, which tail_factors factors again and again.
!>
!> Columns are stored from their first non-zero row on, in panels that share it (column_panels),
!> those of the tail to the last leading row.
module skyline
   use column_panels, only: column_panels_type
   use kinds, only: dp, long
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: skyline_type

   real(dp), parameter :: lost = 64*epsilon(1.0_dp)   !! pivot over its diagonal entry: rounding

   !> A skyline matrix and, after factor_leading, its factors.
   type :: skyline_type
      integer :: order = 0                        !! number of columns
      integer :: leading = 0                      !! columns before the tail
      integer, allocatable :: first_row(:)        !! (order) first row of a column, <= leading + 1
      type(column_panels_type) :: columns = column_panels_type() !! the matrix, then its factors
      real(dp), allocatable :: schur(:, :) !! (tail, tail) Schur complement, both triangles
      integer(long) :: leading_flops = 0 !! operations of Crout's method on the columns as they are
      real(dp) :: smallest_pivot = 1.0_dp         !! of factor_leading, over its diagonal entry
   contains
      procedure :: set_pattern
      procedure :: set_values
      procedure :: factor_leading
      procedure :: condense
      procedure :: recover
   end type skyline_type

contains

   !> Lays out columns for the pattern of a symmetric matrix in another order.
   pure subroutine set_pattern(self, lower, position, tail)
      class(skyline_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower  !! lower triangle by rows
      integer, intent(in) :: position(:)             !! (rows) new position of each row
      integer, intent(in) :: tail                    !! number of tail columns, the last ones
      integer :: i, j, k, row

      self%order = lower%row_count
      self%leading = self%order - tail
      self%first_row = [(min(j, self%leading + 1), j=1, self%order)]
      do row = 1, self%order
         do k = lower%row_start(row), lower%row_start(row + 1) - 1
            i = min(position(row), position(lower%column(k)))
            j = max(position(row), position(lower%column(k)))
            self%first_row(j) = min(self%first_row(j), i)
         end do
      end do
      call self%columns%set_profile(self%first_row, self%leading)
      self%leading_flops = crout_flops(self%first_row, self%leading)
   end subroutine set_pattern

   !> Takes over the values of a matrix in that pattern.
   pure subroutine set_values(self, lower, position)
      class(skyline_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower  !! lower triangle by rows
      integer, intent(in) :: position(:)             !! (rows) as set_pattern
      integer :: i, j, k, row

      self%columns%value = 0.0_dp
      if (allocated(self%schur)) deallocate (self%schur)
      allocate (self%schur(self%order - self%leading, self%order - self%leading), source=0.0_dp)
      do row = 1, self%order
         do k = lower%row_start(row), lower%row_start(row + 1) - 1
            i = min(position(row), position(lower%column(k)))
            j = max(position(row), position(lower%column(k)))
            if (i <= self%leading) then
               self%columns%value(self%columns%place(self%columns%panel(j), i, j)) = lower%value(k)
            else
               self%schur(i - self%leading, j - self%leading) = lower%value(k)
            end if
         end do
      end do
   end subroutine set_values

   !> Factors the leading block and forms its Schur complement on the tail.
   pure subroutine factor_leading(self, bad_column)
      class(skyline_type), intent(inout) :: self  !! matrix in, factors out
      integer, intent(out) :: bad_column !! column whose pivot is lost to rounding, 0 for none
      integer :: j

      call self%columns%factor(1, lost, self%smallest_pivot, bad_column)
      if (bad_column > 0) return
      call self%columns%form_schur(size(self%schur, 1), self%schur)
      do j = 1, size(self%schur, 1)
         self%schur(j, :j) = self%schur(:j, j)
      end do
   end subroutine factor_leading

   !> Operations of Crout's method by columns.
   pure function crout_flops(first_row, leading) result(flops)
      integer, intent(in) :: first_row(:), leading
      integer(long) :: flops
      integer :: high, i, j

      flops = 0
      do j = 1, size(first_row)
         high = min(j - 1, leading)
         do i = first_row(j) + 1, high
            flops = flops + 2*max(i - max(first_row(i), first_row(j)), 0)
         end do
         do i = leading + 1, j - 1
            flops = flops + 2*max(leading + 1 - max(first_row(i), first_row(j)), 0)
         end do
         flops = flops + 3*max(high - first_row(j) + 1, 0)
      end do
   end function crout_flops

   !> Right-hand sides condensed on the tail: the leading rows are eliminated forward.
   pure subroutine condense(self, x)
      class(skyline_type), intent(in) :: self  !! factors of the leading block
      real(dp), intent(inout) :: x(:, :)       !! (order, right-hand sides)

      call self%columns%eliminate(size(x, 1), size(x, 2), x)
   end subroutine condense

   !> Leading rows of the solutions, from condensed right-hand sides whose tail rows hold the tail's
   !> solution.
   pure subroutine recover(self, x)
      class(skyline_type), intent(in) :: self  !! factors of the leading block
      real(dp), intent(inout) :: x(:, :)       !! (order, right-hand sides)

      call self%columns%substitute(size(x, 1), size(x, 2), x)
   end subroutine recover

end module skyline
