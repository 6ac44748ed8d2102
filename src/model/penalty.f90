!> Penalty of the augmented Lagrangian. The converged solution does not depend on it; it weighs gap
!> and slip against forces where the contact status is decided.
module dd3_model_penalty
  use dd3_base_kinds, only : wp
  use dd3_model_contact_pressure, only : tributary_areas
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: contact_penalty, set_contact_stiffness

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

  !> Set the stiffness of the sheet through its thickness under each candidate, E A/t, with its
  !> tributary area A, the thickness there, and Young's modulus of the last element at the node. A
  !> candidate that belongs to no face gets the mean area, and the modulus of the first element.
  subroutine set_contact_stiffness(model)
    type(model_t), intent(inout) :: model

    real(wp) :: area(model%n_contact), young(model%n_contact), mean
    integer :: f, c

    area = tributary_areas(model, model%x0)
    young = model%material(model%material_of(1))%young
    do f = 1, size(model%contact_face)
      associate (face => model%contact_face(f))
        young(model%candidate_of(model%face%node(:, face))) = &
            model%material(model%material_of(model%face%element(face)))%young
      end associate
    end do
    mean = model%thickness**2
    if (any(area > 0.0_wp)) mean = sum(area)/real(count(area > 0.0_wp), wp)
    where (area <= 0.0_wp) area = mean
    model%contact_stiffness = young*area/[(model%thickness_at(model%contact_node(c)), &
        c=1, model%n_contact)]
  end subroutine set_contact_stiffness

end module dd3_model_penalty
