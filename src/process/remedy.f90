!> First remedy to try after a failed increment. docs/status.md contains the same texts; a test
!> compares them.
module dd3_process_remedy
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : cause_inverted, cause_inverted_strain, cause_large_step, &
      cause_led_inside, cause_lost_tool, cause_no_progress, cause_singular, cause_solver, &
      cause_solver_memory
  use dd3_model_model, only : model_t
  use dd3_model_penalty, only : contact_penalty
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_step_control, only : attempt_t
  implicit none
  private
  public :: first_remedy

  character(len=*), parameter :: contact_remedy = "a tool that lies before the sheet along its "// &
      "force, a support of the sheet"
  character(len=*), parameter :: motion_remedy = "a prescribed motion that leads no "// &
      "node into a tool"
  character(len=*), parameter :: surface_remedy = "a surface of the tool that continues beyond "// &
      "this edge"
  character(len=*), parameter :: memory_remedy = "method = cgs in *SOLVER"
  character(len=*), parameter :: solver_remedy = "method = umfpack in *SOLVER, supports that "// &
      "stop rigid motion"
  character(len=*), parameter :: support_remedy = "supports that stop rigid motion"
  character(len=*), parameter :: cutback_remedy = "cutback = on in *NEWTON"
  character(len=*), parameter :: damping_remedy = "damping = on in *NEWTON"
  character(len=*), parameter :: material_remedy = "units and parameters of the material"
  character(len=*), parameter :: limit_remedy = "a larger value of this limit"
  character(len=*), parameter :: mesh_remedy = ", a finer mesh there"

  !> Factors on the penalty, on the height of the contact layer, on the limit of rotation and on the
  !> number of iterations that are proposed; rotation proposed if it is not limited, degrees.
  real(wp), parameter :: penalty_factor = 0.1_wp, layer_factor = 2.0_wp, rotation_factor = 0.25_wp
  integer, parameter :: iterations_factor = 2
  character(len=*), parameter :: usual_rotation = "0.5"

contains

  !> Return the first remedy to try; a setting that is off comes before those that change the model.
  function first_remedy(model, committed, attempt) result(remedy)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    remedy = remedy_of_input(committed, attempt)
    if (len(remedy) == 0 .and. attempt%passage%tool > 0) remedy = surface_remedy
    if (len(remedy) > 0) return
    associate (phase => model%phase(committed%phase), verdict => attempt%verdict)
      if (.not. phase%newton%cutback) then
        remedy = cutback_remedy
      else if (.not. phase%newton%damping) then
        remedy = damping_remedy
      else if (any(verdict%cause == [cause_large_step, cause_inverted, cause_inverted_strain])) then
        remedy = usual_rotation
        if (phase%limits%rotation%active) &
            remedy = to_text(rotation_factor*phase%limits%rotation%value, 3)
        remedy = "rotation = "//remedy//" in *LIMITS"//mesh_remedy
      else if (verdict%element > 0) then
        remedy = material_remedy
      else if (attempt%touched) then
        remedy = remedy_of_contact(model, phase, model%candidate_of(verdict%node))
      else
        remedy = "iterations = "//to_text(iterations_factor*phase%newton%iterations)// &
            " in *NEWTON"
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
    case (cause_singular)
      remedy = support_remedy
    case (cause_solver)
      remedy = solver_remedy
      if (attempt%solver%solver == "umfpack") remedy = support_remedy
    case (cause_large_step)
      if (committed%increment == 0) remedy = support_remedy
    end select
  end function remedy_of_input

  !> Return the first remedy where the contact of a candidate does not settle.
  function remedy_of_contact(model, phase, c) result(remedy)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c
    character(len=:), allocatable :: remedy

    if (phase%mixed) then
      remedy = "penalty = "//to_text(penalty_factor*contact_penalty(model, phase, c), 3)
    else
      remedy = "layer = "//to_text(layer_factor*phase%layer, 3)
    end if
    remedy = remedy//" in *CONTACT"
  end function remedy_of_contact

end module dd3_process_remedy
