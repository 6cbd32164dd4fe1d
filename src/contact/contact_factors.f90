!> Factors of the rows of an active set (contact_system). From set to set only a few rows change.
!> Let M be the matrix of all rows of the tail, those that are not sought being sigma_i d_i = 0.
!> Another set has
!>
!>    M + E D,   E the unit columns of the changed rows, D their differences,
!>
!> and by Woodbury's formula its solutions are y - M^-1 E (1 + D M^-1 E)^-1 D y, M y the forces. So
!> the first set of many is factored; the next ones cost a few solutions with it.
!>
!> Rows of a sparse tail are factored in their band. Where motions Z border them, A is singular, and
!> a band cannot hold the border. Then A is pinned at as many rows, A' = A + E W E^T; with the
!> border's unknowns mu and the pins' displacements xi
!>
!>    A' x = f - border Z mu + E W xi,   Z^T x = 0,   E^T x = xi.
module contact_factors
   use band_lu, only: band_lu_type
   use contact_system, only: contact_rows_type, contact_system_type
   use dense, only: lu_type, product_of, transposed_product
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: contact_factors_type

   integer, parameter :: rows_per_change = 16   !! free rows for each one that may change
   integer, parameter :: most_changes = 48      !! of rows of a sparse tail
   !> Entry of 1 + D M^-1 E from which the first set is too near to a singular one.
   real(dp), parameter :: most_growth = 1.0e6_dp

   !> Factors of one set, and what makes them those of another.
   type :: contact_factors_type
      integer :: full = 0                          !! sets that were factored in full, so far
      real(dp), private :: border = 1.0_dp         !! scale of the border [force/length]
      logical, private :: may_change = .false.     !! whether other sets may use the factors
      type(lu_type), private :: lu                 !! on the free rows, bordered
      logical, private :: is_banded = .false.      !! whether they are these instead:
      type(band_lu_type), private :: band          !! on the free rows, pinned where bordered
      !> (free, l) Z and E; (free, 2l) A'^-1 [border Z, -E W]
      real(dp), allocatable, private :: pins(:, :), of_border(:, :)
      type(lu_type), private :: of_unknowns        !! of mu and xi
      type(contact_rows_type), private :: rows     !! that were factored
      real(dp), allocatable, private :: scale(:)   !! (free) factor of the rows, 1 beside a border
      real(dp), allocatable, private :: unconstrained(:, :)   !! (free, l) motions that border them
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
      procedure :: is_negative
   end type contact_factors_type

