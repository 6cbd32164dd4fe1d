!> Where a value lies between the rows of a table: linear between rows, held outside of them.
module table_rows
   use kinds, only: dp
   implicit none
   private
   public :: find_row, row_below

contains

   !> The row at or below a value, the first one below it, and the part of the way to the next one.
   pure subroutine find_row(rows, value, row, part)
      real(dp), intent(in) :: rows(:)     !! ascending
      real(dp), intent(in) :: value
      integer, intent(out) :: row
      real(dp), intent(out) :: part       !! 0 on a row and outside of them

      row = row_below(rows, value)
      part = 0.0_dp
      if (row > 0 .and. row < size(rows)) part = (value - rows(row))/(rows(row + 1) - rows(row))
      row = max(row, 1)
   end subroutine find_row

   !> The last row not above a value, or 0.
   pure integer function row_below(rows, value) result(row)
      real(dp), intent(in) :: rows(:)     !! ascending
      real(dp), intent(in) :: value

      do row = size(rows), 1, -1
         if (rows(row) <= value) return
      end do
   end function row_below

end module table_rows
