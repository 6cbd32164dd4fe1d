!> Memory that OpenBLAS takes at its first use, and waits for without an end where there is too
!> little of it, as under `ulimit -v`.
module blas_memory
   use, intrinsic :: iso_c_binding, only: c_ptr, c_size_t
   use blas_lapack, only: dgetrf
   use kinds, only: dp
   implicit none
   private
   public :: reserve_blas_memory

   !> What it takes, and some room for what is taken between the question and its use [byte].
   integer(c_size_t), parameter :: needed = 144_c_size_t*1048576_c_size_t

   interface
      !> malloc(3) of C.
      function c_malloc(bytes) bind(c, name='malloc') result(address)
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: bytes
         type(c_ptr) :: address
      end function c_malloc

      !> free(3) of C.
      subroutine c_free(address) bind(c, name='free')
         import :: c_ptr
         type(c_ptr), value :: address
      end subroutine c_free
   end interface

contains

   !> Has OpenBLAS take its memory now, where there is enough of it. None of it is touched. Where
   !> there is not, the program ends as at any allocation.
   subroutine reserve_blas_memory()
      type(c_ptr) :: address
      real(dp) :: matrix(1, 1)
      integer :: pivot(1), info

      address = c_malloc(needed)
      call c_free(address)
      matrix = 1.0_dp
      call dgetrf(1, 1, matrix, 1, pivot, info)
   end subroutine reserve_blas_memory

end module blas_memory
