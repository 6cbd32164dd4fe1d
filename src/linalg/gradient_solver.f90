!> Solver of matrices whose values change with nearly each solution, so that factors would serve but
!> once: conjugate gradients, preconditioned by a sweep of Gauss and Seidel to and fro, at the cost
!> of one product for both (S. C. Eisenstat, SIAM J. Sci. Stat. Comput. 2 (1981) 1). It takes few
!> steps where heat is stored. A matrix that would need many goes to a direct solver.
!>
!> It solves for unknowns of a given basis: values between corners beside parts of those at corners
!> (hierarchical basis) save half of the steps.
module gradient_solver
   use errors, only: error_type
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use sparse_matrix, only: congruent, sparse_matrix_type, symmetric
   implicit none
   private
   public :: gradient_solver_type

   ! How fast they converge is tried with a uniform load, whose solution is smooth. So many steps
   ! would be some 200 to the end.
   integer, parameter :: trial_steps = 8
   real(dp), parameter :: trial_tolerance = 0.36_dp
   integer, parameter :: most_steps = 1000
   !> What is left over of a right-hand side, and where the size of a solution is asked for
   real(dp), parameter :: tolerance = 1.0e-11_dp, rough = 1.0e-3_dp

   !> A matrix without a tail that is scaled to I + L + L^T, or the factors of another solver.
   type, extends(linear_solver_type) :: gradient_solver_type
      class(linear_solver_type), allocatable :: direct   !! that other solver, given at first
      type(sparse_matrix_type) :: basis   !! unknowns by those that are solved for, given at first
      integer, allocatable, private :: rank(:)           !! (order) for it, if known
      logical, private :: is_analysed = .false.          !! whether it is
      logical, private :: iterates = .false.
      !> Entries beside the diagonal, and their matrix between the unknowns that are solved for
      real(dp), allocatable, private :: beside(:)
      type(sparse_matrix_type), private :: transformed
      type(sparse_matrix_type), private :: scaled        !! L by rows, beside a diagonal not read
      real(dp), allocatable, private :: scaling(:)       !! (order) 1/sqrt(diagonal)
   contains
      procedure :: analyse
      procedure :: factor
      procedure :: condense
      procedure :: recover
      procedure :: release
   end type gradient_solver_type

