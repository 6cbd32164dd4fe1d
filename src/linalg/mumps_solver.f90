!> Direct solver on sequential MUMPS. The only module that sees MUMPS.
!>
!> Debian's MUMPS is built without METIS, so METIS's order is computed here and handed over as
!> PERM_IN. MUMPS factors the leading block and returns its Schur complement; the tail is factored
!> by Crout, as in the skyline solver. MUMPS refuses a matrix without leading unknowns.
module mumps_solver
   use errors, only: error_type, set_error, status_deck, status_internal
   use interruption, only: c_end_without_memory
   use kinds, only: dp, long
   use linear_solver, only: check_pattern, linear_solver_type
   use ordering, only: adjacency, alike_unknowns, nested_dissection, positions_by_rank
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   use text, only: to_text
   implicit none
   private
   public :: mumps_solver_type, mumps_version, schur_complement

   include 'dmumps_struc.h'

   interface
      subroutine dmumps(id)
         import :: dmumps_struc
         type(dmumps_struc), intent(inout) :: id
      end subroutine dmumps
   end interface

   integer, parameter :: job_start = -1, job_analyse = 1, job_factor = 2
   integer, parameter :: job_solve = 3, job_end = -2
   integer, parameter :: factors_are_dropped = 1   !! ICNTL(31)
   integer, parameter :: rhs_is_sparse = 1         !! ICNTL(20)
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
      procedure :: analyse
      procedure :: factor
      procedure :: condense
      procedure :: recover
      procedure :: release
   end type mumps_solver_type

