!> First remedy to try after a failed increment. docs/status.md contains the same texts; a test
!> compares them.
module dd3_process_remedy
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : cause_inverted, cause_inverted_strain, cause_large_step, &
      cause_led_inside, cause_lost_tool, cause_singular, cause_solver, cause_solver_memory
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_penalty, only : contact_penalty
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_attempt, only : attempt_t
  implicit none
  private
  public :: first_remedy

  character(len=*), parameter :: contact_remedy = "a tool that lies before the sheet along its "// &
      "force, a support of the sheet"
  character(len=*), parameter :: motion_remedy = "a prescribed motion that leads no "// &
      "node into a tool"
  character(len=*), parameter :: memory_remedy = "method = cgs in *SOLVER"
  character(len=*), parameter :: solver_remedy = "method = umfpack in *SOLVER, supports that "// &
      "stop rigid motion"
  character(len=*), parameter :: support_remedy = "supports that stop rigid motion"
  character(len=*), parameter :: cutback_remedy = "cutback = on in *NEWTON"
  character(len=*), parameter :: damping_remedy = "damping = on in *NEWTON"
  character(len=*), parameter :: material_remedy = "units and parameters of the material"
  character(len=*), parameter :: mesh_remedy = ", a finer mesh there"

  !> Factors on the penalty, on the height of the contact layer, on the limit of rotation, on the
  !> tolerance after the release and on the number of iterations that are proposed; rotation proposed
  !> if it is not limited, degrees.
  real(wp), parameter :: penalty_factor = 0.1_wp, layer_factor = 2.0_wp, rotation_factor = 0.25_wp, &
      tolerance_factor = 10.0_wp
  integer, parameter :: iterations_factor = 2
  real(wp), parameter :: usual_rotation = 0.5_wp

contains

  !> Return the first remedy to try.
  function first_remedy(model, committed, attempt) result(remedy)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    associate (phase => model%phase(committed%phase))
      remedy = ""
      select case (attempt%verdict%cause)
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
      if (len(remedy) > 0) return
      if (.not. phase%newton%cutback) then
        remedy = cutback_remedy
      else if (.not. phase%newton%damping) then
        remedy = damping_remedy
      else
        remedy = remedy_of_cause(model, phase, attempt)
      end if
    end associate
  end function first_remedy

  !> Return the first remedy if all automatic ones are on.
  function remedy_of_cause(model, phase, attempt) result(remedy)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(attempt_t), intent(in) :: attempt
    character(len=:), allocatable :: remedy

    real(wp) :: rotation
    integer :: c

    rotation = usual_rotation
    if (phase%limits%rotation%active) rotation = rotation_factor*phase%limits%rotation%value
    c = candidate_in_contact(model, attempt)
    associate (newton => phase%newton)
      if (any(attempt%verdict%cause == [cause_large_step, cause_inverted, &
          cause_inverted_strain])) then
        remedy = "rotation = "//to_text(rotation, 3)//" in *LIMITS"//mesh_remedy
      else if (attempt%verdict%element > 0) then
        remedy = material_remedy
      else if (c > 0) then
        remedy = remedy_of_contact(model, phase, c)
      else if (ends_near_release_tolerance(phase, attempt%verdict%norm)) then
        remedy = "release_tolerance = "//to_text(tolerance_factor*newton%release_tolerance, 3)// &
            " in *NEWTON"
      else
        remedy = "iterations = "//to_text(iterations_factor*newton%iterations)//" in *NEWTON"
      end if
    end associate
  end function remedy_of_cause

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

  !> Return the candidate at the node of a failure if a tool touched it in the last iterations; 0 if
  !> none did. At a node without contact no penalty acts.
  pure integer function candidate_in_contact(model, attempt) result(c)
    type(model_t), intent(in) :: model
    type(attempt_t), intent(in) :: attempt

    c = 0
    if (attempt%verdict%node > 0) c = model%candidate_of(attempt%verdict%node)
    if (c == 0) return
    if (.not. any(attempt%correction%status(c, :) > status_gap)) c = 0
  end function candidate_in_contact

  !> Whether all tools are released and a slightly larger tolerance would have been met.
  pure logical function ends_near_release_tolerance(phase, criterion) result(ends)
    type(phase_t), intent(in) :: phase
    !> Of convergence, in the last iteration.
    real(wp), intent(in) :: criterion

    ends = .false.
    if (size(phase%active) == 0 .or. any(phase%active)) return
    associate (tolerance => phase%newton%release_tolerance)
      ends = phase%newton%tolerance >= tolerance .and. criterion < tolerance_factor*tolerance
    end associate
  end function ends_near_release_tolerance

end module dd3_process_remedy
