!> Sparse matrices by rows, neutral between the solvers, and their products, row by row (F. G.
!> Gustavson, ACM Trans. Math. Softw. 4 (1978) 250). A symmetric matrix for a solver is given by its
!> lower triangle.
module sparse_matrix
   use kinds, only: dp
   implicit none
   private
   public :: sparse_matrix_type, triplet_list_type, between_spaces, congruent, have_same_pattern, &
      linear_combination, symmetric

   !> A matrix in compressed rows, columns ascending in each row.
   type :: sparse_matrix_type
      integer :: row_count = 0                !! number of rows
      integer :: column_count = 0             !! number of columns
      integer, allocatable :: row_start(:)    !! (rows + 1) position of each row's first entry
      integer, allocatable :: column(:)       !! (entries) column of an entry
      real(dp), allocatable :: value(:)       !! (entries) its value
      !> Whether rows 1 and 2, 3 and 4, ... have the same columns, and these come in such pairs
      logical :: in_pairs = .false.
   contains
      procedure :: graph
      procedure :: multiply
      procedure :: multiply_columns
      procedure :: multiply_transposed
   end type sparse_matrix_type

   !> Entries as they come from the elements, in any order; equal positions add up.
   type :: triplet_list_type
      integer :: length = 0                   !! entries in use
      integer, allocatable :: row(:)          !! (capacity) row of an entry
      integer, allocatable :: column(:)       !! (capacity) its column
      real(dp), allocatable :: value(:)       !! (capacity) its value
   contains
      procedure :: reserve
      procedure :: add
      procedure :: add_block
      procedure :: compress
   end type triplet_list_type

