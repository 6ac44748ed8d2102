!> Kernels of the multifrontal method on one front, a dense matrix of `p` pivots and `u` rows of
!> border in three parts: the columns of the pivots `left(p + u, p)`, the rows of the pivots in the
!> other columns `upper(p, u)`, and `rest(u, u)`.
module dd3_linalg_front_factor
  use dd3_base_kinds, only : wp
  use dd3_linalg_dense, only : dgemm, dgetrf, dtrsm
  implicit none
  private
  public :: put_blocks, add_border, factor_front

  !> Smallest pivot that is not shifted (the rows of the matrix add up to one), the first shift, and
  !> the largest number of shifts.
  real(wp), parameter :: pivot_limit = 1.0e-13_wp, pivot_shift = 1.0e-3_wp
  integer, parameter :: most_shifts = 5

contains

  !> Set a part of a front to the blocks of the matrix that belong to it.
  pure subroutine put_blocks(m, width, n, block, entry, value, part)
    !> Rows and columns of the part.
    integer, intent(in) :: m, width
    !> Number of blocks, their numbers, and the place of their first entries in the part.
    integer, intent(in) :: n, block(n), entry(n)
    real(wp), intent(in) :: value(3, 3, *)
    real(wp), intent(out) :: part(m*width)

    integer :: k, c, at

    part = 0.0_wp
    do k = 1, n
      do c = 1, 3
        at = entry(k) + m*(c - 1)
        part(at:at + 2) = value(:, c, block(k))
      end do
    end do
  end subroutine put_blocks

  !> Add the border of a child to a front.
  pure subroutine add_border(n, place, border, p, u, left, upper, rest)
    !> Number of block rows of the border, and their places in the front, ascending.
    integer, intent(in) :: n, place(n)
    real(wp), intent(in) :: border(3*n, 3*n)
    integer, intent(in) :: p, u
    real(wp), intent(inout) :: left(p + u, p), upper(p, u), rest(u, u)

    integer :: run(3, n), j, c, n_pivot, n_run, in_pivots

    n_pivot = count(place <= p/3)
    call find_runs(n, place, n_pivot, run, n_run, in_pivots)
    do j = 1, n_pivot
      do c = 1, 3
        call add_column(n_run, run, border(:, 3*j - 3 + c), 0, left(:, 3*place(j) - 3 + c))
      end do
    end do
    do j = n_pivot + 1, n
      do c = 1, 3
        associate (column => 3*place(j) - 3 + c - p, from => 3*j - 3 + c)
          call add_column(in_pivots, run, border(:, from), 0, upper(:, column))
          call add_column(n_run - in_pivots, run(:, in_pivots + 1:n_run), border(:, from), p, &
              rest(:, column))
        end associate
      end do
    end do
  end subroutine add_border

  !> Find the runs of rows that are neighbours in a front too; none extends beyond the pivots.
  pure subroutine find_runs(n, place, n_pivot, run, n_run, in_pivots)
    integer, intent(in) :: n, place(n), n_pivot
    !> First scalar row in the border less one, first in the front less one, number of scalar rows.
    integer, intent(out) :: run(3, n)
    !> Number of runs, and of those among the pivots.
    integer, intent(out) :: n_run, in_pivots

    logical :: begins
    integer :: i

    n_run = 0
    in_pivots = 0
    do i = 1, n
      begins = i == 1 .or. i == n_pivot + 1
      if (.not. begins) begins = place(i) /= place(i - 1) + 1
      if (begins) then
        n_run = n_run + 1
        run(:, n_run) = [3*i - 3, 3*place(i) - 3, 0]
      end if
      run(3, n_run) = run(3, n_run) + 3
      if (i == n_pivot) in_pivots = n_run
    end do
  end subroutine find_runs

  !> Add a column of a border to one of a front.
  pure subroutine add_column(n_run, run, from, before, to)
    integer, intent(in) :: n_run, run(3, n_run)
    real(wp), intent(in) :: from(*)
    !> Rows of the front before the part.
    integer, intent(in) :: before
    real(wp), intent(inout) :: to(*)

    integer :: k, i, shift

    do k = 1, n_run
      shift = run(2, k) - run(1, k) - before
      do i = run(1, k) + 1, run(1, k) + run(3, k)
        to(i + shift) = to(i + shift) + from(i)
      end do
    end do
  end subroutine add_column

  !> Eliminate the pivots of a front; see `multifrontal_t` for the factors.
  subroutine factor_front(p, u, is_leaf, left, upper, rest, pivot, shifted, good)
    integer, intent(in) :: p, u
    !> Whether nothing has been added to `rest`, which is undefined then.
    logical, intent(in) :: is_leaf
    real(wp), intent(inout) :: left(p + u, p), rest(u, u)
    real(wp), intent(in) :: upper(p, u)
    !> Row interchanges.
    integer, intent(out) :: pivot(p)
    !> Number of fronts shifted so far.
    integer, intent(inout) :: shifted
    !> Whether the pivots are finite.
    logical, intent(out) :: good

    real(wp) :: held(u)
    integer :: m, j

    m = p + u
    call factor_pivots(p, m, left, pivot, shifted, good)
    if (u == 0 .or. .not. good) return
    call dtrsm("R", "U", "N", "N", u, p, 1.0_wp, left, m, left(p + 1, 1), m)
    call dtrsm("R", "L", "N", "U", u, p, 1.0_wp, left, m, left(p + 1, 1), m)
    do j = p, 1, -1
      if (pivot(j) == j) cycle
      held = left(p + 1:, j)
      left(p + 1:, j) = left(p + 1:, pivot(j))
      left(p + 1:, pivot(j)) = held
    end do
    call dgemm("N", "N", u, u, p, -1.0_wp, left(p + 1, 1), m, upper, p, &
        merge(0.0_wp, 1.0_wp, is_leaf), rest, u)
  end subroutine factor_front

  !> Factorise the square of the pivots with row interchanges; its diagonal is shifted if a pivot
  !> vanishes.
  subroutine factor_pivots(p, m, left, pivot, shifted, good)
    integer, intent(in) :: p, m
    real(wp), intent(inout) :: left(m, p)
    integer, intent(out) :: pivot(p)
    integer, intent(inout) :: shifted
    logical, intent(out) :: good

    real(wp) :: kept(p, p), shift
    integer :: attempt, i, info

    kept = left(:p, :)
    shift = pivot_shift
    do attempt = 0, most_shifts
      call dgetrf(p, p, left, m, pivot, info)
      good = info == 0
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

end module dd3_linalg_front_factor