contains

   !> Factors the rows of a set, bordered by the motions that it leaves unconstrained.
   pure subroutine factor(self, system, rows, hold, unconstrained, singular)
      class(contact_factors_type), intent(inout) :: self   !! of another set, or none
      type(contact_system_type), intent(in) :: system      !! the reduced system
      type(contact_rows_type), intent(in) :: rows
      real(dp), intent(in) :: hold                         !! soft one of the motions [force/length]
      real(dp), intent(in) :: unconstrained(:, :)          !! (free, l)
      logical, intent(out) :: singular                     !! the rows depend on each other
      logical :: is_plain

      is_plain = hold <= 0.0_dp .and. size(unconstrained, 2) == 0
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
      real(dp), intent(in) :: unconstrained(:, :)
      logical, intent(out) :: singular

      self%full = self%full + 1
      self%rows = rows
      self%free = rows%free
      self%unconstrained = unconstrained
      self%entering = [integer ::]
      if (allocated(self%difference)) deallocate (self%difference)
      self%is_banded = system%schur%is_sparse()
      if (self%is_banded) then
         call factor_band(self, system, hold, singular)
      else
         call factor_dense(self, system, hold, singular)
      end if
   end subroutine factor_in_full

   !> Factors the free rows of a full tail with their border.
   pure subroutine factor_dense(self, system, hold, singular)
      type(contact_factors_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: hold
      logical, intent(out) :: singular
      real(dp) :: matrix(size(self%free) + size(self%unconstrained, 2), size(self%free) + &
         size(self%unconstrained, 2))
      real(dp), allocatable :: columns(:, :)
      integer :: i, j

      associate (rows => self%rows, unconstrained => self%unconstrained, f => size(self%free), &
         free => self%free)
         columns = system%schur%columns(free)
         if (hold > 0.0_dp) columns = columns + &
            hold*matmul(system%motion, transpose(system%motion(free, :)))
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
         if (size(unconstrained, 2) == 0) self%scale = 1.0_dp/max(maxval(abs(matrix(:f, :f)), &
            dim=2), tiny(1.0_dp))
         do j = 1, f
            matrix(:f, j) = self%scale*matrix(:f, j)
         end do
         ! A body that nothing holds has no stiffness to compare with.
         self%border = maxval(abs(matrix))
         if (self%border < tiny(1.0_dp)) self%border = 1.0_dp
         matrix(:f, f + 1:) = self%border*unconstrained
         matrix(f + 1:, :f) = self%border*transpose(unconstrained)
      end associate
      call self%lu%factor(matrix, singular)
   end subroutine factor_dense

   !> Factors the free rows of a sparse tail in their band.
   pure subroutine factor_band(self, system, hold, singular)
      type(contact_factors_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: hold
      logical, intent(out) :: singular
      real(dp), allocatable :: unknowns(:, :)
      integer :: j, l
      integer, allocatable :: pin(:)

      l = size(self%unconstrained, 2)
      call form_rows(self, system, hold)
      self%scale = [(1.0_dp, j=1, size(self%free))]
      if (l == 0) then
         call self%band%factor(self%scale, singular)
         return
      end if
      pin = pinned_rows(self%unconstrained)
      self%border = max(maxval(abs(system%own)), tiny(1.0_dp))
      do j = 1, l
         call self%band%add(pin(j), pin(j), self%border)
      end do
      call self%band%factor(singular=singular)
      if (singular) return
      if (allocated(self%pins)) deallocate (self%pins)
      allocate (self%pins(size(self%free), l), source=0.0_dp)
      do j = 1, l
         self%pins(pin(j), j) = 1.0_dp
      end do
      self%of_border = reshape([self%border*self%unconstrained, -self%border*self%pins], &
         [size(self%free), 2*l])
      call self%band%solve(self%of_border)
      unknowns = reshape([transposed_product(self%of_border, self%unconstrained), &
         transposed_product(self%of_border, self%pins)], [2*l, 2*l])
      do j = 1, l
         unknowns(l + j, l + j) = unknowns(l + j, l + j) + 1.0_dp
      end do
      call self%of_unknowns%factor(transpose(unknowns), singular)
   end subroutine factor_band

   !> The free rows of a set.
   pure subroutine form_rows(self, system, hold)
      type(contact_factors_type), intent(inout) :: self  !! receives them in its band
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: hold
      integer :: i, pass, q, place(system%schur%order)
      integer, allocatable :: moved(:)

      place = 0
      place(self%free) = [(i, i=1, size(self%free))]
      call self%band%begin(system%schur%rank(self%free))
      do pass = 1, 2
         associate (rows => self%rows, free => self%free)
            do i = 1, size(free)
               call visit_row(system%schur%sparse, place, i, free(i), rows%own(free(i)), pass, &
                  self%band)
               if (rows%partner(free(i)) > 0) call visit_row(system%schur%sparse, place, i, &
                  rows%partner(free(i)), rows%share(free(i)), pass, self%band)
               if (pass == 2) call self%band%add(i, i, rows%spring(free(i)))
            end do
            do i = 1, size(rows%closing)
               do q = rows%arm%start(i), rows%arm%start(i + 1) - 1
                  call visit_row(system%schur%sparse, place, place(rows%closing(i)), &
                     rows%arm%value(q), rows%arm%coefficient(q), pass, self%band)
               end do
            end do
            if (hold <= 0.0_dp) cycle
            do q = 1, size(system%motion, 2)
               moved = pack(free, abs(system%motion(free, q)) > 0.0_dp)
               call visit_motion(place(moved), system%motion(moved, q), hold, pass, self%band)
            end do
         end associate
      end do
   end subroutine form_rows

   !> Widens the band for a row of S, or adds it, times a factor.
   pure subroutine visit_row(schur, place, to, from, factor, pass, band)
      type(sparse_matrix_type), intent(in) :: schur
      integer, intent(in) :: place(:)
      integer, intent(in) :: to, from, pass
      real(dp), intent(in) :: factor
      type(band_lu_type), intent(inout) :: band
      integer :: k

      do k = schur%row_start(from), schur%row_start(from + 1) - 1
         associate (column => place(schur%column(k)))
            if (column == 0) cycle
            if (pass == 1) then
               call band%reach(to, column)
            else
               call band%add(to, column, factor*schur%value(k))
            end if
         end associate
      end do
   end subroutine visit_row

   !> Widens the band for the soft hold of a motion, or adds it.
   pure subroutine visit_motion(rows, motion, hold, pass, band)
      integer, intent(in) :: rows(:)
      real(dp), intent(in) :: motion(:), hold
      integer, intent(in) :: pass
      type(band_lu_type), intent(inout) :: band
      integer :: i, j

      do j = 1, size(rows)
         do i = 1, size(rows)
            if (pass == 1) then
               call band%reach(rows(i), rows(j))
            else
               call band%add(rows(i), rows(j), hold*motion(i)*motion(j))
            end if
         end do
      end do
   end subroutine visit_motion

   !> Rows that tell motions apart, as many as there are motions.
   pure function pinned_rows(motions) result(pin)
      real(dp), intent(in) :: motions(:, :)     ! (n, l) that do not depend on each other
      integer :: pin(size(motions, 2))
      real(dp) :: left(size(motions, 1), size(motions, 2))
      integer :: j, k

      left = motions
      do j = 1, size(pin)
         pin(j) = maxloc(abs(left(:, j)), dim=1)
         do k = j + 1, size(pin)
            if (abs(left(pin(j), k)) > 0.0_dp) left(:, k) = left(:, k) - left(:, j)* &
               (left(pin(j), k)/left(pin(j), j))
         end do
      end do
   end function pinned_rows

   !> Makes the factors those of another set.
   pure subroutine change_rows(self, system, rows, failed)
      type(contact_factors_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      type(contact_rows_type), intent(in) :: rows
      !> Too many rows change, or one of the sets is all but singular
      logical, intent(out) :: failed
      logical :: in_cycle(0:size(rows%own))
      logical, dimension(size(rows%own)) :: is_free, was_free
      integer, allocatable :: changed(:)
      real(dp), allocatable :: columns(:, :), matrix(:, :)
      integer :: i, j

      is_free = .false.
      is_free(rows%free) = .true.
      was_free = .false.
      was_free(self%rows%free) = .true.
      changed = pack([(i, i=1, size(is_free))], (is_free .neqv. was_free) .or. (is_free .and. &
         differ(rows, self%rows)))
      ! Rows in cycles are 1e8 times as large as others.
      in_cycle = .false.
      in_cycle(pack(system%tangent, system%compliance > 0.0_dp)) = .true.
      failed = any(in_cycle(changed))
      if (failed) return
      failed = rows_per_change*size(changed) > size(self%rows%free) .or. &
         (self%is_banded .and. size(changed) > most_changes)
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

   !> Whether rows have other factors.
   pure function differ(a, b)
      type(contact_rows_type), intent(in) :: a, b
      logical :: differ(size(a%own))
      integer :: i, j

      differ = a%partner /= b%partner .or. abs(a%share - b%share) > 0.0_dp .or. &
         abs(a%own - b%own) > 0.0_dp .or. abs(a%spring - b%spring) > 0.0_dp
      do i = 1, size(a%closing)
         j = findloc(b%closing, a%closing(i), dim=1)
         if (j == 0) then
            differ(a%closing(i)) = .true.
         else
            differ(a%closing(i)) = differ(a%closing(i)) .or. .not. a%arm%is_sum_of(i, b%arm, j)
         end if
      end do
      do j = 1, size(b%closing)
         if (all(a%closing /= b%closing(j))) differ(b%closing(j)) = .true.
      end do
   end function differ

   !> A row of M, in a column.
   pure function row_of(system, rows, i, is_free) result(row)
      type(contact_system_type), intent(in) :: system
      type(contact_rows_type), intent(in) :: rows
      integer, intent(in) :: i
      logical, intent(in) :: is_free(:)
      real(dp) :: row(size(is_free))
      integer :: c, t

      row = 0.0_dp
      if (is_free(i)) then
         call system%schur%add_row(i, rows%own(i), row)
         if (rows%partner(i) > 0) call system%schur%add_row(rows%partner(i), rows%share(i), row)
         c = findloc(rows%closing, i, dim=1)
         if (c > 0) then
            do t = rows%arm%start(c), rows%arm%start(c + 1) - 1
               call system%schur%add_row(rows%arm%value(t), rows%arm%coefficient(t), row)
            end do
         end if
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
      real(dp) :: rows(size(self%scale) + size(self%unconstrained, 2), size(x, 2))
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
         if (self%is_banded) then
            call solve_band(self, rows)
         else if (size(rows, 1) > 0) then
            call self%lu%solve(rows)
         end if
         x(base, :) = rows(:f, :)
         if (present(unbalanced)) unbalanced = self%border*rows(f + 1:, :)
      end associate
   end subroutine solve_base

   !> Solves in the band, with the border's unknowns behind.
   pure subroutine solve_band(self, rows)
      type(contact_factors_type), intent(in) :: self
      real(dp), intent(inout) :: rows(:, :)        ! (free + l, columns)
      real(dp), allocatable :: x(:, :), unknowns(:, :)
      integer :: f, l

      f = size(self%scale)
      l = size(self%unconstrained, 2)
      x = rows(:f, :)
      call self%band%solve(x)
      if (l > 0) then
         allocate (unknowns(2*l, size(x, 2)))
         unknowns(:l, :) = transposed_product(self%unconstrained, x)
         unknowns(l + 1:, :) = transposed_product(self%pins, x)
         call self%of_unknowns%solve(unknowns)
         x = x - product_of(self%of_border, unknowns)
         rows(f + 1:, :) = unknowns(:l, :)
      end if
      rows(:f, :) = x
   end subroutine solve_band

   !> Free displacements that take up forces.
   pure subroutine solve(self, x, unbalanced)
      class(contact_factors_type), intent(in) :: self
      !> (tail, columns) forces as they enter the rows in; displacements in the free rows out
      real(dp), intent(inout) :: x(:, :)
      !> (l, columns) forces along the unconstrained motions that nothing takes up
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp) :: taken(size(x, 1), size(x, 2))
      real(dp), allocatable :: heads(:, :)

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

   !> Whether the determinant of the free rows, with their border, is negative.
   pure logical function is_negative(self)
      class(contact_factors_type), intent(in) :: self

      if (self%is_banded) then
         is_negative = self%band%negative_determinant()
         if (size(self%unconstrained, 2) > 0) is_negative = (is_negative .neqv. &
            self%of_unknowns%negative_determinant()) .neqv. mod(size(self%unconstrained, 2), 2) == 1
      else
         is_negative = self%lu%negative_determinant()
      end if
      if (allocated(self%difference)) is_negative = is_negative .neqv. &
         self%correction%negative_determinant()
   end function is_negative

end module contact_factors
