!> Nested dissection by METIS.
module metis
   use, intrinsic :: iso_c_binding, only: c_int, c_ptr, c_null_ptr
   use errors, only: error_type, set_error, status_internal
   use sparse_matrix, only: sparse_matrix_type
   implicit none
   private
   public :: nested_dissection

   interface
      function metis_nodend(nvtxs, xadj, adjncy, vwgt, options, perm, iperm) &
         result(status) bind(c, name='METIS_NodeND')
         import :: c_int, c_ptr
         integer(c_int), intent(in) :: nvtxs, xadj(*), adjncy(*)
         type(c_ptr), value :: vwgt, options
         integer(c_int), intent(out) :: perm(*), iperm(*)
         integer(c_int) :: status
      end function metis_nodend
   end interface

contains

   !> Fill-reducing position of each vertex of a graph. METIS's default options fix its random seed.
   !> Error: METIS fails.
   subroutine nested_dissection(graph, position, error)
      type(sparse_matrix_type), intent(in) :: graph !! both triangles without the diagonal
      integer, allocatable, intent(out) :: position(:)    !! (rows) new position of each vertex
      type(error_type), allocatable, intent(out) :: error
      integer(c_int), allocatable :: order(:)
      integer(c_int) :: status
      integer(c_int), parameter :: metis_ok = 1

      allocate (order(graph%row_count), position(graph%row_count))
      ! METIS divides by the number of vertices.
      if (graph%row_count == 0) return
      status = metis_nodend(int(graph%row_count, c_int), graph%row_start - 1, graph%column - 1, &
         c_null_ptr, c_null_ptr, order, position)
      position(:) = position + 1
      if (status /= metis_ok) call set_error(error, status_internal, &
         'METIS could not order the unknowns')
   end subroutine nested_dissection

end module metis
