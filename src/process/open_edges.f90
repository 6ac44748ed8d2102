! SPDX-License-Identifier: GPL-3.0-or-later
!> Points under pressure that leave the surface of a tool over an open edge: one without a
!> neighbouring patch, where the surface ends.
module dd3_process_open_edges
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_integers, count_over_ranks, rank_of_smallest, sum_over_ranks
  use dd3_base_text, only : to_text
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_placement, only : placement_t
  use dd3_tools_surface, only : edge_parameters, surface_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: passage_t, find_passage, observe_passages, edge_name, open_edge_at

  !> Contact force that counts, relative to the mean of those on the tool.
  real(wp), parameter :: notable_force = 0.1_wp

  !> Passage of a point over an open edge.
  type :: passage_t
    !> Tool, 0 for none, patch, number of the edge as in `edge_t`, node of the point.
    integer :: tool = 0, patch = 0, edge = 0, node = 0
  end type passage_t

contains

  !> Record in a state the first passage over an open edge of each tool in the phase.
  subroutine observe_passages(model, committed, trial)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Converged.
    type(state_t), intent(inout) :: trial

    type(passage_t) :: passage
    integer :: tool

    do tool = 1, model%n_tool
      if (trial%observed%open_edge(1, tool) > 0) cycle
      passage = passage_over(model, committed, trial%x, trial%placement(tool), tool)
      if (passage%tool == 0) cycle
      trial%observed%open_edge(:, tool) = [passage%patch, passage%edge, passage%node]
      trial%observed%open_edge_displacement(tool) = norm2(trial%tools%displacement(:, tool) &
          - trial%start%tool_displacement(:, tool))
    end do
  end subroutine observe_passages

  !> Return a passage over an open edge in the displacement of sheet and tools from a state.
  function find_passage(model, state, displacement, tool_displacement) result(passage)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(3, n_node)` and `(3, n_tool)`, mm.
    real(wp), intent(in) :: displacement(:, :), tool_displacement(:, :)
    type(passage_t) :: passage

    type(placement_t) :: placement
    integer :: tool

    do tool = 1, model%n_tool
      placement = state%placement(tool)
      placement%translation = placement%translation + tool_displacement(:, tool)
      passage = passage_over(model, state, state%x + displacement, placement, tool)
      if (passage%tool > 0) return
    end do
  end function find_passage

  !> Return a point in contact with a tool in a state that lies beside its surface in another one:
  !> that of the lowest node that a rank finds first.
  function passage_over(model, state, x, placement, tool) result(passage)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Positions of the nodes, `(3, n_node)`, mm, and placement of the tool in the other state.
    real(wp), intent(in) :: x(:, :)
    type(placement_t), intent(in) :: placement
    integer, intent(in) :: tool
    type(passage_t) :: passage

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: force(model%n_contact), total(1), least
    integer :: c

    force = 0.0_wp
    where (state%contact%tool == tool .and. state%contact%status /= status_gap) &
        force = norm2(state%contact%lambda, dim=1)
    total = sum(force)
    call sum_over_ranks(1, total)
    least = notable_force*total(1)/real(max(1, count_over_ranks(count(force > 0.0_wp))), wp)
    associate (distance => model%tolerance%tool_search)
      do c = 1, model%n_contact_fixed
        if (force(c) <= least) cycle
        hint = state%contact%hint(tool, c)
        call find_on_tool(model%tool(tool), placement, model%contact_point(c)%position(x), hint, &
            distance, distance, hit)
        if (.not. hit%border) cycle
        passage = passage_t(tool, hit%patch, open_edge_at(model%tool(tool)%surface, hit), &
            model%contact_node(c))
        exit
      end do
    end associate
    if (model%part%divided) call share_passage(passage)
  end function passage_over

  !> Give all ranks the passage of the lowest node.
  subroutine share_passage(passage)
    type(passage_t), intent(inout) :: passage

    integer, allocatable :: bits(:)

    bits = transfer(passage, [0])
    call broadcast_integers(rank_of_smallest(merge(0.0_wp, 1.0_wp, passage%tool > 0), &
        passage%node), size(bits), bits)
    passage = transfer(bits, passage)
  end subroutine share_passage

  !> Return the number of the open edge at a closest point on a border.
  pure integer function open_edge_at(surface, hit) result(edge)
    type(surface_t), intent(in) :: surface
    type(hit_t), intent(in) :: hit

    real(wp) :: uv(2)

    do edge = 1, 4
      if (surface%edge(edge, hit%patch)%patch > 0 .or. surface%edge(edge, hit%patch)%pole) cycle
      uv = edge_parameters(edge, 0.5_wp)
      if (abs(merge(hit%u - uv(1), hit%v - uv(2), edge <= 2)) <= 0.0_wp) return
    end do
  end function open_edge_at

  !> Return the name of an edge: "edge u = 1 of patch 3".
  pure function edge_name(patch, edge) result(text)
    !> Numbers of the patch and, as in `edge_t`, of the edge.
    integer, intent(in) :: patch, edge
    character(len=:), allocatable :: text

    character(len=5), parameter :: side(4) = ["u = 0", "u = 1", "v = 0", "v = 1"]

    text = "edge "//side(edge)//" of patch "//to_text(patch)
  end function edge_name

end module dd3_process_open_edges
