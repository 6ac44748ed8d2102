! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear systems of a run, for the comparison of the solvers.
module run_samples
  use dd3_base_error, only : error_list_t, error_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : text_t
  use dd3_base_verdict, only : verdict_converged
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  use dd3_input_case, only : case_t
  use dd3_input_reader, only : read_case
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : solver_options_t
  use dd3_setup_model, only : new_model
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state, state_t
  use dd3_process_increment, only : accept_increment, prepare_increment, try_increment
  use dd3_process_phase_end, only : phase_is_over
  use dd3_process_phase_start, only : begin_phase
  use dd3_process_predictor, only : new_prediction
  use dd3_process_step_control, only : cut_back, stepper_t
  use dd3_system_system, only : new_system
  implicit none
  private
  public :: sample_t, argument, read_model, usual_options, collect

  !> Number of increments sampled in the last phase.
  integer, parameter :: places = 10

  !> One linear system of the run.
  type :: sample_t
    !> Row of the table of systems.
    character(len=120) :: origin = ""
    type(block_matrix_t) :: matrix
    !> Right-hand side and direct solution.
    real(wp), allocatable :: b(:), reference(:)
  end type sample_t

contains

  !> Return an argument of the command line.
  function argument(number) result(text)
    integer, intent(in) :: number
    character(len=:), allocatable :: text

    integer :: length

    call get_command_argument(number, length=length)
    allocate (character(len=length) :: text)
    call get_command_argument(number, text)
  end function argument

  !> Read an input file, with its changes; stop if it has errors.
  subroutine read_model(model, first)
    type(model_t), intent(out) :: model
    !> Number of the argument of the command line that names the file; `name=value` follow.
    integer, intent(in) :: first

    type(case_t) :: case
    type(error_list_t) :: errors
    type(text_t), allocatable :: override(:)
    integer :: i

    allocate (override(command_argument_count() - first))
    do i = 1, size(override)
      override(i)%s = argument(first + i)
    end do
    call read_case(case, argument(first), override, errors)
    if (errors%count == 0) call new_model(model, case, errors)
    if (errors%count == 0) return
    do i = 1, errors%count
      print '(a)', errors%item(i)%message
    end do
    error stop 1
  end subroutine read_model

  !> Return the options of a method that the measurements vary.
  pure type(solver_options_t) function usual_options(method) result(options)
    character(len=*), intent(in) :: method

    options%method = method
    options%ilu_level = 2
    options%tolerance = 1.0e-10_wp
    options%iterations = 200
    options%ordering = "none"
  end function usual_options

  !> Run the job and keep linear systems of it: the reduced matrix and right-hand side of the
  !> predictor and of the corrector's last iteration, from ten increments of the last phase and from
  !> one in the middle of each earlier phase.
  subroutine collect(model, sample, travel)
    type(model_t), intent(in) :: model
    type(sample_t), allocatable, intent(out) :: sample(:)
    !> Ascending values of the travel, mm, at the first increment beyond each of which to take the
    !> systems instead; the run ends after the last.
    real(wp), intent(in), optional :: travel(:)

    type(stepper_t) :: stepper
    type(state_t) :: committed, trial
    type(error_t), allocatable :: error
    real(wp) :: step, next
    logical :: chosen
    integer :: number, found

    allocate (sample(0))
    found = 0
    call new_state(committed, model)
    call new_state(trial, model)
    call new_system(stepper%system, model, usual_options("auto"), error)
    if (allocated(error)) error stop 1
    call new_prediction(stepper%prediction, model)
    do number = 1, size(model%phase)
      call begin_phase(model, number, committed)
      step = 1.0_wp
      if (number == size(model%phase)) step = 1.0_wp/real(places, wp)
      next = 0.5_wp*step
      do while (.not. phase_is_over(model, committed))
        chosen = committed%progress >= next
        if (present(travel)) chosen = committed%travel >= travel(found + 1)
        call run_increment(model, stepper, committed, trial, chosen, sample)
        if (committed%increment /= trial%increment) return
        if (.not. chosen) cycle
        next = next + step
        found = found + 1
        if (.not. present(travel)) cycle
        if (found == size(travel)) return
      end do
    end do
  end subroutine collect

  !> Run one increment; `trial%increment` is -1 on return if it fails.
  subroutine run_increment(model, stepper, committed, trial, chosen, sample)
    type(model_t), intent(in) :: model
    type(stepper_t), intent(inout) :: stepper
    type(state_t), intent(inout) :: committed, trial
    !> Whether to add the systems of the increment to `sample`.
    logical, intent(in) :: chosen
    type(sample_t), allocatable, intent(inout) :: sample(:)

    logical :: again

    trial%increment = -1
    call prepare_increment(model, committed, stepper)
    if (stepper%attempt%verdict%outcome /= verdict_converged) return
    if (chosen) call keep("predictor", model, committed, stepper, sample)
    do
      call try_increment(model, committed, trial, stepper)
      if (stepper%attempt%verdict%outcome == verdict_converged) exit
      call cut_back(stepper%attempt, again)
      if (again) cycle
      trial%increment = -1
      return
    end do
    if (chosen) call keep("corrector", model, trial, stepper, sample)
    call accept_increment(model, trial, stepper, committed)
  end subroutine run_increment

  !> Append the present linear system to the samples.
  subroutine keep(part, model, state, stepper, sample)
    !> Predictor or corrector.
    character(len=*), intent(in) :: part
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(sample_t), allocatable, intent(inout) :: sample(:)

    type(sample_t), allocatable :: longer(:)
    integer :: n

    n = size(sample)
    allocate (longer(n + 1))
    longer(:n) = sample
    call move_alloc(longer, sample)
    associate (this => sample(n + 1), status => stepper%system%contact%status)
      this%matrix = stepper%system%matrix
      this%b = stepper%system%problem%rhs
      write (this%origin, '("| ",i0," | ",a," | ",f5.2," | ",i0," | ",a," | ",4(i0," | "))') &
          n + 1, model%phase(state%phase)%name, state%travel, state%increment, part, &
          count(state%sheet%plastic), count(status == status_gap), &
          count(status == status_stick), count(status == status_slip)
    end associate
  end subroutine keep

end module run_samples
