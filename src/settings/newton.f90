! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the corrector.
module dd3_settings_newton
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: newton_spec_t

  !> Settings of the corrector.
  type :: newton_spec_t
    !> Tolerance of the convergence criterion.
    real(wp) :: tolerance = 0.0_wp
    !> Maximum number of iterations of an increment.
    integer :: iterations = 0
    !> Whether a failed increment is repeated with a smaller r.
    logical :: cutback = .false.
    !> Whether there is a line search.
    logical :: line_search = .false.
    !> Whether there is nonlinear elimination.
    logical :: elimination = .false.
  end type newton_spec_t

end module dd3_settings_newton
