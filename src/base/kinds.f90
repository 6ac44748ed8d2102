!> Kinds of numbers, and pi.
module dd3_base_kinds
  use, intrinsic :: iso_fortran_env, only : real64, int64
  implicit none
  private
  public :: wp, i8, pi

  !> Working precision of real numbers.
  integer, parameter :: wp = real64
  !> Long integers: clocks and hashes.
  integer, parameter :: i8 = int64
  real(wp), parameter :: pi = 3.141592653589793_wp

end module dd3_base_kinds
