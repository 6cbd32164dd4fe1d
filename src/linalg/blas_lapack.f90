!> Explicit interfaces of the BLAS and LAPACK routines that are called; the memory that OpenBLAS
!> takes at its first use, and waits for without an end where there is too little of it, as under
!> `ulimit -v`.
module blas_lapack
   use, intrinsic :: iso_c_binding, only: c_ptr, c_size_t
   use kinds, only: dp
   implicit none
   private
   public :: ddot, daxpy, dgemm, dgemv, dsyr2k, dtrsm, dgetrf, dgetrs, dgesvd, dgeev, dgelsy, &
      dpstrf, dtrtri, ilaver, reserve_blas_memory

   interface
      !> Scalar product x.y.
      pure function ddot(n, x, stride_x, y, stride_y) result(product)
         import :: dp
         integer, intent(in) :: n, stride_x, stride_y
         real(dp), intent(in) :: x(*), y(*)
         real(dp) :: product
      end function ddot

      !> y = y + a x.
      pure subroutine daxpy(n, a, x, stride_x, y, stride_y)
         import :: dp
         integer, intent(in) :: n, stride_x, stride_y
         real(dp), intent(in) :: a, x(*)
         real(dp), intent(inout) :: y(*)
      end subroutine daxpy

      !> y = alpha A x + beta y, or with A^T.
      pure subroutine dgemv(trans, m, n, alpha, a, lda, x, stride_x, beta, y, stride_y)
         import :: dp
         character, intent(in) :: trans
         integer, intent(in) :: m, n, lda, stride_x, stride_y
         real(dp), intent(in) :: alpha, a(lda, *), x(*), beta
         real(dp), intent(inout) :: y(*)
      end subroutine dgemv

      !> C = alpha A B + beta C, or with A^T or B^T.
      pure subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: dp
         character, intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(dp), intent(in) :: alpha, a(lda, *), b(ldb, *), beta
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dgemm

      !> C = alpha (A B^T + B A^T) + beta C, or with A^T B, a triangle of it.
      pure subroutine dsyr2k(uplo, trans, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: dp
         character, intent(in) :: uplo, trans
         integer, intent(in) :: n, k, lda, ldb, ldc
         real(dp), intent(in) :: alpha, a(lda, *), b(ldb, *), beta
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dsyr2k

      !> B = alpha A^-1 B, or with A^T, or from the right; A is a triangle.
      pure subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
         import :: dp
         character, intent(in) :: side, uplo, transa, diag
         integer, intent(in) :: m, n, lda, ldb
         real(dp), intent(in) :: alpha, a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
      end subroutine dtrsm

      !> LU factors of a general matrix, with row exchanges.
      pure subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: dp
         integer, intent(in) :: m, n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgetrf

      !> Solution from the factors of dgetrf.
      pure subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         character, intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ipiv(*), ldb
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs

      !> Singular value decomposition of a general matrix.
      pure subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         import :: dp
         character, intent(in) :: jobu, jobvt
         integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *), work(*)
         integer, intent(out) :: info
      end subroutine dgesvd

      !> Eigenvalues, and eigenvectors where asked for, of a general matrix.
      subroutine dgeev(jobvl, jobvr, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, work, lwork, info)
         import :: dp
         character, intent(in) :: jobvl, jobvr
         integer, intent(in) :: n, lda, ldvl, ldvr, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: wr(*), wi(*), vl(ldvl, *), vr(ldvr, *), work(*)
         integer, intent(out) :: info
      end subroutine dgeev

      !> Cholesky factors of a symmetric matrix, with row and column exchanges, up to its rank.
      subroutine dpstrf(uplo, n, a, lda, piv, rank, tol, work, info)
         import :: dp
         character, intent(in) :: uplo
         integer, intent(in) :: n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: piv(*), rank, info
         real(dp), intent(in) :: tol
         real(dp), intent(out) :: work(*)
      end subroutine dpstrf

      !> Inverse of a triangular matrix.
      subroutine dtrtri(uplo, diag, n, a, lda, info)
         import :: dp
         character, intent(in) :: uplo, diag
         integer, intent(in) :: n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: info
      end subroutine dtrtri

      !> Least squares of any rank, by an orthogonal factorisation with column exchanges.
      subroutine dgelsy(m, n, nrhs, a, lda, b, ldb, jpvt, rcond, rank, work, lwork, info)
         import :: dp
         integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(inout) :: jpvt(*)
         real(dp), intent(in) :: rcond
         integer, intent(out) :: rank, info
         real(dp), intent(out) :: work(*)
      end subroutine dgelsy

      !> Version of LAPACK.
      subroutine ilaver(major, minor, patch)
         integer, intent(out) :: major, minor, patch
      end subroutine ilaver
   end interface

   !> Memory of OpenBLAS, and room for allocations between the question and its use [byte].
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

end module blas_lapack
