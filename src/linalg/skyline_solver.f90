!> Direct solver on a skyline in profile order.
module skyline_solver
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use ordering, only: adjacency, alike_unknowns, positions_by_rank, profile_order
   use skyline, only: skyline_type
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: skyline_solver_type

   !> Skyline factors behind the common interface.
   type, extends(linear_solver_type) :: skyline_solver_type
      private
      integer, allocatable :: position(:)   !! (order) new position of each unknown
      type(skyline_type) :: skyline         !! the factors
   contains
      procedure :: analyse
      procedure :: factor
      procedure :: condense
      procedure :: recover
      procedure :: extend
      procedure :: release
   end type skyline_solver_type

contains

   !> As analyse_interface of linear_solver says.
   subroutine analyse(self, lower, tail, rank, error)
      class(skyline_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer, intent(in) :: tail
      integer, allocatable, intent(inout) :: rank(:)
      type(error_type), allocatable, intent(out) :: error   ! never
      integer, allocatable :: group(:), position(:)

      self%order = lower%row_count
      self%tail = tail
      self%row_start = lower%row_start
      self%column = lower%column
      if (.not. allocated(rank)) then
         group = alike_unknowns(lower, self%order - tail)
         position = profile_order(adjacency(lower, group))
         rank = position(group)
      end if
      self%position = positions_by_rank(rank, self%order)
      call self%skyline%set_pattern(lower, self%position, tail)
      self%full_flops = self%skyline%leading_flops
      self%factor_bytes = storage_size(1.0_dp)/8*(size(self%skyline%columns%value, kind=long) + &
         int(tail, long)*(tail + 1)/2)
   end subroutine analyse

   !> As factor_interface of linear_solver says.
   subroutine factor(self, lower, error)
      class(skyline_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error
      integer :: bad_column

      call check_pattern(self, lower, error)
      if (allocated(error)) return
      call self%skyline%set_values(lower, self%position)
      call self%skyline%factor_leading(bad_column)
      self%smallest_pivot = self%skyline%smallest_pivot
      call move_alloc(self%skyline%schur, self%schur)
      if (bad_column > 0) call set_error(error, status_deck, &
         'singular matrix: a body is not held by its supports and contacts, or far too weakly')
   end subroutine factor

   !> As condense_interface of linear_solver says.
   subroutine condense(self, rhs, condensed, welded)
      class(skyline_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: condensed(:, :)
      real(dp), intent(out), optional :: welded(:, :)
      real(dp), allocatable :: x(:, :)

      allocate (x, mold=rhs)
      x(self%position, :) = rhs
      call self%skyline%condense(x)
      condensed = x(self%order - self%tail + 1:, :)
      if (.not. present(welded)) return
      x(self%order - self%tail + 1:, :) = 0.0_dp
      call self%skyline%recover(x)
      welded = x(self%position, :)
   end subroutine condense

   !> As recover_interface of linear_solver says.
   subroutine recover(self, rhs, on_tail, solution)
      class(skyline_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      real(dp), allocatable :: x(:, :)

      allocate (x, mold=rhs)
      x(self%position, :) = rhs
      call self%skyline%condense(x)
      x(self%order - self%tail + 1:, :) = on_tail
      call self%skyline%recover(x)
      solution = x(self%position, :)
   end subroutine recover

   !> As extend_interface of linear_solver says.
   subroutine extend(self, on_tail, solution)
      class(skyline_solver_type), intent(in) :: self
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      real(dp), allocatable :: x(:, :)

      allocate (x, mold=solution)
      x(:self%order - self%tail, :) = 0.0_dp
      x(self%order - self%tail + 1:, :) = on_tail
      call self%skyline%recover(x)
      solution = x(self%position, :)
   end subroutine extend

   !> As release_interface of linear_solver says.
   subroutine release(self)
      class(skyline_solver_type), intent(inout) :: self

      if (allocated(self%position)) deallocate (self%position)
      self%skyline = skyline_type()
   end subroutine release

end module skyline_solver
