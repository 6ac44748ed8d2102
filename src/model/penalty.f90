!> Penalty of the augmented Lagrangian. The converged solution does not depend on it; it weighs gap
!> and slip against forces where the contact status is decided.
module dd3_model_penalty
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: contact_penalty, reduce_penalty, set_contact_stiffness

  !> Automatic penalty over the stiffness of the sheet under a candidate. Where a node closes, the
  !> linearisation leaves gaps and slips of the order of the curvature of tool and path; a penalty
  !> near the stiffness of the sheet turns them into forces that decide the status wrongly.
  real(wp), parameter :: fraction = 1.0e-3_wp
  !> Factor of one reduction of the penalty.
  real(wp), parameter :: reduction = 0.1_wp

contains

  !> Return the penalty of a candidate, N/mm: the automatic one, or that of the input, reduced if it
  !> is higher than the automatic one.
  pure real(wp) function contact_penalty(model, phase, c, factor)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    !> Number of the candidate.
    integer, intent(in) :: c
    !> Factor on the penalty of the input, at most 1.
    real(wp), intent(in) :: factor

    real(wp) :: automatic

    automatic = fraction*model%contact_stiffness(c)
    contact_penalty = automatic
    if (phase%penalty > 0.0_wp) &
        contact_penalty = max(factor*phase%penalty, min(phase%penalty, automatic))
  end function contact_penalty

  !> Reduce the factor on the penalty of the input, down to the value with which all candidates have
  !> the automatic penalty.
  pure subroutine reduce_penalty(model, phase, factor)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    real(wp), intent(inout) :: factor

    if (phase%penalty <= 0.0_wp) return
    factor = max(reduction*factor, &
        min(factor, fraction*minval(model%contact_stiffness)/phase%penalty))
  end subroutine reduce_penalty

  !> Set the stiffness of the sheet through its thickness under each candidate, E A/t, with its
  !> tributary area A, the thickness there, and Young's modulus of the last element at the node. A
  !> candidate that belongs to no face gets the mean area, and the modulus of the first element.
  subroutine set_contact_stiffness(model)
    type(model_t), intent(inout) :: model

    real(wp) :: area(model%n_contact), young(model%n_contact), mean
    integer :: f, c

    area = 0.0_wp
    young = model%material(model%material_of(1))%young
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)), x => model%x0)
        associate (candidate => model%candidate_of(model%face%node(:, model%contact_face(f))))
          area(candidate) = area(candidate) + model%element%face_weight*(0.5_wp*norm2(cross( &
              x(:, corner(3)) - x(:, corner(1)), x(:, corner(4)) - x(:, corner(2)))))
          young(candidate) = model%material(model%material_of(model%face%element( &
              model%contact_face(f))))%young
        end associate
      end associate
    end do
    mean = model%thickness**2
    if (any(area > 0.0_wp)) mean = sum(area)/real(count(area > 0.0_wp), wp)
    where (area <= 0.0_wp) area = mean
    model%contact_stiffness = young*area/[(model%thickness_at(model%contact_node(c)), &
        c=1, model%n_contact)]
  end subroutine set_contact_stiffness

end module dd3_model_penalty
