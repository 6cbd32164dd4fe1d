!> Crout's U^T D U of a symmetric matrix whose columns are stored in panels: neighbouring columns
!> with one first row, so that matrix products do the work. Columns behind the last pivot, the
!> border, hold their rows down to that pivot.
!>
!> Each panel takes from the earlier ones what these eliminate, left-looking like Crout's method by
!> columns. Until its rows are divided by their pivots it holds D U.
module column_panels
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use blas_lapack, only: daxpy, ddot, dgemm, dtrsm
   use kinds, only: dp, long
   implicit none
   private
   public :: column_panels_type, crout_flops

   !> Columns that a panel may have: products are fastest with multiples of 16.
   integer, parameter :: widths(8) = [64, 48, 32, 16, 8, 4, 2, 1]
   integer, parameter :: rest = 32        !! fewer columns that are left may be one panel
   integer, parameter :: narrow = 16      !! columns that a diagonal block is updated by
   integer, parameter :: zero_share = 4   !! entries for each zero that is stored above first rows

   !> The panels. Entry (i, j) of panel p is value(place(p, i, j)).
   type :: column_panels_type
      integer :: pivots = 0                      !! columns that are eliminated, the first ones
      integer, allocatable :: first_column(:)    !! (panels + 1), the last one behind all columns
      integer, allocatable :: first_row(:)       !! (panels) first stored row
      integer, allocatable :: height(:)          !! (panels) stored rows
      integer, allocatable :: panel(:)           !! (columns) the panel of each column
      integer(long), allocatable :: offset(:)    !! (panels) entries before the panel
      real(dp), allocatable :: value(:)          !! the matrix, then U and on its diagonal D
      real(dp), allocatable :: pivot(:)          !! (pivots) D
      real(dp), allocatable, private :: inverse(:)   !! (pivots) 1/D
      real(dp), allocatable, private :: room(:)      !! for D U of the rows above a panel's own
   contains
      procedure :: set_profile
      procedure :: place
      procedure :: factor
      procedure :: form_schur
      procedure :: eliminate
      procedure :: substitute
   end type column_panels_type

