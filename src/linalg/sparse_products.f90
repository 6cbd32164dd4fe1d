!> Products of sparse matrices, row by row (F. G. Gustavson, ACM Trans. Math. Softw. 4 (1978) 250).
module sparse_products
   use kinds, only: dp
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: between_spaces, congruent

contains

   !> Lower triangle of T^T A T.
   pure function congruent(a, t) result(lower)
      type(sparse_matrix_type), intent(in) :: a     !! (n, n) symmetric, both triangles
      type(sparse_matrix_type), intent(in) :: t     !! (n, m) columns of a row in any order
      type(sparse_matrix_type) :: lower             !! (m, m)

      lower = in_order(product_of(transposed(t), product_of(a, t, .false.), .true.))
   end function congruent

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
      allocate (c%row_start(a%row_count + 1), c%column(0), c%value(0))
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

end module sparse_products
