! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the linear solver.
module dd3_settings_solver
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: solver_spec_t

  !> Settings of the linear solver.
  type :: solver_spec_t
    !> Not yet checked against the registry of solvers.
    character(len=:), allocatable :: method
    type(location_t) :: method_at
    !> Level of fill of the incomplete factorisation.
    integer :: ilu_level = 0
    !> Tolerance of the relative residual.
    real(wp) :: tolerance = 0.0_wp
    !> Maximum number of iterations.
    integer :: iterations = 0
    character(len=:), allocatable :: ordering
    !> Where MUMPS keeps its factors, and the place of the word.
    character(len=:), allocatable :: factors
    type(location_t) :: factors_at
  end type solver_spec_t

end module dd3_settings_solver
