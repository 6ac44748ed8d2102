! SPDX-License-Identifier: GPL-3.0-or-later
!> State of a run: all that changes in it and decides how it continues. Two copies exist, the
!> committed state (configuration N-1, in equilibrium) and the trial state (configuration N);
!> acceptance and cut-back are assignments. The walk over the components in state_walk.f90 serves
!> the restart; a test checks that it names every component.
module dd3_model_state
  use dd3_base_kinds, only : wp
  use dd3_model_configuration, only : configuration_t, no_offset, phase_start_t
  use dd3_model_contact_state, only : new_contact_state
  use dd3_model_model, only : model_t
  use dd3_model_observations, only : new_observations
  use dd3_model_sheet_state, only : new_sheet_state
  use dd3_model_terms_list, only : new_terms
  use dd3_model_terms_term, only : term_box_t
  use dd3_model_tools_state, only : new_tools_state
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: state_t, new_state

  !> The configuration, and the terms that act on the sheet in it.
  type, extends(configuration_t) :: state_t
    type(term_box_t), allocatable :: term(:)
  end type state_t

contains

  !> Make the initial state: the sheet as it is at the start of the job, unstressed or with the
  !> state that another run has left in it, and the tools at their initial positions.
  subroutine new_state(self, model, sheet)
    type(state_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> The sheet of the model; unstressed if it is left out.
    type(sheet_t), intent(in), optional :: sheet

    self%x = model%start_positions()
    allocate (self%external_force(3, model%n_node), source=0.0_wp)
    call new_sheet_state(self%sheet, model, sheet)
    call new_contact_state(self%contact, model%n_tool, model%n_contact)
    call new_tools_state(self%tools, model)
    call new_observations(self%observed, model%n_tool, model%n_pin)
    call new_terms(self%term, model)
    call new_phase_start(self%start, self)
  end subroutine new_state

  !> Allocate the values at the start of a phase for a state and set them to zero.
  subroutine new_phase_start(self, state)
    type(phase_start_t), intent(out) :: self
    type(state_t), intent(in) :: state

    associate (n_tool => size(state%tools%layer_offset))
      allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), &
          self%tool_load_end(3, n_tool), self%layer_offset(n_tool), source=0.0_wp)
    end associate
    allocate (self%held_offset(size(state%contact%status)), source=no_offset)
    associate (stress => state%sheet%stress)
      allocate (self%plastic_strain(size(stress, 2), size(stress, 3)), source=0.0_wp)
    end associate
    self%tool_rotation = state%tools%rotation
    self%tool_angle = state%tools%angle
    self%x = state%x
  end subroutine new_phase_start

end module dd3_model_state
