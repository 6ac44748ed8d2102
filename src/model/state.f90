! SPDX-License-Identifier: GPL-3.0-or-later
!> State of a run: all that changes in it and decides how it continues. Two copies exist, the
!> committed state (configuration N-1, in equilibrium) and the trial state (configuration N);
!> acceptance and cut-back are assignments. The walk over the components in state_walk.f90 serves
!> the restart; a test checks that it names every component.
module dd3_model_state
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : identity
  use dd3_model_configuration, only : configuration_t, phase_start_t
  use dd3_model_model, only : model_t
  use dd3_model_terms_list, only : new_terms
  use dd3_model_terms_term, only : term_box_t
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

    integer :: e, p, t

    call new_sheet(self, model)
    call new_terms(self%term, model)
    associate (n_contact => model%n_contact, n_tool => model%n_tool)
      allocate (self%lambda(3, n_contact), source=0.0_wp)
      allocate (self%status(n_contact), self%contact_tool(n_contact), source=0)
      allocate (self%hint(n_tool, n_contact))
      allocate (self%slip_path(n_contact), source=0.0_wp)
      allocate (self%place(n_contact), source=0.5_wp)
      allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), source=0.0_wp)
      allocate (self%tool_centre(3, n_tool), self%tool_angle(n_tool), source=0.0_wp)
      self%tool_rotation = spread(identity, 3, n_tool)
      allocate (self%tool_force(3, n_tool), self%layer_offset(n_tool), source=0.0_wp)
      allocate (self%touched(n_tool), source=.false.)
      allocate (self%tool_depth(n_tool), self%largest_depth(n_tool), source=0.0_wp)
      allocate (self%deepest_face(n_tool), self%open_edge(3, n_tool), source=0)
      allocate (self%open_edge_displacement(n_tool), source=0.0_wp)
      allocate (self%deepest_radius(n_tool), source=huge(1.0_wp))
    end associate
    self%x(:, :) = model%start_positions()
    do e = 1, size(model%part%element)
      do p = 1, model%element%n_point
        self%orientation(:, :, p, e) = model%axes(:, :, model%material_of(model%part%element(e)))
      end do
    end do
    if (present(sheet)) then
      if (sheet%has_state) then
        associate (e => model%part%element, &
            n => min(model%n_internal, size(sheet%internal_variables, 1)))
          self%stress(:, :, :) = sheet%stress(:, :, e)
          self%orientation(:, :, :, :) = sheet%orientation(:, :, :, e)
          self%internal_variables(:n, :, :) = sheet%internal_variables(:n, :, e)
        end associate
      end if
    end if
    do t = 1, model%n_tool
      self%tool_displacement(:, t) = model%tool(t)%position
    end do
    call new_phase_start(self%start, self)
  end subroutine new_state

  !> Allocate what belongs to nodes and integration points, and set it to zero.
  subroutine new_sheet(self, model)
    type(state_t), intent(inout) :: self
    type(model_t), intent(in) :: model

    associate (n_node => model%n_node, n_point => model%element%n_point, &
        n => size(model%part%element))
      allocate (self%x(3, n_node), self%internal_force(3, n_node), source=0.0_wp)
      allocate (self%external_force(3, n_node), source=0.0_wp)
      allocate (self%stress(6, n_point, n), source=0.0_wp)
      allocate (self%internal_variables(model%n_internal, n_point, n), source=0.0_wp)
      allocate (self%orientation(3, 3, n_point, n), source=0.0_wp)
      allocate (self%enhanced(model%element%n_enhanced, n), source=0.0_wp)
      allocate (self%plastic(n_point, n), source=.false.)
    end associate
  end subroutine new_sheet

  !> Allocate the values at the start of a phase for a state and set them to zero.
  subroutine new_phase_start(self, state)
    type(phase_start_t), intent(out) :: self
    type(state_t), intent(in) :: state

    associate (n_tool => size(state%layer_offset))
      allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), &
          self%tool_load_end(3, n_tool), self%layer_offset(n_tool), source=0.0_wp)
    end associate
    allocate (self%held_offset(size(state%status)), source=-1.0_wp)
    allocate (self%plastic_strain(size(state%stress, 2), size(state%stress, 3)), source=0.0_wp)
    self%tool_rotation = state%tool_rotation
    self%tool_angle = state%tool_angle
    self%x = state%x
  end subroutine new_phase_start

end module dd3_model_state
