! SPDX-License-Identifier: GPL-3.0-or-later
!> How far the sheet is formed to the tools at the end of a phase, measured at its columns of nodes.
!>
!> A punch is a tool that has moved against the sheet and does not go on in the next phase. Where
!> the sheet lies between it and a parallel surface of a tool across, along the path of the punch,
!> the path that is left until the two would pinch the sheet is the sum of the distances along the
!> path; of all places the shortest counts, as one pinched place stops the punch. A sheet thinner
!> than at the start counts as thick as that, since thinning is no open tool. The sheet is formed
!> there if it lies on one of the tools. In walls the tools may leave more space than the thickness
!> by design: there the distance from the nearer tool and that space are told, and not judged. Where
!> no tool is across, as under a punch in an open die, neither is measured.
!>
!> A sheet that is drawn over a punch from both sides keeps a place under it that does not move
!> across the path. The least displacement of the columns on its level faces is the slide.
module dd3_report_closing
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : closing_t, held_t, place_t, punch_t
  use dd3_report_held_sheet, only : draws, is_holder, measure_holder
  use dd3_report_tool_view, only : are_parallel, flat, meet, near, new_path, new_place, new_view, &
      nodes_of_column, path_t, view_t
  implicit none
  private
  public :: measure_closing

  !> Least n.d of the normal of the punch and its path at which a sheet on a pad is pinched, and of
  !> a level face.
  real(wp), parameter :: level = 0.87_wp

