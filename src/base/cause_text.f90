! SPDX-License-Identifier: GPL-3.0-or-later
!> Texts of the causes of failures, for the log and status.csv.
module dd3_base_cause_text
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, cause_inverted, cause_inverted_strain, cause_not_finite, &
      cause_large_strain, cause_return_mapping, cause_strain_bound, cause_singular_tangent, &
      cause_no_strain, cause_gradient, cause_singular, cause_solver_memory, cause_solver, &
      cause_factor_files, cause_lost_tool, cause_led_inside, cause_large_step, cause_unsettled, &
      cause_residual, cause_tool_force, cause_no_progress, cause_beyond_until, cause_interrupted
  implicit none
  private
  public :: cause_code, cause_text

contains

  !> Return the cause of a verdict as text; empty for none.
  pure function cause_text(verdict, tool) result(text)
    type(verdict_t), intent(in) :: verdict
    !> Name of the tool in the verdict.
    character(len=*), intent(in) :: tool
    character(len=:), allocatable :: text

    text = text_of_cause(verdict, tool)
    if (verdict%changing == 0) return
    if (len(text) > 0) text = text//"; "
    text = text//"contact status changes at "//to_text(verdict%changing)//" node"
    if (verdict%changing > 1) text = text//"s"
  end function cause_text

  !> Return the code of the message on a cause; blank for none. See docs/messages.md.
  pure function cause_code(verdict) result(code)
    type(verdict_t), intent(in) :: verdict
    character(len=4) :: code

    ! Causes and their codes.
    integer, parameter :: cause(19) = [cause_inverted, cause_inverted_strain, cause_not_finite, &
        cause_large_strain, cause_return_mapping, cause_strain_bound, cause_singular_tangent, &
        cause_no_strain, cause_gradient, cause_singular, cause_solver_memory, cause_solver, &
        cause_factor_files, cause_lost_tool, cause_led_inside, cause_large_step, cause_unsettled, &
        cause_residual, cause_tool_force]
    character(len=4), parameter :: code_of(19) = ["E211", "E212", "E213", "E214", "E215", "E221", &
        "E222", "E223", "E224", "E231", "E232", "E233", "E235", "E241", "E242", "E243", "E244", &
        "E245", "E246"]
    integer :: i

    code = ""
    if (verdict%cause == cause_no_progress) code = "E247"
    i = findloc(cause, verdict%cause, 1)
    if (i > 0) code = code_of(i)
  end function cause_code

  !> Return the text without the changes of the contact status.
  pure function text_of_cause(verdict, tool) result(text)
    type(verdict_t), intent(in) :: verdict
    character(len=*), intent(in) :: tool
    character(len=:), allocatable :: text

    associate (value => verdict%value)
      select case (verdict%cause)
      case (cause_inverted)
        text = "an element is turned inside out"
      case (cause_inverted_strain)
        text = "the assumed strain turns an element inside out"
      case (cause_not_finite)
        text = "stress, strain or internal variables are not finite"
      case (cause_large_strain)
        text = "strain increment of "//to_text(value(1), 4)//" is too large"
      case (cause_return_mapping)
        text = "return mapping fails: strain increment "//to_text(value(1), 4)// &
            ", plastic strain "//to_text(value(2), 4)//", trial/flow stress "// &
            to_text(value(3), 4)//" in the last substep, residual "//to_text(value(4), 4)
      case (cause_strain_bound)
        text = "the target stress requires a strain beyond "//to_text(value(1))
      case (cause_singular_tangent)
        text = "the target stress cannot be reached: the tangent is singular"
      case (cause_no_strain)
        text = "no strain found for the target stress; residual "//to_text(value(1), 4)//" MPa"
      case (cause_gradient)
        text = "det F is not positive"
      case (cause_singular, cause_solver_memory, cause_solver, cause_factor_files)
        text = "linear solver: "//trim(verdict%detail)
      case (cause_lost_tool)
        text = "nothing resists the pressed tool "//tool
      case (cause_led_inside)
        text = "a prescribed motion leads a node into a tool"
      case (cause_large_step)
        text = "an iteration moved a node by "//to_text(value(1), 3)//" mm"
      case (cause_residual)
        text = "residual "//to_text(value(1), 3)//" N at node "//to_text(verdict%node)// &
            " after "//to_text(verdict%iterations)//" iterations"
      case (cause_tool_force)
        text = "force on the pressed tool "//tool//" off by "//to_text(value(1), 3)// &
            " N after "//to_text(verdict%iterations)//" iterations"
      case (cause_no_progress)
        text = "no progress"
      case (cause_beyond_until)
        text = "beyond the value of `until`"
      case (cause_interrupted)
        text = "interrupted"
      case default
        text = ""
      end select
      if (any(verdict%cause == [cause_strain_bound, cause_singular_tangent, cause_no_strain])) then
        text = text//"; the flow stress is "//to_text(value(2), 4)//" MPa"
      end if
    end associate
  end function text_of_cause

end module dd3_base_cause_text
