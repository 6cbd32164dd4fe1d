!> LU factors of a sparse matrix without symmetry, front by front (I. S. Duff and J. K. Reid, ACM
!> Trans. Math. Softw. 9 (1983) 302). A front is a small full matrix: the rows and columns that are
!> eliminated in it and those of fronts above to which these are joined. Pivots are chosen among
!> the rows of their own front; a column without a good one is left to the front above.
!>
!> What a front leaves for the one above stays with it, so that entries that change cost only their
!> own fronts and those above: what partial refactorisation is for a skyline, below eq. (3.4).
module front_factors
   use blas_lapack, only: dgemm, dgemv, dtrsm
   use front_tree, only: front_tree_type
   use kinds, only: dp
   use sorting, only: invert_lists
   use sparse_matrix, only: triplet_list_type
   use sum_lists, only: sum_list_type
   implicit none
   private
   public :: front_factors_type

   integer, parameter :: width = 16            !! columns that are eliminated at a time
   real(dp), parameter :: good = 1.0_dp        !! pivot, as part of what else its column has
   real(dp), parameter :: lost = 1.0e-14_dp    !! pivot, as part of the size of its column

   !> One front, eliminated. Rows and columns, those of pivots first, then those left to fronts
   !> above; in the matrix L without its diagonal of 1, U, and what is left.
   type :: front_type
      integer, allocatable :: row(:), column(:)
      integer :: pivots = 0
      integer :: shared = 0                        !! rows and columns that may have pivots
      real(dp), allocatable :: matrix(:, :)        !! (rows, columns)
   end type front_type

   !> Room for the lists of one front: its rows and columns, and places of unknowns in them, 0 for
   !> none.
   type :: room_type
      integer, allocatable :: row(:), column(:), row_place(:), column_place(:)   !! (unknowns)
      integer :: rows = 0, columns = 0
   end type room_type

   !> All fronts.
   type :: front_factors_type
      type(front_type), allocatable, private :: front(:)
      integer, allocatable, private :: above(:)    !! (fronts) the next one above, 0 for the last
      integer, allocatable, private :: home(:)     !! (unknowns) front
   contains
      procedure :: begin
      procedure :: is_begun
      procedure :: above_changed
      procedure :: home_of
      procedure :: factor
      procedure :: solve
      procedure :: solve_part
      procedure :: solve_transposed
      procedure :: negative_determinant
   end type front_factors_type

