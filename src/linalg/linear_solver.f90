!> What the solution asks of a direct solver for a symmetric positive definite matrix whose last
!> unknowns, the tail, are the contact's: factor the leading block once, then only ever work on the
!> tail.
module linear_solver
   use errors, only: error_type
   use kinds, only: dp, long
   use skyline, only: skyline_type
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: linear_solver_type

   !> A direct solver. Order of calls: factor; then condense and recover at any time; refactor_tail
   !> before solve_tail.
   type, abstract :: linear_solver_type
      integer :: order = 0               !! unknowns
      integer :: tail = 0                !! tail unknowns, the last ones
      integer(long) :: full_flops = 0    !! operations of a factorisation of the leading block
      integer(long) :: factor_bytes = 0  !! memory of the factors [byte]
      !> Smallest pivot of the leading block over its diagonal entry, at most 1; MUMPS: over the
      !> largest entry of its row, nearly.
      real(dp) :: smallest_pivot = 1.0_dp
      type(skyline_type) :: skyline      !! what Crout factors: the whole matrix, or its tail alone
   contains
      procedure(factor_interface), deferred :: factor
      procedure(condense_interface), deferred :: condense
      procedure(recover_interface), deferred :: recover
      procedure(release_interface), deferred :: release
      procedure, non_overridable :: schur_complement
      procedure, non_overridable :: refactor_tail
      procedure, non_overridable :: solve_tail
      procedure, non_overridable :: tail_flops
   end type linear_solver_type

   abstract interface
      !> Orders the leading unknowns, factors their block and forms its Schur complement on the
      !> tail.
      !> Error: the matrix is not positive definite (the message begins with "singular"), or the
      !> solver failed.
      subroutine factor_interface(self, lower, tail, error)
         import :: linear_solver_type, sparse_matrix_type, error_type
         class(linear_solver_type), intent(inout) :: self   !! the solver
         type(sparse_matrix_type), intent(in) :: lower      !! lower triangle by rows
         integer, intent(in) :: tail                        !! number of tail unknowns
         type(error_type), allocatable, intent(out) :: error !! failure
      end subroutine factor_interface

      !> Right-hand sides condensed on the tail: f_tail - K_tail,lead K_lead^-1 f_lead.
      subroutine condense_interface(self, rhs, condensed)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(inout) :: self   !! the solver
         real(dp), intent(in) :: rhs(:, :)                  !! (order, columns)
         real(dp), intent(out) :: condensed(:, :)           !! (tail, columns)
      end subroutine condense_interface

      !> Solutions in full from the solution on the tail: K_lead x_lead = f_lead - K_lead,tail
      !> x_tail.
      subroutine recover_interface(self, rhs, on_tail, solution)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(inout) :: self   !! the solver
         real(dp), intent(in) :: rhs(:, :) !! (order, columns); tail rows are not used
         real(dp), intent(in) :: on_tail(:, :)              !! (tail, columns)
         real(dp), intent(out) :: solution(:, :)            !! (order, columns)
      end subroutine recover_interface

      !> Frees what the solver holds outside Fortran.
      subroutine release_interface(self)
         import :: linear_solver_type
         class(linear_solver_type), intent(inout) :: self   !! the solver
      end subroutine release_interface
   end interface

contains

   !> The Schur complement of the leading block on the tail.
   pure function schur_complement(self) result(schur)
      class(linear_solver_type), intent(in) :: self      !! the solver
      real(dp) :: schur(self%tail, self%tail)            !! full symmetric

      schur = self%skyline%full_schur()
   end function schur_complement

   !> Factors Schur complement + diagonal on the tail, from the first changed column on.
   pure subroutine refactor_tail(self, diagonal, first_changed)
      class(linear_solver_type), intent(inout) :: self   !! the solver
      real(dp), intent(in) :: diagonal(:)                !! (tail) added to the diagonal
      integer, intent(in) :: first_changed               !! first tail column that changed

      call self%skyline%refactor_tail(diagonal, first_changed)
   end subroutine refactor_tail

   !> Solves on the tail with the factors of refactor_tail.
   pure subroutine solve_tail(self, x)
      class(linear_solver_type), intent(in) :: self      !! the solver
      real(dp), intent(inout) :: x(:)                    !! (tail) right-hand side, then solution

      call self%skyline%solve_tail(x)
   end subroutine solve_tail

   !> Operations of refactor_tail.
   pure function tail_flops(self, first_changed) result(flops)
      class(linear_solver_type), intent(in) :: self      !! the solver
      integer, intent(in) :: first_changed               !! first tail column that changed
      integer(long) :: flops                             !! floating-point operations

      flops = self%skyline%tail_flops(first_changed)
   end function tail_flops

end module linear_solver
