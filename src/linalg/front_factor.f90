! SPDX-License-Identifier: GPL-3.0-or-later
!> Elimination of the pivots of a front, see dd3_linalg_front_assembly for its parts. Rows and
!> columns are divided into blocks, for threads or not, that depend on the size of the front only:
!> the results are the same for any number of threads.
module dd3_linalg_front_factor
  use dd3_base_kinds, only : wp
  use dd3_linalg_dense, only : dgemm, dgetrf, dlaswp
  use dd3_linalg_front_triangle, only : diagonal_block, divide_by_lower, &
      divide_by_lower_from_left, divide_by_upper, invert_lower, invert_upper
  implicit none
  private
  public :: factor_front

  !> Smallest pivot that is not shifted (the rows of the matrix add up to one), the first shift, and
  !> the largest number of shifts.
  real(wp), parameter :: pivot_limit = 1.0e-13_wp, pivot_shift = 1.0e-3_wp
  integer, parameter :: most_shifts = 5
  !> Columns of a panel of the pivots, a multiple of `diagonal_block`, and twice the rows or columns
  !> of the border from which it is divided.
  integer, parameter :: panel = 96, divided = 256

contains

  !> Eliminate the pivots of a front; see `multifrontal_t` for the factors.
  subroutine factor_front(p, u, is_leaf, threads, left, upper, rest, pivot, shifted, good)
    integer, intent(in) :: p, u
    !> Whether nothing has been added to `rest`, which is undefined then.
    logical, intent(in) :: is_leaf
    integer, intent(in) :: threads
    real(wp), intent(inout) :: left(p + u, p), rest(u, u)
    real(wp), intent(in) :: upper(p, u)
    !> Row interchanges.
    integer, intent(out) :: pivot(p)
    !> Number of fronts shifted so far.
    integer, intent(inout) :: shifted
    !> Whether the pivots are finite.
    logical, intent(out) :: good

    real(wp) :: inverse(diagonal_block, p)
    integer :: m, n_block, b, first, n

    m = p + u
    call factor_pivots(p, m, threads, left, pivot, inverse, shifted, good)
    if (u == 0 .or. .not. good) return
    call invert_upper(p, m, left, inverse)
    n_block = max(1, 2*(u/divided))
    !$omp parallel do num_threads(threads) if (threads > 1) private(first, n) schedule(dynamic)
    do b = 1, n_block
      first = (b - 1)*u/n_block + 1
      n = b*u/n_block - first + 1
      call eliminate_rows(n, p, m, left, inverse, pivot, left(p + first, 1))
    end do
    !$omp end parallel do
    !$omp parallel do num_threads(threads) if (threads > 1) private(first, n) schedule(dynamic)
    do b = 1, n_block
      first = (b - 1)*u/n_block + 1
      n = b*u/n_block - first + 1
      call dgemm("N", "N", u, n, p, -1.0_wp, left(p + 1, 1), m, upper(1, first), p, &
          merge(0.0_wp, 1.0_wp, is_leaf), rest(1, first), u)
    end do
    !$omp end parallel do
  end subroutine factor_front

  !> Set rows of A21 to A21 A11^-1.
  subroutine eliminate_rows(n, p, m, factors, inverse, pivot, rows)
    integer, intent(in) :: n, p, m
    !> P A11 = L U and the inverses of the diagonal blocks of L and U.
    real(wp), intent(in) :: factors(m, *), inverse(diagonal_block, p)
    integer, intent(in) :: pivot(p)
    real(wp), intent(inout) :: rows(m, *)

    real(wp) :: held(n)
    integer :: j

    call divide_by_upper(n, p, factors, m, inverse, rows, m)
    call divide_by_lower(n, p, factors, m, inverse, rows, m)
    do j = p, 1, -1
      if (pivot(j) == j) cycle
      held = rows(:n, j)
      rows(:n, j) = rows(:n, pivot(j))
      rows(:n, pivot(j)) = held
    end do
  end subroutine eliminate_rows

  !> Factorise the square of the pivots with row interchanges; its diagonal is shifted if a pivot
  !> vanishes.
  subroutine factor_pivots(p, m, threads, left, pivot, inverse, shifted, good)
    integer, intent(in) :: p, m, threads
    real(wp), intent(inout) :: left(m, p)
    integer, intent(out) :: pivot(p)
    !> Of the diagonal blocks of L.
    real(wp), intent(out) :: inverse(diagonal_block, p)
    integer, intent(inout) :: shifted
    logical, intent(out) :: good

    real(wp) :: kept(p, p), shift
    integer :: attempt, i

    kept = left(:p, :)
    shift = pivot_shift
    do attempt = 0, most_shifts
      call factor_square(p, m, threads, left, pivot, inverse)
      good = .true.
      do i = 1, p
        good = good .and. abs(left(i, i)) > pivot_limit .and. abs(left(i, i)) < huge(shift)
      end do
      if (good) return
      if (attempt == 0) shifted = shifted + 1
      left(:p, :) = kept
      do i = 1, p
        left(i, i) = left(i, i) + sign(shift, left(i, i))
      end do
      shift = 10*shift
    end do
  end subroutine factor_pivots

  !> Factorise the square panel by panel; with several threads the next panel is factorised as soon
  !> as its columns are up to date.
  subroutine factor_square(p, m, threads, a, pivot, inverse)
    integer, intent(in) :: p, m, threads
    real(wp), intent(inout) :: a(m, p)
    integer, intent(out) :: pivot(p)
    real(wp), intent(out) :: inverse(diagonal_block, p)

    integer :: mark(0:(p - 1)/panel), i, j, k

    if (p <= panel) then
      call factor_panel(p, p, m, a, pivot, inverse)
      return
    end if
    !$omp parallel num_threads(threads) if (threads > 1)
    !$omp single
    do k = 0, (p - 1)/panel
      !$omp task depend(inout: mark(k)) firstprivate(k) private(i) default(shared)
      i = panel*k + 1
      call factor_panel(p - i + 1, min(panel, p - i + 1), m, a(i, i), pivot(i), inverse(1, i))
      !$omp end task
      do j = k + 1, (p - 1)/panel
        !$omp task depend(in: mark(k)) depend(inout: mark(j)) firstprivate(j, k) private(i) &
        !$omp& default(shared)
        i = panel*k + 1
        call update_panel(p - i + 1, min(panel, p - panel*j), m, a(i, i), pivot(i), &
            inverse(1, i), a(i, panel*j + 1))
        !$omp end task
      end do
    end do
    !$omp end single
    !$omp end parallel
    do k = 1, (p - 1)/panel
      i = panel*k + 1
      pivot(i:min(p, i + panel - 1)) = pivot(i:min(p, i + panel - 1)) + i - 1
      call dlaswp(i - 1, a, m, i, min(p, i + panel - 1), pivot, 1)
    end do
  end subroutine factor_square

  !> Factorise a panel.
  subroutine factor_panel(rows, columns, m, a, pivot, inverse)
    integer, intent(in) :: rows, columns, m
    real(wp), intent(inout) :: a(m, *)
    integer, intent(out) :: pivot(columns)
    real(wp), intent(out) :: inverse(diagonal_block, columns)

    integer :: ignored

    call dgetrf(rows, columns, a, m, pivot, ignored)
    call invert_lower(columns, m, a, inverse)
  end subroutine factor_panel

  !> Update the columns of a later panel.
  subroutine update_panel(rows, columns, m, a, pivot, inverse, x)
    integer, intent(in) :: rows, columns, m
    !> Panel, factorised.
    real(wp), intent(in) :: a(m, *)
    integer, intent(in) :: pivot(*)
    real(wp), intent(in) :: inverse(diagonal_block, *)
    real(wp), intent(inout) :: x(m, *)

    call dlaswp(columns, x, m, 1, panel, pivot, 1)
    call divide_by_lower_from_left(panel, columns, a, m, inverse, x, m)
    call dgemm("N", "N", rows - panel, columns, panel, -1.0_wp, a(panel + 1, 1), m, x, m, 1.0_wp, &
        x(panel + 1, 1), m)
  end subroutine update_panel

end module dd3_linalg_front_factor
