!> Factors of the rows of an active set on a sparse tail, front by front (front_factors). From set
!> to set the fronts of the rows that change are factored again, and those above them.
!>
!> With S of the tail, C the factors of forces in the rows and K their springs, the matrix is
!> C S + K on the free rows. Motions Z that nothing holds border it,
!>
!>    (C S + K) x + Z mu = f,   Z^T x = mu/hold,
!>
!> without a hold Z^T x = 0. Fronts stay from set to set where nothing borders them, or all motions
!> with the same hold.
module contact_fronts
   use contact_system, only: contact_rows_type, contact_system_type, differ
   use front_factors, only: front_factors_type
   use kinds, only: dp
   use sparse_matrix, only: triplet_list_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: contact_fronts_type

   !> Factors of one set.
   type :: contact_fronts_type
      integer :: full = 0                          !! sets that were factored, so far
      real(dp), private :: border_size = 1.0_dp    !! scale of the border [force/length]
      type(sum_list_type), private :: border       !! motions that border the rows
      logical, private :: may_change = .false.     !! whether other sets may use the factors
      real(dp), private :: hold = 0.0_dp           !! that the border has [force/length]
      type(front_factors_type), private :: fronts
      type(contact_rows_type), private :: rows     !! that were factored
      real(dp), allocatable, private :: scale(:)   !! (tail) factors of the rows, 0 where not free
   contains
      procedure :: factor
      procedure :: solve
      procedure :: solve_part
      procedure :: solve_transposed
      procedure :: is_negative
   end type contact_fronts_type