contains

   !> As analyse_interface of linear_solver says, but for the order: none is made.
   subroutine analyse(self, lower, tail, rank, error)
      class(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer, intent(in) :: tail                           ! none
      integer, allocatable, intent(inout) :: rank(:)
      type(error_type), allocatable, intent(out) :: error   ! never

      self%order = lower%row_count
      self%tail = tail
      self%row_start = lower%row_start
      self%column = lower%column
      if (allocated(rank)) self%rank = rank
   end subroutine analyse

   !> As factor_interface of linear_solver says.
   subroutine factor(self, lower, error)
      class(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error
      logical :: is_solved
      real(dp) :: load(self%order)

      call check_pattern(self, lower, error)
      if (allocated(error)) return
      call scale_matrix(self, lower)
      load = 1.0_dp
      if (self%iterates) then
         call iterate(self, trial_steps, trial_tolerance, load, is_solved)
         self%iterates = is_solved
      end if
      self%schur = reshape([real(dp) ::], [0, 0])
      if (self%iterates) then
         self%factor_bytes = storage_size(1.0_dp)/8*size(self%scaled%value, kind=long)
         self%smallest_pivot = 1.0_dp
         return
      end if
      if (.not. self%is_analysed) then
         self%direct%joined = self%joined
         call self%direct%analyse(lower, self%tail, self%rank, error)
         if (allocated(error)) return
         self%is_analysed = .true.
      end if
      call self%direct%factor(lower, error)
      self%full_flops = self%direct%full_flops
      self%factor_bytes = self%direct%factor_bytes
      self%smallest_pivot = self%direct%smallest_pivot
      self%lost_unknown = self%direct%lost_unknown
   end subroutine factor

   !> Takes a matrix to the unknowns that are solved for. What changes is mostly its diagonal.
   pure subroutine transform(self, lower)
      type(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(sparse_matrix_type) :: rest
      integer :: i, j, k, place

      rest = lower
      rest%value(rest%row_start(2:) - 1) = 0.0_dp
      if (.not. allocated(self%beside)) self%beside = 0.0_dp*rest%value - 1.0_dp
      if (any(abs(self%beside - rest%value) > 0.0_dp)) then
         self%beside = rest%value
         self%transformed = congruent(symmetric(rest), self%basis)
      end if
      self%scaled = self%transformed
      associate (to => self%scaled, by => self%basis)
         do i = 1, self%order
            do j = by%row_start(i), by%row_start(i + 1) - 1
               do k = by%row_start(i), j
                  associate (first => to%row_start(by%column(j)), last => to%row_start( &
                     by%column(j) + 1) - 1)
                     place = first - 1 + findloc(to%column(first:last), by%column(k), dim=1)
                  end associate
                  to%value(place) = to%value(place) + lower%value(lower%row_start(i + 1) - 1)* &
                     by%value(j)*by%value(k)
               end do
            end do
         end do
      end associate
   end subroutine transform

   !> Brings the diagonal to 1, if all of it is positive.
   pure subroutine scale_matrix(self, lower)
      type(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer :: i, k

      call transform(self, lower)
      associate (matrix => self%scaled)
         self%scaling = matrix%value(matrix%row_start(2:) - 1)
         self%iterates = all(self%scaling > 0.0_dp)
         if (.not. self%iterates) return
         self%scaling = 1.0_dp/sqrt(self%scaling)
         do i = 1, self%order
            do k = matrix%row_start(i), matrix%row_start(i + 1) - 2
               matrix%value(k) = self%scaling(i)*matrix%value(k)*self%scaling(matrix%column(k))
            end do
         end do
      end associate
   end subroutine scale_matrix

   !> Solves for a right-hand side.
   pure subroutine iterate(self, most, part, x, is_solved)
      type(gradient_solver_type), intent(in) :: self
      integer, intent(in) :: most                    ! steps
      real(dp), intent(in) :: part                   ! of the right-hand side that may be left over
      real(dp), intent(inout) :: x(self%order)       ! that, then the solution
      logical, intent(out) :: is_solved
      real(dp), dimension(self%order) :: direction, left_over, product, t
      real(dp) :: before, length, square, least
      integer :: step

      left_over = self%scaling*self%basis%multiply_transposed(x)
      call sweep_down(self%order, self%scaled%row_start, self%scaled%column, self%scaled%value, &
         left_over)
      direction = left_over
      square = dot_product(left_over, left_over)
      least = part**2*square
      x = 0.0_dp
      do step = 1, most
         is_solved = square <= least
         if (is_solved) exit
         t = direction
         call sweep_up(self%order, self%scaled%row_start, self%scaled%column, self%scaled%value, t)
         product = direction - t
         call sweep_down(self%order, self%scaled%row_start, self%scaled%column, &
            self%scaled%value, product)
         product = product + t
         length = square/dot_product(direction, product)
         x = x + length*t
         left_over = left_over - length*product
         before = square
         square = dot_product(left_over, left_over)
         direction = left_over + square/before*direction
      end do
      x = self%basis%multiply(self%scaling*x)
   end subroutine iterate

   !> (I + L)^-1 x.
   pure subroutine sweep_down(n, row_start, column, value, x)
      integer, intent(in) :: n, row_start(n + 1), column(*)
      real(dp), intent(in) :: value(*)
      real(dp), intent(inout) :: x(n)
      real(dp) :: total
      integer :: i, k

      do i = 1, n
         total = x(i)
         !GCC$ unroll 4
         do k = row_start(i), row_start(i + 1) - 2
            total = total - value(k)*x(column(k))
         end do
         x(i) = total
      end do
   end subroutine sweep_down

   !> (I + L^T)^-1 x.
   pure subroutine sweep_up(n, row_start, column, value, x)
      integer, intent(in) :: n, row_start(n + 1), column(*)
      real(dp), intent(in) :: value(*)
      real(dp), intent(inout) :: x(n)
      real(dp) :: own
      integer :: i, k

      do i = n, 1, -1
         own = x(i)
         !GCC$ unroll 4
         do k = row_start(i), row_start(i + 1) - 2
            x(column(k)) = x(column(k)) - value(k)*own
         end do
      end do
   end subroutine sweep_up

   !> As condense_interface of linear_solver says, but that solutions are rough.
   subroutine condense(self, rhs, condensed, welded)
      class(gradient_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: condensed(:, :)
      real(dp), intent(out), optional :: welded(:, :)

      if (.not. self%iterates) then
         call self%direct%condense(rhs, condensed, welded)
      else if (present(welded)) then
         call solve(self, rough, rhs, welded)
      end if
   end subroutine condense

   !> As recover_interface of linear_solver says.
   subroutine recover(self, on_tail, solution, rhs)
      class(gradient_solver_type), intent(in) :: self
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      real(dp), intent(in), optional :: rhs(:, :)

      if (.not. self%iterates) then
         call self%direct%recover(on_tail, solution, rhs)
      else if (present(rhs)) then
         call solve(self, tolerance, rhs, solution)
      else
         solution = 0.0_dp
      end if
   end subroutine recover

   !> Solves for right-hand sides.
   pure subroutine solve(self, part, rhs, solution)
      type(gradient_solver_type), intent(in) :: self
      real(dp), intent(in) :: part                   ! of these that may be left over
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: solution(:, :)
      logical :: is_solved
      integer :: k

      solution = rhs
      do k = 1, size(rhs, 2)
         call iterate(self, most_steps, part, solution(:, k), is_solved)
      end do
   end subroutine solve

   !> As release_interface of linear_solver says.
   subroutine release(self)
      class(gradient_solver_type), intent(inout) :: self

      self%iterates = .false.
      if (self%is_analysed) call self%direct%release()
      self%is_analysed = .false.
   end subroutine release

end module gradient_solver
