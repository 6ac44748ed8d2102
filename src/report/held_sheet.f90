! SPDX-License-Identifier: GPL-3.0-or-later
!> Sheet under a holder at the end of a phase: its waves, and its rim beyond the holder.
module dd3_report_held_sheet
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : held_t, place_t
  use dd3_report_tool_view, only : across, depth, new_place, new_view, nodes_of_column, path_t, &
      view_t
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_placement, only : placement_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: draws, is_holder, measure_holder

  !> Least -m.n of the normals of a holder and the tool across where they hold the sheet, not where
  !> the latter is rounded; least cosine between the inward normal of the rim and the direction to a
  !> holder inside.
  real(wp), parameter :: alike = 0.999_wp, inside = 0.7_wp

contains

  !> Whether a tool holds the sheet around another one on the same face: it has been pressed or
  !> moved to a gap, and does not draw.
  pure logical function is_holder(model, state, path, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: tool

    integer :: t

    is_holder = .false.
    if (.not. state%tools%touches(tool)) return
    if (any([(draws(model, t, tool), t=1, size(model%phase))])) return
    if (.not. any([(model%phase(t)%pressed(tool) .or. model%phase(t)%gap_other(tool) > 0, &
        t=1, state%phase)])) return
    do t = 1, model%n_tool
      if (t == tool .or. .not. path%acts(t)) cycle
      if (.not. any(model%member(t, :) .and. model%member(tool, :))) cycle
      if (all(path%lower(:, tool) >= path%lower(:, t) .and. path%upper(:, tool) <= &
          path%upper(:, t))) then
        is_holder = .false.
        return
      end if
      is_holder = .true.
    end do
  end function is_holder

  !> Whether a phase moves a tool as a punch or a die, not to press it or to a gap as a holder.
  pure logical function draws(model, phase, tool)
    type(model_t), intent(in) :: model
    integer, intent(in) :: phase, tool

    associate (now => model%phase(phase))
      draws = now%active(tool) .and. .not. now%withdrawn(tool) .and. now%gap_other(tool) == 0
      if (draws) draws = merge(now%control == tool, norm2(now%move(:, tool)) > 0.0_wp, &
          now%pressed(tool))
      if (.not. draws .or. phase == size(model%phase) .or. now%control == tool) return
      draws = .not. model%phase(phase + 1)%pressed(tool)
    end associate
  end function draws

  !> Measure the sheet under a holder. The height of its waves is the smaller one of its largest
  !> distances from the holder and from the tool across: a sheet of uneven thickness, which leaves
  !> space without a wave, lies on one of the two.
  subroutine measure_holder(self, model, state, path, tool)
    type(held_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: tool

    type(view_t) :: view(2)
    type(place_t) :: largest(2)
    integer :: node, n(2), other

    self%tool = tool
    do node = 1, model%n_node
      n = nodes_of_column(model, path, node, tool)
      if (n(1) == 0) cycle
      call measure_rim(self%beyond, model, state, path, tool, n(1))
      view(1) = new_view(model, state, path, n(1))
      if (minloc(view(1)%gap, dim=1) /= tool) cycle
      view(2) = new_view(model, state, path, n(2))
      view(2)%gap(tool) = huge(1.0_wp)
      other = minloc(view(2)%gap, dim=1)
      if (-dot_product(view(1)%normal(:, tool), view(2)%normal(:, other)) < alike) cycle
      if (view(1)%gap(tool) >= largest(1)%distance) then
        largest(1) = new_place(state, n(1), view(1)%gap(tool), tool)
      end if
      if (view(2)%gap(other) >= largest(2)%distance) then
        largest(2) = new_place(state, n(2), view(2)%gap(other), other)
      end if
    end do
    self%wave = largest(minloc(largest%distance, dim=1))
    self%lift = largest(2)
  end subroutine measure_holder

  !> Keep the distance of a node of the rim from a holder, if it lies outside of it: the holder is
  !> in the direction of the inward normal of the rim, and no other tool on its side of the sheet,
  !> which may form this rim, is nearer.
  pure subroutine measure_rim(beyond, model, state, path, tool, node)
    type(place_t), intent(inout) :: beyond
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: tool, node

    type(placement_t) :: placement
    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: to_holder(2), inward(2), at(2), to_other
    integer :: t

    if (.not. allocated(model%rim_normal)) return
    inward = across(path, model%rim_normal(:, node))
    if (norm2(inward) <= 0.0_wp) return
    at = across(path, state%x(:, node))
    to_other = huge(1.0_wp)
    do t = 1, model%n_tool
      if (t == tool .or. .not. (path%acts(t) .and. model%member(t, node))) cycle
      to_other = min(to_other, norm2(max(path%lower(:, t) - at, at - path%upper(:, t), 0.0_wp)))
    end do
    if (to_other <= 0.0_wp) return
    call find_on_tool(model%tool(tool), state%placement(tool), state%x(:, node), hint, &
        model%tolerance%tool_search, depth*model%thickness_at(node), hit, path%normal(:, node))
    if (.not. hit%border) return
    placement = state%placement(tool)
    to_holder = across(path, placement%vector_to_global(hit%point) + placement%translation) - at
    if (dot_product(to_holder, inward) < inside*norm2(to_holder)*norm2(inward)) return
    if (norm2(to_holder) <= beyond%distance .or. norm2(to_holder) > to_other) return
    beyond = new_place(state, node, norm2(to_holder), tool)
  end subroutine measure_rim

end module dd3_report_held_sheet
