!> A linear field problem, thermal or mechanical, and its reduction to the contact unknowns.
!>
!> The problem is the matrix of the bodies and the numbering of its unknowns; either may change
!> while the other stays. A reduction is made of it for one numbering, once for given values of the
!> matrix and of what is added to it, such as films; whoever needs another one makes one of its own.
!> Loads that were solved for are kept with what became of them: a load that they make up needs no
!> solution of its own.
!>
!> A matrix without a tail that has another diagonal beside it for nearly each solution is not
!> factored where conjugate gradients are quick.
!>
!> Where many interfaces join many bodies, these are reduced piece by piece (body_pieces), and what
!> is left of them is the tail, a sparse one; else all unknowns but the contact's are eliminated:
!> where faces slide, first those inside of the bodies, once for all places of the faces.
module field_problem
   use body_pieces, only: body_division_type, body_pieces_type
   use controls, only: solver_mumps, solver_skyline
   use errors, only: check_finite, error_type, set_error, status_deck, status_internal
   use gradient_solver, only: gradient_solver_type
   use kinds, only: dp, long
   use linear_constraints, only: linear_constraints_type
   use linear_solver, only: linear_solver_type
   use mumps_solver, only: mumps_solver_type
   use skyline_solver, only: skyline_solver_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type, symmetric
   use tail_matrix, only: tail_matrix_type
   implicit none
   private
   public :: field_load_type, field_problem_type, field_reduction_type, largest_of, &
      solved_loads_type

   !> Part of a load, in its largest entry, that is rounding.
   real(dp), parameter :: rounding = 64*epsilon(1.0_dp)
   integer, parameter :: most_kept = 4   !! loads that were solved for

   !> Loads and prescribed values of a field at the end of an increment.
   type :: field_load_type
      real(dp), allocatable :: given(:)                       !! (dofs) prescribed values
      real(dp), allocatable :: forces(:)    !! (dofs) nodal ones, where bodies are reduced by pieces
      real(dp), allocatable :: rhs(:, :)                      !! (equations, 1) right-hand side
      real(dp), allocatable :: condensed(:) !! (tail) right-hand side condensed on the tail
      real(dp) :: rates = 0.0_dp            !! norm of what balances it, where this is known
   end type field_load_type

   !> Matrix of the bodies.
   type :: field_operator_type
      type(sparse_matrix_type) :: matrix !! (dofs, dofs) bodies alone, both triangles
      real(dp) :: largest_entry = 0.0_dp                      !! of this matrix but what is apart
      !> (apart) stiffness of degrees of freedom that move a whole body, as a multiple of that, and
      !> at least 1; unallocated for none
      real(dp), allocatable :: lever(:)
      integer :: values = 0                                   !! which values it has, counted
   contains
      procedure :: set_matrix
   end type field_operator_type

   !> The matrix and the numbering of the unknowns.
   type, extends(field_operator_type) :: field_problem_type
      type(linear_constraints_type) :: map                    !! u = T v + B g, and the unknowns v
      integer :: numbering = 0                                !! which numbering, counted
      type(body_division_type) :: division                    !! where bodies are reduced by pieces
      !> Whether most solutions have a diagonal of their own, and neither pieces nor a tail; where
      !> they have, the leading nodes of the map
      logical :: changes = .false.
      integer, allocatable :: leading(:)
   contains
      procedure :: matrix_of_unknowns
   end type field_problem_type

   !> Factors of a problem, its unknowns condensed on the tail.
   type :: field_reduction_type
      integer :: numbering = 0                                !! of the unknowns; 0 at first
      integer :: values = 0                                   !! of the matrix likewise
      !> (dofs, dofs) what was added to the matrix; without values where there was nothing
      type(sparse_matrix_type) :: added = sparse_matrix_type()
      !> Where the problem changes, both together, and the diagonal beside them
      type(sparse_matrix_type) :: whole
      real(dp), allocatable :: diagonal(:)                    !! (dofs)
      !> (leading) the order in which solvers eliminate the unknowns of this numbering, once made
      integer, allocatable :: rank(:)
      class(linear_solver_type), allocatable :: solver        !! pattern and factors
      type(body_pieces_type) :: pieces     !! of divided bodies; with a tail in the solver's place
      !> (dofs, dofs) what they leave of the matrix, for a solver, and the division it is of
      type(sparse_matrix_type) :: kept
      integer :: kept_made = 0                                !! how often that was made
      integer, private :: division = 0, kept_values = 0
      type(sparse_matrix_type), private :: kept_added
      type(tail_matrix_type) :: schur                         !! what is left on the tail
      integer :: factored = 0                                 !! how often
      integer :: lost_node = 0   !! where a singular matrix shows, if that is known
      integer, private :: analysed = 0                        !! numbering that the solver serves
      logical, private :: is_factored = .false.
   contains
      procedure :: renumber
      procedure :: is_for
      procedure :: is_of
      procedure :: factor
      procedure :: add_diagonal
      procedure :: condense_inside
      procedure :: forces_inside
      procedure :: load_of
      procedure :: condense_load
      procedure :: recover
      procedure :: recover_kept
      procedure :: extended
      procedure :: extended_to_kept
      procedure :: unit_responses
      procedure :: welded_response
      procedure :: condense_forces
      procedure :: condense_kept
      procedure :: release
      procedure :: release_tail
      procedure :: full_flops
   end type field_reduction_type

   !> Orthonormal loads that were solved for, the latest last, and the reduction that they were
   !> solved with.
   type :: solved_loads_type
      private
      integer :: numbering = 0, values = 0
      type(sparse_matrix_type) :: added = sparse_matrix_type()
      ! Inside of pieces equations and tail are all degrees of freedom.
      real(dp), allocatable :: rhs(:, :)           !! (equations, n)
      real(dp), allocatable :: condensed(:, :)     !! (tail, n)
      real(dp), allocatable :: solution(:, :)      !! (equations, n), or none
   contains
      procedure, private :: begin
      procedure :: take_off
      procedure :: keep
   end type solved_loads_type

