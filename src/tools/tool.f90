! SPDX-License-Identifier: GPL-3.0-or-later
!> A tool, rigid or with a compliance of its surface: that surface, friction and initial position,
!> and the closest point to a point of the sheet where it is placed.
module dd3_tools_tool
  use dd3_base_kinds, only : wp
  use dd3_contact_friction, only : friction_t
  use dd3_tools_closest, only : border_t, find_contact, hint_t, hit_t
  use dd3_tools_crossing, only : crossing_t, find_crossing
  use dd3_tools_placement, only : placement_t
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: tool_t, find_on_tool, find_crossing_on_tool

  !> A tool, without its place, which the state holds.
  type :: tool_t
    !> Name in the input.
    character(len=:), allocatable :: name
    !> Surface in the frame of its file.
    type(surface_t) :: surface
    !> Friction against the sheet.
    type(friction_t) :: friction
    !> Deflection of the surface along its normal per pressure, mm/MPa; 0: rigid.
    real(wp) :: compliance = 0.0_wp
    !> Initial offset of the surface's frame from the global one, mm.
    real(wp) :: position(3) = 0.0_wp
  end type tool_t

contains

  !> Find the closest point of a tool in its place, as `find_contact` does on its surface.
  pure subroutine find_on_tool(tool, placement, x, hint, search_distance, depth, hit, outward, &
      border)
    type(tool_t), intent(in) :: tool
    type(placement_t), intent(in) :: placement
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    type(hint_t), intent(inout) :: hint
    !> Largest distance of a contact outside the tool, and depth inside it, mm.
    real(wp), intent(in) :: search_distance, depth
    !> Vectors in the global frame, the point in that of the tool.
    type(hit_t), intent(out) :: hit
    !> Outward normal of the sheet at the node.
    real(wp), intent(in), optional :: outward(3)
    !> Contact beside the border.
    type(border_t), intent(in), optional :: border

    real(wp) :: facing(3)

    facing = 0.0_wp
    if (present(outward)) facing = placement%vector_to_tool(outward)
    call find_contact(tool%surface, placement%to_tool(x), hint, search_distance, depth, hit, &
        facing, border)
    hit%normal = placement%vector_to_global(hit%normal)
    hit%gap_gradient = placement%vector_to_global(hit%gap_gradient)
    hit%dnormal = placement%tensor_to_global(hit%dnormal)
  end subroutine find_on_tool

  !> Find where an edge of the mesh crosses the border of a tool in its place, as `find_crossing`
  !> does on its surface.
  pure subroutine find_crossing_on_tool(tool, placement, ends, outward, border, largest_gap, &
      crossing)
    type(tool_t), intent(in) :: tool
    type(placement_t), intent(in) :: placement
    !> Ends of the edge, mm, and the outward normal of the sheet.
    real(wp), intent(in) :: ends(3, 2), outward(3)
    type(border_t), intent(in) :: border
    !> Largest gap, mm.
    real(wp), intent(in) :: largest_gap
    !> Vectors in the global frame.
    type(crossing_t), intent(out) :: crossing

    call find_crossing(tool%surface, reshape([placement%to_tool(ends(:, 1)), &
        placement%to_tool(ends(:, 2))], [3, 2]), placement%vector_to_tool(outward), border, &
        largest_gap, crossing)
    if (.not. crossing%found) return
    crossing%normal = placement%vector_to_global(crossing%normal)
    crossing%by_point = placement%vector_to_global(crossing%by_point)
    crossing%by_edge = placement%vector_to_global(crossing%by_edge)
    crossing%weight_by_point = placement%vector_to_global(crossing%weight_by_point)
    crossing%weight_by_edge = placement%vector_to_global(crossing%weight_by_edge)
    crossing%dnormal = placement%tensor_to_global(crossing%dnormal)
    crossing%along = placement%vector_to_global(crossing%along)
  end subroutine find_crossing_on_tool

end module dd3_tools_tool
