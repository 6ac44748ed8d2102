! SPDX-License-Identifier: GPL-3.0-or-later
!> Reports on an attempt: its row of status.csv and, if it was the last one, the message with the
!> first remedy to try. docs/status.md contains the remedies; a test compares them.
module dd3_report_attempt_report
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : count_over_ranks, largest_over_ranks, n_ranks
  use dd3_base_cause_text, only : cause_text
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : cause_factor_files, cause_inverted, cause_inverted_strain, &
      cause_large_step, cause_led_inside, cause_lost_tool, cause_no_progress, cause_singular, &
      cause_solver, cause_solver_memory, verdict_converged
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  use dd3_model_contact_layer, only : contact_penalty
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_output_status, only : status_row_t
  use dd3_process_open_edges, only : edge_name
  use dd3_process_step_control, only : attempt_t, stepper_t
  use dd3_report_necked_sheet, only : has_necked
  use dd3_report_node_report, only : place_of_node
  implicit none
  private
  public :: status_row, failure_message, first_remedy, tool_name

  character(len=*), parameter :: contact_remedy = "a tool that lies before the sheet along its "// &
      "force, a support of the sheet"
  character(len=*), parameter :: motion_remedy = "a prescribed motion that leads no "// &
      "node into a tool"
  character(len=*), parameter :: surface_remedy = "a surface of the tool that continues beyond "// &
      "this edge"
  character(len=*), parameter :: memory_remedy = "method = cgs in *SOLVER"
  character(len=*), parameter :: ranks_remedy = "more processes, factors = disk in *SOLVER"
  character(len=*), parameter :: solver_remedy = "method = umfpack in *SOLVER, supports that "// &
      "stop rigid motion"
  character(len=*), parameter :: files_remedy = "a folder of results on a larger disk, "// &
      "factors = memory in *SOLVER"
  character(len=*), parameter :: mumps_remedy = "method = petsc_mumps in *SOLVER, "// &
      "supports that stop rigid motion"
  character(len=*), parameter :: support_remedy = "supports that stop rigid motion"
  character(len=*), parameter :: cutback_remedy = "cutback = on in *NEWTON"
  character(len=*), parameter :: line_search_remedy = "line_search = on in *NEWTON"
  character(len=*), parameter :: material_remedy = "units and parameters of the material"
  character(len=*), parameter :: limit_remedy = "a larger value of this limit"
  character(len=*), parameter :: necked_remedy = "larger radii of the tools, less restraint "// &
      "and friction, as the sheet has necked"
  character(len=*), parameter :: unload_remedy = "unload = at_once in the phase"
  character(len=*), parameter :: mesh_remedy = "a finer mesh there"

  !> Factors on the penalty, on the height of the contact layer and on the limit of rotation that
  !> are proposed. A setting that is at its bound has been tried.
  real(wp), parameter :: penalty_factor = 0.1_wp, layer_factor = 2.0_wp, rotation_factor = 0.25_wp
  !> Bounds: height of the contact layer over the thickness, rotation, degrees.
  real(wp), parameter :: largest_layer = 0.03_wp, smallest_rotation = 0.5_wp
  !> Numbers of iterations that are proposed: the usual one and a large one.
  integer, parameter :: usual_iterations = 30, many_iterations = 60