contains

   !> Factors the rows of a set.
   pure subroutine factor(self, system, rows, hold, unconstrained, singular)
      class(contact_fronts_type), intent(inout) :: self   !! of another set, or none
      type(contact_system_type), intent(in) :: system     !! the reduced system
      type(contact_rows_type), intent(in) :: rows
      real(dp), intent(in) :: hold                        !! soft one of all motions [force/length]
      type(sum_list_type), intent(in) :: unconstrained    !! (l, tail) motions that border the rows
      logical, intent(out) :: singular                    !! the rows depend on each other
      logical :: is_plain, changed(size(system%tree%parent))
      integer :: i

      is_plain = unconstrained%count == 0
      if (self%may_change .and. is_plain .and. abs(hold - self%hold) <= 0.0_dp) then
         changed = .false.
         associate (differing => differ(rows, self%rows), tree => system%tree)
            do i = 1, size(differing)
               if (differing(i)) changed(tree%touched(tree%start(i):tree%start(i + 1) - 1)) = .true.
            end do
         end associate
         changed = self%fronts%above_changed(changed)
      else
         if (hold > 0.0_dp) then
            self%border = system%motions%basis
         else
            self%border = unconstrained
         end if
         call self%fronts%begin(system%tree, self%border)
         self%border_size = max(maxval(abs(system%own)), tiny(1.0_dp))
         changed = .true.
      end if
      self%rows = rows
      self%hold = hold
      call set_scale(self, system)
      self%full = self%full + 1
      call factor_fronts(self, system, hold, changed, singular)
      self%may_change = is_plain .and. .not. singular
   end subroutine factor

   !> Factors of the rows that make their entries 1 at most.
   pure subroutine set_scale(self, system)
      type(contact_fronts_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      real(dp) :: size_of_row(system%schur%order)
      type(sum_list_type) :: sizes

      associate (rows => self%rows)
         size_of_row = abs(rows%spring)
         sizes = rows%forces%without_signs()
         call sizes%add_totals(system%row_size, size_of_row)
         self%scale = 0.0_dp*size_of_row
         self%scale(rows%free) = 1.0_dp/max(size_of_row(rows%free), tiny(1.0_dp))
      end associate
   end subroutine set_scale

   !> Factors some fronts, with motions that border the free rows.
   pure subroutine factor_fronts(self, system, hold, changed, singular)
      type(contact_fronts_type), intent(inout) :: self
      type(contact_system_type), intent(in) :: system
      real(dp), intent(in) :: hold
      logical, intent(in) :: changed(:)
      logical, intent(out) :: singular
      type(triplet_list_type) :: entries
      logical :: is_sought(system%schur%order + self%border%count)
      real(dp) :: column_size(system%schur%order + self%border%count)
      integer :: k, q

      associate (tail => system%schur%order, free => self%rows%free, motions => self%border)
         is_sought = .false.
         is_sought(free) = .true.
         is_sought(tail + 1:) = .true.
         column_size(:tail) = system%column_size
         column_size(tail + 1:) = 1.0_dp
         call form_entries(self, system, changed, size(motions%value), entries)
         do q = 1, self%border%count
            do k = motions%start(q), motions%start(q + 1) - 1
               associate (row => motions%value(k), part => motions%coefficient(k))
                  if (.not. is_sought(row)) cycle
                  call entries%add(row, tail + q, self%scale(row)*self%border_size*part)
                  call entries%add(tail + q, row, part)
               end associate
            end do
            if (hold > 0.0_dp) call entries%add(tail + q, tail + q, -self%border_size/hold)
         end do
         call self%fronts%factor(entries, is_sought, column_size, changed, singular)
      end associate
   end subroutine factor_fronts

   !> Entries of the rows, scaled, in some fronts, and room for those of motions.
   pure subroutine form_entries(self, system, changed, of_motions, entries)
      type(contact_fronts_type), intent(in) :: self
      type(contact_system_type), intent(in) :: system
      logical, intent(in) :: changed(:)
      integer, intent(in) :: of_motions
      type(triplet_list_type), intent(out) :: entries
      type(sum_list_type) :: rows   ! in which each force is, C^T
      integer :: e, i, j, k

      rows = self%rows%forces%transposed(system%schur%order)
      associate (s => system%schur%sparse, home => system%tree%front, forces => self%rows%forces)
         associate (used => forces%value(:forces%start(forces%count + 1) - 1))
            call entries%reserve(sum(s%row_start(used + 1) - s%row_start(used)) + size(home) + &
               2*of_motions + self%border%count)
         end associate
         do i = 1, size(home)
            if (.not. self%scale(i) > 0.0_dp) cycle
            if (.not. changed(home(i))) cycle
            do e = forces%start(i), forces%start(i + 1) - 1
               do k = s%row_start(forces%value(e)), s%row_start(forces%value(e) + 1) - 1
                  j = s%column(k)
                  if (.not. self%scale(j) > 0.0_dp .or. home(j) < home(i)) cycle
                  call entries%add(i, j, self%scale(i)*forces%coefficient(e)*s%value(k))
               end do
            end do
            if (abs(self%rows%spring(i)) > 0.0_dp) call entries%add(i, i, &
               self%scale(i)*self%rows%spring(i))
            do k = s%row_start(i), s%row_start(i + 1) - 1
               do e = rows%start(s%column(k)), rows%start(s%column(k) + 1) - 1
                  j = rows%value(e)
                  if (home(j) > home(i)) call entries%add(j, i, &
                     self%scale(j)*rows%coefficient(e)*s%value(k))
               end do
            end do
         end do
      end associate
   end subroutine form_entries

   !> Free displacements that take up forces.
   pure subroutine solve(self, x, unbalanced)
      class(contact_fronts_type), intent(in) :: self
      !> (tail, columns) forces as they enter the rows in; displacements in the free rows out
      real(dp), intent(inout) :: x(:, :)
      !> (l, columns) forces along the motions that border the rows, which nothing takes up
      real(dp), allocatable, intent(out), optional :: unbalanced(:, :)
      real(dp), allocatable :: bordered(:, :)

      allocate (bordered(size(x, 1) + self%border%count, size(x, 2)), source=0.0_dp)
      associate (free => self%rows%free)
         bordered(free, :) = spread(self%scale(free), 2, size(x, 2))*x(free, :)
         call self%fronts%solve(bordered)
         x(free, :) = bordered(free, :)
      end associate
      if (present(unbalanced)) unbalanced = self%border_size*bordered(size(x, 1) + 1:, :)
   end subroutine solve

   !> Displacements of some rows for forces on them alone.
   pure function solve_part(self, rows, forces) result(part)
      class(contact_fronts_type), intent(in) :: self
      integer, intent(in) :: rows(:)                !! (m)
      real(dp), intent(in) :: forces(:, :)          !! (m, n) as they enter the rows
      real(dp) :: part(size(rows), size(forces, 2)) !! (m, n) 0 in rows that are not free

      part = self%fronts%solve_part(rows, spread(self%scale(rows), 2, size(forces, 2))*forces)
   end function solve_part

   !> Sums of forces as they enter the rows, from sums of the displacements that take these up.
   pure subroutine solve_transposed(self, x)
      class(contact_fronts_type), intent(in) :: self
      !> (tail) factors of displacements in the free rows in; those of forces there out
      real(dp), intent(inout) :: x(:)
      real(dp) :: bordered(size(x) + self%border%count)

      bordered = 0.0_dp
      associate (free => self%rows%free)
         bordered(free) = x(free)
         call self%fronts%solve_transposed(bordered)
         x(free) = self%scale(free)*bordered(free)
      end associate
   end subroutine solve_transposed

   !> Whether the determinant of the free rows, with their border, is negative.
   pure logical function is_negative(self)
      class(contact_fronts_type), intent(in) :: self

      is_negative = self%fronts%negative_determinant()
   end function is_negative

end module contact_fronts
