!> Verdict of a numerical step. Numerics neither stop nor print; they return one of these.
module dd3_base_verdict
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: verdict_t, verdict_converged, verdict_retry, verdict_impossible

  !> The step succeeded.
  integer, parameter :: verdict_converged = 0
  !> The step failed; a smaller one may succeed.
  integer, parameter :: verdict_retry = 1
  !> The step failed and no smaller one will help.
  integer, parameter :: verdict_impossible = 2

  !> Result of a numerical step; initially a failure.
  type :: verdict_t
    !> One of the `verdict_*` values.
    integer :: outcome = verdict_impossible
    !> Reason for a failure; empty if converged.
    character(len=160) :: reason = ""
    integer :: iterations = 0
    !> Norm of the residual, in the unit of the step.
    real(wp) :: norm = huge(1.0_wp)
    !> Location of the largest error: node, element, integration point, tool; 0 if not applicable.
    integer :: node = 0, element = 0, point = 0, tool = 0
  end type verdict_t

end module dd3_base_verdict
