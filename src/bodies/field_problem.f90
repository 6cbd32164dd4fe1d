!> A linear field problem, thermal or mechanical, reduced once to its contact unknowns.
module field_problem
   use controls, only: solver_mumps
   use errors, only: error_type, status_deck
   use finite_values, only: check_finite
   use kinds, only: dp
   use known_loads, only: known_loads_type
   use linear_constraints, only: linear_constraints_type
   use linear_solver, only: linear_solver_type
   use mumps_solver, only: mumps_solver_type
   use skyline_solver, only: skyline_solver_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: field_load_type, field_problem_type

   !> Part of a load, in its largest entry, that is rounding.
   real(dp), parameter :: rounding = 64*epsilon(1.0_dp)

   !> What acts on a field at the end of an increment.
   type :: field_load_type
      real(dp), allocatable :: given(:)                       !! (dofs) prescribed values
      real(dp), allocatable :: rhs(:, :)                      !! (equations, 1) right-hand side
      real(dp), allocatable :: condensed(:) !! (tail) right-hand side condensed on the tail
   end type field_load_type

   !> Matrix of the bodies, numbering of the unknowns, factors.
   type :: field_problem_type
      type(sparse_matrix_type) :: matrix !! (dofs, dofs) bodies alone, both triangles
      real(dp) :: largest_entry = 0.0_dp                      !! of the bodies alone, set by reduce
      !> (dofs, dofs) what is added to it, such as films; without values where there is nothing.
      type(sparse_matrix_type) :: added
      type(linear_constraints_type) :: map                    !! u = T v + B g, and the unknowns v
      class(linear_solver_type), allocatable :: solver        !! factors
      integer :: reduction = 0                                !! which factors, by number
   contains
      procedure :: reduce
      procedure :: matrix_of_unknowns
      procedure :: leading_nodes
      procedure :: load_of
      procedure :: condense_load
      procedure :: recover
      procedure :: extended
      procedure :: unit_responses
      procedure :: condense_forces
      procedure :: release
   end type field_problem_type

