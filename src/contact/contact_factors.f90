!> Factors of the rows of an active set (contact_system). From set to set only a few rows change.
!> Let M be the matrix of all rows of the tail, those that are not sought being sigma_i d_i = 0.
!> Another set has
!>
!>    M + E D,   E the unit columns of the changed rows, D their differences,
!>
!> and by Woodbury's formula its solutions are y - M^-1 E (1 + D M^-1 E)^-1 D y, M y the forces. So
!> the first set of many is factored; the next ones cost a few solutions with it.
!>
!> Rows of a sparse tail are factored by contact_fronts.
module contact_factors
   use contact_fronts, only: contact_fronts_type
   use contact_system, only: contact_rows_type, contact_system_type, differ
   use dense, only: lu_type, product_of, transposed_product
   use kinds, only: dp
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: contact_factors_type

   integer, parameter :: rows_per_change = 16   !! free rows for each one that may change
   !> Entry of 1 + D M^-1 E from which the first set is too near to a singular one.
   real(dp), parameter :: most_growth = 1.0e6_dp

   !> Factors of one set, and what makes them those of another.
   type :: contact_factors_type
      integer :: full = 0                          !! sets that were factored in full, so far
      real(dp), private :: border = 1.0_dp         !! scale of the border [force/length]
      logical, private :: may_change = .false.     !! whether other sets may use the factors
      type(lu_type), private :: lu                 !! on the free rows, bordered
      !> Those of a sparse tail, for which all of the rest is unallocated
      type(contact_fronts_type), allocatable, private :: fronts
      type(contact_rows_type), private :: rows     !! that were factored
      real(dp), allocatable, private :: scale(:)   !! (free) factor of the rows, 1 beside a border
      integer, private :: borders = 0              !! motions that border them
      integer, allocatable, private :: free(:)     !! of the present set
      integer, allocatable, private :: entering(:) !! rows that are free now and were not
      real(dp), allocatable, private :: sigma(:)   !! (entering) [force/length]
      real(dp), allocatable, private :: of_entering(:, :)     !! (free, entering) their columns
      real(dp), allocatable, private :: difference(:, :)      !! (tail, changed) D^T
      real(dp), allocatable, private :: response(:, :)        !! (tail, changed) M^-1 E
      type(lu_type), private :: correction         !! 1 + D M^-1 E
   contains
      procedure :: factor
      procedure :: solve
      procedure :: solve_part
      procedure :: solve_transposed
      procedure :: is_negative
   end type contact_factors_type

