!> A linear field problem, thermal or mechanical, reduced once to its contact unknowns.
module field_problem
   use controls, only: solver_mumps
   use errors, only: error_type, status_deck
   use finite_values, only: check_finite
   use kinds, only: dp
   use linear_constraints, only: linear_constraints_type
   use linear_solver, only: linear_solver_type
   use mumps_solver, only: mumps_solver_type
   use skyline_solver, only: skyline_solver_type
   use sparse_matrix, only: linear_combination, sparse_matrix_type
   implicit none
   private
   public :: field_load_type, field_problem_type

   !> What acts on a field at the end of an increment.
   type :: field_load_type
      real(dp), allocatable :: given(:)                       !! (dofs) prescribed values
      real(dp), allocatable :: rhs(:, :)                      !! (equations, 1) right-hand side
      real(dp), allocatable :: condensed(:) !! (tail) right-hand side condensed on the tail
   end type field_load_type

   !> Matrix of the bodies, numbering of the unknowns, factors.
   type :: field_problem_type
      type(sparse_matrix_type) :: matrix !! (dofs, dofs) bodies alone, both triangles
      !> (dofs, dofs) what is added to it, such as films; without values where there is nothing.
      type(sparse_matrix_type) :: added
      type(linear_constraints_type) :: map                    !! u = T v + B g, and the unknowns v
      class(linear_solver_type), allocatable :: solver        !! factors
   contains
      procedure :: reduce
      procedure :: load_of
      procedure :: condense_load
      procedure :: recover
      procedure :: unit_responses
      procedure :: condense_forces
      procedure :: release
   end type field_problem_type

contains

   !> Factors the matrix for a numbering of the unknowns; done once for all increments with the same
   !> supports.
   !> Errors: the matrix or its factors overflow; as the solver's factor.
   subroutine reduce(self, solver_kind, error)
      class(field_problem_type), intent(inout) :: self    !! the problem; its matrix and map are set
      integer, intent(in) :: solver_kind                  !! solver_skyline or solver_mumps
      type(error_type), allocatable, intent(out) :: error

      call self%release()
      if (solver_kind == solver_mumps) then
         allocate (mumps_solver_type :: self%solver)
      else
         allocate (skyline_solver_type :: self%solver)
      end if
      call check_finite(self%matrix%value, 'matrices of the bodies', status_deck, error)
      if (allocated(error)) return
      call self%map%stiffen_links(self%matrix)
      if (allocated(self%added%value)) then
         call self%solver%factor(self%map%transform(linear_combination(1.0_dp, self%matrix, &
            1.0_dp, self%added)), self%map%tail, error)
      else
         call self%solver%factor(self%map%transform(self%matrix), self%map%tail, error)
      end if
      if (allocated(error)) return
      call check_finite([self%solver%schur], 'factors of the bodies', status_deck, error)
   end subroutine reduce

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

   !> Condenses a load on the tail.
   subroutine condense_load(self, load)
      class(field_problem_type), intent(in) :: self       !! the problem, reduced
      type(field_load_type), intent(inout) :: load        !! receives what is condensed
      real(dp) :: condensed(self%map%tail, 1)

      call self%solver%condense(load%rhs, condensed)
      load%condensed = condensed(:, 1)
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

   !> Values of all degrees of freedom for unit values of some tail unknowns, without load and with
   !> zero prescribed values.
   subroutine unit_responses(self, first, values)
      class(field_problem_type), intent(in) :: self
      integer, intent(in) :: first                        !! first of the tail unknowns
      real(dp), intent(out) :: values(:, :)               !! (dofs, number of tail unknowns)
      real(dp), allocatable :: zero(:, :), unit(:, :), solution(:, :)
      real(dp) :: none(self%matrix%row_count)
      integer :: k

      allocate (zero(self%map%equations, size(values, 2)), source=0.0_dp)
      allocate (solution, mold=zero)
      allocate (unit(self%map%tail, size(values, 2)), source=0.0_dp)
      do k = 1, size(values, 2)
         unit(first + k - 1, k) = 1.0_dp
      end do
      call self%solver%recover(zero, unit, solution)
      none = 0.0_dp
      do k = 1, size(values, 2)
         values(:, k) = self%map%expand(solution(:, k), none)
      end do
   end subroutine unit_responses

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

   !> Frees the factors.
   subroutine release(self)
      class(field_problem_type), intent(inout) :: self

      if (.not. allocated(self%solver)) return
      call self%solver%release()
      deallocate (self%solver)
   end subroutine release

end module field_problem
