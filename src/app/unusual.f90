! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings of values that lie outside their usual range.
module dd3_app_unusual
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  implicit none
  private
  public :: add_unusual, outside, unusual_unit

  character(len=*), parameter :: unusual_unit = "unusual; units are N, mm and MPa"

contains

  !> Whether a value lies outside its bounds.
  pure logical function outside(value, lower, upper)
    real(wp), intent(in) :: value, lower, upper

    outside = value < lower .or. value > upper
  end function outside

  !> Add a warning.
  subroutine add_unusual(warnings, code, at, what, remark)
    type(message_list_t), intent(inout) :: warnings
    character(len=*), intent(in) :: code
    !> Location of the value.
    type(location_t), intent(in) :: at
    !> The value with its unit and owner.
    character(len=*), intent(in) :: what
    character(len=*), intent(in) :: remark

    call warnings%add_new(code, what//": "//remark, at)
  end subroutine add_unusual

end module dd3_app_unusual
