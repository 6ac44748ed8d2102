! SPDX-License-Identifier: GPL-3.0-or-later
!> The formulation of elements with a mean dilatation, or none: kernels in the trial configuration
!> that work from the element's table.
module dd3_element_mean_dilatation
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_force, only : element_cauchy, element_force
  use dd3_element_kinematics, only : element_gradients, element_kinematics
  use dd3_element_log_strain, only : element_strain
  use dd3_element_rate, only : element_rate
  use dd3_element_stiffness, only : element_stiffness
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: use_mean_dilatation

contains

  !> Set the kernels of an element.
  subroutine use_mean_dilatation(self)
    type(element_t), intent(inout) :: self

    self%deform => deform
    self%linearise => linearise
    self%set_stress => element_cauchy
    self%evaluate_force => element_force
    self%evaluate_stiffness => element_stiffness
    self%evaluate_rate => element_rate
  end subroutine use_mean_dilatation

  !> Evaluate kinematics, strain increments and trial material axes.
  subroutine deform(element, rotation_committed, work, verdict)
    type(element_t), intent(in) :: element
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    type(element_work_t), intent(inout) :: work
    type(verdict_t), intent(out) :: verdict

    call element_kinematics(element, work%x_committed, work%x_trial, work, verdict)
    if (verdict%outcome == verdict_converged) call element_strain(element, rotation_committed, work)
  end subroutine deform

  !> Evaluate the gradients in the committed configuration.
  subroutine linearise(element, rotation_committed, work, verdict)
    type(element_t), intent(in) :: element
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    type(element_work_t), intent(inout) :: work
    type(verdict_t), intent(out) :: verdict

    call element_gradients(element, work%x_committed, work, verdict)
    work%strain = 0.0_wp
    work%rotation(:, :, :) = rotation_committed
  end subroutine linearise

end module dd3_element_mean_dilatation
