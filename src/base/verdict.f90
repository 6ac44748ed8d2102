!> The verdict of a numerical step: numerics never stop and never print, they return one of these.
module dd3_base_verdict
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: verdict_t, verdict_converged, verdict_retry, verdict_impossible

  !> The step succeeded.
  integer, parameter :: verdict_converged = 0
  !> The step failed, a smaller one may succeed.
  integer, parameter :: verdict_retry = 1
  !> The step failed and no smaller one will help.
  integer, parameter :: verdict_impossible = 2

  !> How a numerical step ended; it starts pessimistic.
  type :: verdict_t
    !> One of the `verdict_*` values.
    integer :: outcome = verdict_impossible
    !> Why, in words; empty when converged.
    character(len=160) :: reason = ""
    !> Iterations made.
    integer :: iterations = 0
    !> Norm of what should vanish, in the step's own unit.
    real(wp) :: norm = huge(1.0_wp)
    !> Worst node, element, integration point and tool; 0 where it has no meaning.
    integer :: node = 0, element = 0, point = 0, tool = 0
  end type verdict_t

end module dd3_base_verdict