contains

  !> Measure how far the sheet is formed at the end of the running phase. All ranks measure the
  !> whole sheet.
  subroutine measure_closing(model, state, closing)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Its pins are left as they are.
    type(closing_t), intent(inout) :: closing

    type(path_t) :: path
    type(punch_t) :: punch
    type(held_t) :: held
    logical :: acts(model%n_tool)
    integer :: t

    closing%punch = [punch_t ::]
    closing%holder = [held_t ::]
    if (model%n_tool == 0 .or. .not. allocated(model%column)) return
    if (any([(model%turns(t), t=1, model%n_tool)])) return
    associate (phase => model%phase(state%phase))
      acts = phase%active .and. .not. phase%withdrawn
      if (.not. any(acts .and. state%tools%touches)) return
      do t = 1, model%n_tool
        if (.not. acts(t)) cycle
        if (norm2(path_of(model, state, t)) <= 0.0_wp) cycle
        call new_path(path, model, state, path_of(model, state, t), acts)
        if (ends_path(model, state, t)) then
          call measure_punch(punch, model, state, path, t)
          closing%punch = [closing%punch, punch]
        else if (is_holder(model, state, path, t)) then
          call measure_holder(held, model, state, path, t)
          closing%holder = [closing%holder, held]
        end if
      end do
    end associate
  end subroutine measure_closing

  !> Return the direction of the path of a tool, or of the first one that moves if it rests; zero if
  !> none moves.
  pure function path_of(model, state, tool) result(direction)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    real(wp) :: direction(3)

    integer :: t

    associate (phase => model%phase(state%phase))
      direction = phase%direction(:, tool)
      do t = 1, model%n_tool
        if (norm2(direction) > 0.0_wp) return
        if (phase%active(t) .and. .not. phase%withdrawn(t)) direction = phase%direction(:, t)
      end do
    end associate
  end function path_of

  !> Whether a tool has moved against the sheet in the running phase and does not go on.
  pure logical function ends_path(model, state, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    associate (direction => model%phase(state%phase)%direction(:, tool))
      ends_path = draws(model, state%phase, tool) .and. &
          dot_product(state%tools%force(:, tool), direction) < 0.0_wp
      if (.not. ends_path .or. state%phase == size(model%phase)) return
      if (draws(model, state%phase + 1, tool)) ends_path = &
          dot_product(model%phase(state%phase + 1)%direction(:, tool), direction) <= 0.0_wp
    end associate
  end function ends_path

  !> Measure the sheet under a punch.
  subroutine measure_punch(self, model, state, path, tool)
    type(punch_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: tool

    integer :: node, n(2)

    self%tool = tool
    do node = 1, model%n_node
      n = nodes_of_column(model, path, node, tool)
      if (n(1) > 0) call measure_column(self, model, state, path, n)
    end do
  end subroutine measure_punch

  !> Measure a column between a punch and the tools across.
  subroutine measure_column(self, model, state, path, node)
    type(punch_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    !> On the face of the punch, and across.
    integer, intent(in) :: node(2)

    type(view_t) :: view(2)
    type(place_t) :: off
    integer :: other, t

    view(1) = new_view(model, state, path, node(1))
    if (view(1)%gap(self%tool) >= huge(1.0_wp)) return
    if (view(1)%gap(self%tool) <= near*model%thickness_at(node(1)) .and. &
        view(1)%slope(self%tool) >= level) call measure_slide(self, model, state, path, node(1))
    view(2) = new_view(model, state, path, node(2))
    view(2)%gap(self%tool) = huge(1.0_wp)
    other = minloc(view(2)%gap, dim=1)
    off = new_place(state, node(2), view(2)%gap(other), other)
    t = minloc(view(1)%gap, dim=1)
    if (view(1)%gap(t) <= off%distance) off = new_place(state, node(1), view(1)%gap(t), t)
    if (min(view(1)%slope(self%tool), &
        abs(dot_product(path%normal(:, node(2)), path%direction))) >= flat) then
      call measure_floor(self, model, state, path, node, view, off)
    else if (are_parallel(view(1)%normal(:, self%tool), view(2)%normal(:, other))) then
      if (off%distance <= self%wall%distance .and. self%wall%node > 0) return
      self%wall = off
      self%wall_space = view(1)%gap(self%tool) + view(2)%gap(other)
    end if
  end subroutine measure_column

  !> Measure the displacement across the path, in this job, of a node on a level face of the punch.
  pure subroutine measure_slide(self, model, state, path, node)
    type(punch_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: node

    real(wp) :: vector(3)

    if (allocated(model%x_start)) then
      vector = state%x(:, node) - model%x_start(:, node)
    else
      vector = state%x(:, node) - model%x0(:, node)
    end if
    vector = vector - dot_product(vector, path%direction)*path%direction
    if (self%slide%node > 0 .and. norm2(vector) >= self%slide%distance) return
    self%slide = new_place(state, node, norm2(vector), self%tool)
    self%slide_vector = vector
  end subroutine measure_slide

  !> Measure a column that lies across the path of a punch.
  subroutine measure_floor(self, model, state, path, node, view, off)
    type(punch_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    !> On the face of the punch, and across, and the tools that they face.
    integer, intent(in) :: node(2)
    type(view_t), intent(in) :: view(2)
    !> Distance from the nearer tool.
    type(place_t), intent(in) :: off

    real(wp) :: left, thinned, above, below, normal(3, 2)
    integer :: t

    call meet(model, state, view(1), node(1), self%tool, -path%direction, above, normal(:, 1))
    if (above >= huge(1.0_wp)) return
    thinned = min(0.0_wp, norm2(state%x(:, node(1)) - state%x(:, node(2))) &
        - model%thickness_at(node(1)))/abs(dot_product(path%normal(:, node(2)), path%direction))
    do t = 1, model%n_tool
      ! A tool that has not met the sheet, such as an ejector below, forms nothing.
      if (t == self%tool .or. .not. (path%acts(t) .and. state%tools%touches(t))) cycle
      if (.not. model%member(t, node(2))) cycle
      call meet(model, state, view(2), node(2), t, path%direction, below, normal(:, 2))
      if (below >= huge(1.0_wp) .or. .not. are_parallel(normal(:, 1), normal(:, 2))) cycle
      if (off%distance > self%floor%distance .or. self%floor%node == 0) self%floor = off
      if (model%phase(state%phase)%pressed(t)) cycle
      if (abs(dot_product(normal(:, 1), path%direction)) < level .and. &
          has_pad(model, state, path, self%tool)) cycle
      left = above + below + thinned
      left = merge(left, 0.0_wp, left > 0.0_wp)
      if (self%bottom%node > 0 .and. left >= self%bottom%distance) cycle
      self%bottom = new_place(state, node(1), left, t)
    end do
  end subroutine measure_floor

  !> Whether a pressed tool within the punch, in plan, holds the sheet against it. It yields: only
  !> radii and walls are left between the punch and a die beside it, which do not end its path.
  pure logical function has_pad(model, state, path, punch)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: punch

    integer :: t

    has_pad = .false.
    do t = 1, model%n_tool
      if (.not. (model%phase(state%phase)%pressed(t) .and. state%tools%touches(t))) cycle
      has_pad = has_pad .or. all(path%lower(:, t) > path%lower(:, punch) - model%thickness .and. &
          path%upper(:, t) < path%upper(:, punch) + model%thickness)
    end do
  end function has_pad

end module dd3_report_closing
