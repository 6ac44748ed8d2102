! SPDX-License-Identifier: GPL-3.0-or-later
!> Tables of factors over the progress of a phase, linear between their places.
module dd3_model_progress_table
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: table_value, table_slope, next_place, interval, step

  !> Progress by which two places in a phase differ.
  real(wp), parameter :: step = 1.0e-9_wp

contains

  !> Return the factor of a table at a progress; the progress if there is no table.
  pure real(wp) function table_value(table, progress) result(factor)
    !> Progress and factor, `(2, n)`.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    integer :: i

    factor = progress
    if (.not. allocated(table)) return
    i = interval(table(1, :), progress)
    associate (x => table(1, i:i + 1), y => table(2, i:i + 1))
      factor = y(1) + (y(2) - y(1))*((progress - x(1))/(x(2) - x(1)))
    end associate
  end function table_value

  !> Return the derivative of the factor of a table behind a progress; 1 if there is no table.
  pure real(wp) function table_slope(table, progress) result(slope)
    !> Progress and factor, `(2, n)`.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    integer :: i

    slope = 1.0_wp
    if (.not. allocated(table)) return
    i = interval(table(1, :), progress + step)
    slope = (table(2, i + 1) - table(2, i))/(table(1, i + 1) - table(1, i))
  end function table_slope

  !> Return the next place of a table behind a progress; 1 without a table.
  pure real(wp) function next_place(table, progress)
    !> Progress in the first row.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    next_place = 1.0_wp
    if (allocated(table)) next_place = table(1, interval(table(1, :), progress + step) + 1)
  end function next_place

  !> Return the number of the interval that holds a value.
  pure integer function interval(x, value) result(i)
    !> Ascending.
    real(wp), intent(in) :: x(:)
    real(wp), intent(in) :: value

    do i = 1, size(x) - 2
      if (value < x(i + 1)) return
    end do
  end function interval

end module dd3_model_progress_table
