! SPDX-License-Identifier: GPL-3.0-or-later
!> Condition that ends a phase early.
module dd3_settings_until
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: until_spec_t, until_never, until_displacement, until_force

  !> Quantity that ends a phase early.
  integer, parameter :: until_never = 0, until_displacement = 1, until_force = 2

  !> Condition that ends a phase early.
  type :: until_spec_t
    !> One of the `until_*` values.
    integer :: kind = until_never
    !> Position in `case%tool`.
    integer :: tool = 0
    !> Magnitude in the tool's direction of motion, mm or N.
    real(wp) :: value = huge(1.0_wp)
    type(location_t) :: at
  end type until_spec_t

end module dd3_settings_until
