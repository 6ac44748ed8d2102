! SPDX-License-Identifier: GPL-3.0-or-later
!> The folder between, which declares that it uses the lowest.
module middle
  use low, only : number
  implicit none
  private
  public :: twice

  !> Something to use.
  integer, parameter :: twice = 2*number

end module middle
