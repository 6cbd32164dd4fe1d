!> Solver of a matrix beside which a small part changes with nearly each solution, so that factors
!> would serve but once: conjugate gradients, preconditioned by a sweep of Gauss and Seidel to and
!> fro, at the cost of one product for both (S. C. Eisenstat, SIAM J. Sci. Stat. Comput. 2 (1981)
!> 1). It takes few steps where heat is stored. A matrix that would need many goes to a direct
!> solver.
!>
!> It solves for unknowns of a given basis: values between corners beside parts of those at corners
!> (hierarchical basis) save half of the steps.
module gradient_solver
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use sparse_matrix, only: congruent, linear_combination, sparse_matrix_type, symmetric
   use text, only: to_text
   implicit none
   private
   public :: gradient_solver_type

   ! How fast they converge is tried with a uniform load, whose solution is smooth. So many steps
   ! would be some 200 to the end.
   integer, parameter :: trial_steps = 8
   real(dp), parameter :: trial_tolerance = 0.36_dp
   integer, parameter :: most_steps = 1000
   !> What is left over of a right-hand side, where the size of a solution is asked for, and of the
   !> rates that balance
   real(dp), parameter :: tolerance = 1.0e-11_dp, rough = 1.0e-3_dp, of_rates = 1.0e-10_dp

   !> A matrix without a tail, with a part beside it scaled to I + L + L^T, or factors of both by
   !> another solver.
   type, extends(linear_solver_type) :: gradient_solver_type
      class(linear_solver_type), allocatable :: direct   !! that other solver, given at first
      type(sparse_matrix_type) :: basis   !! unknowns by those that are solved for, given at first
      integer, allocatable, private :: rank(:)           !! (order) for it, if known
      logical, private :: is_analysed = .false.          !! whether it is
      logical, private :: iterates = .false.
      type(sparse_matrix_type), private :: lower         !! as it was given, for the other solver
      !> Between the unknowns that are solved for, both triangles, and that with the part, scaled
      type(sparse_matrix_type), private :: transformed, scaled
      integer, allocatable, private :: diagonal(:)       !! (order) places on its diagonal
      real(dp), allocatable, private :: scaling(:)       !! (order) 1/sqrt(diagonal)
   contains
      procedure :: analyse
      procedure :: factor
      procedure :: add
      procedure :: condense
      procedure :: recover
      procedure :: improve
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
      type(sparse_matrix_type) :: part

      call check_pattern(self, lower, error)
      if (allocated(error)) return
      self%schur = reshape([real(dp) ::], [0, 0])
      part = congruent(symmetric(lower), self%basis)
      self%transformed = symmetric(part)
      self%scaled = self%transformed
      ! Rows of L have so many entries, the last of them on the diagonal.
      self%diagonal = self%scaled%row_start(:self%order) + part%row_start(2:) - &
         part%row_start(:self%order) - 1
      call scale_matrix(self)
      load = 1.0_dp
      if (self%iterates) then
         call iterate(self, trial_steps, trial_tolerance, 0.0_dp, load, is_solved)
         self%iterates = is_solved
      end if
      if (.not. self%iterates) then
         self%lower = lower
         call factor_directly(self, lower, error)
      end if
   end subroutine factor

   !> Factors the matrix that was given last with a positive semidefinite part beside it, within its
   !> pattern. With that gradients are no slower.
   !> Errors: as factor.
   subroutine add(self, part, error)
      class(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: part           !! (order, order) lower triangle
      type(error_type), allocatable, intent(out) :: error

      if (self%iterates) then
         call add_part(self, part)
         call scale_matrix(self)
      else
         call factor_directly(self, linear_combination(1.0_dp, self%lower, 1.0_dp, part), error)
      end if
   end subroutine add

   !> Factors with the other solver.
   !> Errors: as its analyse and factor.
   subroutine factor_directly(self, lower, error)
      type(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error

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
   end subroutine factor_directly

   !> Takes a part to the unknowns that are solved for, and adds it to the matrix there.
   pure subroutine add_part(self, part)
      type(gradient_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: part
      integer :: i, k

      self%scaled%value(:) = self%transformed%value
      do i = 1, self%order
         do k = part%row_start(i), part%row_start(i + 1) - 1
            if (abs(part%value(k)) <= 0.0_dp) cycle
            call add_entry(self%scaled, self%basis, i, part%column(k), part%value(k))
            if (i /= part%column(k)) call add_entry(self%scaled, self%basis, part%column(k), i, &
               part%value(k))
         end do
      end do
   end subroutine add_part

   !> Adds what an entry is between other unknowns.
   pure subroutine add_entry(matrix, basis, i, j, value)
      type(sparse_matrix_type), intent(inout) :: matrix      ! between the others
      type(sparse_matrix_type), intent(in) :: basis
      integer, intent(in) :: i, j                            ! row and column
      real(dp), intent(in) :: value
      integer :: k, l, place

      do k = basis%row_start(i), basis%row_start(i + 1) - 1
         do l = basis%row_start(j), basis%row_start(j + 1) - 1
            associate (first => matrix%row_start(basis%column(k)), next => matrix%row_start( &
               basis%column(k) + 1))
               place = first - 1 + findloc(matrix%column(first:next - 1), basis%column(l), dim=1)
            end associate
            matrix%value(place) = matrix%value(place) + value*basis%value(k)*basis%value(l)
         end do
      end do
   end subroutine add_entry

   !> Brings the diagonal to 1, if all of it is positive.
   pure subroutine scale_matrix(self)
      type(gradient_solver_type), intent(inout) :: self
      integer :: i, k

      associate (matrix => self%scaled)
         self%scaling = matrix%value(self%diagonal)
         self%iterates = all(self%scaling > 0.0_dp)
         if (.not. self%iterates) return
         self%scaling = 1.0_dp/sqrt(self%scaling)
         do i = 1, self%order
            do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
               matrix%value(k) = self%scaling(i)*matrix%value(k)*self%scaling(matrix%column(k))
            end do
         end do
         self%factor_bytes = storage_size(1.0_dp)/8*size(matrix%value, kind=long)
         self%smallest_pivot = 1.0_dp
      end associate
   end subroutine scale_matrix

   !> Solves for a right-hand side.
   pure subroutine iterate(self, most, part, small, x, is_solved)
      type(gradient_solver_type), intent(in) :: self
      integer, intent(in) :: most                    ! steps
      real(dp), intent(in) :: part                   ! of the right-hand side that may be left over
      real(dp), intent(in) :: small                  ! norm before scaling that may be, too
      real(dp), intent(inout) :: x(self%order)       ! that, then the solution
      logical, intent(out) :: is_solved
      real(dp), dimension(self%order) :: direction, left_over, product, t
      real(dp) :: before, length, square, least
      integer :: step

      left_over = self%scaling*self%basis%multiply_transposed(x)
      call sweep_down(self%order, self%scaled%row_start, self%diagonal, self%scaled%column, &
         self%scaled%value, left_over)
      direction = left_over
      square = dot_product(left_over, left_over)
      least = max(part*norm2(left_over), small*minval(self%scaling))**2
      x = 0.0_dp
      do step = 1, most
         is_solved = square <= least
         if (is_solved) exit
         t = direction
         call sweep_up(self%order, self%scaled%row_start, self%diagonal, self%scaled%column, &
            self%scaled%value, t)
         product = direction - t
         call sweep_down(self%order, self%scaled%row_start, self%diagonal, self%scaled%column, &
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
   pure subroutine sweep_down(n, row_start, diagonal, column, value, x)
      integer, intent(in) :: n, row_start(n + 1), diagonal(n), column(*)
      real(dp), intent(in) :: value(*)
      real(dp), intent(inout) :: x(n)
      real(dp) :: total
      integer :: i, k

      do i = 1, n
         total = x(i)
         do k = row_start(i), diagonal(i) - 1
            total = total - value(k)*x(column(k))
         end do
         x(i) = total
      end do
   end subroutine sweep_down

   !> (I + L^T)^-1 x.
   pure subroutine sweep_up(n, row_start, diagonal, column, value, x)
      integer, intent(in) :: n, row_start(n + 1), diagonal(n), column(*)
      real(dp), intent(in) :: value(*)
      real(dp), intent(inout) :: x(n)
      real(dp) :: total
      integer :: i, k

      do i = n, 1, -1
         total = x(i)
         do k = row_start(i + 1) - 1, diagonal(i) + 1, -1
            total = total - value(k)*x(column(k))
         end do
         x(i) = total
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
         call solve(self, rough, 0.0_dp, rhs, welded)
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
         call solve(self, tolerance, 0.0_dp, rhs, solution)
      else
         solution = 0.0_dp
      end if
   end subroutine recover

   !> Solves for what a guess leaves over of rates that balance.
   !> Error: status_no_convergence, gradients do not get there.
   subroutine improve(self, rates, rhs, solution, error)
      class(gradient_solver_type), intent(in) :: self
      real(dp), intent(in) :: rates           !! their norm, 0 where it is not known
      real(dp), intent(in) :: rhs(:, :)       !! (order, columns), in the unit of the rates
      real(dp), intent(out) :: solution(:, :) !! (order, columns)
      type(error_type), allocatable, intent(out) :: error
      logical :: is_solved

      if (self%iterates) then
         call solve(self, tolerance, of_rates*rates, rhs, solution, is_solved)
         if (.not. is_solved) call set_error(error, status_no_convergence, 'conjugate '// &
            'gradients do not find temperatures in '//to_text(most_steps)//' steps, since '// &
            'little heat is stored beside what is conducted; allow shorter increments')
      else
         call self%direct%recover(rhs(:0, :), solution, rhs)
      end if
   end subroutine improve

   !> Solves for right-hand sides.
   pure subroutine solve(self, part, small, rhs, solution, is_solved)
      type(gradient_solver_type), intent(in) :: self
      real(dp), intent(in) :: part                   ! of these that may be left over
      real(dp), intent(in) :: small                  ! norm that may be, too
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: solution(:, :)
      logical, intent(out), optional :: is_solved    ! whether all are
      logical :: solved(size(rhs, 2))
      integer :: k

      solution = rhs
      do k = 1, size(rhs, 2)
         call iterate(self, most_steps, part, small, solution(:, k), solved(k))
      end do
      if (present(is_solved)) is_solved = all(solved)
   end subroutine solve

   !> As release_interface of linear_solver says.
   subroutine release(self)
      class(gradient_solver_type), intent(inout) :: self

      self%iterates = .false.
      if (self%is_analysed) call self%direct%release()
      self%is_analysed = .false.
   end subroutine release

end module gradient_solver
