!> Direct solver on a skyline in profile order: Crout's U^T D U of the leading block, and its Schur
!> complement on the last columns, the tail, which dense factors again and again. Where values are
!> others in some columns only, those before them keep their factors.
!>
!> Columns are stored from their first non-zero row on, in panels that share it (column_panels),
!> those of the tail to the last leading row.
module skyline_solver
   use column_panels, only: column_panels_type, crout_flops
   use errors, only: error_type, set_error, status_deck
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use ordering, only: adjacency, alike_unknowns, first_rows, positions_by_rank, profile_order
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: skyline_solver_type

   real(dp), parameter :: lost = 64*epsilon(1.0_dp)   !! pivot over its diagonal entry: rounding

   !> Skyline factors behind the common interface.
   type, extends(linear_solver_type) :: skyline_solver_type
      private
      integer, allocatable :: position(:)   !! (order) new position of each unknown
      type(column_panels_type) :: columns = column_panels_type() !! the matrix, then its factors
      real(dp), allocatable :: factored(:)  !! values of the lower triangle that these are of
   contains
      procedure :: analyse
      procedure :: factor
      procedure :: condense
      procedure :: recover
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
      integer :: first_row(lower%row_count), leading

      leading = lower%row_count - tail
      self%order = lower%row_count
      self%tail = tail
      self%row_start = lower%row_start
      self%column = lower%column
      if (.not. allocated(rank)) then
         group = alike_unknowns(lower, leading - self%joined)
         position = profile_order(adjacency(lower, group))
         rank = [position(group), spread(size(position) + 1, 1, self%joined)]
      end if
      self%position = positions_by_rank(rank, self%order)
      first_row = min(first_rows(lower, self%position), leading + 1)
      call self%columns%set_profile(first_row, leading)
      self%full_flops = crout_flops(first_row, leading, 1)
      self%factor_bytes = storage_size(1.0_dp)/8*(size(self%columns%value, kind=long) + &
         int(tail, long)*(tail + 1)/2)
   end subroutine analyse

   !> As factor_interface of linear_solver says.
   subroutine factor(self, lower, error)
      class(skyline_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error
      integer :: bad_column, first, i, j
      real(dp) :: smallest

      call check_pattern(self, lower, error)
      if (allocated(error)) return
      first = first_changed(self, lower)
      if (allocated(self%factored)) deallocate (self%factored)
      call set_values(self, lower, first)
      call self%columns%factor(first, lost, smallest, bad_column)
      if (first > 1) smallest = min(smallest, self%smallest_pivot)
      self%smallest_pivot = smallest
      if (bad_column > 0) then
         self%lost_unknown = findloc(self%position, bad_column, dim=1)
         call set_error(error, status_deck, 'singular matrix: a body is not held by its '// &
            'supports and contacts, or far too weakly')
         return
      end if
      self%factored = lower%value
      call self%columns%form_schur(self%tail, self%schur)
      do j = 1, self%tail
         do i = 1, j - 1
            self%schur(j, i) = self%schur(i, j)
         end do
      end do
   end subroutine factor

   !> First column of the first panel whose values are not those that were factored last.
   pure integer function first_changed(self, lower) result(first)
      type(skyline_solver_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer :: k, row

      first = 1
      if (.not. allocated(self%factored)) return
      first = self%order + 1
      do row = 1, self%order
         do k = lower%row_start(row), lower%row_start(row + 1) - 1
            if (abs(lower%value(k) - self%factored(k)) <= 0.0_dp) cycle
            first = min(first, max(self%position(row), self%position(lower%column(k))))
            if (first >= self%columns%first_column(2)) cycle
            first = 1
            return
         end do
      end do
      if (first <= self%order) first = self%columns%first_column(self%columns%panel(first))
   end function first_changed

   !> Copies the values of a matrix in the pattern that was analysed, from a column on.
   pure subroutine set_values(self, lower, first)
      type(skyline_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer, intent(in) :: first          ! of a panel, or none
      integer :: i, j, k, leading, row
      integer(long) :: above(self%order)    ! entries before row 1 of each column

      leading = self%order - self%tail
      above = [(self%columns%place(self%columns%panel(j), 0, j), j=1, self%order)]
      if (first <= self%order) self%columns%value(self%columns%place(self%columns%panel(first), &
         self%columns%first_row(self%columns%panel(first)), first):) = 0.0_dp
      if (.not. allocated(self%schur)) allocate (self%schur(self%tail, self%tail))
      self%schur = 0.0_dp
      do row = 1, self%order
         do k = lower%row_start(row), lower%row_start(row + 1) - 1
            i = min(self%position(row), self%position(lower%column(k)))
            j = max(self%position(row), self%position(lower%column(k)))
            if (i > leading) then
               self%schur(i - leading, j - leading) = lower%value(k)
            else if (j >= first) then
               self%columns%value(above(j) + i) = lower%value(k)
            end if
         end do
      end do
   end subroutine set_values

   !> As condense_interface of linear_solver says.
   subroutine condense(self, rhs, condensed, welded)
      class(skyline_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: condensed(:, :)
      real(dp), intent(out), optional :: welded(:, :)
      real(dp), allocatable :: x(:, :)

      allocate (x, mold=rhs)
      x(self%position, :) = rhs
      call self%columns%eliminate(self%order, size(x, 2), x)
      condensed = x(self%order - self%tail + 1:, :)
      if (.not. present(welded)) return
      x(self%order - self%tail + 1:, :) = 0.0_dp
      call self%columns%substitute(self%order, size(x, 2), x)
      welded = x(self%position, :)
   end subroutine condense

   !> As recover_interface of linear_solver says.
   subroutine recover(self, on_tail, solution, rhs)
      class(skyline_solver_type), intent(in) :: self
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      real(dp), intent(in), optional :: rhs(:, :)
      real(dp), allocatable :: x(:, :)

      allocate (x, mold=solution)
      if (present(rhs)) then
         x(self%position, :) = rhs
         call self%columns%eliminate(self%order, size(x, 2), x)
      else
         x(:self%order - self%tail, :) = 0.0_dp
      end if
      x(self%order - self%tail + 1:, :) = on_tail
      call self%columns%substitute(self%order, size(x, 2), x)
      solution = x(self%position, :)
   end subroutine recover

   !> As release_interface of linear_solver says.
   subroutine release(self)
      class(skyline_solver_type), intent(inout) :: self

      if (allocated(self%position)) deallocate (self%position)
      if (allocated(self%factored)) deallocate (self%factored)
      self%columns = column_panels_type()
   end subroutine release

end module skyline_solver
