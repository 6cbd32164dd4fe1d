!> Anderson's mixing of a fixed point x = x + f(x) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011)
!> 1715):
!>
!>    x_i+1 = x_i + g f_i - (dX + g dF) gamma,    gamma = argmin |f_i - dF gamma|,
!>
!> dX and dF being the changes of the last passes.
module anderson_mixing
   use dense, only: least_squares
   use kinds, only: dp
   implicit none
   private
   public :: mixing_type

   integer, parameter :: depth = 5                  !! changes that are kept

   !> What the mixing remembers.
   type :: mixing_type
      !> Part of the largest singular value of dF below which a direction is dropped
      real(dp) :: rank_tolerance = 1.0e-14_dp
      real(dp), allocatable, private :: last_x(:), last_f(:) !! (n) of the last pass
      real(dp), allocatable, private :: x_changes(:, :)             !! (n, changes) dX
      real(dp), allocatable, private :: f_changes(:, :)             !! (n, changes) dF
   contains
      procedure :: step
   end type mixing_type

contains

   !> x_i+1 - x_i.
   function step(self, x, f, g)
      class(mixing_type), intent(inout) :: self
      real(dp), intent(in) :: x(:)          !! (n) x_i
      real(dp), intent(in) :: f(:)          !! (n) what it leaves over
      real(dp), intent(in) :: g(:)          !! (n) part of the way that each entry goes
      real(dp) :: step(size(x))             !! (n)
      real(dp), allocatable :: weights(:)

      call remember(self, x, f)
      step = g*f
      if (size(self%f_changes, 2) == 0) return
      weights = least_squares(self%f_changes, f, self%rank_tolerance)
      step = step - matmul(self%x_changes, weights) - g*matmul(self%f_changes, weights)
   end function step

   !> Adds the changes since the last pass, and drops the oldest ones.
   pure subroutine remember(self, x, f)
      class(mixing_type), intent(inout) :: self
      real(dp), intent(in) :: x(:), f(:)
      integer :: kept

      if (allocated(self%last_x)) then
         kept = min(size(self%x_changes, 2) + 1, depth)
         self%x_changes = with_last(self%x_changes, x - self%last_x, kept)
         self%f_changes = with_last(self%f_changes, f - self%last_f, kept)
      else
         allocate (self%x_changes(size(x), 0), self%f_changes(size(x), 0))
      end if
      self%last_x = x
      self%last_f = f
   end subroutine remember

   !> The last columns of a matrix and one more.
   pure function with_last(columns, last, kept) result(longer)
      real(dp), intent(in) :: columns(:, :), last(:)
      integer, intent(in) :: kept   !! columns of the result
      real(dp) :: longer(size(columns, 1), kept)
      integer :: have

      have = size(columns, 2)
      longer(:, :kept - 1) = columns(:, have - kept + 2:)
      longer(:, kept) = last
   end function with_last

end module anderson_mixing
