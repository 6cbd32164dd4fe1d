!> Factors of the tail, the last columns of (3.4).
!>
!> The matrix of the tail is the Schur complement of the leading block plus the present diagonal. If
!> the diagonal changes, only the columns from the first changed one on are factored again, by
!> Crout's U^T D U, as the paper requires below eq. (3.4). Columns of a sparse tail begin at their
!> first entry, in an order that keeps them short.
!>
!> A few sums of tail unknowns may have a conductance of their own beside the diagonal, A + V W V^T;
!> solutions then have the heats W V^T x as unknowns too, however large W is (Woodbury).
module tail_factors
   use column_panels, only: column_panels_type
   use dense, only: lu_type
   use kinds, only: dp, long
   use tail_matrix, only: tail_matrix_type
   implicit none
   private
   public :: tail_factors_type

   real(dp), parameter :: any_pivot = -1.0_dp   !! the tail may be indefinite: no pivot is refused

   !> The factors, with the diagonal that they are of.
   type :: tail_factors_type
      real(dp), allocatable :: diagonal(:) !! (tail) added to the Schur complement
      integer :: first_changed = 1         !! first column that refactor factored again
      integer, allocatable :: first_row(:) !! (tail) of each column
      integer, allocatable, private :: column(:)      !! (tail) place of each unknown
      !> All columns from their first rows on.
      type(column_panels_type), private :: columns = column_panels_type()
      !> (tail, n) V and A^-1 V; unallocated without sums
      real(dp), allocatable, private :: sums(:, :), responses(:, :)
      type(lu_type), private :: heats              !! W^-1 + V^T A^-1 V
   contains
      procedure :: refactor
      procedure :: add_sums
      procedure :: solve => solve_on_tail
      procedure :: solve_columns
   end type tail_factors_type

contains

   !> Factors schur + diagonal, from the first column on whose diagonal is another one. No stored
   !> entry before that column is written.
   pure subroutine refactor(self, schur, diagonal)
      class(tail_factors_type), intent(inout) :: self !! factors of the same schur, or none
      type(tail_matrix_type), intent(in) :: schur     !! of the leading block
      real(dp), intent(in) :: diagonal(:)             !! (tail) added to it
      real(dp) :: smallest
      integer :: bad_column, i

      self%first_changed = 1
      if (allocated(self%diagonal)) then
         associate (changed => abs(diagonal - self%diagonal) > 0.0_dp)
            self%first_changed = minval([size(diagonal) + 1, pack(self%column, changed)])
         end associate
      else
         self%column = schur%rank
         self%first_row = schur%first_rows()
         call self%columns%set_profile(self%first_row, size(diagonal))
      end if
      self%diagonal = diagonal
      if (allocated(self%sums)) deallocate (self%sums)
      do i = 1, size(diagonal)
         if (self%column(i) >= self%first_changed) call set_column(self, schur, i)
      end do
      call self%columns%factor(self%first_changed, any_pivot, smallest, bad_column)
   end subroutine refactor

   !> The column of an unknown, down to its diagonal.
   pure subroutine set_column(self, schur, unknown)
      type(tail_factors_type), intent(inout) :: self
      type(tail_matrix_type), intent(in) :: schur
      integer, intent(in) :: unknown
      integer(long) :: last
      integer :: k

      associate (columns => self%columns, j => self%column(unknown))
         last = columns%place(columns%panel(j), j, j)
         if (schur%is_sparse()) then
            columns%value(columns%place(columns%panel(j), columns%first_row(columns%panel(j)), &
               j):last) = 0.0_dp
            do k = schur%sparse%row_start(unknown), schur%sparse%row_start(unknown + 1) - 1
               associate (i => self%column(schur%sparse%column(k)))
                  if (i <= j) columns%value(last - j + i) = schur%sparse%value(k)
               end associate
            end do
         else
            columns%value(last - j + 1:last) = schur%full(:j, j)
         end if
         columns%value(last) = columns%value(last) + self%diagonal(unknown)
      end associate
   end subroutine set_column

   !> Adds V W V^T until the tail is factored again.
   pure subroutine add_sums(self, sums, conductance)
      class(tail_factors_type), intent(inout) :: self
      real(dp), intent(in) :: sums(:, :)           !! (tail, n) V
      real(dp), intent(in) :: conductance(:)       !! (n) W, none of them 0
      real(dp) :: matrix(size(conductance), size(conductance))
      logical :: singular
      integer :: i

      if (allocated(self%sums)) deallocate (self%sums)
      if (size(conductance) == 0) return
      self%responses = sums
      call self%solve_columns(self%responses)
      self%sums = sums
      matrix = matmul(transpose(sums), self%responses)
      do i = 1, size(conductance)
         matrix(i, i) = matrix(i, i) + 1.0_dp/conductance(i)
      end do
      call self%heats%factor(matrix, singular)
   end subroutine add_sums

   !> Solves with the factors.
   pure subroutine solve_on_tail(self, x)
      class(tail_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:)              !! (tail) right-hand side in, solution out
      real(dp) :: column(size(x), 1)

      column(:, 1) = x
      call self%solve_columns(column)
      x = column(:, 1)
   end subroutine solve_on_tail

   !> Solves with the factors for several right-hand sides.
   pure subroutine solve_columns(self, x)
      class(tail_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:, :)           !! (tail, columns) as solve
      real(dp) :: in_place(size(x, 1), size(x, 2))
      real(dp), allocatable :: heats(:, :)

      in_place(self%column, :) = x
      call self%columns%eliminate(size(x, 1), size(x, 2), in_place)
      call self%columns%substitute(size(x, 1), size(x, 2), in_place)
      x = in_place(self%column, :)
      if (.not. allocated(self%sums)) return
      heats = matmul(transpose(self%sums), x)
      call self%heats%solve(heats)
      x = x - matmul(self%responses, heats)
   end subroutine solve_columns

end module tail_factors