contains

   !> Forgets what is of another numbering of the unknowns.
   subroutine renumber(self, problem)
      class(field_reduction_type), intent(inout) :: self
      type(field_problem_type), intent(in) :: problem

      if (self%numbering == problem%numbering) return
      if (self%division == 0 .or. self%division /= problem%division%version) then
         call self%release()
      else
         ! The pattern is mostly the same wherever faces that slide are, and the solver serves.
         self%is_factored = .false.
         self%schur = tail_matrix_type()
      end if
      if (allocated(self%rank)) deallocate (self%rank)
      self%numbering = problem%numbering
   end subroutine renumber

   !> Whether this is, or is to be, the reduction of a problem as it is numbered, with an addition
   !> to its matrix.
   pure logical function is_for(self, problem, added)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem
      type(sparse_matrix_type), intent(in) :: added       !! (dofs, dofs), or without values

      is_for = self%numbering == problem%numbering .and. self%values == problem%values
      if (is_for) is_for = same_values(self%added, added)
   end function is_for

   !> Whether it is, with its factors.
   pure logical function is_of(self, problem, added)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem
      type(sparse_matrix_type), intent(in) :: added       !! (dofs, dofs), or without values

      is_of = self%is_factored
      if (is_of) is_of = self%is_for(problem, added)
   end function is_of

   !> Whether two matrices have the same entries.
   pure logical function same_values(a, b)
      type(sparse_matrix_type), intent(in) :: a, b

      same_values = allocated(a%value) .eqv. allocated(b%value)
      if (.not. (same_values .and. allocated(a%value))) return
      same_values = size(a%value) == size(b%value)
      ! Whole arrays are counted faster than they are searched.
      if (same_values) same_values = count(abs(a%value - b%value) > 0.0_dp) + count(a%column /= &
         b%column) == 0
   end function same_values

   !> Factors the matrix with what is added to it. Unknowns are ordered and their pattern analysed
   !> once for a numbering, whatever values the matrix is given: films lie on sides of elements,
   !> whose nodes the matrix joins already.
   !> Errors: the matrix or its factors overflow; as the solver's analyse and factor.
   subroutine factor(self, problem, added, solver_kind, node_rank, error)
      class(field_reduction_type), intent(inout) :: self
      type(field_problem_type), intent(in) :: problem
      type(sparse_matrix_type), intent(in) :: added       !! (dofs, dofs), or without values
      integer, intent(in) :: solver_kind                  !! solver_skyline or solver_mumps
      !> (nodes) ranks in nested dissection, where they are known
      integer, allocatable, intent(in) :: node_rank(:)
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: lower

      call self%renumber(problem)
      self%is_factored = .false.
      self%values = problem%values
      self%added = added
      if (.not. has_pieces(self, problem, added)) call check_finite(problem%matrix%value, &
         'matrices of the bodies', status_deck, error)
      if (allocated(error)) return
      if (allocated(problem%division%piece)) then
         call reduce_pieces(self, problem, added, solver_kind, error)
         if (allocated(error) .or. problem%division%is_tail()) return
         lower = problem%map%transform_kept(self%kept, problem%map%link_stiffness(problem%matrix))
      else
         lower = problem%matrix_of_unknowns(added)
      end if
      if (problem%changes) then
         self%whole = linear_combination(1.0_dp, problem%matrix, 1.0_dp, added)
         self%diagonal = spread(0.0_dp, 1, self%whole%row_count)
      end if
      if (allocated(self%solver) .and. self%analysed /= self%numbering) then
         if (problem%changes .or. .not. self%solver%is_for(lower, problem%map%tail, &
            problem%map%last)) call self%release_tail()
      end if
      self%analysed = self%numbering
      if (.not. allocated(self%solver)) then
         call choose_solver(problem, solver_kind, self%solver)
         if (allocated(node_rank) .and. .not. allocated(self%rank)) then
            self%rank = node_rank(problem%map%leading_nodes())
            self%rank(size(self%rank) - problem%map%last + 1:) = maxval(node_rank) + 1
         end if
         self%solver%joined = problem%map%last
         call self%solver%analyse(lower, problem%map%tail, self%rank, error)
      end if
      if (.not. allocated(error)) call self%solver%factor(lower, error)
      if (.not. allocated(error)) call check_finite([self%solver%schur], 'factors of the bodies', &
         status_deck, error)
      self%factored = self%factored + 1
      self%is_factored = .not. allocated(error)
      if (.not. allocated(error)) then
         self%schur = tail_matrix_type()
         call move_alloc(self%solver%schur, self%schur%full)
         call self%schur%set_order()
         return
      end if
      associate (node => problem%map%leading_nodes(), lost => self%solver%lost_unknown)
         if (lost > 0 .and. lost <= size(node)) self%lost_node = node(lost)
      end associate
      call self%release()
   end subroutine factor

   !> Factors with another diagonal beside the matrix.
   !> Errors: as the solver's.
   subroutine add_diagonal(self, problem, diagonal, error)
      class(field_reduction_type), intent(inout) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: diagonal(:)                 !! (dofs) not negative
      type(error_type), allocatable, intent(out) :: error

      if (all(abs(self%diagonal - diagonal) <= 0.0_dp)) return
      self%diagonal = diagonal
      select type (solver => self%solver)
      type is (gradient_solver_type)
         call solver%add(problem%map%by_unknowns, diagonal, error)
      class default
         call set_error(error, status_internal, 'a diagonal stands beside a matrix with factors')
      end select
      self%factored = self%factored + 1
      self%is_factored = .not. allocated(error)
   end subroutine add_diagonal

   !> A solver for a problem.
   subroutine choose_solver(problem, solver_kind, solver)
      type(field_problem_type), intent(in) :: problem
      integer, intent(in) :: solver_kind                  !! solver_skyline or solver_mumps
      class(linear_solver_type), allocatable, intent(out) :: solver
      class(linear_solver_type), allocatable :: direct
      type(gradient_solver_type), allocatable :: gradients

      if (solver_kind == solver_mumps .and. problem%map%equations > problem%map%tail .and. .not. &
         allocated(problem%division%piece)) then
         allocate (mumps_solver_type :: direct)
      else
         allocate (skyline_solver_type :: direct)
      end if
      if (problem%changes) then
         allocate (gradients)
         call move_alloc(direct, gradients%direct)
         call move_alloc(gradients, solver)
      else
         call move_alloc(direct, solver)
      end if
   end subroutine choose_solver

   !> Reduces the bodies piece by piece; what is left is the tail, or kept for a solver, for all
   !> numberings of these pieces.
   !> Error: as the pieces' reduce.
   subroutine reduce_pieces(self, problem, added, solver_kind, error)
      class(field_reduction_type), intent(inout) :: self
      type(field_problem_type), intent(in) :: problem
      type(sparse_matrix_type), intent(in) :: added
      integer, intent(in) :: solver_kind
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: kept

      if (has_pieces(self, problem, added)) return
      associate (piece => problem%division%piece, kind => merge(solver_skyline, solver_kind, &
         problem%division%is_tail()))
         call self%pieces%reduce(linear_combination(1.0_dp, problem%matrix, 1.0_dp, added), &
            piece, kind, kept, error)
      end associate
      if (allocated(error)) return
      self%division = problem%division%version
      if (.not. problem%division%is_tail()) then
         self%kept = kept
         self%kept_made = self%kept_made + 1
         self%kept_values = problem%values
         self%kept_added = added
         return
      end if
      self%schur%sparse = symmetric(problem%map%transform(kept, &
         problem%map%link_stiffness(problem%matrix)))
      if (.not. allocated(self%schur%rank)) call self%schur%set_order()
      call check_finite(self%schur%sparse%value, 'factors of the bodies', status_deck, error)
      self%factored = self%factored + 1
      self%is_factored = .not. allocated(error)
   end subroutine reduce_pieces

   !> Whether the bodies are reduced to what pieces keep of them, for a solver.
   pure logical function has_pieces(self, problem, added) result(has)
      type(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem
      type(sparse_matrix_type), intent(in) :: added

      has = self%division == problem%division%version .and. self%kept_values == problem%values &
         .and. allocated(self%kept%value)
      if (has) has = same_values(self%kept_added, added)
   end function has_pieces

   !> Gives the matrix new values.
   subroutine set_matrix(self, matrix, apart)
      class(field_operator_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: matrix      !! (dofs, dofs) both triangles
      integer, intent(in), optional :: apart(:)           !! dofs whose entries are far larger
      integer :: i

      self%matrix = matrix
      self%largest_entry = largest_of(matrix, apart)
      self%values = self%values + 1
      if (.not. present(apart)) return
      self%lever = spread(1.0_dp, 1, size(apart))
      do i = 1, size(apart)
         associate (own => matrix%row_start(apart(i)), next => matrix%row_start(apart(i) + 1))
            self%lever(i) = max(1.0_dp, maxval(matrix%value(own:next - 1), &
               mask=matrix%column(own:next - 1) == apart(i))/self%largest_entry)
         end associate
      end do
   end subroutine set_matrix

   !> Largest entry of a matrix but for some rows, and columns of the same numbers.
   pure real(dp) function largest_of(matrix, apart) result(largest)
      type(sparse_matrix_type), intent(in) :: matrix
      integer, intent(in), optional :: apart(:)
      logical :: counts(max(matrix%row_count, matrix%column_count))
      integer :: i, k

      largest = maxval(abs(matrix%value))
      if (.not. present(apart)) return
      counts = .true.
      counts(apart) = .false.
      largest = 0.0_dp
      do i = 1, matrix%row_count
         if (.not. counts(i)) cycle
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            if (counts(matrix%column(k))) largest = max(largest, abs(matrix%value(k)))
         end do
      end do
   end function largest_of

   !> The matrix on the unknowns, its lower triangle.
   pure function matrix_of_unknowns(self, added) result(lower)
      class(field_problem_type), intent(in) :: self
      type(sparse_matrix_type), intent(in) :: added       !! (dofs, dofs), or without values
      type(sparse_matrix_type) :: lower                   !! (equations, equations)

      lower = self%map%transform(linear_combination(1.0_dp, self%matrix, 1.0_dp, added), &
         self%map%link_stiffness(self%matrix))
   end function matrix_of_unknowns

   !> Forces less those of prescribed values that are no part of what pieces leave: on the pieces
   !> these act as forces do.
   function forces_inside(self, problem, forces, given) result(acting)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of, with pieces
      real(dp), intent(in) :: forces(:)                   !! (dofs) nodal forces or heat rates
      real(dp), intent(in) :: given(:)                    !! (dofs) prescribed values
      real(dp), dimension(size(given)) :: acting, fixed

      acting = forces
      fixed = merge(given, 0.0_dp, problem%division%piece < 0)
      if (.not. any(abs(fixed) > 0.0_dp)) return
      acting = acting - problem%matrix%multiply(fixed)
      if (allocated(self%added%value)) acting = acting - self%added%multiply(fixed)
   end function forces_inside

   !> What forces leave on the degrees of freedom that pieces keep, wherever faces that slide are;
   !> what earlier ones say of it is taken from them.
   subroutine condense_inside(self, problem, forces, given, known, left, inside)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of, with pieces
      real(dp), intent(in) :: forces(:)                   !! (dofs) nodal forces or heat rates
      real(dp), intent(in) :: given(:)                    !! (dofs) prescribed values
      type(solved_loads_type), intent(inout) :: known     !! earlier loads of the pieces
      real(dp), allocatable, intent(out) :: left(:)       !! (dofs) forces on what is kept
      !> (dofs) values that they make inside of the pieces while those kept are zero
      real(dp), allocatable, intent(out), optional :: inside(:)
      real(dp), dimension(size(forces)) :: acting, rest
      real(dp), allocatable :: solution(:, :)

      call known%begin(self%division, self%kept_values, self%kept_added)
      acting = self%forces_inside(problem, forces, given)
      rest = merge(acting, 0.0_dp, problem%division%piece > 0)
      left = acting - rest
      allocate (solution(merge(size(rest), 0, present(inside)), 2), source=0.0_dp)
      acting = rest
      call known%take_off(rest, left, solution(:, 1))
      if (maxval(abs(rest)) > rounding*maxval(abs(acting))) then
         acting = rest
         call self%pieces%condense(acting)
         acting = merge(acting, 0.0_dp, problem%division%piece == 0)
         left = left + acting
         if (present(inside)) call self%pieces%fill(solution(:, 2), rest)
         call known%keep(rest, acting, solution(:, 2))
      end if
      if (present(inside)) inside = solution(:, 1) + solution(:, 2)
   end subroutine condense_inside

   !> The load of an increment; without forces inside of pieces where what they leave is given.
   function load_of(self, problem, forces, given, left) result(load)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: forces(:)                   !! (dofs) nodal forces or heat rates
      real(dp), intent(in) :: given(:)                    !! (dofs) prescribed values
      real(dp), intent(in), optional :: left(:)           !! (dofs) as from condense_inside
      type(field_load_type) :: load                       !! not condensed
      real(dp), dimension(size(given)) :: acting, supported

      load%given = given
      supported = problem%map%supported(given)
      if (present(left)) then
         supported = merge(supported, 0.0_dp, problem%division%piece == 0)
         acting = left
         if (any(abs(supported) > 0.0_dp)) acting = acting - self%kept%multiply(supported)
      else
         acting = forces
         if (any(abs(supported) > 0.0_dp)) then
            acting = acting - problem%matrix%multiply(supported)
            if (allocated(self%added%value)) acting = acting - self%added%multiply(supported)
         end if
         if (allocated(problem%division%piece)) then
            load%forces = self%forces_inside(problem, forces, given)
            call self%pieces%condense(acting)
         end if
      end if
      load%rhs = reshape(problem%map%load(acting, given, &
         problem%map%link_stiffness(problem%matrix)), [problem%map%equations, 1])
   end function load_of

   !> Condenses a load on the tail. What earlier loads say of it is taken from them: steps that ramp
   !> their loads solve for a first one only.
   !> Error: status_no_convergence, as of gradients.
   subroutine condense_load(self, problem, load, known, error, welded, inside)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      type(field_load_type), intent(inout) :: load        !! receives what is condensed
      type(solved_loads_type), intent(inout) :: known     !! earlier loads of the field
      type(error_type), allocatable, intent(out) :: error
      !> (dofs) values where the tail is zero; where the matrix changes, at first a guess
      real(dp), intent(inout), optional :: welded(:)
      !> (dofs) as from condense_inside: values inside of pieces are these, and need no solution
      real(dp), intent(in), optional :: inside(:)
      real(dp) :: rest(problem%map%equations, 1), condensed(problem%map%tail, 1)
      real(dp), allocatable :: solution(:, :)

      if (problem%division%is_tail()) then
         load%condensed = load%rhs(:, 1)
         if (present(welded)) welded = self%recover(problem, load, 0.0_dp*load%condensed)
         return
      else if (problem%changes .and. present(welded)) then
         load%condensed = [real(dp) ::]
         allocate (solution, mold=rest)
         associate (first => welded(problem%leading))
            welded = problem%map%expand(first)
            rest(:, 1) = load%rhs(:, 1) - problem%map%restrict(self%whole%multiply(welded) + &
               self%diagonal*welded)
            select type (solver => self%solver)
            type is (gradient_solver_type)
               call solver%improve(load%rates, rest, solution, error)
            class default
               call solver%recover(rest(:0, :), solution, rest)
            end select
            welded = problem%map%expand(first + solution(:, 1), load%given)
         end associate
         return
      end if
      call known%begin(self%numbering, self%values, self%added)
      allocate (load%condensed(problem%map%tail), source=0.0_dp)
      allocate (solution(merge(problem%map%equations, 0, present(welded)), 2), source=0.0_dp)
      rest = load%rhs
      call known%take_off(rest(:, 1), load%condensed, solution(:, 1))
      if (maxval(abs(rest)) > rounding*maxval(abs(load%rhs))) then
         if (present(welded)) then
            call self%solver%condense(rest, condensed, solution(:, 2:2))
            solution(:, 1) = solution(:, 1) + solution(:, 2)
         else
            call self%solver%condense(rest, condensed)
         end if
         load%condensed = load%condensed + condensed(:, 1)
         call known%keep(rest(:, 1), condensed(:, 1), solution(:, 2))
      end if
      if (.not. present(welded)) return
      welded = problem%map%expand(solution(:, 1), load%given)
      if (present(inside)) then
         welded = welded + inside
      else if (allocated(load%forces)) then
         call self%pieces%fill(welded, load%forces)
      end if
   end subroutine condense_load

   !> Values of all degrees of freedom under a load.
   function recover(self, problem, load, on_tail) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      type(field_load_type), intent(in) :: load
      real(dp), intent(in) :: on_tail(:)                  !! (tail) solution on the tail
      real(dp) :: values(problem%matrix%row_count)           !! (dofs)

      values = self%recover_kept(problem, load, on_tail)
      if (allocated(load%forces)) call self%pieces%fill(values, load%forces)
   end function recover

   !> The same of the degrees of freedom that pieces keep, or of all where there are none.
   function recover_kept(self, problem, load, on_tail) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      type(field_load_type), intent(in) :: load
      real(dp), intent(in) :: on_tail(:)                  !! (tail) solution on the tail
      real(dp) :: values(problem%matrix%row_count)           !! (dofs)
      real(dp) :: solution(problem%map%equations, 1)

      solution(:, 1) = [load%rhs(:problem%map%equations - size(on_tail), 1), on_tail]
      if (.not. problem%division%is_tail()) call self%solver%recover(reshape(on_tail, &
         [size(on_tail), 1]), solution, load%rhs)
      values = problem%map%expand(solution(:, 1), load%given)
   end function recover_kept

   !> Values of all degrees of freedom that follow the tail, without load and with zero prescribed
   !> values.
   function extended(self, problem, on_tail) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: on_tail(:, :)               !! (tail, columns)
      real(dp) :: values(problem%matrix%row_count, size(on_tail, 2))   !! (dofs, columns)
      integer :: k

      values = self%extended_to_kept(problem, on_tail)
      do k = 1, size(on_tail, 2)
         call self%pieces%fill(values(:, k))
      end do
   end function extended

   !> The same of the degrees of freedom that pieces keep, or of all where there are none.
   function extended_to_kept(self, problem, on_tail) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: on_tail(:, :)               !! (tail, columns)
      real(dp) :: values(problem%matrix%row_count, size(on_tail, 2))   !! (dofs, columns)
      real(dp), allocatable :: solution(:, :)
      integer :: k

      allocate (solution(problem%map%equations, size(on_tail, 2)))
      if (problem%division%is_tail()) then
         solution = on_tail
      else
         call self%solver%recover(on_tail, solution)
      end if
      do k = 1, size(on_tail, 2)
         values(:, k) = problem%map%expand(solution(:, k))
      end do
   end function extended_to_kept

   !> Values of the degrees of freedom that pieces keep, or of all where there are none, for unit
   !> values of some tail unknowns, without load and with zero prescribed values.
   function unit_responses(self, problem, first, last) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      integer, intent(in) :: first, last                  !! tail unknowns
      real(dp) :: values(problem%matrix%row_count, last - first + 1) !! (dofs, of each of them)
      real(dp) :: unit(problem%map%tail, last - first + 1)
      integer :: k

      unit = 0.0_dp
      do k = first, last
         unit(k, k - first + 1) = 1.0_dp
      end do
      values = self%extended_to_kept(problem, unit)
   end function unit_responses

   !> Values of all degrees of freedom under nodal forces, the tail held, with zero prescribed
   !> values; rough ones where solutions are found step by step.
   function welded_response(self, problem, forces) result(values)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: forces(:)                   !! (dofs)
      real(dp) :: values(size(forces))                    !! (dofs)
      real(dp) :: condensed(problem%map%tail, 1), welded(size(forces), 1)

      call self%condense_forces(problem, reshape(forces, shape(welded)), condensed, welded)
      values = welded(:, 1)
   end function welded_response

   !> Nodal forces condensed on the tail, and the values that they make where the tail is zero.
   subroutine condense_forces(self, problem, forces, condensed, welded)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: forces(:, :)                !! (dofs, columns)
      real(dp), intent(out) :: condensed(:, :)            !! (tail, columns)
      real(dp), intent(out), optional :: welded(:, :)     !! (dofs, columns)
      real(dp), allocatable :: acting(:, :)
      integer :: k

      acting = forces
      do k = 1, size(forces, 2)
         call self%pieces%condense(acting(:, k))
      end do
      call self%condense_kept(problem, acting, condensed, welded)
      if (.not. present(welded)) return
      do k = 1, size(forces, 2)
         call self%pieces%fill(welded(:, k), forces(:, k))
      end do
   end subroutine condense_forces

   !> The same of forces on the degrees of freedom that pieces keep, or on all where there are none;
   !> the values are those of the former.
   subroutine condense_kept(self, problem, forces, condensed, welded)
      class(field_reduction_type), intent(in) :: self
      type(field_problem_type), intent(in) :: problem     !! that it is of
      real(dp), intent(in) :: forces(:, :)                !! (dofs, columns)
      real(dp), intent(out) :: condensed(:, :)            !! (tail, columns)
      real(dp), intent(out), optional :: welded(:, :)     !! (dofs, columns)
      real(dp) :: rhs(problem%map%equations, size(forces, 2))
      real(dp), allocatable :: solution(:, :)
      integer :: k

      do k = 1, size(forces, 2)
         rhs(:, k) = problem%map%restrict(forces(:, k))
      end do
      allocate (solution, mold=rhs)
      if (problem%division%is_tail()) then
         condensed = rhs
         solution = 0.0_dp
      else if (present(welded)) then
         call self%solver%condense(rhs, condensed, solution)
      else
         call self%solver%condense(rhs, condensed)
      end if
      if (.not. present(welded)) return
      do k = 1, size(forces, 2)
         welded(:, k) = problem%map%expand(solution(:, k))
      end do
   end subroutine condense_kept

   !> Operations of a factorisation up to the tail.
   pure integer(long) function full_flops(self)
      class(field_reduction_type), intent(in) :: self
      integer :: i

      full_flops = 0
      if (allocated(self%solver)) full_flops = self%solver%full_flops
      if (.not. allocated(self%pieces%piece)) return
      do i = 1, size(self%pieces%piece)
         associate (piece => self%pieces%piece(i))
            if (allocated(piece%solver)) full_flops = full_flops + piece%solver%full_flops
         end associate
      end do
   end function full_flops

   !> Frees the factors; the order of the unknowns stays.
   subroutine release(self)
      class(field_reduction_type), intent(inout) :: self

      call self%release_tail()
      call self%pieces%release()
      self%division = 0
      self%kept = sparse_matrix_type()
   end subroutine release

   !> Frees the factors, but for those of pieces.
   subroutine release_tail(self)
      class(field_reduction_type), intent(inout) :: self

      self%is_factored = .false.
      self%schur = tail_matrix_type()
      if (.not. allocated(self%solver)) return
      call self%solver%release()
      deallocate (self%solver)
   end subroutine release_tail

   !> Forgets loads of another reduction.
   pure subroutine begin(self, numbering, values, added)
      class(solved_loads_type), intent(inout) :: self
      integer, intent(in) :: numbering, values         ! of unknowns or pieces; of the matrix
      type(sparse_matrix_type), intent(in) :: added    ! to this

      if (self%numbering == numbering .and. self%values == values) then
         if (same_values(self%added, added)) return
      end if
      if (allocated(self%rhs)) deallocate (self%rhs, self%condensed, self%solution)
      self%numbering = numbering
      self%values = values
      self%added = added
   end subroutine begin

   !> Takes from a load its parts along known ones, twice for their rounding, and adds these parts'
   !> condensed loads and solutions.
   pure subroutine take_off(self, rhs, condensed, solution)
      class(solved_loads_type), intent(in) :: self
      real(dp), intent(inout) :: rhs(:)         !! (equations)
      real(dp), intent(inout) :: condensed(:)   !! (tail)
      real(dp), intent(inout) :: solution(:)    !! (equations), or none
      real(dp) :: part
      integer :: j, turn

      if (.not. allocated(self%rhs)) return
      do turn = 1, 2
         do j = 1, size(self%rhs, 2)
            part = dot_product(self%rhs(:, j), rhs)
            rhs = rhs - part*self%rhs(:, j)
            condensed = condensed + part*self%condensed(:, j)
            solution = solution + part*self%solution(:, j)
         end do
      end do
   end subroutine take_off

   !> Keeps a load that is orthogonal to the known ones, in the place of the oldest where there are
   !> many.
   pure subroutine keep(self, rhs, condensed, solution)
      class(solved_loads_type), intent(inout) :: self
      real(dp), intent(in) :: rhs(:)            !! (equations), not zero
      real(dp), intent(in) :: condensed(:)      !! (tail)
      real(dp), intent(in) :: solution(:)       !! (equations), or none
      real(dp) :: length

      length = norm2(rhs)
      if (.not. allocated(self%rhs)) then
         allocate (self%rhs(size(rhs), 0), self%condensed(size(condensed), 0), &
            self%solution(size(solution), 0))
      end if
      associate (n => size(self%rhs, 2), oldest => 1 + size(self%rhs, 2)/most_kept)
         self%rhs = reshape([self%rhs(:, oldest:), rhs/length], [size(rhs), n + 2 - oldest])
         self%condensed = reshape([self%condensed(:, oldest:), condensed/length], &
            [size(condensed), n + 2 - oldest])
         self%solution = reshape([self%solution(:, oldest:), solution/length], &
            [size(solution), n + 2 - oldest])
      end associate
   end subroutine keep

end module field_problem
