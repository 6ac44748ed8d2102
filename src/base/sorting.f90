! SPDX-License-Identifier: GPL-3.0-or-later
!> Sorting by merging (Knuth, The Art of Computer Programming, vol. 3, 5.2.4): stable, n log n.
module dd3_base_sorting
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: ascending

contains

  !> Return the order that makes keys ascend.
  pure function ascending(key) result(order)
    real(wp), intent(in) :: key(:)
    integer :: order(size(key))

    integer, allocatable :: from(:)
    integer :: width, start, i

    order = [(i, i=1, size(key))]
    width = 1
    do while (width < size(key))
      from = order
      do start = 1, size(key), 2*width
        call merge_runs(key, from, start, width, order)
      end do
      width = 2*width
    end do
  end function ascending

  !> Merge two neighbouring runs.
  pure subroutine merge_runs(key, from, start, width, to)
    real(wp), intent(in) :: key(:)
    integer, intent(in) :: from(:)
    !> First place, and number of places of a run.
    integer, intent(in) :: start, width
    integer, intent(inout) :: to(:)

    integer :: i, j, k, middle, last
    logical :: left

    middle = min(start + width, size(key) + 1)
    last = min(start + 2*width - 1, size(key))
    i = start
    j = middle
    do k = start, last
      left = i < middle
      if (left .and. j <= last) left = key(from(i)) <= key(from(j))
      to(k) = from(merge(i, j, left))
      if (left) i = i + 1
      if (.not. left) j = j + 1
    end do
  end subroutine merge_runs

end module dd3_base_sorting