contains

   !> Begins with a tree, and further unknowns that border the matrix.
   pure subroutine begin(self, tree, borders)
      class(front_factors_type), intent(inout) :: self
      type(front_tree_type), intent(in) :: tree
      type(sum_list_type), intent(in) :: borders     !! (borders, unknowns) that each is joined to
      integer :: q

      if (allocated(self%front)) deallocate (self%front)
      allocate (self%front(size(tree%parent)))
      self%above = tree%parent
      self%home = [tree%front, (tree%front_above(borders%values_of(q)), q=1, borders%count)]
   end subroutine begin

   !> Whether it has begun.
   pure logical function is_begun(self)
      class(front_factors_type), intent(in) :: self

      is_begun = allocated(self%front)
   end function is_begun

   !> Front that holds an entry.
   elemental integer function home_of(self, row, column)
      class(front_factors_type), intent(in) :: self
      integer, intent(in) :: row, column

      home_of = min(self%home(row), self%home(column))
   end function home_of

   !> Fronts with entries that change, and all above them.
   pure function above_changed(self, changed) result(all_changed)
      class(front_factors_type), intent(in) :: self
      logical, intent(in) :: changed(:)              !! (fronts)
      logical :: all_changed(size(changed))
      integer :: f

      all_changed = changed
      do f = 1, size(changed) - 1
         if (all_changed(f)) all_changed(self%above(f)) = .true.
      end do
   end function above_changed

   !> Factors the fronts that changed, from all of their entries.
   pure subroutine factor(self, entries, is_sought, column_size, changed, singular)
      class(front_factors_type), intent(inout) :: self
      type(triplet_list_type), intent(in) :: entries  !! of these fronts
      logical, intent(in) :: is_sought(:)             !! (unknowns) others have no row and no column
      real(dp), intent(in) :: column_size(:)          !! (unknowns) beside which entries may be lost
      logical, intent(in) :: changed(:)               !! (fronts) as from above_changed
      logical, intent(out) :: singular
      integer :: below(size(changed)), f, i, next(size(changed))
      integer, allocatable :: order(:), own(:), own_start(:), start(:)
      type(room_type) :: room

      associate (n => entries%length)
         call invert_lists(reshape(self%home_of(entries%row(:n), entries%column(:n)), [1, n]), &
            [(1, i=1, n)], size(changed), start, order)
      end associate
      call invert_lists(reshape(self%home, [1, size(self%home)]), merge(1, 0, is_sought), &
         size(changed), own_start, own)
      below = 0
      do f = size(changed) - 1, 1, -1
         next(f) = below(self%above(f))
         below(self%above(f)) = f
      end do
      allocate (room%row_place(size(is_sought)), room%column_place(size(is_sought)), source=0)
      allocate (room%row(size(is_sought)), room%column(size(is_sought)))
      do f = 1, size(changed)
         if (.not. changed(f)) cycle
         associate (own_entries => order(start(f):start(f + 1) - 1))
            call place_all(self%front, below(f), next, own(own_start(f):own_start(f + 1) - 1), &
               room, self%front(f)%shared)
            call list_all(entries%row(own_entries), room%row_place, room%row, room%rows)
            call list_all(entries%column(own_entries), room%column_place, room%column, &
               room%columns)
            call assemble(self%front, f, below(f), next, entries, own_entries, room)
         end associate
         call eliminate(self%front(f), column_size)
      end do
      associate (last => self%front(size(changed)))
         singular = last%pivots < last%shared
      end associate
      if (singular) deallocate (self%front)
   end subroutine factor

   !> Rows and columns of a front: its own ones and those that the fronts below could not eliminate,
   !> which it shares, then those that it leaves to others.
   pure subroutine place_all(front, below, next, own, room, shared)
      type(front_type), intent(in) :: front(:)
      integer, intent(in) :: below, next(:)           ! first front below; the next one beside each
      integer, intent(in) :: own(:)
      type(room_type), intent(inout) :: room
      integer, intent(out) :: shared
      integer :: c

      room%rows = 0
      room%columns = 0
      call list_all(own, room%row_place, room%row, room%rows)
      call list_all(own, room%column_place, room%column, room%columns)
      c = below
      do while (c > 0)
         associate (p => front(c)%pivots, s => front(c)%shared)
            call list_all(front(c)%row(p + 1:s), room%row_place, room%row, room%rows)
            call list_all(front(c)%column(p + 1:s), room%column_place, room%column, room%columns)
         end associate
         c = next(c)
      end do
      shared = room%rows
      c = below
      do while (c > 0)
         associate (s => front(c)%shared)
            call list_all(front(c)%row(s + 1:), room%row_place, room%row, room%rows)
            call list_all(front(c)%column(s + 1:), room%column_place, room%column, room%columns)
         end associate
         c = next(c)
      end do
   end subroutine place_all

   !> The matrix of a front: its own entries and what the fronts below have left.
   pure subroutine assemble(front, f, below, next, entries, own_entries, room)
      type(front_type), intent(inout) :: front(:)
      integer, intent(in) :: f
      integer, intent(in) :: below, next(:)           ! first front below; the next one beside each
      type(triplet_list_type), intent(in) :: entries
      integer, intent(in) :: own_entries(:)
      type(room_type), intent(inout) :: room          ! its rows and columns in; no places out
      integer :: c, i, j, k

      front(f)%row = room%row(:room%rows)
      front(f)%column = room%column(:room%columns)
      if (allocated(front(f)%matrix)) deallocate (front(f)%matrix)
      allocate (front(f)%matrix(room%rows, room%columns), source=0.0_dp)
      associate (a => front(f)%matrix)
         do k = 1, size(own_entries)
            i = room%row_place(entries%row(own_entries(k)))
            j = room%column_place(entries%column(own_entries(k)))
            a(i, j) = a(i, j) + entries%value(own_entries(k))
         end do
         c = below
         do while (c > 0)
            associate (child => front(c), to => room%row_place(front(c)%row))
               do k = child%pivots + 1, size(child%column)
                  j = room%column_place(child%column(k))
                  do i = child%pivots + 1, size(to)
                     a(to(i), j) = a(to(i), j) + child%matrix(i, k)
                  end do
               end do
            end associate
            c = next(c)
         end do
      end associate
      room%row_place(front(f)%row) = 0
      room%column_place(front(f)%column) = 0
   end subroutine assemble

   !> Gives places to unknowns that have none yet, and lists them in the order of these.
   pure subroutine list_all(unknowns, place, list, last)
      integer, intent(in) :: unknowns(:)
      integer, intent(inout) :: place(:)             ! (all unknowns) 0 for none
      integer, intent(inout), optional :: list(:)
      integer, intent(inout) :: last                 ! place that was given
      integer :: i

      do i = 1, size(unknowns)
         if (place(unknowns(i)) > 0) cycle
         last = last + 1
         place(unknowns(i)) = last
         if (present(list)) list(last) = unknowns(i)
      end do
   end subroutine list_all

   !> Eliminates a front as far as good pivots are found, some columns at a time.
   pure subroutine eliminate(front, column_size)
      type(front_type), intent(inout) :: front
      real(dp), intent(in) :: column_size(:)
      integer :: before, final, first, k, last, rows

      rows = size(front%row)
      k = 0
      associate (a => front%matrix, shared => front%shared)
         do
            before = k
            last = shared
            do while (k < last)
               first = k + 1
               final = min(k + width, last)
               call eliminate_columns(front, column_size, final, k)
               associate (pivots => k - first + 1, rest => size(front%column) - final)
                  if (pivots > 0 .and. rest > 0) then
                     call dtrsm('L', 'L', 'N', 'U', pivots, rest, 1.0_dp, a(first, first), rows, &
                        a(first, final + 1), rows)
                     if (rows > k) call dgemm('N', 'N', rows - k, rest, pivots, -1.0_dp, &
                        a(k + 1, first), rows, a(first, final + 1), rows, 1.0_dp, &
                        a(k + 1, final + 1), rows)
                  end if
               end associate
               if (k < final) then
                  call exchange_columns(front, k + 1, last)
                  last = last - 1
               end if
            end do
            if (k == before .or. k == shared) exit
         end do
      end associate
      front%pivots = k
   end subroutine eliminate

   !> Eliminates columns up to an end, or to one without a good pivot.
   pure subroutine eliminate_columns(front, column_size, final, k)
      type(front_type), intent(inout) :: front
      real(dp), intent(in) :: column_size(:)
      integer, intent(in) :: final
      integer, intent(inout) :: k            ! columns eliminated so far
      integer :: c, i

      associate (a => front%matrix)
         do while (k < final)
            i = k + maxloc(abs(a(k + 1:front%shared, k + 1)), dim=1)
            if (abs(a(i, k + 1)) < good*maxval(abs(a(k + 1:, k + 1))) .or. &
               abs(a(i, k + 1)) <= lost*column_size(front%column(k + 1))) return
            k = k + 1
            call exchange_rows(front, i, k)
            a(k + 1:, k) = a(k + 1:, k)/a(k, k)
            do c = k + 1, final
               if (abs(a(k, c)) > 0.0_dp) a(k + 1:, c) = a(k + 1:, c) - a(k, c)*a(k + 1:, k)
            end do
         end do
      end associate
   end subroutine eliminate_columns

   !> Exchanges two columns.
   pure subroutine exchange_columns(front, i, j)
      type(front_type), intent(inout) :: front
      integer, intent(in) :: i, j
      real(dp) :: column(size(front%row))

      if (i == j) return
      front%column([i, j]) = front%column([j, i])
      column = front%matrix(:, i)
      front%matrix(:, i) = front%matrix(:, j)
      front%matrix(:, j) = column
   end subroutine exchange_columns

   !> Exchanges two rows.
   pure subroutine exchange_rows(front, i, j)
      type(front_type), intent(inout) :: front
      integer, intent(in) :: i, j
      real(dp) :: entry
      integer :: c

      if (i == j) return
      front%row([i, j]) = front%row([j, i])
      do c = 1, size(front%column)
         entry = front%matrix(i, c)
         front%matrix(i, c) = front%matrix(j, c)
         front%matrix(j, c) = entry
      end do
   end subroutine exchange_rows

   !> Solves with the factors; unknowns that are not sought have 0.
   pure subroutine solve(self, x)
      class(front_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:, :)         !! (unknowns, n) right-hand sides in, solutions out
      integer :: f
      real(dp) :: solution(size(x, 1), size(x, 2))

      solution = 0.0_dp
      do f = 1, size(self%front)
         associate (front => self%front(f))
            call eliminate_forward(front, front%row, front%column, x, solution)
         end associate
      end do
      do f = size(self%front), 1, -1
         call substitute_back(self%front(f), self%front(f)%column, solution)
      end do
      x = solution
   end subroutine solve

   !> Some rows of solutions for right-hand sides that are zero in all other rows: only fronts of
   !> these rows, and those above them, are visited.
   pure function solve_part(self, rows, rhs) result(part)
      class(front_factors_type), intent(in) :: self
      integer, intent(in) :: rows(:)               !! (m)
      real(dp), intent(in) :: rhs(:, :)            !! (m, n) 0 in rows that are not sought
      real(dp) :: part(size(rows), size(rhs, 2))   !! (m, n) 0 likewise
      integer :: f, place(size(self%home)), places
      logical :: visited(size(self%front))
      real(dp), allocatable :: x(:, :), solution(:, :)

      visited = .false.
      visited(self%home(rows)) = .true.
      visited = self%above_changed(visited)
      place = 0
      places = 0
      call list_all(rows, place, last=places)
      do f = 1, size(visited)
         if (.not. visited(f)) cycle
         call list_all(self%front(f)%row, place, last=places)
         call list_all(self%front(f)%column, place, last=places)
      end do
      allocate (x(places, size(rhs, 2)), solution(places, size(rhs, 2)), source=0.0_dp)
      x(place(rows), :) = rhs
      do f = 1, size(visited)
         associate (front => self%front(f))
            if (visited(f)) call eliminate_forward(front, place(front%row), place(front%column), &
               x, solution)
         end associate
      end do
      do f = size(visited), 1, -1
         if (visited(f)) call substitute_back(self%front(f), place(self%front(f)%column), solution)
      end do
      part = solution(place(rows), :)
   end function solve_part

   !> Solves with the transposed of the matrix, U^T and then L^T.
   pure subroutine solve_transposed(self, x)
      class(front_factors_type), intent(in) :: self
      real(dp), intent(inout) :: x(:)            !! (unknowns) right-hand side in, solution out
      integer :: f, k
      real(dp) :: solution(size(x))
      real(dp), allocatable :: own(:)

      solution = 0.0_dp
      do f = 1, size(self%front)
         associate (front => self%front(f), p => self%front(f)%pivots)
            if (p == 0) cycle
            own = x(front%column)
            do k = 1, p
               own(k) = own(k)/front%matrix(k, k)
               own(k + 1:) = own(k + 1:) - own(k)*front%matrix(k, k + 1:)
            end do
            x(front%column(p + 1:)) = own(p + 1:)
            solution(front%row(:p)) = own(:p)
         end associate
      end do
      do f = size(self%front), 1, -1
         associate (front => self%front(f), p => self%front(f)%pivots)
            own = solution(front%row)
            do k = p, 1, -1
               own(k) = own(k) - dot_product(front%matrix(k + 1:, k), own(k + 1:))
            end do
            solution(front%row(:p)) = own(:p)
         end associate
      end do
      x = solution
   end subroutine solve_transposed

   !> L^-1 of a front.
   pure subroutine eliminate_forward(front, row, column, x, solution)
      type(front_type), intent(in) :: front
      integer, intent(in) :: row(:), column(:)     ! its rows in x, its columns in the solution
      real(dp), intent(inout) :: x(:, :)
      real(dp), intent(inout) :: solution(:, :)    ! receives the pivots' rows
      real(dp) :: own(size(front%row))
      integer :: j, k

      associate (p => front%pivots)
         if (p == 0) return
         do j = 1, size(x, 2)
            own = x(row, j)
            if (.not. any(abs(own(:p)) > 0.0_dp)) then
               solution(column(:p), j) = 0.0_dp
               cycle
            end if
            do k = 1, p
               own(k + 1:p) = own(k + 1:p) - own(k)*front%matrix(k + 1:p, k)
            end do
            if (size(own) > p) call dgemv('N', size(own) - p, p, -1.0_dp, front%matrix(p + 1, 1), &
               size(own), own, 1, 1.0_dp, own(p + 1), 1)
            x(row(p + 1:), j) = own(p + 1:)
            solution(column(:p), j) = own(:p)
         end do
      end associate
   end subroutine eliminate_forward

   !> U^-1 of a front.
   pure subroutine substitute_back(front, column, solution)
      type(front_type), intent(in) :: front
      integer, intent(in) :: column(:)             ! its columns in the solution
      real(dp), intent(inout) :: solution(:, :)
      real(dp) :: own(size(front%column))
      integer :: j, k

      associate (p => front%pivots)
         if (p == 0) return
         do j = 1, size(solution, 2)
            own = solution(column, j)
            if (size(own) > p) call dgemv('N', p, size(own) - p, -1.0_dp, front%matrix(1, p + 1), &
               size(front%row), own(p + 1), 1, 1.0_dp, own, 1)
            do k = p, 1, -1
               own(k) = own(k)/front%matrix(k, k)
               own(:k - 1) = own(:k - 1) - own(k)*front%matrix(:k - 1, k)
            end do
            solution(column(:p), j) = own(:p)
         end do
      end associate
   end subroutine substitute_back

   !> Whether the determinant of the matrix is negative.
   pure logical function negative_determinant(self) result(negative)
      class(front_factors_type), intent(in) :: self
      integer :: at(size(self%home)), f, i, k, next
      ! Pivots at (row, column) are a permutation, of which each cycle of even length is odd.
      at = 0
      negative = .false.
      do f = 1, size(self%front)
         associate (front => self%front(f))
            do k = 1, front%pivots
               at(front%row(k)) = front%column(k)
               negative = negative .neqv. front%matrix(k, k) < 0.0_dp
            end do
         end associate
      end do
      do i = 1, size(at)
         do while (at(i) > 0 .and. at(i) /= i)
            next = at(i)
            at(i) = at(next)
            at(next) = next
            negative = .not. negative
         end do
      end do
   end function negative_determinant

end module front_factors
