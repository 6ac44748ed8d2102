! SPDX-License-Identifier: GPL-3.0-or-later
!> What is said at the end of a phase on how far the sheet is formed, and on its supports.
module dd3_run_phase_closing
  use dd3_base_message, only : message_list_t
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_run_summary, only : run_summary_t
  use dd3_report_closing, only : measure_closing
  use dd3_report_closing_notes, only : add_closing_notes
  use dd3_report_limits_reached, only : measure_limits
  use dd3_run_pin_load, only : add_pin_notes, loaded_pins
  use dd3_run_support_load, only : add_support_note, find_support
  implicit none
  private
  public :: close_phase

contains

  !> Measure how far the sheet is formed at the end of the running phase, its limits, and what
  !> supports carry.
  subroutine close_phase(model, case, state, summary, notes)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    type(state_t), intent(in) :: state
    !> Gets the measures.
    type(run_summary_t), intent(inout) :: summary
    !> Gets what they say.
    type(message_list_t), intent(inout) :: notes

    associate (closing => summary%phase(state%phase)%closing, &
        before => summary%phase(:state%phase - 1)%closing)
      call measure_closing(model, state, closing)
      call find_support(case, model, state, closing%support)
      call measure_limits(model, state, closing)
      call add_closing_notes(model, state, closing, before, notes)
      call add_support_note(model, state, closing%support, notes)
      closing%pin = loaded_pins(case, state)
      call add_pin_notes(model, state, closing%pin, notes)
    end associate
  end subroutine close_phase

end module dd3_run_phase_closing
