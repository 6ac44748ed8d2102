!> Last step of a corrector that has converged but for the force balance of a pressed tool.
module dd3_process_balance
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_contact
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_residual, only : evaluate_forces, pressed_force
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: balance_tools, tool_tolerance

  !> Largest residual of a pressed tool, over its force, that is accepted, and the one from which on
  !> the motion of the tool alone reduces it.
  real(wp), parameter :: tool_tolerance = 1.0e-3_wp, balanced = 1.0e-6_wp
  !> Largest number of such motions.
  integer, parameter :: most_motions = 4

contains

  !> Balance the forces of the pressed tools by the motion of the tools alone, once all else has
  !> converged. Where many nodes lie flat under a tool, the last of them open and close for many
  !> iterations with forces far below the tolerance of the nodes, but not below that of the tool. An
  !> increment that began with a tool out of balance would take many iterations too. Larger residuals
  !> are left to the iterations.
  subroutine balance_tools(model, committed, trial, system, moved)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Evaluated at the trial state.
    type(system_t), intent(inout) :: system
    !> A tool was moved.
    logical, intent(out) :: moved

    real(wp) :: distance(model%n_tool)
    integer :: k, tool

    moved = .false.
    call system%profile%start()
    associate (phase => model%phase(trial%phase))
      do k = 1, most_motions
        distance = 0.0_wp
        do tool = 1, model%n_tool
          if (.not. phase%pressed(tool)) cycle
          associate (residual => abs(system%problem%tool_residual(tool)), &
              force => pressed_force(trial, tool))
            if (residual > balanced*force .and. residual <= tool_tolerance*force) &
                distance(tool) = distance_to_balance(system, phase%direction(:, tool), tool)
          end associate
        end do
        if (all(abs(distance) <= 0.0_wp)) exit
        do tool = 1, model%n_tool
          trial%tool_displacement(:, tool) = trial%tool_displacement(:, tool) &
              + distance(tool)*phase%direction(:, tool)
        end do
        moved = .true.
        call evaluate_forces(model, committed, trial, system)
      end do
    end associate
    call system%profile%add(section_contact)
  end subroutine balance_tools

  !> Return the distance along its line at which the force of a pressed tool is balanced, mm; zero
  !> if nothing resists it.
  pure real(wp) function distance_to_balance(system, line, tool) result(distance)
    !> Evaluated at the trial state.
    type(system_t), intent(in) :: system
    !> Unit vector along the line of motion.
    real(wp), intent(in) :: line(3)
    integer, intent(in) :: tool

    real(wp) :: stiffness
    integer :: c

    stiffness = 0.0_wp
    do c = 1, size(system%contact%tool)
      if (system%contact%tool(c) /= tool .or. system%contact%status(c) == status_gap) cycle
      stiffness = stiffness + dot_product(line, matmul(system%contact%d(:, :, c), line))
    end do
    distance = 0.0_wp
    if (stiffness > 0.0_wp) distance = system%problem%tool_residual(tool)/stiffness
  end function distance_to_balance

end module dd3_process_balance