contains

   !> Lays out panels for a profile and fills them with zeros.
   pure subroutine set_profile(self, first_row, pivots)
      class(column_panels_type), intent(inout) :: self
      integer, intent(in) :: first_row(:)   !! (columns) first row of each column
      integer, intent(in) :: pivots         !! columns that are eliminated
      integer :: start(size(first_row) + 1), top(size(first_row))
      integer :: j, p
      integer(long) :: stored

      self%pivots = pivots
      allocate (self%panel(size(first_row)))
      p = 0
      start(1) = 1
      do while (start(p + 1) <= size(first_row))
         p = p + 1
         start(p + 1) = start(p) + panel_width(first_row, pivots, start(p))
         self%panel(start(p):start(p + 1) - 1) = p
         top(p) = minval(first_row(start(p):start(p + 1) - 1))
      end do
      self%first_column = start(:p + 1)
      self%first_row = top(:p)
      self%height = min(start(2:p + 1) - 1, pivots) - top(:p) + 1
      allocate (self%offset(p))
      stored = 0
      do j = 1, p
         self%offset(j) = stored
         stored = stored + int(self%height(j), long)*(start(j + 1) - start(j))
      end do
      allocate (self%value(stored), self%pivot(pivots), self%inverse(pivots), source=0.0_dp)
      allocate (self%room(widths(1)*maxval([0, self%height])))
   end subroutine set_profile

   !> Columns of the panel that begins with a column: as many as need few zeros above their first
   !> rows.
   pure integer function panel_width(first_row, pivots, j)
      integer, intent(in) :: first_row(:), pivots, j
      integer :: entries, i, k, last, top

      last = merge(pivots, size(first_row), j <= pivots)
      do i = 1, size(widths)
         panel_width = widths(i)
         if (panel_width == rest .and. j + rest - 1 > last) panel_width = last - j + 1
         if (j + panel_width - 1 > last) cycle
         associate (first => first_row(j:j + panel_width - 1))
            top = minval(first)
            entries = sum([(min(pivots, j + k - 1) - first(k) + 1, k=1, panel_width)])
            if (zero_share*sum(first - top) <= entries) return
         end associate
      end do
   end function panel_width

   !> Operations of Crout's method by columns, from one of them on.
   pure integer(long) function crout_flops(first_row, pivots, from) result(flops)
      integer, intent(in) :: first_row(:)   !! (columns) first row of each column
      integer, intent(in) :: pivots         !! columns that are eliminated
      integer, intent(in) :: from           !! first column
      integer :: high, i, j

      flops = 0
      do j = from, size(first_row)
         high = min(j - 1, pivots)
         do i = first_row(j) + 1, high
            flops = flops + 2*max(i - max(first_row(i), first_row(j)), 0)
         end do
         do i = pivots + 1, j - 1
            flops = flops + 2*max(pivots + 1 - max(first_row(i), first_row(j)), 0)
         end do
         flops = flops + 3*max(high - first_row(j) + 1, 0)
      end do
   end function crout_flops

   !> Position of an entry of a panel in value.
   pure integer(long) function place(self, p, i, j)
      class(column_panels_type), intent(in) :: self
      integer, intent(in) :: p      !! the panel
      integer, intent(in) :: i      !! row
      integer, intent(in) :: j      !! column

      place = self%offset(p) + int(j - self%first_column(p), long)*self%height(p) + &
         i - self%first_row(p) + 1
   end function place

   !> Factors the columns from one on; those before have their factors, and no entry of theirs is
   !> written.
   pure subroutine factor(self, from, least, smallest, bad_column)
      class(column_panels_type), intent(inout) :: self  !! matrix in, factors out
      integer, intent(in) :: from                       !! first column
      real(dp), intent(in) :: least   !! lost pivot over its diagonal entry; < 0: any but 0 is good
      real(dp), intent(out) :: smallest                 !! smallest pivot over its diagonal entry
      integer, intent(out) :: bad_column                !! column whose pivot is lost, 0 for none
      real(dp) :: original(widths(1))   ! diagonal entries
      integer :: first, j, last, p

      smallest = 1.0_dp
      bad_column = 0
      if (from > size(self%panel)) return
      do p = self%panel(from), size(self%first_row)
         last = self%first_column(p + 1) - 1
         first = max(from, self%first_column(p))
         if (first <= self%pivots) then
            do j = first, last
               original(j - first + 1) = self%value(self%place(p, j, j))
            end do
         end if
         call reduce_columns(self, p, first, last)
         if (first > self%pivots) cycle
         call factor_diagonal(self, p, first, original(:last - first + 1), least, smallest, &
            bad_column)
         if (bad_column > 0) return
      end do
   end subroutine factor

   !> Rows of U above the diagonal block of a panel, and what they leave of that block.
   pure subroutine reduce_columns(self, p, first, last)
      type(column_panels_type), intent(inout) :: self
      integer, intent(in) :: p, first, last   !! the panel and its columns that are factored
      integer :: block, j, own, q, rows, top
      integer(long) :: at

      own = self%first_column(p)
      top = self%first_row(p)
      rows = min(own - 1, self%pivots) - top + 1
      if (rows <= 0) return
      do q = self%panel(top), self%panel(top + rows - 1)
         call reduce_rows(self, q, p, first, last - first + 1)
      end do
      do j = first, last
         at = self%place(p, top, j)
         associate (column => self%value(at:at + rows - 1))
            self%room(rows*(j - first) + 1:rows*(j - first + 1)) = column
            column = column*self%inverse(top:top + rows - 1)
         end associate
      end do
      if (own > self%pivots) return
      do block = first, last, narrow
         j = min(block + narrow - 1, last)
         call dgemm('T', 'N', j - own + 1, j - block + 1, rows, -1.0_dp, &
            self%value(self%place(p, top, own)), self%height(p), &
            self%room(rows*(block - first) + 1), rows, 1.0_dp, &
            self%value(self%place(p, own, block)), self%height(p))
      end do
   end subroutine reduce_columns

   !> Eliminates the rows of panel q in columns of panel p, which keep D U.
   pure subroutine reduce_rows(self, q, p, first, columns)
      type(column_panels_type), intent(inout) :: self
      integer, intent(in) :: q, p, first, columns
      integer :: low, row, rows

      low = max(self%first_row(q), self%first_row(p))
      row = max(self%first_column(q), self%first_row(p))
      rows = self%first_column(q + 1) - row
      associate (at => self%place(p, row, first), hq => self%height(q), hp => self%height(p))
         if (row > low) call dgemm('T', 'N', rows, columns, row - low, -1.0_dp, &
            self%value(self%place(q, low, row)), hq, self%value(self%place(p, low, first)), hp, &
            1.0_dp, self%value(at), hp)
         call dtrsm('L', 'U', 'T', 'U', rows, columns, 1.0_dp, &
            self%value(self%place(q, row, row)), hq, self%value(at), hp)
      end associate
   end subroutine reduce_rows

   !> Factors the diagonal block of a panel, from one of its columns on, row by row: the same
   !> operations in the same order wherever it begins.
   pure subroutine factor_diagonal(self, p, first, original, least, smallest, bad_column)
      type(column_panels_type), intent(inout) :: self
      integer, intent(in) :: p, first
      real(dp), intent(in) :: original(:)   !! (columns from first on) diagonal entries
      real(dp), intent(in) :: least
      real(dp), intent(inout) :: smallest
      integer, intent(out) :: bad_column
      real(dp) :: block(widths(1), widths(1)), row(widths(1)), reduced
      integer :: before, i, j, n
      integer(long) :: at

      bad_column = 0
      before = first - self%first_column(p)
      n = before + size(original)
      do j = 1, n
         at = self%place(p, self%first_column(p), self%first_column(p) + j - 1)
         block(:j, j) = self%value(at:at + j - 1)
         block(j + 1:n, j) = 0.0_dp
      end do
      do i = 1, n
         if (i > before) then
            associate (entry => abs(original(i - before)))
               if (least >= 0.0_dp) then
                  if (.not. block(i, i) > least*entry) then
                     bad_column = self%first_column(p) + i - 1
                     return
                  end if
                  smallest = min(smallest, block(i, i)/entry)
               else if (.not. ieee_is_nan(block(i, i))) then
                  ! Solutions then are no numbers either, which is seen where they are checked.
                  if (abs(block(i, i)) <= 0.0_dp) block(i, i) = ieee_value(1.0_dp, ieee_quiet_nan)
               end if
            end associate
            self%pivot(self%first_column(p) + i - 1) = block(i, i)
            self%inverse(self%first_column(p) + i - 1) = 1.0_dp/block(i, i)
         end if
         row(i + 1:n) = block(i, i + 1:n)
         row(max(i, before) + 1:n) = row(max(i, before) + 1:n)/block(i, i)
         do j = max(i, before) + 1, n
            reduced = block(i, j)
            block(i + 1:j, j) = block(i + 1:j, j) - row(i + 1:j)*reduced
            block(i, j) = row(j)
         end do
      end do
      do j = before + 1, n
         at = self%place(p, self%first_column(p), self%first_column(p) + j - 1)
         self%value(at:at + n - 1) = block(:n, j)
      end do
   end subroutine factor_diagonal

   !> Subtracts U^T D U of the border from the upper triangle of a matrix.
   pure subroutine form_schur(self, border, schur)
      class(column_panels_type), intent(in) :: self      !! factors
      integer, intent(in) :: border                      !! columns of the border
      real(dp), intent(inout) :: schur(border, border)   !! its upper triangle
      real(dp), allocatable :: reduced(:)
      integer :: columns, first, j, low, p, q
      integer(long) :: at

      do p = 1, size(self%first_row)
         first = self%first_column(p)
         if (first <= self%pivots .or. self%height(p) < 1) cycle
         columns = self%first_column(p + 1) - first
         associate (h => self%height(p), top => self%first_row(p))
            if (allocated(reduced)) deallocate (reduced)
            allocate (reduced(columns*h))
            do j = 1, columns
               at = self%offset(p) + (j - 1)*h
               reduced((j - 1)*h + 1:j*h) = self%value(at + 1:at + h)*self%pivot(top:)
            end do
            do q = self%panel(self%pivots + 1), p
               low = max(top, self%first_row(q))
               if (low > self%pivots) cycle
               call dgemm('T', 'N', self%first_column(q + 1) - self%first_column(q), columns, &
                  self%pivots - low + 1, -1.0_dp, &
                  self%value(self%place(q, low, self%first_column(q))), self%height(q), &
                  reduced(low - top + 1), h, 1.0_dp, &
                  schur(self%first_column(q) - self%pivots, first - self%pivots), border)
            end do
         end associate
      end do
   end subroutine form_schur

   !> Forward elimination: U^-T on the rows of the pivots, which are taken from those of the border.
   pure subroutine eliminate(self, rows, columns, x)
      class(column_panels_type), intent(in) :: self      !! factors
      integer, intent(in) :: rows                        !! pivots and border
      integer, intent(in) :: columns                     !! right-hand sides, 0 or more
      real(dp), intent(inout) :: x(rows, columns)
      integer :: above, first, p, width

      if (columns == 0) return
      if (columns == 1) then
         call eliminate_one(self, rows, x)
         return
      end if
      do p = 1, size(self%first_row)
         first = self%first_column(p)
         width = self%first_column(p + 1) - first
         associate (h => self%height(p), top => self%first_row(p))
            above = min(first - 1, self%pivots) - top + 1
            if (above > 0) call dgemm('T', 'N', width, columns, above, -1.0_dp, &
               self%value(self%place(p, top, first)), h, x(top, 1), rows, 1.0_dp, &
               x(first, 1), rows)
            if (first <= self%pivots .and. width > 1) call dtrsm('L', 'U', 'T', 'U', width, &
               columns, 1.0_dp, self%value(self%place(p, first, first)), h, x(first, 1), rows)
         end associate
      end do
   end subroutine eliminate

   !> Forward elimination of one right-hand side, which is read along with each column.
   pure subroutine eliminate_one(self, rows, x)
      type(column_panels_type), intent(in) :: self
      integer, intent(in) :: rows
      real(dp), intent(inout) :: x(rows)
      integer :: j, p
      integer(long) :: at

      do p = 1, size(self%first_row)
         associate (top => self%first_row(p))
            at = self%offset(p) + 1
            do j = self%first_column(p), self%first_column(p + 1) - 1
               if (min(j, self%pivots + 1) > top) x(j) = x(j) - &
                  ddot(min(j, self%pivots + 1) - top, self%value(at), 1, x(top), 1)
               at = at + self%height(p)
            end do
         end associate
      end do
   end subroutine eliminate_one

   !> Divides by the pivots and substitutes back, the rows of the border being known.
   pure subroutine substitute(self, rows, columns, x)
      class(column_panels_type), intent(in) :: self      !! factors
      integer, intent(in) :: rows                        !! pivots and border
      integer, intent(in) :: columns                     !! right-hand sides, 0 or more
      real(dp), intent(inout) :: x(rows, columns)
      integer :: above, first, j, p, width

      if (columns == 0) return
      do j = 1, columns
         x(:self%pivots, j) = x(:self%pivots, j)/self%pivot
      end do
      if (columns == 1) then
         call substitute_one(self, rows, x)
         return
      end if
      do p = size(self%first_row), 1, -1
         first = self%first_column(p)
         width = self%first_column(p + 1) - first
         associate (h => self%height(p), top => self%first_row(p))
            above = min(first - 1, self%pivots) - top + 1
            if (first <= self%pivots .and. width > 1) call dtrsm('L', 'U', 'N', 'U', width, &
               columns, 1.0_dp, self%value(self%place(p, first, first)), h, x(first, 1), rows)
            if (above > 0) call dgemm('N', 'N', above, columns, width, -1.0_dp, &
               self%value(self%place(p, top, first)), h, x(first, 1), rows, 1.0_dp, x(top, 1), rows)
         end associate
      end do
   end subroutine substitute

   !> Back substitution of one right-hand side, divided by the pivots.
   pure subroutine substitute_one(self, rows, x)
      type(column_panels_type), intent(in) :: self
      integer, intent(in) :: rows
      real(dp), intent(inout) :: x(rows)
      integer :: j, p
      integer(long) :: at

      do p = size(self%first_row), 1, -1
         associate (top => self%first_row(p), width => self%first_column(p + 1) - &
            self%first_column(p))
            at = self%offset(p) + int(width, long)*self%height(p) + 1
            do j = self%first_column(p + 1) - 1, self%first_column(p), -1
               at = at - self%height(p)
               if (min(j, self%pivots + 1) > top) call daxpy(min(j, self%pivots + 1) - top, &
                  -x(j), self%value(at), 1, x(top), 1)
            end do
         end associate
      end do
   end subroutine substitute_one

end module column_panels
