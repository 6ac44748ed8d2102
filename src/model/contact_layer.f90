!> Contact layer of the tools in the compliant formulation. A tool may start at the sheet, inside the
!> height of its layer. So that the sheet starts without pressure, the layer begins behind its place
!> by what is missing, and advances to it over the first part of the phase.
module dd3_model_contact_layer
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : find_contact, hint_t, hit_t
  use dd3_contact_compliant, only : layer_t, new_layer
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: layer_at, missing_clearance, offset_factor, offset_rate, progress_left

  !> Part of the phase over which the layers advance.
  real(wp), parameter :: advance = 0.1_wp
  !> Progress by which two places in a phase differ.
  real(wp), parameter :: step = 1.0e-9_wp

contains

  !> Return the layer at a candidate.
  pure type(layer_t) function layer_at(model, phase, c) result(layer)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: c

    layer = new_layer(phase%layer, model%thickness_at(model%contact_node(c)), &
        model%contact_stiffness(c))
  end function layer_at

  !> Return the part of a layer's offset that is left at a progress of the phase.
  pure real(wp) function offset_factor(progress)
    real(wp), intent(in) :: progress

    offset_factor = progress_left(progress)/advance
  end function offset_factor

  !> Return the progress after which the layers are in their places.
  pure real(wp) function progress_left(progress)
    real(wp), intent(in) :: progress

    progress_left = max(0.0_wp, advance - progress)
    if (progress_left <= step) progress_left = 0.0_wp
  end function progress_left

  !> Return the derivative of the offset factor behind a progress.
  pure real(wp) function offset_rate(progress)
    real(wp), intent(in) :: progress

    offset_rate = merge(-1.0_wp/advance, 0.0_wp, progress_left(progress) > 0.0_wp)
  end function offset_rate

  !> Return the distance by which the gap between a tool and its candidates is smaller than the
  !> layer, mm; zero if it is not.
  function missing_clearance(model, phase, state, tool) result(missing)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    real(wp) :: missing

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: height
    integer :: c

    missing = 0.0_wp
    do c = 1, model%n_contact
      if (.not. model%candidate(tool, c)) cycle
      height = phase%layer*model%thickness_at(model%contact_node(c))
      hint = hint_t()
      call find_contact(model%tool(tool)%surface, state%x(:, model%contact_node(c)) &
          - state%tool_displacement(:, tool), hint, height, model%tolerance%committed_depth, hit)
      if (hit%found) missing = max(missing, height - hit%distance)
    end do
  end function missing_clearance

end module dd3_model_contact_layer
