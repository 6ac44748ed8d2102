!> Stiffness of the loads that depend on the displacements: pressures, draw-beads, and the springs
!> of released tools.
module dd3_system_load_stiffness
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_drawbead, only : add_bead_stiffness
  use dd3_system_pressure, only : add_pressure_stiffness
  use dd3_system_release, only : add_release_stiffness
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: add_load_stiffness

contains

  !> Add the stiffness of the loads to that of the sheet.
  subroutine add_load_stiffness(system, model, state)
    !> Its draw-beads are placed, or evaluated at the state.
    type(system_t), intent(inout) :: system
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    call add_pressure_stiffness(system, model, state)
    call add_bead_stiffness(system%stiffness, system%bead)
    call add_release_stiffness(system, model, state)
  end subroutine add_load_stiffness

end module dd3_system_load_stiffness
