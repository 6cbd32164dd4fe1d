!> Tails from full matrices.
module sample_tails
   use kinds, only: dp
   use sparse_matrix, only: triplet_list_type
   use tail_matrix, only: tail_matrix_type
   implicit none
   private
   public :: full_tail, sparse_tail

contains

   !> A full one.
   pure function full_tail(matrix) result(tail)
      real(dp), intent(in) :: matrix(:, :)
      type(tail_matrix_type) :: tail

      tail%full = matrix
      call tail%set_order()
   end function full_tail

   !> A sparse one, of the entries that are not 0.
   pure function sparse_tail(matrix) result(tail)
      real(dp), intent(in) :: matrix(:, :)
      type(tail_matrix_type) :: tail
      type(triplet_list_type) :: list
      integer :: i, j

      call list%reserve(size(matrix))
      do j = 1, size(matrix, 2)
         do i = 1, size(matrix, 1)
            if (abs(matrix(i, j)) > 0.0_dp) call list%add(i, j, matrix(i, j))
         end do
      end do
      tail%sparse = list%compress(size(matrix, 1), size(matrix, 1))
      call tail%set_order()
   end function sparse_tail

end module sample_tails
