! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the refinement with which elements become short enough.
module dd3_report_suitable_levels
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_settings_adaptive, only : adaptive_spec_t, most_levels
  implicit none
  private
  public :: halvings, levels_advice

  !> Excess of a ratio that is round-off.
  real(wp), parameter :: round_off = 1.0e-6_wp

contains

  !> Return how often a value must be halved to be at most another one.
  elemental integer function halvings(value, limit)
    real(wp), intent(in) :: value, limit

    halvings = max(0, ceiling(log(max(value, tiny(1.0_wp))/limit)/log(2.0_wp) - round_off))
  end function halvings

  !> Return which settings let elements be divided far enough.
  pure function levels_advice(adaptive, levels, length) result(text)
    !> Settings of the run.
    type(adaptive_spec_t), intent(in) :: adaptive
    !> Level that elements need, and their length with it, mm.
    integer, intent(in) :: levels
    real(wp), intent(in) :: length
    character(len=:), allocatable :: text

    text = ""
    if (levels > most_levels) then
      text = "`adaptive = "//to_text(most_levels)//"` with elements 1/"// &
          to_text(2**(levels - most_levels))//" as long at the start"
    else if (levels > adaptive%levels) then
      text = "`adaptive = "//to_text(levels)//"`"
    end if
    if (length < (1.0_wp - round_off)*adaptive%size) then
      if (text /= "") text = text//" and "
      text = text//"`adaptive_size = "//to_text(length, 2)//"`"
    end if
    if (text == "") text = "a smaller `adaptive_angle`"
  end function levels_advice

end module dd3_report_suitable_levels