contains

  !> Return the row of status.csv, as if no further attempt followed.
  function status_row(model, committed, stepper) result(row)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(stepper_t), intent(in) :: stepper
    type(status_row_t) :: row

    associate (attempt => stepper%attempt, phase => model%phase(committed%phase))
      row%increment = committed%increment + 1
      row%attempt = attempt%number
      row%phase = phase%name
      row%elements = model%n_element
      row%travel = committed%travel + phase%path(committed%progress, committed%progress &
          + attempt%limit%r*stepper%prediction%progress)
      row%r = attempt%limit%r
      row%limiter = attempt%limit%limiter
      row%limiter_element = attempt%limit%element
      row%limiter_point = attempt%limit%point
      row%limiter_node = attempt%limit%node
      row%limiter_tool = tool_name(model, attempt%limit%tool)
      row%r_force = attempt%force_limit%r
      row%force_node = attempt%force_limit%node
      row%force_tool = tool_name(model, attempt%force_limit%tool)
      row%force_size = attempt%force_limit%force_size
      row%solver_iterations = attempt%solver%iterations
      row%solver = attempt%solver%solver(:len(row%solver))
      row%perturbed = attempt%solver%perturbed%blocks
      associate (status => stepper%system%contact%status)
        row%gap = count_over_ranks(count(status(:model%n_contact_fixed) == status_gap))
        row%stick = count_over_ranks(count(status == status_stick))
        row%slip = count_over_ranks(count(status == status_slip))
      end associate
      if (attempt%verdict%outcome == verdict_converged) then
        row%outcome = "accepted"
        row%reason = attempt%solver%reason
      else
        row%outcome = "failed"
        row%reason = reason(model, attempt)
      end if
    end associate
    call add_corrector(row, stepper%attempt)
  end function status_row

  !> Add the course of the corrector to a row.
  subroutine add_corrector(row, attempt)
    type(status_row_t), intent(inout) :: row
    type(attempt_t), intent(in) :: attempt

    associate (verdict => attempt%verdict)
      row%iterations = verdict%iterations
      row%shortened = attempt%course%shortened
      row%eliminated = attempt%course%eliminations
      if (allocated(attempt%course%norm)) then
        if (size(attempt%course%norm) > 0) then
          row%criterion = attempt%course%norm(size(attempt%course%norm))
        end if
      end if
      if (verdict%element > 0) then
        row%worst_element = verdict%element
        row%worst_point = verdict%point
      else if (attempt%residual%worst_node > 0) then
        row%worst_node = attempt%residual%worst_node
        row%worst_residual = attempt%residual%worst
      end if
    end associate
  end subroutine add_corrector

  !> Return the name of a tool; empty for 0.
  function tool_name(model, tool) result(name)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    character(len=:), allocatable :: name

    name = ""
    if (tool > 0) name = model%tool(tool)%name
  end function tool_name

  !> Return the reason why an attempt failed.
  function reason(model, attempt) result(text)
    type(model_t), intent(in) :: model
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: text

    text = cause_text(attempt%verdict, tool_name(model, attempt%verdict%tool))
    associate (passage => attempt%passage)
      if (passage%tool > 0) text = text//"; in the prediction node "// &
          to_text(passage%node)//" leaves tool "// &
          tool_name(model, passage%tool)//" over the open "//edge_name(passage%patch, passage%edge)
    end associate
  end function reason

  !> Return the message on a failed increment: its location, the reason and the first remedy to try.
  function failure_message(model, committed, stepper) result(message)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(stepper_t), intent(in) :: stepper
    character(len=:), allocatable :: message

    message = failure(model, committed, stepper)//"; try first: "// &
        first_remedy(model, committed, stepper%attempt)
  end function failure_message

  !> Return the location and the reason of a failed increment.
  function failure(model, committed, stepper) result(message)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(stepper_t), intent(in) :: stepper
    character(len=:), allocatable :: message

    integer :: c, tool(1)

    associate (attempt => stepper%attempt, verdict => stepper%attempt%verdict)
      message = "increment "//to_text(committed%increment + 1)//" of phase '" &
          //model%phase(committed%phase)%name//"' (travel "//to_text(committed%travel)//" mm) "
      if (verdict%cause == cause_no_progress) then
        message = message//"makes no progress: r = "//to_text(attempt%limit%r, 3)// &
            ", limited by "//trim(attempt%limit%limiter)
        return
      end if
      message = message//"did not converge"
      if (attempt%number > 1) message = message//" in "//to_text(attempt%number)//" attempts"
      message = message//": "//reason(model, attempt)
      if (verdict%element > 0) message = message//", element "//to_text(verdict%element)
      if (verdict%point > 0) message = message//" point "//to_text(verdict%point)
      if (verdict%node == 0) return
      message = message//", "//place_of_node(model, committed, verdict%node)
      c = model%candidate_of(verdict%node)
      tool = 0
      if (c > 0) tool = stepper%system%contact%tool(c)
      call largest_over_ranks(1, tool)
      if (tool(1) > 0) message = message//", tool "//model%tool(tool(1))%name
    end associate
  end function failure

  !> Return the first remedy to try; a setting that is off comes before those that change the model.
  function first_remedy(model, committed, attempt) result(remedy)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    remedy = remedy_of_input(committed, attempt)
    if (len(remedy) == 0 .and. has_necked(model, committed)) remedy = necked_remedy
    associate (phase => model%phase(committed%phase))
      if (len(remedy) == 0 .and. phase%unloaded .and. any(phase%withdrawn)) remedy = unload_remedy
    end associate
    if (len(remedy) == 0 .and. attempt%passage%tool > 0) remedy = surface_remedy
    if (len(remedy) > 0) return
    associate (phase => model%phase(committed%phase), verdict => attempt%verdict)
      if (.not. phase%newton%cutback) then
        remedy = cutback_remedy
      else if (.not. phase%newton%line_search) then
        remedy = line_search_remedy
      else if (any(verdict%cause == [cause_large_step, cause_inverted, cause_inverted_strain])) then
        remedy = remedy_of_increments(phase, attempt)
      else if (verdict%element > 0) then
        remedy = material_remedy
      else if (phase%newton%iterations < usual_iterations) then
        remedy = "iterations = "//to_text(usual_iterations)//" in *NEWTON"
      else if (attempt%touched) then
        remedy = remedy_of_contact(model, phase, attempt)
      else if (phase%newton%iterations < many_iterations) then
        remedy = "iterations = "//to_text(many_iterations)//" in *NEWTON"
      else
        remedy = remedy_of_increments(phase, attempt)
      end if
    end associate
  end function first_remedy

  !> Return the remedy of a cause that only a change of the model, of the limits or of the solver
  !> removes; empty for others.
  function remedy_of_input(committed, attempt) result(remedy)
    type(state_t), intent(in) :: committed
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    remedy = ""
    select case (attempt%verdict%cause)
    case (cause_no_progress)
      remedy = limit_remedy
    case (cause_lost_tool)
      remedy = contact_remedy
    case (cause_led_inside)
      remedy = motion_remedy
    case (cause_solver_memory)
      remedy = memory_remedy
      if (n_ranks() > 1) remedy = ranks_remedy
    case (cause_factor_files)
      remedy = files_remedy
    case (cause_singular)
      remedy = support_remedy
    case (cause_solver)
      remedy = solver_remedy
      if (attempt%solver%solver == "umfpack") remedy = support_remedy
      if (n_ranks() > 1) remedy = mumps_remedy
      if (attempt%solver%solver == "petsc_mumps") remedy = support_remedy
    case (cause_large_step)
      if (committed%increment == 0) remedy = support_remedy
    case default
      ! Removed by smaller increments.
    end select
  end function remedy_of_input

  !> Return the first remedy where the contact of a candidate does not settle: a setting of the
  !> contact that has its default, else smaller increments.
  function remedy_of_contact(model, phase, attempt) result(remedy)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    real(wp) :: penalty(1)
    integer :: c

    if (phase%mixed .and. phase%penalty <= 0.0_wp) then
      c = model%candidate_of(attempt%verdict%node)
      penalty = 0.0_wp
      if (c > 0) penalty = contact_penalty(model, phase, c)
      call largest_over_ranks(1, penalty)
      remedy = "penalty = "//to_text(penalty_factor*penalty(1), 3)//" in *CONTACT"
    else if (.not. phase%mixed .and. phase%layer < largest_layer) then
      remedy = "layer = "//to_text(min(largest_layer, layer_factor*phase%layer), 3)//" in *CONTACT"
    else
      remedy = remedy_of_increments(phase, attempt)
    end if
  end function remedy_of_contact

  !> Return the first remedy where the increments may be too large: smaller ones, and the mesh alone
  !> where they are small already or the attempts have cut them back.
  function remedy_of_increments(phase, attempt) result(remedy)
    type(phase_t), intent(in) :: phase
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    real(wp) :: proposed

    remedy = mesh_remedy
    if (attempt%number > 1) return
    proposed = smallest_rotation
    associate (rotation => phase%limits%rotation)
      if (rotation%active) proposed = max(proposed, rotation_factor*rotation%value)
      if (rotation%active .and. rotation%value <= proposed) return
    end associate
    remedy = "rotation = "//to_text(proposed, 3)//" in *LIMITS, "//remedy
  end function remedy_of_increments

end module dd3_report_attempt_report
