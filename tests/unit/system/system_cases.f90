! SPDX-License-Identifier: GPL-3.0-or-later
!> Fixtures of the tests of the system: a model from an input file, states far from equilibrium with
!> every contact status, and the residual of the mixed equations.
module system_cases
  use, intrinsic :: iso_fortran_env, only : error_unit
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, error_t
  use dd3_base_text, only : text_t
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_input_case, only : case_t
  use dd3_input_reader, only : read_case
  use dd3_linalg_solver, only : solver_options_t
  use dd3_setup_model, only : new_model
  use dd3_model_model, only : model_t
  use dd3_model_pressed_tools, only : tool_balance
  use dd3_model_state, only : new_state, state_t
  use dd3_system_contact, only : evaluate_contact
  use dd3_system_internal, only : update_material
  use dd3_system_system, only : new_system, system_t
  implicit none
  private
  public :: load_model, load_system, random_values, deform, touch_all, mixed_residual

contains

  !> Read a model whose input has no errors.
  subroutine load_model(model, file, setting)
    type(model_t), intent(out) :: model
    character(len=*), intent(in) :: file
    !> name=value of a parameter.
    character(len=*), intent(in), optional :: setting

    type(case_t) :: case
    type(error_list_t) :: errors
    type(text_t), allocatable :: settings(:)
    integer :: i

    allocate (settings(0))
    if (present(setting)) settings = [text_t(setting)]
    call read_case(case, file, settings, errors)
    if (errors%count == 0) call new_model(model, case, errors)
    do i = 1, errors%count
      write (error_unit, '(a)') errors%item(i)%message
    end do
    if (errors%count > 0) error stop "the input file of the test has errors"
  end subroutine load_model

  !> Make a system with the direct solver.
  subroutine load_system(system, model)
    type(system_t), intent(out) :: system
    type(model_t), intent(in) :: model

    type(solver_options_t) :: options
    type(error_t), allocatable :: error

    options%method = "umfpack"
    options%ilu_level = 2
    options%tolerance = 1.0e-10_wp
    options%iterations = 200
    options%ordering = "none"
    call new_system(system, model, options, error)
    if (allocated(error)) error stop "the solver of the test is unknown"
  end subroutine load_system

  !> Return reproducible numbers between -1 and 1.
  subroutine random_values(seed, values)
    !> State of the sequence.
    integer, intent(inout) :: seed
    real(wp), intent(out) :: values(:, :)

    integer :: i, j

    do j = 1, size(values, 2)
      do i = 1, size(values, 1)
        seed = modulo(seed*3877 + 29573, 139968)
        values(i, j) = 2.0_wp*real(seed, wp)/139968.0_wp - 1.0_wp
      end do
    end do
  end subroutine random_values

  !> Make a committed state with plastic history and a trial state that continues it: stretched,
  !> bent and twisted.
  subroutine deform(system, model, committed, trial)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(out) :: committed
    type(state_t), intent(out) :: trial

    type(verdict_t) :: verdict
    real(wp) :: noise(3, model%n_node)
    integer :: step, seed

    call new_state(committed, model)
    call new_state(trial, model)
    seed = 7
    do step = 1, 3
      if (step > 1) committed = trial
      call random_values(seed, noise)
      trial%x = committed%x + 0.004_wp*min(1.0_wp, model%thickness)*noise
      trial%x(1, :) = trial%x(1, :)*(1.0_wp + 0.004_wp*step)
      trial%x(3, :) = trial%x(3, :) - 0.0005_wp*model%x0(1, :)**2
      call update_material(system, model, committed, trial, .false., verdict)
      if (verdict%outcome /= verdict_converged) error stop "the strip cannot be deformed"
    end do
  end subroutine deform

  !> Set contact forces with which some candidates stick, some slip and some leave their tools.
  subroutine touch_all(system, model, committed, trial)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial

    real(wp) :: tangent(3), pressure, penalty
    integer :: c

    penalty = model%phase(trial%phase)%penalty
    do c = 1, model%n_contact
      system%contact%committed_x(:, c) = model%contact_point(c)%position(committed%x)
    end do
    trial%contact%hint%due = .true.
    call evaluate_contact(system, model, committed, trial)
    do c = 1, model%n_contact
      tangent = [1.0_wp, 0.4_wp, 0.2_wp]
      associate (normal => system%contact%normal(:, c))
        tangent = tangent - dot_product(tangent, normal)*normal
        pressure = merge(6000.0_wp + 3.0_wp*penalty, 1000.0_wp, modulo(c/2, 2) == 0)
        if (modulo(c, 5) == 0) pressure = -60.0_wp
        pressure = pressure + penalty*system%contact%distance(c)
        trial%contact%lambda(:, c) = 300.0_wp*tangent - pressure*normal
      end associate
    end do
    call evaluate_contact(system, model, committed, trial)
  end subroutine touch_all

  !> Evaluate the residuals of the mixed equations.
  subroutine mixed_residual(system, model, committed, trial, residual, contact_residual, &
      tool_residual)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> F_int - F_ext + lambda, `(3, n_node)`.
    real(wp), intent(out) :: residual(:, :)
    !> F_equ - lambda, `(3, n_contact)`.
    real(wp), intent(out) :: contact_residual(:, :)
    !> Residual of the balance of the tools, `(3, n_tool)`.
    real(wp), intent(out) :: tool_residual(:, :)

    type(verdict_t) :: verdict
    integer :: c, t

    call update_material(system, model, committed, trial, .false., verdict)
    if (verdict%outcome /= verdict_converged) error stop "the stress update of the test failed"
    call evaluate_contact(system, model, committed, trial)
    residual = trial%sheet%internal_force - trial%external_force
    contact_residual = system%contact%force - trial%contact%lambda
    residual = residual + model%nodal_contact_forces(trial%x, trial%contact%lambda, &
        trial%contact%place)
    trial%tools%force = 0.0_wp
    do c = 1, model%n_contact
      t = system%contact%tool(c)
      if (t == 0) cycle
      trial%tools%force(:, t) = trial%tools%force(:, t) + system%contact%force(:, c)
    end do
    do t = 1, model%n_tool
      tool_residual(:, t) = tool_balance(model, trial, t, system%contact%force)
    end do
  end subroutine mixed_residual

end module system_cases
