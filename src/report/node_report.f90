! SPDX-License-Identifier: GPL-3.0-or-later
!> What is special about the place of a node, for the message of a run that stops: supports, the rim
!> of the sheet, tools on both faces, further tools near it, open edges of the tools.
module dd3_report_node_report
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_base_text, only : axis_name, to_text
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_process_open_edges, only : edge_name, open_edge_at
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: place_of_node

contains

  !> Return number, position and special circumstances of a node.
  function place_of_node(model, state, node) result(text)
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    character(len=:), allocatable :: text

    integer :: i

    associate (x => state%x(:, node), held => model%phase(state%phase)%prescribed(:, node))
      text = "node "//to_text(node)//" at "//to_text(x(1), 5)//" "//to_text(x(2), 5)//" "// &
          to_text(x(3), 5)
      if (any(held)) text = text//", held along"
      do i = 1, 3
        if (held(i)) text = text//" "//axis_name(i)
      end do
    end associate
    if (allocated(model%rim_normal)) then
      if (norm2(model%rim_normal(:, node)) > 0.0_wp) text = text//", on the rim of the sheet"
    end if
    if (any(model%member(:, node))) text = text//tools_at(model, state, node)
  end function place_of_node

  !> Return which tools touch both faces of the sheet at a node, which others are nearer than its
  !> thickness, and the open edges among their closest points.
  function tools_at(model, state, node) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: node
    character(len=:), allocatable :: text

    type(hint_t) :: hint
    type(hit_t) :: hit
    integer :: tool, mine, other
    real(wp) :: reach

    text = ""
    mine = touching_tool(model, state, node)
    other = touching_tool(model, state, model%opposite(node))
    if (mine > 0 .and. other > 0) text = ", pinched between '"//model%tool(mine)%name// &
        "' and '"//model%tool(other)%name//"'"
    reach = model%thickness_at(node)
    do tool = 1, model%n_tool
      if (.not. model%member(tool, node)) cycle
      if (.not. model%phase(state%phase)%active(tool)) cycle
      hint = hint_t()
      call find_on_tool(model%tool(tool), state%placement(tool), state%x(:, node), hint, reach, &
          reach, hit)
      if (.not. hit%found) cycle
      if (mine > 0 .and. tool /= mine) text = text//", "//to_text(hit%distance, 2)// &
          " mm from tool '"//model%tool(tool)%name//"'"
      if (hit%border) text = text//", at the open "//edge_name(hit%patch, &
          open_edge_at(model%tool(tool)%surface, hit))//" of tool '"//model%tool(tool)%name//"'"
    end do
  end function tools_at

  !> Return the tool in contact with a node; 0 for none.
  integer function touching_tool(model, state, node)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> 0 for none.
    integer, intent(in) :: node

    integer :: c, tool(1)

    touching_tool = 0
    if (node == 0) return
    c = model%candidate_of(node)
    tool = 0
    if (c > 0) tool = merge(state%contact%tool(c), 0, state%contact%status(c) /= status_gap)
    call largest_over_ranks(1, tool)
    touching_tool = tool(1)
  end function touching_tool

end module dd3_report_node_report
