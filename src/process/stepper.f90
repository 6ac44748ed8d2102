!> Work data of the increments: system of equations, prediction and present attempt.
module dd3_process_stepper
  use dd3_process_predictor, only : prediction_t
  use dd3_process_step_control, only : attempt_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: stepper_t

  !> Only the memory of the solver is kept from one increment to the next.
  type :: stepper_t
    type(system_t) :: system
    type(prediction_t) :: prediction
    type(attempt_t) :: attempt
  end type stepper_t

end module dd3_process_stepper
