! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the adaptive refinement of the sheet.
module dd3_settings_adaptive
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: adaptive_spec_t, most_levels

  !> Most times that an element may be divided.
  integer, parameter :: most_levels = 4

  !> Settings of the refinement.
  type :: adaptive_spec_t
    !> Times that an element may be divided; 0 for no refinement.
    integer :: levels = 0
    !> Angle by which the sheet may turn over an element, degrees.
    real(wp) :: angle = 0.0_wp
    !> Least length of an element, mm.
    real(wp) :: size = 0.0_wp
    !> Where the input gives the levels.
    type(location_t) :: at
  end type adaptive_spec_t

end module dd3_settings_adaptive
