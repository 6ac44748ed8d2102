! SPDX-License-Identifier: GPL-3.0-or-later
!> The highest folder, which uses both.
module high
  use low, only : number
  use middle, only : twice
  implicit none
  private
  public :: total

  !> Sum of both.
  integer, parameter :: total = number + twice

end module high