contains

   !> y = A x.
   pure function multiply(self, x) result(y)
      class(sparse_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(:)                  !! (columns) of any stride
      real(dp) :: y(self%row_count)                 !! (rows)

      if (self%in_pairs) then
         call multiply_pairs(self, x, y)
      else
         call multiply_rows(self, x, y)
      end if
   end function multiply

   !> y = A x, row by row.
   pure subroutine multiply_rows(self, x, y)
      type(sparse_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(self%column_count)
      real(dp), intent(out) :: y(self%row_count)
      real(dp) :: total
      integer :: i, k

      do i = 1, self%row_count
         total = 0.0_dp
         !GCC$ unroll 4
         do k = self%row_start(i), self%row_start(i + 1) - 1
            total = total + self%value(k)*x(self%column(k))
         end do
         y(i) = total
      end do
   end subroutine multiply_rows

   !> y = A x, two rows and two columns at a time; sums of odd and even columns stand apart, so that
   !> the compiler takes two at once.
   pure subroutine multiply_pairs(self, x, y)
      type(sparse_matrix_type), intent(in) :: self  ! in pairs
      real(dp), intent(in) :: x(self%column_count)
      real(dp), intent(out) :: y(self%row_count)
      real(dp) :: one(2), other(2), sums(2, self%row_count)
      integer :: i, j, k, n, p

      do i = 1, self%row_count, 2
         n = self%row_start(i + 1) - self%row_start(i)
         one = 0.0_dp
         other = 0.0_dp
         !GCC$ unroll 4
         do p = 0, n/2 - 1
            k = self%row_start(i) + 2*p
            j = self%column(k)
            one = one + self%value(k:k + 1)*x(j:j + 1)
            other = other + self%value(k + n:k + n + 1)*x(j:j + 1)
         end do
         sums(:, i) = one
         sums(:, i + 1) = other
      end do
      y = sums(1, :) + sums(2, :)
   end subroutine multiply_pairs

   !> Y = A X, each entry of A being read once.
   pure subroutine multiply_columns(self, x, y)
      class(sparse_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(:, :)               !! (columns, n)
      real(dp), intent(out) :: y(:, :)              !! (rows, n)
      real(dp) :: by_row(size(x, 2), size(x, 1)), total(size(x, 2))
      integer :: i, k

      by_row = transpose(x)
      do i = 1, self%row_count
         total = 0.0_dp
         do k = self%row_start(i), self%row_start(i + 1) - 1
            total = total + self%value(k)*by_row(:, self%column(k))
         end do
         y(i, :) = total
      end do
   end subroutine multiply_columns

   !> y = A^T x.
   pure function multiply_transposed(self, x) result(y)
      class(sparse_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(:)                  !! (rows)
      real(dp) :: y(self%column_count)              !! (columns)
      integer :: i, k

      y = 0.0_dp
      do i = 1, self%row_count
         do k = self%row_start(i), self%row_start(i + 1) - 1
            y(self%column(k)) = y(self%column(k)) + self%value(k)*x(i)
         end do
      end do
   end function multiply_transposed

   !> Makes room for entries; what the list held is dropped.
   pure subroutine reserve(self, capacity)
      class(triplet_list_type), intent(inout) :: self
      integer, intent(in) :: capacity                 !! entries expected

      self%length = 0
      if (allocated(self%row)) deallocate (self%row, self%column, self%value)
      allocate (self%row(capacity), self%column(capacity), self%value(capacity))
   end subroutine reserve

   !> Adds one entry; the list must have room for it.
   pure subroutine add(self, row, column, value)
      class(triplet_list_type), intent(inout) :: self
      integer, intent(in) :: row                      !! row
      integer, intent(in) :: column                   !! column
      real(dp), intent(in) :: value                   !! value

      self%length = self%length + 1
      self%row(self%length) = row
      self%column(self%length) = column
      self%value(self%length) = value
   end subroutine add

   !> Adds a block, such as an element's matrix.
   pure subroutine add_block(self, rows, columns, block)
      class(triplet_list_type), intent(inout) :: self
      integer, intent(in) :: rows(:)                  !! (m) rows
      integer, intent(in) :: columns(:)               !! (n) columns
      real(dp), intent(in) :: block(:, :)             !! (m, n) values
      integer :: i, j

      do j = 1, size(columns)
         do i = 1, size(rows)
            call self%add(rows(i), columns(j), block(i, j))
         end do
      end do
   end subroutine add_block

   !> a A + b B of two matrices of one size; one without values counts as zero.
   pure function linear_combination(a, matrix_a, b, matrix_b) result(combined)
      real(dp), intent(in) :: a                          !! factor of the first
      type(sparse_matrix_type), intent(in) :: matrix_a   !! first matrix
      real(dp), intent(in) :: b                          !! factor of the second
      type(sparse_matrix_type), intent(in) :: matrix_b   !! second matrix
      type(sparse_matrix_type) :: combined               !! their combination
      type(triplet_list_type) :: list
      integer :: entries

      if (have_same_pattern(matrix_a, matrix_b)) then
         combined = matrix_a
         combined%value = a*matrix_a%value + b*matrix_b%value
         return
      else if (.not. allocated(matrix_b%value)) then
         combined = matrix_a
         if (abs(a - 1.0_dp) > 0.0_dp .and. allocated(matrix_a%value)) combined%value = &
            a*matrix_a%value
         return
      end if
      entries = 0
      if (allocated(matrix_a%value)) entries = size(matrix_a%value)
      if (allocated(matrix_b%value)) entries = entries + size(matrix_b%value)
      call list%reserve(entries)
      call add_entries(list, a, matrix_a)
      call add_entries(list, b, matrix_b)
      if (entries > 0) combined = list%compress(max(matrix_a%row_count, &
         matrix_b%row_count), max(matrix_a%column_count, matrix_b%column_count))
   end function linear_combination

   !> Whether two matrices have entries in the same places, and any.
   pure logical function have_same_pattern(a, b) result(same)
      type(sparse_matrix_type), intent(in) :: a, b  !! without values for none

      same = allocated(a%value) .and. allocated(b%value)
      if (same) same = size(a%value) == size(b%value) .and. size(a%row_start) == size(b%row_start)
      if (same) same = all(a%row_start == b%row_start) .and. all(a%column == b%column)
   end function have_same_pattern

   pure subroutine add_entries(list, factor, matrix)
      type(triplet_list_type), intent(inout) :: list
      real(dp), intent(in) :: factor
      type(sparse_matrix_type), intent(in) :: matrix
      integer :: i, k

      if (.not. allocated(matrix%value)) return
      do i = 1, matrix%row_count
         do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
            call list%add(i, matrix%column(k), factor*matrix%value(k))
         end do
      end do
   end subroutine add_entries

   !> The matrix of a list of entries: a counting sort by column and then by row, equal positions
   !> summed.
   pure function compress(self, row_count, column_count) result(matrix)
      class(triplet_list_type), intent(in) :: self !! the entries
      integer, intent(in) :: row_count             !! rows of the matrix
      integer, intent(in) :: column_count          !! columns of the matrix
      type(sparse_matrix_type) :: matrix           !! compressed rows
      integer, allocatable :: by_column(:), by_row(:)
      integer :: k, entry, row, filled

      allocate (by_column(self%length), by_row(self%length))
      by_column(:) = [(k, k=1, self%length)]
      by_column(:) = counting_sort(self%column(:self%length), by_column, column_count)
      by_row(:) = counting_sort(self%row(:self%length), by_column, row_count)
      matrix%row_count = row_count
      matrix%column_count = column_count
      allocate (matrix%row_start(row_count + 1))
      allocate (matrix%column(self%length), matrix%value(self%length))
      filled = 0
      row = 0
      do k = 1, self%length
         entry = by_row(k)
         if (self%row(entry) /= row) then
            matrix%row_start(row + 1:self%row(entry)) = filled + 1
            row = self%row(entry)
         else if (self%column(entry) == matrix%column(filled)) then
            matrix%value(filled) = matrix%value(filled) + self%value(entry)
            cycle
         end if
         filled = filled + 1
         matrix%column(filled) = self%column(entry)
         matrix%value(filled) = self%value(entry)
      end do
      matrix%row_start(row + 1:) = filled + 1
      matrix%column = matrix%column(:filled)
      matrix%value = matrix%value(:filled)
   end function compress

   !> Stable order of entries by key.
   pure function counting_sort(keys, entries, key_count) result(sorted)
      integer, intent(in) :: keys(:)        !! (all) key of each entry, 1..key_count
      integer, intent(in) :: entries(:)     !! (n) entries in the order so far
      integer, intent(in) :: key_count      !! largest key
      integer :: sorted(size(entries))      !! (n) entries, keys ascending
      integer, allocatable :: position(:)
      integer :: k, key

      allocate (position(key_count + 1), source=0)
      do k = 1, size(entries)
         key = keys(entries(k)) + 1
         position(key) = position(key) + 1
      end do
      do k = 2, key_count + 1
         position(k) = position(k) + position(k - 1)
      end do
      do k = 1, size(entries)
         key = keys(entries(k))
         position(key) = position(key) + 1
         sorted(position(key)) = entries(k)
      end do
   end function counting_sort

   !> Lower triangle of T^T A T.
   pure function congruent(a, t) result(lower)
      type(sparse_matrix_type), intent(in) :: a     !! (n, n) symmetric, both triangles by rows
      type(sparse_matrix_type), intent(in) :: t     !! (n, m) columns of a row in any order
      type(sparse_matrix_type) :: lower             !! (m, m)

      lower = in_order(product_of(transposed(t), product_of(a, t, .false.), .true.))
   end function congruent

   !> Both triangles of a symmetric matrix.
   pure function symmetric(lower) result(matrix)
      type(sparse_matrix_type), intent(in) :: lower !! (n, n) lower triangle by rows
      type(sparse_matrix_type) :: matrix            !! (n, n)
      type(sparse_matrix_type) :: upper
      integer :: i, k, n

      upper = transposed(lower)
      matrix = sparse_matrix_type(lower%row_count, lower%row_count)
      n = 2*lower%row_start(lower%row_count + 1) - 2
      allocate (matrix%row_start(lower%row_count + 1), matrix%column(n), matrix%value(n))
      n = 0
      matrix%row_start(1) = 1
      do i = 1, lower%row_count
         do k = lower%row_start(i), lower%row_start(i + 1) - 1
            n = n + 1
            matrix%column(n) = lower%column(k)
            matrix%value(n) = lower%value(k)
         end do
         do k = upper%row_start(i), upper%row_start(i + 1) - 1
            if (upper%column(k) == i) cycle
            n = n + 1
            matrix%column(n) = upper%column(k)
            matrix%value(n) = upper%value(k)
         end do
         matrix%row_start(i + 1) = n + 1
      end do
      call resize(matrix, n)
   end function symmetric

   !> Which rows of a symmetric matrix are joined: its pattern without the diagonal.
   pure function graph(self)
      class(sparse_matrix_type), intent(in) :: self !! both triangles
      type(sparse_matrix_type) :: graph             !! the values mean nothing
      logical, allocatable :: joins(:)
      integer :: i

      allocate (joins(size(self%column)))
      graph = sparse_matrix_type(self%row_count, self%row_count)
      allocate (graph%row_start(self%row_count + 1))
      graph%row_start(1) = 1
      do i = 1, self%row_count
         associate (first => self%row_start(i), last => self%row_start(i + 1) - 1)
            joins(first:last) = self%column(first:last) /= i
            graph%row_start(i + 1) = graph%row_start(i) + count(joins(first:last))
         end associate
      end do
      graph%column = pack(self%column, joins)
      graph%value = pack(self%value, joins)
   end function graph

   !> S^T A T.
   pure function between_spaces(s, a, t) result(c)
      type(sparse_matrix_type), intent(in) :: s     !! (n, k) columns of a row in any order
      type(sparse_matrix_type), intent(in) :: a     !! (n, l)
      type(sparse_matrix_type), intent(in) :: t     !! (l, m) columns of a row in any order
      type(sparse_matrix_type) :: c                 !! (k, m)

      c = in_order(product_of(transposed(s), product_of(a, t, .false.), .false.))
   end function between_spaces

   !> A B or its lower triangle, the columns of a row in any order.
   pure function product_of(a, b, only_lower) result(c)
      type(sparse_matrix_type), intent(in) :: a, b
      logical, intent(in) :: only_lower
      type(sparse_matrix_type) :: c
      integer :: columns(b%column_count), i, j, k, l, n, row_of(b%column_count)
      real(dp) :: row(b%column_count)

      c%row_count = a%row_count
      c%column_count = b%column_count
      allocate (c%row_start(a%row_count + 1), c%column(size(a%value)), c%value(size(a%value)))
      c%row_start(1) = 1
      row_of = 0
      do i = 1, a%row_count
         n = 0
         do k = a%row_start(i), a%row_start(i + 1) - 1
            ! A loop: sections with these subscripts would take memory for each.
            do l = b%row_start(a%column(k)), b%row_start(a%column(k) + 1) - 1
               j = b%column(l)
               if (only_lower .and. j > i) cycle
               if (row_of(j) /= i) then
                  row_of(j) = i
                  row(j) = 0.0_dp
                  n = n + 1
                  columns(n) = j
               end if
               row(j) = row(j) + a%value(k)*b%value(l)
            end do
         end do
         c%row_start(i + 1) = c%row_start(i) + n
         if (c%row_start(i + 1) > size(c%column)) call resize(c, 2*c%row_start(i + 1))
         associate (first => c%row_start(i), last => c%row_start(i + 1) - 1)
            c%column(first:last) = columns(:n)
            do k = first, last
               c%value(k) = row(c%column(k))
            end do
         end associate
      end do
      call resize(c, c%row_start(a%row_count + 1) - 1)
   end function product_of

   !> Makes room for a number of entries, and keeps those that it has.
   pure subroutine resize(matrix, entries)
      type(sparse_matrix_type), intent(inout) :: matrix
      integer, intent(in) :: entries
      integer, allocatable :: column(:)
      real(dp), allocatable :: value(:)
      integer :: n

      n = min(entries, size(matrix%column))
      allocate (column(entries), value(entries))
      column(:n) = matrix%column(:n)
      value(:n) = matrix%value(:n)
      call move_alloc(column, matrix%column)
      call move_alloc(value, matrix%value)
   end subroutine resize

   !> The same matrix, the columns of each row ascending.
   pure function in_order(a) result(b)
      type(sparse_matrix_type), intent(in) :: a     !! columns of a row in any order
      type(sparse_matrix_type) :: b

      b = transposed(transposed(a))
   end function in_order

   !> A^T, the columns of each row ascending.
   pure function transposed(a) result(b)
      type(sparse_matrix_type), intent(in) :: a     !! columns of a row in any order
      type(sparse_matrix_type) :: b
      integer :: entries, i, k, place

      entries = a%row_start(a%row_count + 1) - 1
      b%row_count = a%column_count
      b%column_count = a%row_count
      allocate (b%row_start(b%row_count + 1), source=0)
      allocate (b%column(entries), b%value(entries))
      do k = 1, entries
         b%row_start(a%column(k)) = b%row_start(a%column(k)) + 1
      end do
      place = 1
      do i = 1, b%row_count + 1
         place = place + b%row_start(i)
         b%row_start(i) = place
      end do
      do i = a%row_count, 1, -1
         do k = a%row_start(i), a%row_start(i + 1) - 1
            place = b%row_start(a%column(k)) - 1
            b%row_start(a%column(k)) = place
            b%column(place) = i
            b%value(place) = a%value(k)
         end do
      end do
   end function transposed

end module sparse_matrix