contains

   !> Factors the matrix with what is added to it. Unknowns are ordered and their pattern analysed
   !> once for a numbering: films lie on sides of elements, whose nodes the matrix joins already.
   !> Errors: the matrix or its factors overflow; as the solver's analyse and factor.
   subroutine reduce(self, solver_kind, node_rank, error)
      class(field_problem_type), intent(inout) :: self    !! the problem; its matrix and map are set
      integer, intent(in) :: solver_kind                  !! solver_skyline or solver_mumps
      !> (nodes) ranks in nested dissection, where they are known
      integer, allocatable, intent(in) :: node_rank(:)
      type(error_type), allocatable, intent(out) :: error
      type(sparse_matrix_type) :: lower

      if (.not. allocated(self%map%rank)) call self%release()
      self%reduction = self%reduction + 1
      call check_finite(self%matrix%value, 'matrices of the bodies', status_deck, error)
      if (allocated(error)) return
      self%largest_entry = maxval(abs(self%matrix%value))
      call self%map%stiffen_links(self%matrix)
      lower = self%matrix_of_unknowns()
      if (.not. allocated(self%solver)) then
         if (solver_kind == solver_mumps) then
            allocate (mumps_solver_type :: self%solver)
         else
            allocate (skyline_solver_type :: self%solver)
         end if
         if (allocated(node_rank) .and. .not. allocated(self%map%rank)) then
            self%map%rank = node_rank(self%leading_nodes())
         end if
         call self%solver%analyse(lower, self%map%tail, self%map%rank, error)
         if (allocated(error)) then
            call self%release()
            return
         end if
      end if
      call self%solver%factor(lower, error)
      if (allocated(error)) return
      call check_finite([self%solver%schur], 'factors of the bodies', status_deck, error)
   end subroutine reduce

   !> The matrix on the unknowns, its lower triangle.
   pure function matrix_of_unknowns(self) result(lower)
      class(field_problem_type), intent(in) :: self       !! the problem; its matrix and map are set
      type(sparse_matrix_type) :: lower                   !! (equations, equations)

      if (allocated(self%added%value)) then
         lower = self%map%transform(linear_combination(1.0_dp, self%matrix, 1.0_dp, self%added))
      else
         lower = self%map%transform(self%matrix)
      end if
   end function matrix_of_unknowns

   !> Nodes of the leading unknowns.
   pure function leading_nodes(self) result(node)
      class(field_problem_type), intent(in) :: self
      integer, allocatable :: node(:)                     !! (leading)

      node = self%map%nodes_of_unknowns()
      node = node(:self%map%equations - self%map%tail)
   end function leading_nodes

   !> The load of an increment.
   pure function load_of(self, forces, given) result(load)
      class(field_problem_type), intent(in) :: self
      real(dp), intent(in) :: forces(:)                   !! (dofs) nodal forces or heat rates
      real(dp), intent(in) :: given(:)                    !! (dofs) prescribed values
      type(field_load_type) :: load                       !! not condensed
      real(dp) :: supported(size(given))

      load%given = given
      supported = self%map%supported(given)
      allocate (load%rhs(self%map%equations, 1))
      if (.not. any(abs(supported) > 0.0_dp)) then
         load%rhs(:, 1) = self%map%load(forces, given)
         return
      end if
      load%rhs(:, 1) = self%map%load(forces - self%matrix%multiply(supported), given)
      if (allocated(self%added%value)) load%rhs(:, 1) = load%rhs(:, 1) - &
         self%map%restrict(self%added%multiply(supported))
   end function load_of

   !> Condenses a load on the tail. What earlier loads say of it is taken from them: steps that ramp
   !> their loads solve for a first one only.
   subroutine condense_load(self, load, known, welded)
      class(field_problem_type), intent(in) :: self       !! the problem, reduced
      type(field_load_type), intent(inout) :: load        !! receives what is condensed
      type(known_loads_type), intent(inout) :: known      !! earlier loads of the field
      real(dp), intent(out), optional :: welded(:)        !! (dofs) values where the tail is zero
      real(dp) :: rest(self%map%equations, 1), condensed(self%map%tail, 1)
      real(dp), allocatable :: solution(:, :)

      if (known%reduction /= self%reduction) then
         known = known_loads_type()
         known%reduction = self%reduction
      end if
      allocate (load%condensed(self%map%tail), source=0.0_dp)
      allocate (solution(merge(self%map%equations, 0, present(welded)), 2), source=0.0_dp)
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
      if (present(welded)) welded = self%map%expand(solution(:, 1), load%given)
   end subroutine condense_load

   !> Values of all degrees of freedom under a load.
   function recover(self, load, on_tail) result(values)
      class(field_problem_type), intent(in) :: self       !! the problem, reduced
      type(field_load_type), intent(in) :: load
      real(dp), intent(in) :: on_tail(:)                  !! (tail) solution on the tail
      real(dp) :: values(self%matrix%row_count)           !! (dofs)
      real(dp) :: solution(self%map%equations, 1)

      call self%solver%recover(load%rhs, reshape(on_tail, [size(on_tail), 1]), solution)
      values = self%map%expand(solution(:, 1), load%given)
   end function recover

   !> Values of all degrees of freedom that follow the tail, without load and with zero prescribed
   !> values.
   function extended(self, on_tail) result(values)
      class(field_problem_type), intent(in) :: self       !! the problem, reduced
      real(dp), intent(in) :: on_tail(:, :)               !! (tail, columns)
      real(dp) :: values(self%matrix%row_count, size(on_tail, 2))   !! (dofs, columns)
      real(dp) :: none(self%matrix%row_count)
      real(dp), allocatable :: solution(:, :)
      integer :: k

      allocate (solution(self%map%equations, size(on_tail, 2)))
      call self%solver%extend(on_tail, solution)
      none = 0.0_dp
      do k = 1, size(on_tail, 2)
         values(:, k) = self%map%expand(solution(:, k), none)
      end do
   end function extended

   !> Values of all degrees of freedom for unit values of some tail unknowns, without load and with
   !> zero prescribed values.
   function unit_responses(self, first, last) result(values)
      class(field_problem_type), intent(in) :: self
      integer, intent(in) :: first, last                  !! tail unknowns
      real(dp) :: values(self%matrix%row_count, last - first + 1) !! (dofs, of each of them)
      real(dp) :: unit(self%map%tail, last - first + 1)
      integer :: k

      unit = 0.0_dp
      do k = first, last
         unit(k, k - first + 1) = 1.0_dp
      end do
      values = self%extended(unit)
   end function unit_responses

   !> Nodal forces condensed on the tail.
   subroutine condense_forces(self, forces, condensed)
      class(field_problem_type), intent(in) :: self
      real(dp), intent(in) :: forces(:, :)                !! (dofs, columns)
      real(dp), intent(out) :: condensed(:, :)            !! (tail, columns)
      real(dp) :: rhs(self%map%equations, size(forces, 2))
      integer :: k

      do k = 1, size(forces, 2)
         rhs(:, k) = self%map%restrict(forces(:, k))
      end do
      call self%solver%condense(rhs, condensed)
   end subroutine condense_forces

   !> Frees the factors; the order of the unknowns stays.
   subroutine release(self)
      class(field_problem_type), intent(inout) :: self

      if (.not. allocated(self%solver)) return
      call self%solver%release()
      deallocate (self%solver)
   end subroutine release

end module field_problem
