!> Direct solver on sequential MUMPS. The only module that sees MUMPS.
!>
!> Debian's MUMPS is built without METIS, so METIS's order is computed here and handed over as
!> PERM_IN. MUMPS factors the leading block and returns its Schur complement; the tail is factored
!> by Crout, as in the skyline solver.
module mumps_solver
   use errors, only: error_type, set_error, status_deck, status_internal
   use kinds, only: dp, long
   use linear_solver, only: linear_solver_type
   use metis, only: nested_dissection
   use ordering, only: adjacency
   use sparse_matrix, only: sparse_matrix_type
   use text, only: to_text
   implicit none
   private
   public :: mumps_solver_type, mumps_version

   include 'dmumps_struc.h'

   interface
      subroutine dmumps(id)
         import :: dmumps_struc
         type(dmumps_struc), intent(inout) :: id
      end subroutine dmumps
   end interface

   integer, parameter :: job_start = -1, job_analyse = 1, job_factor = 2
   integer, parameter :: job_solve = 3, job_end = -2
   integer, parameter :: order_given = 1       !! ICNTL(7) and INFOG(7): the order of PERM_IN
   integer, parameter :: workspace_tries = 5   !! how often ICNTL(14) is raised

   !> Message for a matrix that is not positive definite.
   character(*), parameter :: unheld = &
      'singular matrix: a body is not held by its supports and contacts, or far too weakly'

   !> MUMPS's factors behind the common interface.
   type, extends(linear_solver_type) :: mumps_solver_type
      private
      type(dmumps_struc), pointer :: mumps => null()   !! MUMPS's own data
   contains
      procedure :: factor
      procedure :: condense
      procedure :: recover
      procedure :: release
   end type mumps_solver_type