contains

   !> Factors the rows of a set, bordered by the motions that it leaves unconstrained.
   pure subroutine factor(self, system, rows, hold, unconstrained, singular)
      class(contact_factors_type), intent(inout) :: self   !! of another set, or none
      type(contact_system_type), intent(in) :: system      !! the reduced system
      type(contact_rows_type), intent(in) :: rows
      real(dp), intent(in) :: hold                         !! soft one of the motions [force/length]
      type(sum_list_type), intent(in) :: unconstrained     !! (l, tail)
      logical, intent(out) :: singular                     !! the rows depend on each other
      logical :: is_plain

      if (system%schur%is_sparse()) then
         if (.not. allocated(self%fronts)) allocate (self%fronts)
         call self%fronts%factor(system, rows, hold, unconstrained, singular)
         self%full = self%fronts%full
         return
      end if
      ! Rows in cycles are 1e8 times as large as others, and links have no stiffness.
      is_plain = hold <= 0.0_dp .and. unconstrained%count == 0 .and. size(system%link) == 0 &
         .and. .not. any(system%compliance > 0.0_dp)
      if (self%may_change .and. is_plain) then
         call change_rows(self, system, rows, singular)
         if (.not. singular) return
      end if
      call factor_in_full(self, system, rows, hold, unconstrained, singular)
      self%may_change = is_plain .and. .not. singular
   end subroutine factor

   !> Factors the rows of a set in full.
   pure subroutine factor_in_full(self, system, rows, hold, unconstrained, singular)
      type(contact_factors_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      type(contact_rows_type), intent(in) :: rows
      real(dp), intent(in) :: hold
      type(sum_list_type), intent(in) :: unconstrained
      logical, intent(out) :: singular
      real(dp) :: matrix(size(rows%free) + unconstrained%count, size(rows%free) + &
         unconstrained%count)
      real(dp), allocatable :: columns(:, :)
      integer :: i, j

      self%full = self%full + 1
      self%rows = rows
      self%free = rows%free
      self%borders = unconstrained%count
      self%entering = [integer ::]
      if (allocated(self%difference)) deallocate (self%difference)
      associate (f => size(rows%free), free => rows%free)
         columns = system%schur%columns(free)
         if (hold > 0.0_dp) then
            associate (basis => system%motions%basis%as_columns(size(columns, 1)))
               columns = columns + hold*matmul(basis, transpose(basis(free, :)))
            end associate
         end if
         columns = rows%combine(columns)
         do j = 1, f
            matrix(:f, j) = columns(free, j)
            matrix(f + 1:, j) = 0.0_dp
            matrix(j, j) = matrix(j, j) + rows%spring(free(j))
         end do
         matrix(:, f + 1:) = 0.0_dp
         ! Rows of slipping contact points are mu times as large, those of stuck ones in cycles 1e8
         ! times.
         self%scale = [(1.0_dp, i=1, f)]
         if (unconstrained%count == 0) self%scale = 1.0_dp/max(maxval(abs(matrix(:f, :f)), &
            dim=2), tiny(1.0_dp))
         do j = 1, f
            matrix(:f, j) = self%scale*matrix(:f, j)
         end do
         ! A body that nothing holds has no stiffness to compare with.
         self%border = maxval(abs(matrix))
         if (self%border < tiny(1.0_dp)) self%border = 1.0_dp
         columns = self%border*unconstrained%as_columns(size(columns, 1))
         matrix(:f, f + 1:) = columns(free, :)
         matrix(f + 1:, :f) = transpose(columns(free, :))
      end associate
      call self%lu%factor(matrix, singular)
   end subroutine factor_in_full

   !> Makes the factors those of another set.
   pure subroutine change_rows(self, system, rows, failed)
      type(contact_factors_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      type(contact_rows_type), intent(in) :: rows
      !> Too many rows change, or one of the sets is all but singular
      logical, intent(out) :: failed
      logical, dimension(size(rows%spring)) :: is_free, was_free
      integer, allocatable :: changed(:)
      real(dp), allocatable :: columns(:, :), matrix(:, :)
      integer :: i, j

      is_free = rows%is_free()
      was_free = self%rows%is_free()
      changed = pack([(i, i=1, size(is_free))], differ(rows, self%rows))
      failed = rows_per_change*size(changed) > size(self%rows%free)
      if (failed) return
      self%free = rows%free
      self%entering = pack(changed, .not. was_free(changed))
      self%sigma = system%own(self%entering)
      failed = any(self%sigma <= 0.0_dp)
      if (failed) return
      columns = self%rows%combine(system%schur%columns(self%entering))
      self%of_entering = columns(self%rows%free, :)
      deallocate (columns)
      allocate (columns(size(is_free), size(changed)), source=0.0_dp)
      do j = 1, size(changed)
         columns(changed(j), j) = 1.0_dp
      end do
      call solve_base(self, columns)
      self%response = columns
      do j = 1, size(changed)
         columns(:, j) = row_of(system, rows, changed(j), is_free) - row_of(system, self%rows, &
            changed(j), was_free)
      end do
      self%difference = columns
      matrix = transposed_product(self%difference, self%response)
      do j = 1, size(changed)
         matrix(j, j) = matrix(j, j) + 1.0_dp
      end do
      failed = any(abs(matrix) > most_growth)
      if (.not. failed) call self%correction%factor(matrix, failed)
   end subroutine change_rows

   !> A row of M, in a column.
   pure function row_of(system, rows, i, is_free) result(row)
      type(contact_system_type), intent(in) :: system
      type(contact_rows_type), intent(in) :: rows
      integer, intent(in) :: i
      logical, intent(in) :: is_free(:)
      real(dp) :: row(size(is_free))
      integer :: t

      row = 0.0_dp
      if (is_free(i)) then
         do t = rows%forces%start(i), rows%forces%start(i + 1) - 1
            call system%schur%add_row(rows%forces%value(t), rows%forces%coefficient(t), row)
         end do
         row(i) = row(i) + rows%spring(i)
      else
         row(i) = system%own(i)
      end if
   end function row_of

   !> Solves with the rows that were factored, and with those that enter.
   pure subroutine solve_base(self, x, unbalanced)
      type(contact_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:, :)
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp) :: rows(size(self%scale) + self%borders, size(x, 2))
      integer :: j

      associate (f => size(self%scale), base => self%rows%free, entering => self%entering)
         rows(f + 1:, :) = 0.0_dp
         do j = 1, size(entering)
            x(entering(j), :) = x(entering(j), :)/self%sigma(j)
         end do
         rows(:f, :) = x(base, :)
         if (size(entering) > 0) rows(:f, :) = rows(:f, :) - product_of(self%of_entering, &
            x(entering, :))
         do j = 1, size(x, 2)
            rows(:f, j) = self%scale*rows(:f, j)
         end do
         if (size(rows, 1) > 0) call self%lu%solve(rows)
         x(base, :) = rows(:f, :)
         if (present(unbalanced)) unbalanced = self%border*rows(f + 1:, :)
      end associate
   end subroutine solve_base

   !> Free displacements that take up forces.
   pure subroutine solve(self, x, unbalanced)
      class(contact_factors_type), intent(in) :: self
      !> (tail, columns) forces as they enter the rows in; displacements in the free rows out
      real(dp), intent(inout) :: x(:, :)
      !> (l, columns) forces along the unconstrained motions that nothing takes up
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp) :: taken(size(x, 1), size(x, 2))
      real(dp), allocatable :: heads(:, :)

      if (allocated(self%fronts)) then
         call self%fronts%solve(x, unbalanced)
         return
      end if
      taken = 0.0_dp
      taken(self%free, :) = x(self%free, :)
      call solve_base(self, taken, unbalanced)
      if (allocated(self%difference)) then
         heads = transposed_product(self%difference, taken)
         call self%correction%solve(heads)
         taken = taken - product_of(self%response, heads)
      end if
      x(self%free, :) = taken(self%free, :)
   end subroutine solve

   !> Displacements of some rows for forces on them alone.
   pure function solve_part(self, rows, forces) result(part)
      class(contact_factors_type), intent(in) :: self
      integer, intent(in) :: rows(:)                !! (m)
      real(dp), intent(in) :: forces(:, :)          !! (m, n) as they enter the rows
      real(dp) :: part(size(rows), size(forces, 2)) !! (m, n) 0 in rows that are not free
      real(dp), allocatable :: x(:, :)
      logical, allocatable :: is_free(:)
      integer :: i

      if (allocated(self%fronts)) then
         part = self%fronts%solve_part(rows, forces)
         return
      end if
      allocate (x(size(self%rows%spring), size(forces, 2)), source=0.0_dp)
      x(rows, :) = forces
      call self%solve(x)
      allocate (is_free(size(x, 1)), source=.false.)
      is_free(self%free) = .true.
      do i = 1, size(rows)
         part(i, :) = merge(x(rows(i), :), 0.0_dp, is_free(rows(i)))
      end do
   end function solve_part

   !> The transposed of solve, on a sparse tail.
   pure subroutine solve_transposed(self, x)
      class(contact_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:)   !! (tail) as contact_fronts has it

      call self%fronts%solve_transposed(x)
   end subroutine solve_transposed

   !> Whether the determinant of the free rows, with their border, is negative.
   pure logical function is_negative(self)
      class(contact_factors_type), intent(in) :: self

      if (allocated(self%fronts)) then
         is_negative = self%fronts%is_negative()
         return
      end if
      is_negative = self%lu%negative_determinant()
      if (allocated(self%difference)) is_negative = is_negative .neqv. &
         self%correction%negative_determinant()
   end function is_negative

end module contact_factors
