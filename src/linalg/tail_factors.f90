!> Factors of the tail, the last columns of (3.4): the Schur complement of the leading block plus
!> what stands on the diagonal of the moment. Of a new diagonal only the columns from the first
!> changed one on are factored again, by Crout's L D L^T: what the paper asks for below eq. (3.4).
module tail_factors
   use blas_lapack, only: daxpy, ddot
   use kinds, only: dp, long
   implicit none
   private
   public :: tail_factors_type, tail_flops

   !> The factors, with the diagonal that they are of.
   type :: tail_factors_type
      real(dp), allocatable :: diagonal(:) !! (tail) added to the Schur complement
      integer :: first_changed = 1         !! first column that refactor factored again
      !> (tail, tail) unit upper factor, its diagonal replaced by D; nothing below it
      real(dp), allocatable, private :: value(:, :)
   contains
      procedure :: refactor
      procedure :: solve
   end type tail_factors_type

contains

   !> Factors schur + diagonal, from the first column on whose diagonal is another one. No stored
   !> entry before that column is written.
   pure subroutine refactor(self, schur, diagonal)
      class(tail_factors_type), intent(inout) :: self !! factors of the same schur, or none
      real(dp), intent(in) :: schur(:, :)             !! (tail, tail), its upper triangle
      real(dp), intent(in) :: diagonal(:)             !! (tail) added to it
      integer :: i, j
      real(dp) :: reduced

      self%first_changed = 1
      if (allocated(self%diagonal)) then
         self%first_changed = findloc(abs(diagonal - self%diagonal) > 0.0_dp, .true., dim=1)
         if (self%first_changed == 0) self%first_changed = size(diagonal) + 1
      else
         allocate (self%value(size(diagonal), size(diagonal)))
      end if
      self%diagonal = diagonal
      do j = self%first_changed, size(diagonal)
         associate (column => self%value(:, j))
            do i = 1, j - 1
               column(i) = schur(i, j) - ddot(i - 1, self%value(:, i), 1, column, 1)
            end do
            column(j) = schur(j, j) + diagonal(j)
            do i = 1, j - 1
               reduced = column(i)
               column(i) = reduced/self%value(i, i)
               column(j) = column(j) - column(i)*reduced
            end do
         end associate
      end do
   end subroutine refactor

   !> Solves with the factors.
   pure subroutine solve(self, x)
      class(tail_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:)              !! (tail) right-hand side in, solution out
      integer :: j

      do j = 2, size(x)
         x(j) = x(j) - ddot(j - 1, self%value(:, j), 1, x, 1)
      end do
      do j = 1, size(x)
         x(j) = x(j)/self%value(j, j)
      end do
      do j = size(x), 2, -1
         call daxpy(j - 1, -x(j), self%value(:, j), 1, x, 1)
      end do
   end subroutine solve

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
