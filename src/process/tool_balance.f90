! SPDX-License-Identifier: GPL-3.0-or-later
!> Balance of the pressed tools in the mixed formulation by their motion alone.
module dd3_process_tool_balance
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_forces, only : evaluate_forces
  use dd3_process_norm, only : balanced, pressed_force
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: balance_tools

  !> Largest residual of a pressed tool, over its force, that its motion reduces. Larger ones are
  !> left to the iterations.
  real(wp), parameter :: largest_fraction = 1.0e-3_wp
  !> Largest number of such motions.
  integer, parameter :: most_motions = 4

contains

  !> Balance the forces of the pressed tools by the motion of the tools alone, once all else has
  !> converged. Where many nodes lie flat under a tool, the last of them open and close for many
  !> iterations with forces far below the tolerance of the nodes, but not below that of the tool. An
  !> increment that began with a tool out of balance would take many iterations too.
  subroutine balance_tools(model, committed, trial, system, moved)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    type(system_t), intent(inout) :: system
    !> A tool was moved.
    logical, intent(out) :: moved

    real(wp) :: fraction, distance
    integer :: k, tool
    logical :: moves

    moved = .false.
    associate (phase => model%phase(trial%phase))
      do k = 1, most_motions
        moves = .false.
        do tool = 1, model%n_tool
          if (.not. phase%pressed(tool)) cycle
          fraction = abs(system%problem%tool_residual(1, tool))/pressed_force(trial, tool)
          if (fraction <= balanced .or. fraction > largest_fraction) cycle
          distance = distance_to_balance(system, phase%direction(:, tool), tool)
          moves = moves .or. abs(distance) > 0.0_wp
          trial%tools%displacement(:, tool) = trial%tools%displacement(:, tool) &
              + distance*phase%direction(:, tool)
        end do
        if (.not. moves) exit
        moved = .true.
        call evaluate_forces(model, committed, trial, system)
      end do
    end associate
  end subroutine balance_tools

  !> Return the distance along its line at which the force of a pressed tool is balanced, mm; zero
  !> if nothing resists it.
  real(wp) function distance_to_balance(system, line, tool) result(distance)
    type(system_t), intent(in) :: system
    !> Unit vector along the line of motion.
    real(wp), intent(in) :: line(3)
    integer, intent(in) :: tool

    real(wp) :: stiffness(1)
    integer :: c

    stiffness = 0.0_wp
    do c = 1, size(system%contact%tool)
      if (system%contact%tool(c) /= tool .or. system%contact%status(c) == status_gap) cycle
      stiffness = stiffness + dot_product(line, matmul(system%contact%d(:, :, c), line))
    end do
    call sum_over_ranks(1, stiffness)
    distance = 0.0_wp
    if (stiffness(1) > 0.0_wp) distance = system%problem%tool_residual(1, tool)/stiffness(1)
  end function distance_to_balance

end module dd3_process_tool_balance
