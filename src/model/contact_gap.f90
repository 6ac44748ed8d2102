!> Gap between the candidates and the nearest tool in a committed state.
module dd3_model_contact_gap
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : hint_t, hit_t
  use dd3_contact_tool, only : find_on_tool
  use dd3_model_contact_layer, only : border_at
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : outward_normals
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: contact_gaps

contains

  !> Return the gaps, `(n_contact_node)`, mm; at most the search distance of the phase, which is
  !> also the value where no active tool is that near.
  function contact_gaps(model, state) result(gap)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), allocatable :: gap(:)

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: outward(3, model%n_contact)
    integer :: c, t

    associate (phase => model%phase(state%phase))
      allocate (gap(model%n_contact_node), source=phase%search_distance)
      if (.not. allocated(model%contact_face)) return
      outward = outward_normals(model, state%x)
      do c = 1, model%n_contact_node
        do t = 1, model%n_tool
          if (.not. (model%candidate(t, c) .and. phase%active(t))) cycle
          hint = state%hint(t, c)
          call find_on_tool(model%tool(t), state%placement(t), &
              model%point_position(c, state%x), hint, &
              phase%search_distance, model%tolerance%committed_depth &
              + state%layer_offset(t), hit, outward(:, c), border_at(model, phase, c))
          if (hit%found) gap(c) = min(gap(c), hit%distance)
        end do
      end do
    end associate
  end function contact_gaps

end module dd3_model_contact_gap