contains

   !> As factor_interface of linear_solver says.
   subroutine factor(self, lower, tail, error)
      class(mumps_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer, intent(in) :: tail
      type(error_type), allocatable, intent(out) :: error
      integer :: attempt, j

      self%order = lower%row_count
      self%tail = tail
      call start(self, lower)
      call hand_over_order(self, lower, error)
      if (allocated(error)) return
      if (tail > 0) call ask_for_schur(self)
      self%mumps%job = job_analyse
      call dmumps(self%mumps)
      call check(self, 'analysis', error)
      if (allocated(error)) return
      if (self%mumps%infog(7) /= order_given) then
         call set_error(error, status_internal, 'MUMPS did not take the order of METIS')
         return
      end if
      self%mumps%job = job_factor
      do attempt = 1, workspace_tries
         call dmumps(self%mumps)
         if (self%mumps%infog(1) /= -9 .and. self%mumps%infog(1) /= -8) exit
         self%mumps%icntl(14) = 2*self%mumps%icntl(14) + 20
      end do
      call check(self, 'factorisation', error)
      if (allocated(error)) return
      if (self%mumps%infog(12) > 0 .or. self%mumps%infog(28) > 0) then
         call set_error(error, status_deck, unheld)
         return
      end if
      self%full_flops = int(self%mumps%rinfog(3), long)
      ! RINFOG(19) is of the matrix as MUMPS has scaled it, rows and columns to about 1.
      if (self%mumps%rinfog(19) > 0.0_dp) self%smallest_pivot = min(1.0_dp, self%mumps%rinfog(19))
      self%factor_bytes = factor_entries(self%mumps%infog(9))*storage_size(1.0_dp)/8
      allocate (self%schur(tail, tail))
      self%schur(:, :) = reshape(self%mumps%schur(:tail*tail), [tail, tail])
      do j = 1, tail
         self%schur(j, :j) = self%schur(:j, j)
      end do
   end subroutine factor

   !> Version of MUMPS.
   function mumps_version() result(version)
      character(:), allocatable :: version   !! such as 5.5.1
      type(dmumps_struc) :: id

      id%comm = 0
      id%sym = 0
      id%par = 1
      id%job = job_start
      call dmumps(id)
      id%icntl(1:3) = -1
      version = trim(id%version_number)
      id%job = job_end
      call dmumps(id)
   end function mumps_version

   !> INFOG(9): entries of the factors, in millions where negative.
   pure function factor_entries(reported) result(entries)
      integer, intent(in) :: reported
      integer(long) :: entries

      entries = reported
      if (reported < 0) entries = -1000000_long*reported
   end function factor_entries

   !> A silent instance on one process, with the matrix in place. The matrix is positive definite;
   !> that it be not, MUMPS only tells when it takes it for a general symmetric one.
   subroutine start(self, lower)
      type(mumps_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer :: i

      allocate (self%mumps)
      associate (id => self%mumps)
         id%comm = 0
         id%sym = 2
         id%par = 1
         id%job = job_start
         call dmumps(id)
         id%icntl(1:3) = -1
         id%icntl(4) = 0
         id%icntl(24) = 1
         id%n = lower%row_count
         id%nnz = size(lower%value, kind=long)
         allocate (id%irn(size(lower%value)), id%jcn(size(lower%value)), id%a(size(lower%value)))
         do i = 1, lower%row_count
            id%irn(lower%row_start(i):lower%row_start(i + 1) - 1) = i
         end do
         id%jcn(:) = lower%column
         id%a(:) = lower%value
         allocate (id%schur(self%tail**2))
      end associate
   end subroutine start

   !> METIS's order for the leading block, the tail behind it.
   subroutine hand_over_order(self, lower, error)
      type(mumps_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error
      integer :: i, leading
      logical :: failed

      leading = self%order - self%tail
      allocate (self%mumps%perm_in(self%order))
      call nested_dissection(adjacency(lower, leading), self%mumps%perm_in(:leading), failed)
      if (failed) then
         call set_error(error, status_internal, 'METIS could not order the unknowns')
         return
      end if
      self%mumps%perm_in(leading + 1:) = [(i, i=leading + 1, self%order)]
      self%mumps%icntl(7) = order_given
   end subroutine hand_over_order

   !> Asks for the Schur complement of the tail: its lower triangle by rows, our upper triangle by
   !> columns.
   subroutine ask_for_schur(self)
      type(mumps_solver_type), intent(inout) :: self
      integer :: i

      associate (id => self%mumps)
         id%icntl(19) = 1
         id%size_schur = self%tail
         allocate (id%listvar_schur(self%tail))
         id%listvar_schur(:) = [(i, i=self%order - self%tail + 1, self%order)]
      end associate
   end subroutine ask_for_schur

   !> Turns what MUMPS reports into an error.
   subroutine check(self, phase, error)
      type(mumps_solver_type), intent(in) :: self
      character(*), intent(in) :: phase
      type(error_type), allocatable, intent(out) :: error

      select case (self%mumps%infog(1))
      case (0:)
         return
      case (-10, -40)
         call set_error(error, status_deck, unheld)
      case default
         call set_error(error, status_internal, 'MUMPS failed in its '//phase// &
            ' with INFOG(1) = '//to_text(self%mumps%infog(1))// &
            ', INFOG(2) = '//to_text(self%mumps%infog(2)))
      end select
   end subroutine check

   !> As condense_interface of linear_solver says.
   subroutine condense(self, rhs, condensed)
      class(mumps_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: condensed(:, :)

      if (self%tail == 0) return
      call load_rhs(self%mumps, self%tail, rhs)
      self%mumps%icntl(26) = 1
      self%mumps%job = job_solve
      call dmumps(self%mumps)
      condensed = reshape(self%mumps%redrhs, [self%tail, size(rhs, 2)])
   end subroutine condense

   !> As recover_interface of linear_solver says.
   subroutine recover(self, rhs, on_tail, solution)
      class(mumps_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)

      call load_rhs(self%mumps, self%tail, rhs)
      self%mumps%job = job_solve
      if (self%tail > 0) then
         self%mumps%icntl(26) = 1
         call dmumps(self%mumps)
         self%mumps%redrhs(:) = reshape(on_tail, [size(on_tail)])
         self%mumps%icntl(26) = 2
      end if
      call dmumps(self%mumps)
      solution = reshape(self%mumps%rhs, shape(solution))
   end subroutine recover

   !> Hands right-hand sides to MUMPS, with room for the condensed ones.
   subroutine load_rhs(id, tail, rhs)
      type(dmumps_struc), intent(inout) :: id
      integer, intent(in) :: tail
      real(dp), intent(in) :: rhs(:, :)

      if (associated(id%rhs)) then
         if (size(id%rhs) /= size(rhs)) deallocate (id%rhs, id%redrhs)
      end if
      if (.not. associated(id%rhs)) then
         allocate (id%rhs(size(rhs)), id%redrhs(tail*size(rhs, 2)))
      end if
      id%rhs(:) = reshape(rhs, [size(rhs)])
      id%nrhs = size(rhs, 2)
      id%lrhs = id%n
      id%lredrhs = tail
   end subroutine load_rhs

   !> MUMPS keeps memory of its own, and finalisers are not to be relied on.
   subroutine release(self)
      class(mumps_solver_type), intent(inout) :: self

      if (.not. associated(self%mumps)) return
      self%mumps%job = job_end
      call dmumps(self%mumps)
      associate (id => self%mumps)
         if (associated(id%irn)) deallocate (id%irn, id%jcn, id%a, id%perm_in, id%schur)
         if (associated(id%listvar_schur)) deallocate (id%listvar_schur)
         if (associated(id%rhs)) deallocate (id%rhs, id%redrhs)
      end associate
      deallocate (self%mumps)
   end subroutine release

end module mumps_solver
