!> Interface of a solver for a symmetric positive definite matrix whose last unknowns, the tail, are
!> the contact's: factor the leading block once, after which only the tail is ever factored again
!> (dense).
!>
!> A solver analyses a pattern once and factors values in that pattern as often as they change. The
!> order of elimination is a value of its own: several solvers that hold factors of one pattern
!> share it, and none but the first one makes it.
module linear_solver
   use errors, only: error_type, set_error, status_internal
   use kinds, only: dp, long
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: linear_solver_type, check_pattern

   !> A direct solver and its latest factors, which condense and recover leave as they are.
   type, abstract :: linear_solver_type
      integer :: order = 0               !! unknowns
      integer :: tail = 0                !! tail unknowns, the last ones
      !> Leading unknowns, the last ones, that are eliminated behind all others: many are joined to
      !> them. To be set before the analysis
      integer :: joined = 0
      integer, allocatable :: row_start(:), column(:)   !! pattern of the lower triangle, by rows
      integer(long) :: full_flops = 0    !! operations of a factorisation of the leading block
      integer(long) :: factor_bytes = 0  !! memory of the factors [byte]
      !> Smallest pivot of the leading block over its diagonal entry, at most 1; MUMPS: over the
      !> largest entry of its row, nearly.
      real(dp) :: smallest_pivot = 1.0_dp
      integer :: lost_unknown = 0        !! leading unknown without a pivot, where one is known
      real(dp), allocatable :: schur(:, :) !! (tail, tail) Schur complement, both triangles
   contains
      procedure :: is_for
      procedure(analyse_interface), deferred :: analyse
      procedure(factor_interface), deferred :: factor
      procedure(condense_interface), deferred :: condense
      procedure(recover_interface), deferred :: recover
      procedure(release_interface), deferred :: release
   end type linear_solver_type

   abstract interface
      !> Analyses a pattern, once for all values in it. Orders the leading unknowns, unless the
      !> caller knows their order.
      !> Error: the solver failed.
      subroutine analyse_interface(self, lower, tail, rank, error)
         import :: linear_solver_type, sparse_matrix_type, error_type
         class(linear_solver_type), intent(inout) :: self   !! fresh or released
         type(sparse_matrix_type), intent(in) :: lower !! lower triangle by rows; its pattern
         integer, intent(in) :: tail                        !! number of tail unknowns
         !> (leading) order of elimination, those of a node alike; made where it is not allocated
         integer, allocatable, intent(inout) :: rank(:)
         type(error_type), allocatable, intent(out) :: error
      end subroutine analyse_interface

      !> Factors the leading block of a matrix in the pattern that was analysed, and forms its Schur
      !> complement on the tail. Earlier factors go.
      !> Error: the matrix is not positive definite (the message begins with "singular"), its
      !> pattern is another one, or the solver failed.
      subroutine factor_interface(self, lower, error)
         import :: linear_solver_type, sparse_matrix_type, error_type
         class(linear_solver_type), intent(inout) :: self   !! analysed
         type(sparse_matrix_type), intent(in) :: lower      !! lower triangle by rows
         type(error_type), allocatable, intent(out) :: error
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
      !> x_tail. Without right-hand sides a back substitution alone.
      subroutine recover_interface(self, on_tail, solution, rhs)
         import :: linear_solver_type, dp
         class(linear_solver_type), intent(in) :: self
         real(dp), intent(in) :: on_tail(:, :)              !! (tail, columns)
         real(dp), intent(out) :: solution(:, :)            !! (order, columns)
         real(dp), intent(in), optional :: rhs(:, :) !! (order, columns); tail rows are not used
      end subroutine recover_interface

      !> Frees the factors and the analysis.
      subroutine release_interface(self)
         import :: linear_solver_type
         class(linear_solver_type), intent(inout) :: self
      end subroutine release_interface
   end interface

contains

   !> Checks that values have the pattern that was analysed.
   !> Error: they have another one.
   subroutine check_pattern(solver, lower, error)
      class(linear_solver_type), intent(in) :: solver
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error

      if (.not. solver%is_for(lower, solver%tail, solver%joined)) call set_error(error, &
         status_internal, 'the pattern of a matrix differs from that analysed')
   end subroutine check_pattern

   !> Whether what was analysed is the pattern of a matrix.
   pure logical function is_for(self, lower, tail, joined)
      class(linear_solver_type), intent(in) :: self      !! analysed
      type(sparse_matrix_type), intent(in) :: lower      !! lower triangle by rows
      integer, intent(in) :: tail                        !! number of tail unknowns
      integer, intent(in) :: joined                      !! unknowns that are eliminated last

      is_for = tail == self%tail .and. joined == self%joined .and. &
         size(lower%row_start) == size(self%row_start) .and. &
         size(lower%column) == size(self%column)
      if (is_for) is_for = all(lower%row_start == self%row_start) .and. &
         all(lower%column == self%column)
   end function is_for

end module linear_solver
