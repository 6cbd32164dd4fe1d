!> Solver of a matrix beside which a small part changes with nearly each solution, so that factors
!> would serve but once: conjugate gradients, preconditioned by incomplete factors that have entries
!> where the matrix has (J. A. Meijerink, H. A. van der Vorst, Math. Comp. 31 (1977) 148). It takes
!> few steps where heat is stored. A matrix that would need many goes to a direct solver.
module gradient_solver
   use errors, only: error_type, set_error, status_no_convergence
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use sparse_matrix, only: sparse_matrix_type
   use sum_lists, only: sum_list_type
   use text, only: to_text
   implicit none
   private
   public :: gradient_solver_type

   ! How fast they converge is tried with a uniform load, whose solution is smooth. So many steps
   ! would be some 70 to the end, which take about as long as factors.
   integer, parameter :: trial_steps = 8
   real(dp), parameter :: trial_tolerance = 0.05_dp
   integer, parameter :: most_steps = 1000
   !> What is left over of a right-hand side, where the size of a solution is asked for, and of the
   !> rates that balance
   real(dp), parameter :: tolerance = 1.0e-11_dp, rough = 1.0e-3_dp, of_rates = 1.0e-11_dp
   !> Pivot over diagonal entry below which incomplete factors take the entry
   real(dp), parameter :: least_pivot = 1.0e-3_dp
   !> Part by which a pivot may change without rows below it
   real(dp), parameter :: hardly = 0.01_dp

   !> A matrix without a tail, with a part beside it, and L of incomplete factors L L^T of both or
   !> factors by another solver.
   type, extends(linear_solver_type) :: gradient_solver_type
      class(linear_solver_type), allocatable :: direct   !! that other solver, given at first
      integer, allocatable, private :: rank(:)           !! (order) for it, if known
      logical, private :: is_analysed = .false.          !! whether it is
      logical, private :: iterates = .false.
      type(sparse_matrix_type), private :: alone         !! as it was given, the lower triangle
      type(sparse_matrix_type), private :: lower         !! with the part
      real(dp), allocatable, private :: factors(:)       !! L; 1/L_ii on the diagonal
      real(dp), allocatable, private :: followed(:)      !! 1/L_ii that rows below it follow
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
      if (allocated(self%factors)) deallocate (self%factors)
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
      self%schur = reshape([real(dp) ::], [0, 0])
      self%alone = lower
      self%lower = lower
      self%lower%value(:) = 0.0_dp   ! no row has its values yet
      self%followed = spread(0.0_dp, 1, self%order)
      self%factor_bytes = 2*storage_size(1.0_dp)/8*size(lower%value, kind=long)
      self%smallest_pivot = 1.0_dp
      call factor_incompletely(self, lower%value)
      load = 1.0_dp
      if (self%iterates) then
         call iterate(self, trial_steps, trial_tolerance, 0.0_dp, load, is_solved)
         self%iterates = is_solved
      end if
      if (.not. self%iterates) call factor_directly(self, lower, error)
   end subroutine factor

   !> Factors the matrix that was given last with T^T D T beside it, within its pattern; D is
   !> diagonal and not negative. With that gradients are no slower.
   !> Errors: as factor.
   subroutine add(self, terms, diagonal, error)
      class(gradient_solver_type), intent(inout) :: self
      type(sum_list_type), intent(in) :: terms               !! (n, order) T
      real(dp), intent(in) :: diagonal(:)                    !! (n) D
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: value(size(self%alone%value))
      integer :: i, k, l, place

      value = self%alone%value
      associate (start => self%lower%row_start)
         do i = 1, size(diagonal)
            if (diagonal(i) <= 0.0_dp) cycle
            do k = terms%start(i), terms%start(i + 1) - 1
               associate (row => terms%value(k))
                  do l = terms%start(i), terms%start(i + 1) - 1
                     if (terms%value(l) > row) cycle
                     place = start(row) - 1 + findloc(self%lower%column(start(row):start(row + 1) &
                        - 1), terms%value(l), dim=1, back=.true.)
                     value(place) = value(place) + diagonal(i)*terms%coefficient(k)* &
                        terms%coefficient(l)
                  end do
               end associate
            end do
         end do
      end associate
      if (self%iterates) then
         call factor_incompletely(self, value)
      else
         self%lower%value(:) = value
         call factor_directly(self, self%lower, error)
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

   !> Finds incomplete factors of new values, row by row, if the diagonal is positive: L_ij L_jj =
   !> A_ij - sum of L_ik L_jk over k < j. Rows stay that have their values, and follow pivots that
   !> have hardly changed.
   pure subroutine factor_incompletely(self, value)
      type(gradient_solver_type), intent(inout) :: self
      real(dp), intent(in) :: value(:)               ! of the lower triangle
      logical :: changes(self%order)                 ! pivots
      real(dp) :: own, row(self%order)               ! L_ij, zero where it has no entry
      integer :: i, j, k, l

      if (.not. allocated(self%factors)) allocate (self%factors(size(value)))
      changes = .false.
      row = 0.0_dp
      associate (start => self%lower%row_start, column => self%lower%column, factors => &
         self%factors)
         ! The last entry of a row of the lower triangle is that on the diagonal.
         self%iterates = all(value(start(2:) - 1) > 0.0_dp)
         do i = 1, self%order
            associate (first => start(i), diagonal => start(i + 1) - 1)
               if (all(abs(value(first:diagonal) - self%lower%value(first:diagonal)) <= 0.0_dp) &
                  .and. .not. any(changes(column(first:diagonal)))) cycle
               do k = first, diagonal - 1
                  row(column(k)) = value(k)
               end do
               factors(diagonal) = value(diagonal)
               do k = first, diagonal - 1
                  j = column(k)
                  own = row(j)
                  do l = start(j), start(j + 1) - 2
                     own = own - factors(l)*row(column(l))
                  end do
                  row(j) = own*factors(start(j + 1) - 1)
                  factors(diagonal) = factors(diagonal) - row(j)**2
               end do
               if (factors(diagonal) < least_pivot*value(diagonal)) factors(diagonal) = &
                  value(diagonal)
               factors(diagonal) = 1.0_dp/sqrt(max(factors(diagonal), tiny(row)))
               changes(i) = abs(factors(diagonal) - self%followed(i)) > hardly*factors(diagonal)
               if (changes(i)) self%followed(i) = factors(diagonal)
               do k = first, diagonal - 1
                  factors(k) = row(column(k))
                  row(column(k)) = 0.0_dp
               end do
            end associate
         end do
      end associate
      self%lower%value(:) = value
   end subroutine factor_incompletely

   !> Solves for a right-hand side.
   pure subroutine iterate(self, most, part, small, x, is_solved)
      type(gradient_solver_type), intent(in) :: self
      integer, intent(in) :: most                    ! steps
      real(dp), intent(in) :: part                   ! of the right-hand side that may be left over
      real(dp), intent(in) :: small                  ! norm that may be, too
      real(dp), intent(inout) :: x(self%order)       ! that, then the solution
      logical, intent(out) :: is_solved
      real(dp), dimension(self%order) :: direction, left_over, product, t
      real(dp) :: before, least, length, square
      integer :: step

      left_over = x
      least = max(part*norm2(left_over), small)**2
      x = 0.0_dp
      direction = 0.0_dp
      square = 1.0_dp
      do step = 0, most
         is_solved = dot_product(left_over, left_over) <= least
         if (is_solved .or. step == most) exit
         t = left_over
         call substitute(self%order, self%lower%row_start, self%lower%column, self%factors, t)
         before = square
         square = dot_product(left_over, t)
         direction = t + square/before*direction
         call multiply(self%order, self%lower%row_start, self%lower%column, self%lower%value, &
            direction, product)
         length = square/dot_product(direction, product)
         x = x + length*direction
         left_over = left_over - length*product
      end do
   end subroutine iterate

   !> (L L^T)^-1 x.
   pure subroutine substitute(n, row_start, column, factors, x)
      integer, intent(in) :: n, row_start(n + 1), column(*)
      real(dp), intent(in) :: factors(*)             ! L; 1/L_ii on the diagonal
      real(dp), intent(inout) :: x(n)
      real(dp) :: own
      integer :: i, j, k

      do i = 1, n
         own = x(i)
         do k = row_start(i), row_start(i + 1) - 2
            own = own - factors(k)*x(column(k))
         end do
         x(i) = own*factors(row_start(i + 1) - 1)
      end do
      do i = n, 1, -1
         own = x(i)*factors(row_start(i + 1) - 1)
         x(i) = own
         do k = row_start(i), row_start(i + 1) - 2
            j = column(k)
            x(j) = x(j) - factors(k)*own
         end do
      end do
   end subroutine substitute

   !> A x of the lower triangle of A.
   pure subroutine multiply(n, row_start, column, value, x, product)
      integer, intent(in) :: n, row_start(n + 1), column(*)
      real(dp), intent(in) :: value(*), x(n)
      real(dp), intent(out) :: product(n)
      real(dp) :: own
      integer :: i, j, k

      do i = 1, n
         own = value(row_start(i + 1) - 1)*x(i)
         do k = row_start(i), row_start(i + 1) - 2
            j = column(k)
            own = own + value(k)*x(j)
            product(j) = product(j) + value(k)*x(i)
         end do
         product(i) = own
      end do
   end subroutine multiply

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
