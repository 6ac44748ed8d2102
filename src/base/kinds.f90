! SPDX-License-Identifier: GPL-3.0-or-later
!> Kinds and mathematical constants.
module dd3_base_kinds
  use, intrinsic :: iso_fortran_env, only : real64, int64
  implicit none
  private
  public :: wp, i8, pi, sqrt2, half_sqrt2, inverse_sqrt2

  !> Working precision of real numbers.
  integer, parameter :: wp = real64
  !> Long integers: clocks and hashes.
  integer, parameter :: i8 = int64
  real(wp), parameter :: pi = 3.141592653589793_wp
  !> Square root of two, its half and its inverse, which differ in the last bit.
  real(wp), parameter :: sqrt2 = sqrt(2.0_wp), half_sqrt2 = 0.5_wp*sqrt2
  real(wp), parameter :: inverse_sqrt2 = 1.0_wp/sqrt2

end module dd3_base_kinds