contains

   !> As analyse_interface of linear_solver says.
   subroutine analyse(self, lower, tail, rank, error)
      class(mumps_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      integer, intent(in) :: tail
      integer, allocatable, intent(inout) :: rank(:)
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: group(:), position(:)

      call start(self, lower%row_count, tail)
      self%row_start = lower%row_start
      self%column = lower%column
      if (.not. allocated(rank)) then
         group = alike_unknowns(lower, self%order - tail - self%joined)
         call nested_dissection(adjacency(lower, group), position, error)
         if (allocated(error)) return
         rank = [position(group), spread(size(position) + 1, 1, self%joined)]
      end if
      call set_positions(self%mumps, lower)
      call analyse_positions(self, rank, error)
      deallocate (self%mumps%irn, self%mumps%jcn)
   end subroutine analyse

   !> As factor_interface of linear_solver says.
   subroutine factor(self, lower, error)
      class(mumps_solver_type), intent(inout) :: self
      type(sparse_matrix_type), intent(in) :: lower
      type(error_type), allocatable, intent(out) :: error

      call check_pattern(self, lower, error)
      if (allocated(error)) return
      call set_positions(self%mumps, lower)
      allocate (self%mumps%a(size(lower%value)))
      self%mumps%a(:) = lower%value
      call factor_values(self, error)
      ! Solutions need the factors alone.
      deallocate (self%mumps%irn, self%mumps%jcn, self%mumps%a)
      if (allocated(error)) return
      self%full_flops = int(self%mumps%rinfog(3), long)
      ! RINFOG(19) is of the matrix as MUMPS has scaled it, rows and columns to about 1.
      if (self%mumps%rinfog(19) > 0.0_dp) self%smallest_pivot = min(1.0_dp, self%mumps%rinfog(19))
      self%factor_bytes = factor_entries(self%mumps%infog(9))*storage_size(1.0_dp)/8
   end subroutine factor

   !> Rows and columns of the entries, which MUMPS reads anew with each set of values.
   subroutine set_positions(id, lower)
      type(dmumps_struc), intent(inout) :: id
      type(sparse_matrix_type), intent(in) :: lower
      integer :: i

      allocate (id%irn(size(lower%value)), id%jcn(size(lower%value)))
      do i = 1, lower%row_count
         id%irn(lower%row_start(i):lower%row_start(i + 1) - 1) = i
      end do
      id%jcn(:) = lower%column
   end subroutine set_positions

   !> Schur complement of a matrix on its tail, without factors to solve with.
   !> Errors: the matrix is not positive definite, MUMPS failed.
   subroutine schur_complement(entries, rank, tail, schur, error)
      type(triplet_list_type), intent(in), target :: entries !! lower triangle
      integer, intent(in) :: rank(:) !! (leading) in nested dissection, those of a node alike
      integer, intent(in) :: tail                            !! number of tail unknowns, the last
      real(dp), allocatable, intent(out) :: schur(:, :)      !! (tail, tail) both triangles
      type(error_type), allocatable, intent(out) :: error
      type(mumps_solver_type) :: solver

      call start(solver, size(rank) + tail, tail)
      solver%mumps%icntl(31) = factors_are_dropped
      solver%mumps%irn => entries%row
      solver%mumps%jcn => entries%column
      solver%mumps%a => entries%value
      call analyse_positions(solver, rank, error)
      if (.not. allocated(error)) call factor_values(solver, error)
      nullify (solver%mumps%irn, solver%mumps%jcn, solver%mumps%a)
      call solver%release()
      if (.not. allocated(error)) call move_alloc(solver%schur, schur)
   end subroutine schur_complement

   !> Analyses the pattern that is in place: the leading block by ranks, the tail behind it, of
   !> which MUMPS is to return the Schur complement.
   subroutine analyse_positions(self, rank, error)
      type(mumps_solver_type), intent(inout) :: self
      integer, intent(in) :: rank(:)                  !! (leading)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%mumps%nnz = size(self%mumps%irn, kind=long)
      allocate (self%mumps%perm_in(self%order))
      self%mumps%perm_in(:) = positions_by_rank(rank, self%order)
      self%mumps%icntl(7) = order_given
      if (self%tail > 0) then
         ! The lower triangle of the Schur complement by rows, our upper triangle by columns.
         self%mumps%icntl(19) = 1
         self%mumps%size_schur = self%tail
         allocate (self%mumps%listvar_schur(self%tail))
         self%mumps%listvar_schur(:) = [(i, i=self%order - self%tail + 1, self%order)]
      end if
      self%mumps%job = job_analyse
      call call_mumps(self%mumps)
      call check(self, 'analysis', error)
      if (allocated(error)) return
      if (self%mumps%infog(7) /= order_given) call set_error(error, status_internal, &
         'MUMPS did not take the order of METIS')
   end subroutine analyse_positions

   !> Factors the values that are in place and copies their Schur complement.
   subroutine factor_values(self, error)
      type(mumps_solver_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: attempt, j, tail

      tail = self%tail
      if (allocated(self%schur)) deallocate (self%schur)
      if (.not. associated(self%mumps%schur)) allocate (self%mumps%schur(tail**2))
      self%mumps%job = job_factor
      do attempt = 1, workspace_tries
         call call_mumps(self%mumps)
         if (self%mumps%infog(1) /= -9 .and. self%mumps%infog(1) /= -8) exit
         self%mumps%icntl(14) = 2*self%mumps%icntl(14) + 20
      end do
      call check(self, 'factorisation', error)
      if (allocated(error)) return
      if (self%mumps%infog(12) > 0 .or. self%mumps%infog(28) > 0) then
         if (self%mumps%infog(28) > 0) self%lost_unknown = self%mumps%pivnul_list(1)
         call set_error(error, status_deck, unheld)
         return
      end if
      allocate (self%schur(tail, tail))
      do j = 1, tail
         self%schur(:, j) = self%mumps%schur(tail*(j - 1) + 1:tail*j)
         self%schur(j, :j) = self%schur(:j, j)
      end do
      deallocate (self%mumps%schur)
   end subroutine factor_values

   !> Version of MUMPS.
   function mumps_version() result(version)
      character(:), allocatable :: version   !! such as 5.5.1
      type(mumps_solver_type) :: solver

      call start(solver, 0, 0)
      version = trim(solver%mumps%version_number)
      call solver%release()
   end function mumps_version

   !> A job of MUMPS. Where memory runs out, which a solution would not tell, the process ends as
   !> where the program's own does.
   subroutine call_mumps(id)
      type(dmumps_struc), intent(inout) :: id
      integer, parameter :: no_memory = -13   ! INFOG(1); INFOG(2) entries were asked for

      call dmumps(id)
      if (id%infog(1) == no_memory) call c_end_without_memory(real(factor_entries(id%infog(2))* &
         storage_size(1.0_dp)/8, dp))
   end subroutine call_mumps

   !> INFOG(9): entries of the factors, in millions where negative.
   pure function factor_entries(reported) result(entries)
      integer, intent(in) :: reported
      integer(long) :: entries

      entries = reported
      if (reported < 0) entries = -1000000_long*reported
   end function factor_entries

   !> A silent instance on one process. The matrix is positive definite; that it be not, MUMPS only
   !> tells when it takes it for a general symmetric one.
   subroutine start(self, order, tail)
      type(mumps_solver_type), intent(inout) :: self
      integer, intent(in) :: order, tail

      self%order = order
      self%tail = tail
      allocate (self%mumps)
      associate (id => self%mumps)
         id%comm = 0
         id%sym = 2
         id%par = 1
         id%job = job_start
         call call_mumps(id)
         id%icntl(1:3) = -1
         id%icntl(4) = 0
         id%icntl(24) = 1
         id%n = order
      end associate
   end subroutine start

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
      case (-8, -9)
         call set_error(error, status_deck, 'MUMPS finds no sequence of pivots: entries of the '// &
            'matrix are too many orders of magnitude apart; check the values and units of '// &
            'materials and loads')
      case default
         call set_error(error, status_internal, 'MUMPS failed in its '//phase// &
            ' with INFOG(1) = '//to_text(self%mumps%infog(1))// &
            ', INFOG(2) = '//to_text(self%mumps%infog(2)))
      end select
   end subroutine check

   !> As condense_interface of linear_solver says.
   subroutine condense(self, rhs, condensed, welded)
      class(mumps_solver_type), intent(in) :: self
      real(dp), intent(in) :: rhs(:, :)
      real(dp), intent(out) :: condensed(:, :)
      real(dp), intent(out), optional :: welded(:, :)
      real(dp) :: zero(self%tail, size(rhs, 2))
      integer :: k

      call eliminate(self, size(rhs, 2), rhs)
      do k = 1, size(rhs, 2)
         condensed(:, k) = self%mumps%redrhs(self%tail*(k - 1) + 1:self%tail*k)
      end do
      if (.not. present(welded)) return
      zero = 0.0_dp
      call substitute(self, zero, welded)
   end subroutine condense

   !> As recover_interface of linear_solver says.
   subroutine recover(self, on_tail, solution, rhs)
      class(mumps_solver_type), intent(in) :: self
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      real(dp), intent(in), optional :: rhs(:, :)

      call eliminate(self, size(on_tail, 2), rhs)
      call substitute(self, on_tail, solution)
   end subroutine recover

   !> Eliminates right-hand sides forward, or none. Without a tail the substitution does both.
   subroutine eliminate(self, columns, rhs)
      type(mumps_solver_type), intent(in) :: self
      integer, intent(in) :: columns
      real(dp), intent(in), optional :: rhs(:, :)
      integer :: k

      call make_room(self%mumps, self%tail, columns)
      associate (id => self%mumps)
         id%job = job_solve
         if (present(rhs)) then
            do k = 1, columns
               id%rhs(id%n*(k - 1) + 1:id%n*k) = rhs(:, k)
            end do
         else
            id%rhs(:) = 0.0_dp
         end if
         if (self%tail == 0) return
         ! MUMPS skips what a sparse right-hand side does not reach: all of the leading rows.
         id%icntl(20) = merge(0, rhs_is_sparse, present(rhs))
         id%irhs_ptr(:) = [1, (2, k=1, columns)]
         id%icntl(26) = 1
         call call_mumps(id)
         id%icntl(20) = 0
      end associate
   end subroutine eliminate

   !> Substitutes back from the tail.
   subroutine substitute(self, on_tail, solution)
      type(mumps_solver_type), intent(in) :: self
      real(dp), intent(in) :: on_tail(:, :)
      real(dp), intent(out) :: solution(:, :)
      integer :: k

      associate (id => self%mumps)
         do k = 1, size(on_tail, 2)
            id%redrhs(self%tail*(k - 1) + 1:self%tail*k) = on_tail(:, k)
         end do
         if (self%tail > 0) id%icntl(26) = 2
         call call_mumps(id)
         do k = 1, size(solution, 2)
            solution(:, k) = id%rhs(id%n*(k - 1) + 1:id%n*k)
         end do
      end associate
   end subroutine substitute

   !> Room for right-hand sides, also condensed ones, and for a sparse one with a zero on the tail.
   subroutine make_room(id, tail, columns)
      type(dmumps_struc), intent(inout) :: id
      integer, intent(in) :: tail, columns

      if (associated(id%rhs)) then
         if (size(id%rhs) /= id%n*columns) deallocate (id%rhs, id%redrhs, id%irhs_ptr, &
            id%irhs_sparse, id%rhs_sparse)
      end if
      if (.not. associated(id%rhs)) then
         allocate (id%rhs(id%n*columns), id%redrhs(tail*columns), id%irhs_ptr(columns + 1))
         allocate (id%irhs_sparse(1), source=id%n)
         allocate (id%rhs_sparse(1), source=0.0_dp)
      end if
      id%nz_rhs = 1
      id%nrhs = columns
      id%lrhs = id%n
      id%lredrhs = tail
   end subroutine make_room

   !> MUMPS keeps memory of its own, and finalisers are not to be relied on.
   subroutine release(self)
      class(mumps_solver_type), intent(inout) :: self

      if (.not. associated(self%mumps)) return
      self%mumps%job = job_end
      call call_mumps(self%mumps)
      associate (id => self%mumps)
         if (associated(id%perm_in)) deallocate (id%perm_in)
         if (associated(id%schur)) deallocate (id%schur)
         if (associated(id%listvar_schur)) deallocate (id%listvar_schur)
         if (associated(id%rhs)) deallocate (id%rhs, id%redrhs, id%irhs_ptr, id%irhs_sparse, &
            id%rhs_sparse)
      end associate
      deallocate (self%mumps)
   end subroutine release

end module mumps_solver
