!> Anderson's mixing (Walker & Ni 2011) of x = log omega, with the residual f = log U(omega) - x:
!>
!>    x_i+1 = x_i + g f_i - (dX + g dF) gamma,    gamma = argmin |f_i - dF gamma|,
!>
!> dX and dF being the changes of the last passes. It asks for no derivative. Contact points that
!> carry no heat before or after a pass have no logarithm: they take the image.
module anderson
   use dense, only: least_squares
   use fixed_point, only: accelerator_type, pass_type
   use kinds, only: dp
   implicit none
   private
   public :: anderson_type

   integer, parameter :: depth = 5                  !! changes that are kept
   real(dp), parameter :: longest_step = 5.0_dp     !! of any x

   !> Memory of the method; g is set by the caller.
   type, extends(accelerator_type) :: anderson_type
      real(dp), allocatable, private :: last_x(:), last_f(:)        !! (m) of the last pass
      real(dp), allocatable, private :: x_changes(:, :)             !! (m, changes) dX
      real(dp), allocatable, private :: f_changes(:, :)             !! (m, changes) dF
   contains
      procedure :: next
   end type anderson_type

contains

   !> The next omega*.
   subroutine next(self, pass)
      class(anderson_type), intent(inout) :: self   !! memory of the method
      type(pass_type), intent(inout) :: pass        !! the last pass in, next omega* out
      real(dp), dimension(size(pass%omega)) :: x, f, step
      real(dp), allocatable :: weights(:)
      logical :: carries(size(pass%omega))

      carries = pass%omega > 0.0_dp .and. pass%image > 0.0_dp
      x = 0.0_dp
      f = 0.0_dp
      where (carries)
         x = log(pass%omega)
         f = log(pass%image) - x
      end where
      call remember(self, x, f)
      step = self%g*f
      if (size(self%f_changes, 2) > 0) then
         weights = least_squares(self%f_changes, f)
         step = step - matmul(self%x_changes, weights) - self%g*matmul(self%f_changes, weights)
      end if
      if (maxval(abs(step)) > longest_step) step = step*longest_step/maxval(abs(step))
      pass%omega = merge(pass%omega*exp(step), pass%image, carries)
   end subroutine next

   !> Adds the changes since the last pass, and drops the oldest ones.
   pure subroutine remember(self, x, f)
      class(anderson_type), intent(inout) :: self
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

end module anderson
