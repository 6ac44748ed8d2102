! SPDX-License-Identifier: GPL-3.0-or-later
!> Division of rectangular blocks by triangular factors, by halves, so that nearly all operations
!> are matrix products: the triangular solves of BLAS take several times as long. The diagonal
!> blocks are inverted beforehand.
module dd3_linalg_front_triangle
  use dd3_base_kinds, only : wp
  use dd3_linalg_dense, only : dgemm, dtrmm
  implicit none
  private
  public :: diagonal_block, invert_lower, invert_upper
  public :: divide_by_lower, divide_by_upper, divide_by_lower_from_left

  !> Size of the diagonal blocks that are inverted.
  integer, parameter :: diagonal_block = 16

contains

  !> Invert the diagonal blocks of a unit lower triangular factor.
  pure subroutine invert_lower(p, lda, factors, inverse)
    integer, intent(in) :: p, lda
    !> L below the diagonal.
    real(wp), intent(in) :: factors(lda, *)
    !> Inverses beside one another; set below the diagonals of the blocks.
    real(wp), intent(inout) :: inverse(diagonal_block, p)

    integer :: first, i, j, k, n

    do first = 1, p, diagonal_block
      n = min(diagonal_block, p - first + 1)
      associate (a => factors(first:first + n - 1, first:first + n - 1), &
          w => inverse(:, first:first + n - 1))
        do j = 1, n - 1
          do i = j + 1, n
            w(i, j) = -a(i, j)
          end do
          do k = j + 1, n - 1
            do i = k + 1, n
              w(i, j) = w(i, j) - a(i, k)*w(k, j)
            end do
          end do
        end do
      end associate
    end do
  end subroutine invert_lower

  !> Invert the diagonal blocks of an upper triangular factor.
  pure subroutine invert_upper(p, lda, factors, inverse)
    integer, intent(in) :: p, lda
    !> U in the upper triangle; no zeros on its diagonal.
    real(wp), intent(in) :: factors(lda, *)
    !> Inverses beside one another; set in the upper triangles of the blocks.
    real(wp), intent(inout) :: inverse(diagonal_block, p)

    integer :: first, i, j, k, n

    do first = 1, p, diagonal_block
      n = min(diagonal_block, p - first + 1)
      associate (a => factors(first:first + n - 1, first:first + n - 1), &
          w => inverse(:, first:first + n - 1))
        do j = 1, n
          w(j, j) = 1.0_wp/a(j, j)
          w(:j - 1, j) = 0.0_wp
          do k = 1, j - 1
            do i = 1, k
              w(i, j) = w(i, j) - w(i, k)*a(k, j)
            end do
          end do
          w(:j - 1, j) = w(j, j)*w(:j - 1, j)
        end do
      end associate
    end do
  end subroutine invert_upper

  !> Return the first part of a triangle cut in halves along its diagonal blocks.
  pure integer function half(p)
    !> Larger than a diagonal block.
    integer, intent(in) :: p

    half = diagonal_block*(((p + diagonal_block - 1)/diagonal_block + 1)/2)
  end function half

  !> Set X to X U^-1.
  recursive subroutine divide_by_upper(rows, p, factors, lda, inverse, x, ldx)
    integer, intent(in) :: rows, p, lda, ldx
    !> U in the upper triangle, and the inverses of its diagonal blocks.
    real(wp), intent(in) :: factors(lda, *), inverse(diagonal_block, *)
    real(wp), intent(inout) :: x(ldx, *)

    integer :: h

    if (p <= diagonal_block) then
      call dtrmm("R", "U", "N", "N", rows, p, 1.0_wp, inverse, diagonal_block, x, ldx)
      return
    end if
    h = half(p)
    call divide_by_upper(rows, h, factors, lda, inverse, x, ldx)
    call dgemm("N", "N", rows, p - h, h, -1.0_wp, x, ldx, factors(1, h + 1), lda, 1.0_wp, &
        x(1, h + 1), ldx)
    call divide_by_upper(rows, p - h, factors(h + 1, h + 1), lda, inverse(1, h + 1), x(1, h + 1), &
        ldx)
  end subroutine divide_by_upper

  !> Set X to X L^-1.
  recursive subroutine divide_by_lower(rows, p, factors, lda, inverse, x, ldx)
    integer, intent(in) :: rows, p, lda, ldx
    !> L below the diagonal, and the inverses of its diagonal blocks.
    real(wp), intent(in) :: factors(lda, *), inverse(diagonal_block, *)
    real(wp), intent(inout) :: x(ldx, *)

    integer :: h

    if (p <= diagonal_block) then
      call dtrmm("R", "L", "N", "U", rows, p, 1.0_wp, inverse, diagonal_block, x, ldx)
      return
    end if
    h = half(p)
    call divide_by_lower(rows, p - h, factors(h + 1, h + 1), lda, inverse(1, h + 1), x(1, h + 1), &
        ldx)
    call dgemm("N", "N", rows, h, p - h, -1.0_wp, x(1, h + 1), ldx, factors(h + 1, 1), lda, &
        1.0_wp, x, ldx)
    call divide_by_lower(rows, h, factors, lda, inverse, x, ldx)
  end subroutine divide_by_lower

  !> Set X to L^-1 X.
  recursive subroutine divide_by_lower_from_left(p, columns, factors, lda, inverse, x, ldx)
    integer, intent(in) :: p, columns, lda, ldx
    !> L below the diagonal, and the inverses of its diagonal blocks.
    real(wp), intent(in) :: factors(lda, *), inverse(diagonal_block, *)
    real(wp), intent(inout) :: x(ldx, *)

    integer :: h

    if (p <= diagonal_block) then
      call dtrmm("L", "L", "N", "U", p, columns, 1.0_wp, inverse, diagonal_block, x, ldx)
      return
    end if
    h = half(p)
    call divide_by_lower_from_left(h, columns, factors, lda, inverse, x, ldx)
    call dgemm("N", "N", p - h, columns, h, -1.0_wp, factors(h + 1, 1), lda, x, ldx, 1.0_wp, &
        x(h + 1, 1), ldx)
    call divide_by_lower_from_left(p - h, columns, factors(h + 1, h + 1), lda, inverse(1, h + 1), &
        x(h + 1, 1), ldx)
  end subroutine divide_by_lower_from_left

end module dd3_linalg_front_triangle
