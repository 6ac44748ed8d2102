! SPDX-License-Identifier: GPL-3.0-or-later
!> Assembly of a front, a dense matrix of `p` pivots and `u` rows of border in three parts: the
!> columns of the pivots `left(p + u, p)`, the rows of the pivots in the other columns
!> `upper(p, u)`, and `rest(u, u)`.
module dd3_linalg_front_assembly
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: put_blocks, add_border, add_part

contains

  !> Add the blocks of the matrix that belong to a part of a front.
  pure subroutine put_blocks(m, n, block, entry, value, part)
    !> Rows of the part.
    integer, intent(in) :: m
    !> Number of blocks, their numbers, and the place of their first entries in the part.
    integer, intent(in) :: n, block(n), entry(n)
    real(wp), intent(in) :: value(3, 3, *)
    real(wp), intent(inout) :: part(*)

    integer :: k, c, at

    do k = 1, n
      do c = 1, 3
        at = entry(k) + m*(c - 1)
        part(at:at + 2) = part(at:at + 2) + value(:, c, block(k))
      end do
    end do
  end subroutine put_blocks

  !> Add the border of a child to some block columns of a front.
  pure subroutine add_border(n, place, border, columns, p, u, left, upper, rest)
    !> Number of block rows of the border, and their places in the front, ascending.
    integer, intent(in) :: n, place(n)
    real(wp), intent(in) :: border(3*n, 3*n)
    !> First and last block column of the front.
    integer, intent(in) :: columns(2)
    integer, intent(in) :: p, u
    real(wp), intent(inout) :: left(p + u, p), upper(p, u), rest(u, u)

    integer :: run(3, n), first, last, j, c, n_run, in_pivots

    first = count(place < columns(1)) + 1
    last = count(place <= columns(2))
    if (first > last) return
    call find_runs(n, place, count(place <= p/3), run, n_run, in_pivots)
    do j = first, last
      do c = 1, 3
        associate (column => 3*place(j) - 3 + c, from => 3*j - 3 + c)
          if (column <= p) then
            call add_column(n_run, run, border(:, from), 0, left(:, column))
          else
            call add_column(in_pivots, run, border(:, from), 0, upper(:, column - p))
            call add_column(n_run - in_pivots, run(:, in_pivots + 1:n_run), border(:, from), p, &
                rest(:, column - p))
          end if
        end associate
      end do
    end do
  end subroutine add_border

  !> Add the part of a vector that belongs to the border of a child to that of a front.
  pure subroutine add_part(n, place, border, p, pivots, rest)
    !> See `add_border`.
    integer, intent(in) :: n, place(n)
    real(wp), intent(in) :: border(3*n)
    !> Number of pivots.
    integer, intent(in) :: p
    !> The front's vector, of the pivots and of its border.
    real(wp), intent(inout) :: pivots(p), rest(*)

    integer :: k, i

    do k = 1, n
      i = 3*place(k) - 2
      if (i < p) then
        pivots(i:i + 2) = pivots(i:i + 2) + border(3*k - 2:3*k)
      else
        rest(i - p:i - p + 2) = rest(i - p:i - p + 2) + border(3*k - 2:3*k)
      end if
    end do
  end subroutine add_part

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

end module dd3_linalg_front_assembly
