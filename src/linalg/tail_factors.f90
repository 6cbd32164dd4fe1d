!> Factors of the tail, the last columns of (3.4): the Schur complement of the leading block plus
!> the present diagonal. If the diagonal changes, only the columns from the first changed one on are
!> factored again, by Crout's U^T D U, as the paper requires below eq. (3.4).
!> A few sums of tail unknowns may have a conductance of their own beside the diagonal, A + V W V^T;
!> solutions then have the heats W V^T x as unknowns too, however large W is (Woodbury).
module tail_factors
   use column_panels, only: column_panels_type
   use dense, only: lu_type
   use kinds, only: dp, long
   implicit none
   private
   public :: tail_factors_type, tail_flops

   real(dp), parameter :: any_pivot = -1.0_dp   !! the tail may be indefinite: no pivot is refused

   !> The factors, with the diagonal that they are of.
   type :: tail_factors_type
      real(dp), allocatable :: diagonal(:) !! (tail) added to the Schur complement
      integer :: first_changed = 1         !! first column that refactor factored again
      !> All columns from the first row on.
      type(column_panels_type), private :: columns = column_panels_type()
      !> (tail, n) V and A^-1 V; unallocated without sums
      real(dp), allocatable, private :: sums(:, :), responses(:, :)
      type(lu_type), private :: heats              !! W^-1 + V^T A^-1 V
   contains
      procedure :: refactor
      procedure :: add_sums
      procedure :: solve
      procedure :: solve_columns
   end type tail_factors_type

contains

   !> Factors schur + diagonal, from the first column on whose diagonal is another one. No stored
   !> entry before that column is written.
   pure subroutine refactor(self, schur, diagonal)
      class(tail_factors_type), intent(inout) :: self !! factors of the same schur, or none
      real(dp), intent(in) :: schur(:, :)             !! (tail, tail), its upper triangle
      real(dp), intent(in) :: diagonal(:)             !! (tail) added to it
      real(dp) :: smallest
      integer :: bad_column, j
      integer(long) :: last

      if (allocated(self%diagonal)) then
         self%first_changed = findloc(abs(diagonal - self%diagonal) > 0.0_dp, .true., dim=1)
         if (self%first_changed == 0) self%first_changed = size(diagonal) + 1
      else
         self%first_changed = 1
         call self%columns%set_profile([(1, j=1, size(diagonal))], size(diagonal))
      end if
      self%diagonal = diagonal
      if (allocated(self%sums)) deallocate (self%sums)
      associate (columns => self%columns)
         do j = self%first_changed, size(diagonal)
            last = columns%place(columns%panel(j), j, j)
            columns%value(last - j + 1:last) = schur(:j, j)
            columns%value(last) = columns%value(last) + diagonal(j)
         end do
         call columns%factor(self%first_changed, any_pivot, smallest, bad_column)
      end associate
   end subroutine refactor

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
   pure subroutine solve(self, x)
      class(tail_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:)              !! (tail) right-hand side in, solution out
      real(dp), allocatable :: heats(:, :)

      call self%columns%eliminate(size(x), 1, x)
      call self%columns%substitute(size(x), 1, x)
      if (.not. allocated(self%sums)) return
      heats = reshape(matmul(x, self%sums), [size(self%sums, 2), 1])
      call self%heats%solve(heats)
      x = x - matmul(self%responses, heats(:, 1))
   end subroutine solve

   !> Solves with the factors for several right-hand sides.
   pure subroutine solve_columns(self, x)
      class(tail_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:, :)           !! (tail, columns) as solve
      real(dp), allocatable :: heats(:, :)

      call self%columns%eliminate(size(x, 1), size(x, 2), x)
      call self%columns%substitute(size(x, 1), size(x, 2), x)
      if (.not. allocated(self%sums)) return
      heats = matmul(transpose(self%sums), x)
      call self%heats%solve(heats)
      x = x - matmul(self%responses, heats)
   end subroutine solve_columns

   !> Operations of factoring the columns of a tail from one on.
   pure function tail_flops(tail, first_changed) result(flops)
      integer, intent(in) :: tail              !! columns
      integer, intent(in) :: first_changed     !! first one that is factored
      integer(long) :: flops                   !! floating-point operations
      integer :: j

      flops = 0
      do j = first_changed, tail
         flops = flops + int(j - 1, long)*(j - 2) + 3*(j - 1)
      end do
   end function tail_flops

end module tail_factors
