! SPDX-License-Identifier: GPL-3.0-or-later
!> Exit codes of the program.
module dd3_app_exit_codes
  implicit none
  private
  public :: exit_end, exit_usage, exit_input, exit_stopped

  !> Reached the end, usage, errors in the input, stopped before the end.
  integer, parameter :: exit_end = 0, exit_usage = 1, exit_input = 2, exit_stopped = 3

end module dd3_app_exit_codes
