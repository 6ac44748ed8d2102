!> The last step of a corrector that has found everything but the balance of a pressed tool.
module dd3_process_balance
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : section_contact
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_residual, only : evaluate_forces, pressed_force, tool_force_tolerance
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: balance_tools

  !> Share of its force within which a tool's own motion may do the rest; attempts at that.
  real(wp), parameter :: nearly_met = 1.0e-4_wp
  !> See above.
  integer, parameter :: most_balances = 4

contains

  !> Meets the forces of the pressed tools by the tools' own motion, once all else is settled. Where
  !> many nodes lie flat under a tool, the last of them open and close for many iterations with
  !> forces of a millionth of the tool's: far below the nodes' own residuals, but not below what is
  !> asked of the tool's balance. A force farther off than `nearly_met` is left to the iterations.
  subroutine balance_tools(system, model, phase, old, new, moved)
    !> The evaluated system.
    type(system_t), intent(inout) :: system
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: old
    !> The trial state.
    type(state_t), intent(inout) :: new
    !> Whether a tool was moved.
    logical, intent(out) :: moved

    real(wp) :: way(model%n_tool)
    integer :: attempt, tool

    moved = .false.
    call system%profile%start()
    do attempt = 1, most_balances
      way = 0.0_wp
      do tool = 1, model%n_tool
        if (.not. phase%pressed(tool)) cycle
        associate (residual => abs(system%problem%tool_residual(tool)), &
                   force => pressed_force(phase, new, tool))
          if (residual > tool_force_tolerance*force .and. residual <= nearly_met*force) &
            way(tool) = way_to_balance(system, phase, tool)
        end associate
      end do
      if (all(abs(way) <= 0.0_wp)) exit
      do tool = 1, model%n_tool
        new%tool_displacement(:, tool) = new%tool_displacement(:, tool) &
            + way(tool)*phase%direction(:, tool)
      end do
      moved = .true.
      call evaluate_forces(system, model, phase, old, new)
    end do
    call system%profile%add(section_contact)
  end subroutine balance_tools

  !> How far a pressed tool has to go along its line until its force is met; zero where nothing
  !> resists it.
  pure real(wp) function way_to_balance(system, phase, tool) result(way)
    !> The system with its contact evaluated.
    type(system_t), intent(in) :: system
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The tool.
    integer, intent(in) :: tool

    real(wp) :: stiffness, line(3)
    integer :: c

    line = phase%direction(:, tool)
    stiffness = 0.0_wp
    do c = 1, size(system%contact%tool)
      if (system%contact%tool(c) /= tool .or. system%contact%status(c) == status_gap) cycle
      stiffness = stiffness + dot_product(line, matmul(system%contact%d(:, :, c), line))
    end do
    way = 0.0_wp
    if (stiffness > 0.0_wp) way = system%problem%tool_residual(tool)/stiffness
  end function way_to_balance

end module dd3_process_balance
