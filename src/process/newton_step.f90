!> Step of the corrector: the solution of the linear system, added to the trial state. With damping,
!> a step with large displacement gradients in the first iterations is shortened, as is any step
!> that inverts an element or overshoots.
module dd3_process_newton_step
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_retry, cause_large_step
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_attempt, only : attempt_t
  use dd3_system_enhanced, only : enhanced_response
  use dd3_system_reduced, only : contact_force_increment
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: advance, retreat

  !> Largest displacement in an iteration, divided by the thickness of the sheet.
  real(wp), parameter :: largest_step = 20.0_wp
  !> Number of iterations that are damped, in which the contact status of the prediction is wrong,
  !> and the largest difference of the displacements of two nodes of an element over their distance
  !> in them: a strain or rotation, beyond which the status would carry the sheet far from the
  !> solution.
  integer, parameter :: damped_iterations = 2
  real(wp), parameter :: largest_gradient = 0.005_wp
  !> Factor on a step that inverts an element or overshoots, and the largest number of reductions.
  real(wp), parameter :: reduction = 0.5_wp
  integer, parameter :: most_reductions = 4

contains

  !> Add the solution to the trial state.
  subroutine advance(model, trial, system, attempt)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: trial
    !> Solved; the solution is scaled if it is shortened.
    type(system_t), intent(inout) :: system
    !> Gets the increment of the contact forces; a verdict to retry if the solution is too large.
    type(attempt_t), intent(inout) :: attempt

    real(wp) :: gradient

    associate (correction => attempt%correction, phase => model%phase(trial%phase))
      call contact_force_increment(model, phase, system%contact, system%stiffness, &
          system%problem, correction%lambda_increment)
      correction%enhanced_increment = enhanced_response(system%enhanced, model, &
          system%problem%solution) - system%enhanced%offset
      if (phase%newton%damping .and. attempt%verdict%iterations <= damped_iterations) then
        gradient = displacement_gradient(model, trial, system%problem%solution)
        if (gradient > largest_gradient) then
          system%problem%solution = largest_gradient/gradient*system%problem%solution
          correction%lambda_increment = largest_gradient/gradient*correction%lambda_increment
          correction%enhanced_increment = largest_gradient/gradient*correction%enhanced_increment
          correction%damped = correction%damped + 1
        end if
      end if
      call check_step(model, system, attempt)
      if (attempt%verdict%outcome == verdict_retry) return
      call add_step(model, trial, system, attempt, 1.0_wp)
      correction%step = 1.0_wp
      correction%reductions = 0
    end associate
  end subroutine advance

  !> Return the largest difference of the displacements of two nodes of an element over their
  !> distance.
  pure real(wp) function displacement_gradient(model, trial, solution) result(gradient)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: trial
    !> Displacements, `(3*n_row)`, mm.
    real(wp), intent(in) :: solution(:)

    real(wp) :: square
    integer :: e, i, j, a, b

    square = 0.0_wp
    do e = 1, model%n_element
      do i = 2, model%element%n_node
        a = model%connectivity(i, e)
        do j = 1, i - 1
          b = model%connectivity(j, e)
          square = max(square, sum((solution(3*a - 2:3*a) - solution(3*b - 2:3*b))**2) &
              /sum((trial%x(:, a) - trial%x(:, b))**2))
        end do
      end do
    end do
    gradient = sqrt(square)
  end function displacement_gradient

  !> Set a verdict to retry if the solution moves a node too far.
  subroutine check_step(model, system, attempt)
    type(model_t), intent(in) :: model
    type(system_t), intent(in) :: system
    type(attempt_t), intent(inout) :: attempt

    real(wp) :: largest
    integer :: node, worst

    largest = 0.0_wp
    worst = 0
    associate (solution => system%problem%solution)
      do node = 1, model%n_node
        if (maxval(abs(solution(3*node - 2:3*node))) <= largest) cycle
        largest = maxval(abs(solution(3*node - 2:3*node)))
        worst = node
      end do
    end associate
    if (largest <= largest_step*model%thickness) return
    attempt%verdict%outcome = verdict_retry
    attempt%verdict%node = worst
    attempt%verdict%cause = cause_large_step
    attempt%verdict%value(1) = largest
  end subroutine check_step

  !> Shorten the last step, which inverted an element or overshot. Before the first iteration the
  !> step is that of the predictor; the tools keep their places.
  subroutine retreat(model, committed, trial, system, attempt, shortened)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    type(system_t), intent(in) :: system
    type(attempt_t), intent(inout) :: attempt
    !> False if no further reduction is allowed.
    logical, intent(out) :: shortened

    associate (correction => attempt%correction)
      shortened = correction%reductions < most_reductions
      if (.not. shortened) return
      correction%reductions = correction%reductions + 1
      correction%damped = correction%damped + 1
      if (attempt%verdict%iterations == 1) then
        trial%x = committed%x + reduction*(trial%x - committed%x)
        trial%enhanced = reduction*trial%enhanced
        trial%lambda = committed%lambda + reduction*(trial%lambda - committed%lambda)
        return
      end if
      call add_step(model, trial, system, attempt, -reduction*correction%step)
      correction%step = (1.0_wp - reduction)*correction%step
    end associate
  end subroutine retreat

  !> Add a multiple of the solution to the trial state.
  subroutine add_step(model, trial, system, attempt, factor)
    type(model_t), intent(in) :: model
    type(state_t), intent(inout) :: trial
    type(system_t), intent(in) :: system
    type(attempt_t), intent(in) :: attempt
    real(wp), intent(in) :: factor

    integer :: tool, row

    associate (solution => system%problem%solution)
      trial%x = trial%x + factor*reshape(solution(:3*model%n_node), [3, model%n_node])
      trial%enhanced = trial%enhanced + factor*attempt%correction%enhanced_increment
      trial%lambda = trial%lambda + factor*attempt%correction%lambda_increment
      do tool = 1, model%n_tool
        row = model%tool_row(tool)
        if (row == 0) cycle
        trial%tool_displacement(:, tool) = trial%tool_displacement(:, tool) &
            + factor*solution(3*row - 2:3*row)
      end do
    end associate
  end subroutine add_step

end module dd3_process_newton_step
