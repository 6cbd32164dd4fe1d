!> Symmetric matrix of the contact unknowns, the tail. It is full where bodies are eliminated up to
!> the relative displacements and jumps, and sparse where the face nodes of many bodies stay on the
!> tail beside these.
module tail_matrix
   use dense, only: product_of
   use kinds, only: dp
   use ordering, only: positions_by_rank, profile => first_rows, profile_order
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: tail_matrix_type

   !> One of both is allocated.
   type :: tail_matrix_type
      integer :: order = 0                      !! tail unknowns
      real(dp), allocatable :: full(:, :)       !! (order, order)
      !> (order, order) both triangles by rows
      type(sparse_matrix_type) :: sparse = sparse_matrix_type()
      integer, allocatable :: rank(:)           !! (order) an order that keeps columns short
   contains
      procedure :: set_order
      procedure :: first_rows
      procedure :: is_sparse
      procedure :: diagonal
      procedure :: columns
      procedure :: block => block_of
      procedure :: neighbours
      procedure :: times
      procedure :: add_row
      procedure :: add_product
   end type tail_matrix_type

contains

   !> Sets the number of unknowns and an order of theirs: their own where the matrix is full.
   pure subroutine set_order(self)
      class(tail_matrix_type), intent(inout) :: self
      integer :: i

      if (self%is_sparse()) then
         self%order = self%sparse%row_count
         self%rank = behind_others(self, profile_order(self%sparse%graph()))
      else
         self%order = size(self%full, 1)
         self%rank = [(i, i=1, self%order)]
      end if
   end subroutine set_order

   !> The order with unknowns that have no diagonal, forces of links and what only these hold, just
   !> behind those that they are joined to: factors without pivoting then have no zero pivot.
   pure function behind_others(self, position) result(rank)
      class(tail_matrix_type), intent(in) :: self
      integer, intent(in) :: position(:)
      integer :: rank(size(position))
      integer :: i, n, turn
      logical :: is_placed(size(position))

      rank = 3*position - 2
      is_placed = abs(self%diagonal()) > 0.0_dp
      do turn = 1, 2
         do i = 1, self%order
            if (is_placed(i)) cycle
            associate (joined => self%sparse%column(self%sparse%row_start(i): &
               self%sparse%row_start(i + 1) - 1))
               n = maxval([0, pack(rank(joined), is_placed(joined))])
            end associate
            if (n > 0) rank(i) = -(3*((n + 2)/3) - 2 + turn)
         end do
         is_placed = is_placed .or. rank < 0
         rank = abs(rank)
      end do
      ! Several may be behind the same one.
      rank = positions_by_rank(rank, self%order)
   end function behind_others

   !> First row of each column in this order.
   pure function first_rows(self)
      class(tail_matrix_type), intent(in) :: self
      integer :: first_rows(self%order)         !! (order)

      first_rows = 1
      if (self%is_sparse()) first_rows = profile(self%sparse, self%rank)
   end function first_rows

   !> Whether only entries that are not zero are stored.
   pure logical function is_sparse(self)
      class(tail_matrix_type), intent(in) :: self

      is_sparse = allocated(self%sparse%value)
   end function is_sparse

   !> Its diagonal.
   pure function diagonal(self)
      class(tail_matrix_type), intent(in) :: self
      real(dp) :: diagonal(self%order)          !! (order)
      integer :: i, k

      if (.not. self%is_sparse()) then
         diagonal = [(self%full(i, i), i=1, self%order)]
         return
      end if
      diagonal = 0.0_dp
      do i = 1, self%order
         do k = self%sparse%row_start(i), self%sparse%row_start(i + 1) - 1
            if (self%sparse%column(k) == i) diagonal(i) = self%sparse%value(k)
         end do
      end do
   end function diagonal

   !> Some of its columns.
   pure function columns(self, which)
      class(tail_matrix_type), intent(in) :: self
      integer, intent(in) :: which(:)               !! (n)
      real(dp), allocatable :: columns(:, :)        !! (order, n)
      integer :: j

      if (.not. self%is_sparse()) then
         columns = self%full(:, which)
         return
      end if
      allocate (columns(self%order, size(which)), source=0.0_dp)
      do j = 1, size(which)
         call self%add_row(which(j), 1.0_dp, columns(:, j))
      end do
   end function columns

   !> Adds a row, times a factor.
   pure subroutine add_row(self, i, factor, row)
      class(tail_matrix_type), intent(in) :: self
      integer, intent(in) :: i
      real(dp), intent(in) :: factor
      real(dp), intent(inout) :: row(:)             !! (order)
      integer :: k

      if (.not. self%is_sparse()) then
         row = row + factor*self%full(:, i)
         return
      end if
      do k = self%sparse%row_start(i), self%sparse%row_start(i + 1) - 1
         row(self%sparse%column(k)) = row(self%sparse%column(k)) + factor*self%sparse%value(k)
      end do
   end subroutine add_row

   !> Some rows of some columns.
   pure function block_of(self, rows, columns) result(block)
      class(tail_matrix_type), intent(in) :: self
      integer, intent(in) :: rows(:), columns(:)    !! (m), (n)
      real(dp) :: block(size(rows), size(columns))  !! (m, n)
      real(dp) :: column(self%order)
      integer :: j

      column = 0.0_dp
      do j = 1, size(columns)
         call self%add_row(columns(j), 1.0_dp, column)
         block(:, j) = column(rows)
         if (self%is_sparse()) then
            column(self%sparse%column(self%sparse%row_start(columns(j)): &
               self%sparse%row_start(columns(j) + 1) - 1)) = 0.0_dp
         else
            column = 0.0_dp
         end if
      end do
   end function block_of

   !> Unknowns to which some are joined, these among them.
   pure function neighbours(self, which) result(around)
      class(tail_matrix_type), intent(in) :: self
      integer, intent(in) :: which(:)
      integer, allocatable :: around(:)
      logical :: is_around(self%order)
      integer :: i, k

      is_around = .not. self%is_sparse()
      is_around(which) = .true.
      if (self%is_sparse()) then
         do i = 1, size(which)
            do k = self%sparse%row_start(which(i)), self%sparse%row_start(which(i) + 1) - 1
               is_around(self%sparse%column(k)) = .true.
            end do
         end do
      end if
      around = pack([(i, i=1, self%order)], is_around)
   end function neighbours

   !> Its product with some columns.
   pure function times(self, x) result(product)
      class(tail_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(:, :)               !! (order, n)
      real(dp) :: product(self%order, size(x, 2))
      integer :: j

      if (.not. self%is_sparse()) then
         product = product_of(self%full, x)
         return
      end if
      do j = 1, size(x, 2)
         product(:, j) = self%sparse%multiply(x(:, j))
      end do
   end function times

   !> A product with a vector, and the moduli of its terms.
   pure subroutine add_product(self, x, product, terms)
      class(tail_matrix_type), intent(in) :: self
      real(dp), intent(in) :: x(:)                        !! (order)
      real(dp), intent(out) :: product(:)                 !! (order)
      real(dp), intent(inout), optional :: terms(:)       !! (order) receives the moduli
      integer :: i, k

      product = 0.0_dp
      do i = 1, self%order
         ! Many are zero: contact points that touched at the start, without slip.
         if (.not. abs(x(i)) > 0.0_dp) cycle
         if (.not. self%is_sparse()) then
            product = product + x(i)*self%full(:, i)
            if (present(terms)) terms = terms + abs(x(i))*abs(self%full(:, i))
            cycle
         end if
         do k = self%sparse%row_start(i), self%sparse%row_start(i + 1) - 1
            associate (j => self%sparse%column(k), term => x(i)*self%sparse%value(k))
               product(j) = product(j) + term
               if (present(terms)) terms(j) = terms(j) + abs(term)
            end associate
         end do
      end do
   end subroutine add_product

end module tail_matrix
