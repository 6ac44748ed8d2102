! SPDX-License-Identifier: GPL-3.0-or-later
!> Data of a run.
module dd3_run_data
  use dd3_linalg_solver, only : solver_options_t
  use dd3_model_state, only : state_t
  use dd3_output_progress, only : progress_t
  use dd3_output_records, only : records_t
  use dd3_output_run_summary, only : run_summary_t
  use dd3_process_step_control, only : stepper_t
  use dd3_report_limits_reached, only : limits_t
  use dd3_run_adaptivity, only : adaptivity_t
  use dd3_run_thread_choice, only : thread_choice_t
  implicit none
  private
  public :: run_t

  !> Committed and trial state, step control, records, and what has been told.
  type :: run_t
    type(state_t) :: committed, trial
    type(stepper_t) :: stepper
    type(records_t) :: records
    type(progress_t) :: progress
    type(run_summary_t) :: summary
    type(thread_choice_t) :: threads
    type(adaptivity_t) :: adaptivity
    !> Largest damage and ratio to the forming limit in the committed state.
    type(limits_t) :: limits
    type(solver_options_t) :: options
    !> Whether the log has told of a perturbed pivot.
    logical :: told_perturbed = .false.
  end type run_t

end module dd3_run_data
