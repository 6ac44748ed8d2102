! SPDX-License-Identifier: GPL-3.0-or-later
!> Interfaces of the procedures of BLAS and LAPACK that the factorisation of dense fronts uses.
module dd3_linalg_dense
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: dgemm, dgemv, dgetrf, dlaswp, dtrmm, dtrsv

  interface
    !> c = alpha op(a) op(b) + beta c.
    subroutine dgemm(op_a, op_b, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: wp
      character, intent(in) :: op_a, op_b
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(wp), intent(in) :: alpha, beta, a(*), b(*)
      real(wp), intent(inout) :: c(*)
    end subroutine dgemm

    !> y = alpha op(a) x + beta y.
    subroutine dgemv(op, m, n, alpha, a, lda, x, stride_x, beta, y, stride_y)
      import :: wp
      character, intent(in) :: op
      integer, intent(in) :: m, n, lda, stride_x, stride_y
      real(wp), intent(in) :: alpha, beta, a(*), x(*)
      real(wp), intent(inout) :: y(*)
    end subroutine dgemv

    !> LU factors with row interchanges.
    subroutine dgetrf(m, n, a, lda, pivot, info)
      import :: wp
      integer, intent(in) :: m, n, lda
      real(wp), intent(inout) :: a(*)
      integer, intent(out) :: pivot(*), info
    end subroutine dgetrf

    !> Interchange row i with row `pivot(i)`, for i from `first` to `last`.
    subroutine dlaswp(n, a, lda, first, last, pivot, stride)
      import :: wp
      integer, intent(in) :: n, lda, first, last, pivot(*), stride
      real(wp), intent(inout) :: a(*)
    end subroutine dlaswp

    !> Multiply several vectors by a triangular matrix.
    subroutine dtrmm(side, triangle, op, diagonal, m, n, alpha, a, lda, b, ldb)
      import :: wp
      character, intent(in) :: side, triangle, op, diagonal
      integer, intent(in) :: m, n, lda, ldb
      real(wp), intent(in) :: alpha, a(*)
      real(wp), intent(inout) :: b(*)
    end subroutine dtrmm

    !> Solve with a triangular matrix.
    subroutine dtrsv(triangle, op, diagonal, n, a, lda, x, stride)
      import :: wp
      character, intent(in) :: triangle, op, diagonal
      integer, intent(in) :: n, lda, stride
      real(wp), intent(in) :: a(*)
      real(wp), intent(inout) :: x(*)
    end subroutine dtrsv
  end interface

end module dd3_linalg_dense
