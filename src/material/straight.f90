! SPDX-License-Identifier: GPL-3.0-or-later
!> Points joined by straight lines, constant before the first and beyond the last.
module dd3_material_straight
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: straight

contains

  !> Evaluate value and slope at a place.
  pure subroutine straight(places, values, at, value, slope)
    !> Of the points; the places rise.
    real(wp), intent(in) :: places(:), values(:)
    real(wp), intent(in) :: at
    real(wp), intent(out) :: value, slope

    integer :: i

    i = count(places <= at)
    slope = 0.0_wp
    value = values(max(i, 1))
    if (i == 0 .or. i == size(places)) return
    slope = (values(i + 1) - values(i))/(places(i + 1) - places(i))
    value = values(i) + slope*(at - places(i))
  end subroutine straight

end module dd3_material_straight
