! SPDX-License-Identifier: GPL-3.0-or-later
!> The lowest folder.
module low
  implicit none
  private
  public :: number

  !> Something to use.
  integer, parameter :: number = 1

end module low
