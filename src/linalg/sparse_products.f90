!> Products of sparse matrices, row by row (F. G. Gustavson, ACM Trans. Math. Softw. 4 (1978) 250).
module sparse_products
   use kinds, only: dp
   use sorting, only: sort_order
   use sparse_matrix, only: sparse_matrix_type, triplet_list_type
   implicit none
   private
   public :: between_spaces, congruent

contains

   !> Lower triangle of T^T A T.
   pure function congruent(a, t) result(lower)
      type(sparse_matrix_type), intent(in) :: a     !! (n, n) symmetric, both triangles
      type(sparse_matrix_type), intent(in) :: t     !! (n, m) columns of a row in any order
      type(sparse_matrix_type) :: lower             !! (m, m)

      lower = product_of(transposed(t), product_of(a, t, .false.), .true.)
   end function congruent

   !> S^T A T.
   pure function between_spaces(s, a, t) result(c)
      type(sparse_matrix_type), intent(in) :: s     !! (n, k) columns of a row in any order
      type(sparse_matrix_type), intent(in) :: a     !! (n, l)
      type(sparse_matrix_type), intent(in) :: t     !! (l, m) columns of a row in any order
      type(sparse_matrix_type) :: c                 !! (k, m)

      c = product_of(transposed(s), product_of(a, t, .false.), .false.)
   end function between_spaces

   !> A B, or its lower triangle.
   pure function product_of(a, b, only_lower) result(c)
      type(sparse_matrix_type), intent(in) :: a, b
      logical, intent(in) :: only_lower
      type(sparse_matrix_type) :: c
      integer :: columns(b%column_count), i, k, l, n, row_of(b%column_count)
      real(dp) :: row(b%column_count)

      c%row_count = a%row_count
      c%column_count = b%column_count
      allocate (c%row_start(a%row_count + 1))
      c%row_start(1) = 1
      row_of = 0
      do i = 1, a%row_count
         call find_columns(a, b, i, only_lower, row_of, columns, n)
         c%row_start(i + 1) = c%row_start(i) + n
      end do
      allocate (c%column(c%row_start(a%row_count + 1) - 1), c%value(c%row_start(a%row_count + 1) &
         - 1))
      row_of = 0
      row = 0.0_dp
      do i = 1, a%row_count
         call find_columns(a, b, i, only_lower, row_of, columns, n)
         do k = a%row_start(i), a%row_start(i + 1) - 1
            ! A loop: sections with these subscripts would take memory for each.
            do l = b%row_start(a%column(k)), b%row_start(a%column(k) + 1) - 1
               row(b%column(l)) = row(b%column(l)) + a%value(k)*b%value(l)
            end do
         end do
         associate (first => c%row_start(i), last => c%row_start(i + 1) - 1)
            c%column(first:last) = columns(:n)
            ! Most rows come in order, and sorting takes memory for each.
            if (any(columns(2:n) < columns(:n - 1))) c%column(first:last) = &
               columns(sort_order(columns(:n)))
            do k = first, last
               c%value(k) = row(c%column(k))
            end do
         end associate
         do k = a%row_start(i), a%row_start(i + 1) - 1
            do l = b%row_start(a%column(k)), b%row_start(a%column(k) + 1) - 1
               row(b%column(l)) = 0.0_dp
            end do
         end do
      end do
   end function product_of

   !> The columns of a row of A B, in the order in which they come.
   pure subroutine find_columns(a, b, i, only_lower, row_of, columns, n)
      type(sparse_matrix_type), intent(in) :: a, b
      integer, intent(in) :: i
      logical, intent(in) :: only_lower
      integer, intent(inout) :: row_of(:)           ! (columns) row that a column was last found in
      integer, intent(inout) :: columns(:)          ! the first n are set
      integer, intent(out) :: n
      integer :: k, l

      n = 0
      do k = a%row_start(i), a%row_start(i + 1) - 1
         do l = b%row_start(a%column(k)), b%row_start(a%column(k) + 1) - 1
            if (row_of(b%column(l)) == i .or. (only_lower .and. b%column(l) > i)) cycle
            row_of(b%column(l)) = i
            n = n + 1
            columns(n) = b%column(l)
         end do
      end do
   end subroutine find_columns

   !> A^T.
   pure function transposed(a) result(b)
      type(sparse_matrix_type), intent(in) :: a
      type(sparse_matrix_type) :: b
      type(triplet_list_type) :: list
      integer :: i, k

      call list%reserve(a%row_start(a%row_count + 1) - 1)
      do i = 1, a%row_count
         do k = a%row_start(i), a%row_start(i + 1) - 1
            call list%add(a%column(k), i, a%value(k))
         end do
      end do
      b = list%compress(a%column_count, a%row_count)
   end function transposed

end module sparse_products
