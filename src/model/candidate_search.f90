!> Closest points of a tool to all its candidates.
module dd3_model_candidate_search
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : hint_t, hit_t
  use dd3_contact_placement, only : placement_t
  use dd3_contact_tool, only : find_on_tool
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: candidate_hits

contains

  !> Return the closest points, `(n_contact)`; none is found for a point that is no candidate.
  pure function candidate_hits(model, tool, placement, x, search_distance, depth, outward) &
      result(hit)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    type(placement_t), intent(in) :: placement
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Largest distance outside the tool, and depth inside it, mm.
    real(wp), intent(in) :: search_distance, depth
    !> Outward normals of the sheet, `(3, n_contact)`.
    real(wp), intent(in), optional :: outward(:, :)
    type(hit_t), allocatable :: hit(:)

    type(hint_t) :: hint
    real(wp) :: facing(3)
    integer :: c

    allocate (hit(model%n_contact))
    facing = 0.0_wp
    do c = 1, model%n_contact
      if (.not. model%candidate(tool, c)) cycle
      hint = hint_t()
      if (present(outward)) facing = outward(:, c)
      call find_on_tool(model%tool(tool), placement, model%contact_point(c)%position(x), hint, &
          search_distance, depth, hit(c), facing)
    end do
  end function candidate_hits

end module dd3_model_candidate_search
