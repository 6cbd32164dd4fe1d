!> What the solution asks of a direct solver for a symmetric positive definite matrix whose last
!> unknowns, the tail, are the contact's: factor the leading block once, after which only the tail
!> is ever factored again (tail_factors).
module linear_solver
   use errors, only: error_type
   use kinds, only: dp, long
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: linear_solver_type

   !> A direct solver. After factor, condense, recover and extend change nothing.
   type, abstract :: linear_solver_type
      integer :: order = 0               !! unknowns
      integer :: tail = 0                !! tail unknowns, the last ones
      !> (leading) ranks in nested dissection, those of a node alike, if they are known before.
      integer, allocatable :: rank(:)
      integer(long) :: full_flops = 0    !! operations of a factorisation of the leading block
      integer(long) :: factor_bytes = 0  !! memory of the factors [byte]
      !> Smallest pivot of the leading block over its diagonal entry, at most 1; MUMPS: over the
      !> largest entry of its row, nearly.
      real(dp) :: smallest_pivot = 1.0_dp
      real(dp), allocatable :: schur(:, :) !! (tail, tail) Schur complement, both triangles
   contains
      procedure(factor_interface), deferred :: factor
      procedure(condense_interface), deferred :: condense
      procedure(recover_interface), deferred :: recover
      procedure(extend_interface), deferred :: extend
      procedure(release_interface), deferred :: release
   end type linear_solver_type

   abstract interface
      !> Orders the leading unknowns, factors their block and forms its Schur complement on the
      !> tail.
      !> Error: the matrix is not positive definite (the message begins with "singular"), or the
      !> solver failed.
      subroutine factor_interface(self, lower, tail, error)
         import :: linear_solver_type, sparse_matrix_type, error_type
         class(linear_solver_type), intent(inout) :: self
         type(sparse_matrix_type), intent(in) :: lower      !! lower triangle by rows
         integer, intent(in) :: tail                        !! number of tail unknowns
         type(error_type), allocatable, intent(out) :: error !! failure
      end subroutine factor_interface

      !> Right-hand sides condensed on the tail: f_tail - K_tail,lead K_lead^-1 f_lead. The
      !> solutions whose tail is zero cost a back substitution more.
      subroutine condense_interface(self, rhs, condensed, welded)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(in) :: self
         real(dp), intent(in) :: rhs(:, :)                  !! (order, columns)
         real(dp), intent(out) :: condensed(:, :)           !! (tail, columns)
         real(dp), intent(out), optional :: welded(:, :)    !! (order, columns)
      end subroutine condense_interface

      !> Solutions in full from the solution on the tail: K_lead x_lead = f_lead - K_lead,tail
      !> x_tail.
      subroutine recover_interface(self, rhs, on_tail, solution)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(in) :: self
         real(dp), intent(in) :: rhs(:, :) !! (order, columns); tail rows are not used
         real(dp), intent(in) :: on_tail(:, :)              !! (tail, columns)
         real(dp), intent(out) :: solution(:, :)            !! (order, columns)
      end subroutine recover_interface

      !> Solutions without right-hand side on the leading rows: a back substitution alone.
      subroutine extend_interface(self, on_tail, solution)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(in) :: self
         real(dp), intent(in) :: on_tail(:, :)              !! (tail, columns)
         real(dp), intent(out) :: solution(:, :)            !! (order, columns)
      end subroutine extend_interface

      !> Frees what the solver holds outside Fortran.
      subroutine release_interface(self)
         import :: linear_solver_type
         class(linear_solver_type), intent(inout) :: self
      end subroutine release_interface
   end interface

end module linear_solver
