!> Penalty of the augmented Lagrangian. The converged solution does not depend on it; it weighs gap
!> and slip against forces where the contact status is decided.
module dd3_model_penalty
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: contact_penalty

  !> Automatic penalty over the stiffness of the sheet under a candidate. Where a node closes, the
  !> linearisation leaves gaps and slips of the order of the curvature of tool and path; a penalty
  !> near the stiffness of the sheet turns them into forces that decide the status wrongly.
  real(wp), parameter :: fraction = 1.0e-3_wp

contains

  !> Return the penalty of a candidate, N/mm: that of the input, or the automatic one if there is
  !> none in the input.
  pure real(wp) function contact_penalty(model, phase, c)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Number of the candidate.
    integer, intent(in) :: c

    contact_penalty = phase%penalty
    if (phase%penalty <= 0.0_wp) contact_penalty = fraction*model%contact_stiffness(c)
  end function contact_penalty

end module dd3_model_penalty
