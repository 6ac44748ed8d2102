! SPDX-License-Identifier: GPL-3.0-or-later
!> Stiffness of the loads that depend on the displacements: pressures, which follow the surface,
!> draw-beads, forces of lost constraints, the springs of a free sheet that is laid down and of the
!> supports of one that floats, and viscous forces.
module dd3_system_load_stiffness
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity
  use dd3_model_carried_forces, only : carried_stiffness
  use dd3_model_loads, only : face_stiffness, laying_factor, spring_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_model_support_springs, only : spring_stiffness_of => support_stiffness
  use dd3_system_drawbead, only : add_bead_stiffness
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: add_load_stiffness, add_laying_stiffness

contains

  !> Add the stiffness of the loads to that of the sheet.
  subroutine add_load_stiffness(system, model, state)
    !> Its draw-beads are placed, or evaluated at the state.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    call add_pressure_stiffness(system, model, state)
    call add_bead_stiffness(system%matrix, system%bead)
    call add_laying_stiffness(system, model, state)
    call add_carried_stiffness(system, model, state)
    call add_damping_stiffness(system, model)
    call add_support_stiffness(system, model, state)
  end subroutine add_load_stiffness

  !> Subtract the derivatives of the pressure forces from the stiffness.
  subroutine add_pressure_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp), allocatable :: stiffness(:, :, :, :)
    integer :: s, f, a, b, k

    do s = 1, size(state%pressure)
      if (.not. abs(state%pressure(s)) > 0.0_wp) cycle
      do f = 1, size(model%pressure_set(s)%node, 2)
        associate (node => model%pressure_set(s)%node(:, f), value => system%matrix%value)
          stiffness = state%pressure(s)*face_stiffness(model%element, state%x(:, node))
          do a = 1, size(node)
            if (.not. holds_row(system%matrix, node(a))) cycle
            do b = 1, size(node)
              k = position_of(system%matrix, node(a), node(b))
              value(:, :, k) = value(:, :, k) - stiffness(:, :, a, b)
            end do
          end do
        end associate
      end do
    end do
  end subroutine add_pressure_stiffness

  !> Add the derivatives of the forces of lost constraints, which turn with the sheet.
  subroutine add_carried_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: factor, stiffness(3, 3)
    integer :: node, k

    if (.not. state%start%fading_turns) return
    factor = model%phase(state%phase)%fading(state%progress)
    do node = 1, model%n_node
      associate (other => model%fibre_end(node), force => state%start%fading(:, node), &
          before => state%start%x, x => state%x, value => system%matrix%value)
        if (other == 0 .or. all(abs(force) <= 0.0_wp)) cycle
        if (.not. holds_row(system%matrix, node)) cycle
        stiffness = factor*carried_stiffness(before(:, other) - before(:, node), &
            x(:, other) - x(:, node), force)
        k = position_of(system%matrix, node, other)
        value(:, :, k) = value(:, :, k) + stiffness
        k = system%matrix%diagonal(node)
        value(:, :, k) = value(:, :, k) - stiffness
      end associate
    end do
  end subroutine add_carried_stiffness

  !> Add the stiffness of the springs at the supports of a sheet that floats.
  subroutine add_support_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    integer :: k, i

    associate (phase => model%phase(state%phase), value => system%matrix%value)
      if (.not. phase%floats) return
      do i = 1, size(phase%support, 2)
        associate (node => phase%support(1, i), axis => phase%support(2, i))
          if (.not. holds_row(system%matrix, node)) cycle
          k = system%matrix%diagonal(node)
          value(axis, axis, k) = value(axis, axis, k) + spring_stiffness_of(model, state)
        end associate
      end do
    end associate
  end subroutine add_support_stiffness

  !> Add the derivatives of the viscous forces to the stiffness.
  subroutine add_damping_stiffness(system, model)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model

    integer :: node, k

    do node = 1, model%n_node
      if (.not. holds_row(system%matrix, node)) cycle
      k = system%matrix%diagonal(node)
      system%matrix%value(:, :, k) = system%matrix%value(:, :, k) &
          + system%problem%damping(node)*identity
    end do
  end subroutine add_damping_stiffness

  !> Add the stiffness of the springs to that of the sheet.
  subroutine add_laying_stiffness(system, model, state)
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: stiffness
    integer :: node, k

    do node = 1, model%n_node
      if (.not. holds_row(system%matrix, node)) cycle
      associate (laying => state%start%laying(:, node))
        if (all(abs(laying) <= 0.0_wp)) cycle
        stiffness = laying_factor(state%progress) &
            *spring_stiffness(laying, model%thickness_at(node))
        k = system%matrix%diagonal(node)
        system%matrix%value(:, :, k) = system%matrix%value(:, :, k) + stiffness*identity
      end associate
    end do
  end subroutine add_laying_stiffness

end module dd3_system_load_stiffness
