! SPDX-License-Identifier: GPL-3.0-or-later
!> Pairs of points at nearly the same place, by a sweep along a direction in which few points have
!> the same abscissa.
module dd3_base_near_points
  use dd3_base_kinds, only : wp
  use dd3_base_sorting, only : ascending
  implicit none
  private
  public :: near_pairs

  !> Direction of the sweep: oblique to the axes and their diagonals.
  real(wp), parameter :: generic(3) = [0.5377_wp, 0.8123_wp, 0.2257_wp]

contains

  !> Find the pairs of points whose coordinates differ by at most a tolerance each.
  pure subroutine near_pairs(x, tolerance, most, pair)
    !> `(3, n)`.
    real(wp), intent(in) :: x(:, :)
    real(wp), intent(in) :: tolerance
    !> Number of pairs at which the search ends.
    integer, intent(in) :: most
    !> `(2, n_pair)`, first < second; ascending by the first, then by the second.
    integer, allocatable, intent(out) :: pair(:, :)

    real(wp), allocatable :: abscissa(:)
    integer, allocatable :: order(:), found(:, :)
    real(wp) :: range
    integer :: i, j, n

    abscissa = matmul(generic, x)
    order = ascending(abscissa)
    range = tolerance*sum(generic)*(1.0_wp + 1.0e-6_wp) &
        + 8.0_wp*epsilon(1.0_wp)*maxval(abs(abscissa))
    allocate (found(2, 64))
    n = 0
    sweep: do i = 1, size(order)
      do j = i + 1, size(order)
        if (abscissa(order(j)) - abscissa(order(i)) > range) exit
        if (any(abs(x(:, order(j)) - x(:, order(i))) > tolerance)) cycle
        if (n == most) exit sweep
        if (n == size(found, 2)) found = reshape(found, [2, 2*n], pad=[0])
        n = n + 1
        found(:, n) = [min(order(i), order(j)), max(order(i), order(j))]
      end do
    end do sweep
    pair = found(:, ascending(real(found(1, :n), wp)*real(size(x, 2) + 1, wp) &
        + real(found(2, :n), wp)))
  end subroutine near_pairs

end module dd3_base_near_points
