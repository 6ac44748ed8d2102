! SPDX-License-Identifier: GPL-3.0-or-later
!> Tools as the sheet sees them: which of them a node faces, at which gap, and how far they are
!> along the path of a tool.
!>
!> Distances along a path are found by sphere tracing: J. C. Hart, The Visual Computer 12 (1996)
!> 527-545.
module dd3_report_tool_view
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_contact_data, only : side_faces
  use dd3_model_contact_layer, only : deflection_at
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : nodal_normals
  use dd3_model_state, only : state_t
  use dd3_model_tolerances, only : wrong_side_depth
  use dd3_output_closing, only : place_t
  use dd3_tools_closest, only : hint_t, hit_t
  use dd3_tools_placement, only : placement_t
  use dd3_tools_tool, only : find_on_tool
  implicit none
  private
  public :: path_t, view_t
  public :: across, are_parallel, meet, new_path, new_place, new_view, nodes_of_column
  public :: depth, flat, near

  !> Least -m.n of the normals of sheet and tool that face each other, and of two tools that form it
  !> between them; least |n.d| of a floor for the direction d of a path.
  real(wp), parameter :: facing = 0.7_wp, parallel = 0.97_wp, flat = 0.5_wp
  !> Gap up to which a surface that faces the sheet counts as plane, depth inside a tool, and length
  !> that counts as zero on a path, in thicknesses.
  real(wp), parameter :: near = 0.5_wp, depth = 0.1_wp, met = 1.0e-4_wp
  !> Largest number of steps along a path.
  integer, parameter :: most_steps = 40

  !> What the tools are from a node of the sheet: gap, huge for a tool that does not face it, and
  !> |n.d| there, `(n_tool)`, and the normal n, `(3, n_tool)`.
  type :: view_t
    real(wp), allocatable :: gap(:), slope(:), normal(:, :)
  end type view_t

  !> Measure along a path.
  type :: path_t
    !> Unit vector of the motion.
    real(wp) :: direction(3) = 0.0_wp
    !> Tools with contact that are not withdrawn, `(n_tool)`.
    logical, allocatable :: acts(:)
    !> Outward normals of the sheet, `(3, n_node)`.
    real(wp), allocatable :: normal(:, :)
    !> Bounds of the tools across the path, `(2, n_tool)`, mm.
    real(wp), allocatable :: lower(:, :), upper(:, :)
  end type path_t

contains

  !> Make a path.
  subroutine new_path(self, model, state, direction, acts)
    type(path_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    real(wp), intent(in) :: direction(3)
    logical, intent(in) :: acts(:)

    self%direction = direction
    self%acts = acts
    self%normal = nodal_normals(model, state%x, side_faces)
    call set_bounds(self, model, state)
  end subroutine new_path

  !> Set the bounds of the tools across the path.
  pure subroutine set_bounds(self, model, state)
    type(path_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    type(placement_t) :: placement
    real(wp) :: corner(3), at(2)
    integer :: t, i

    if (allocated(self%lower)) deallocate (self%lower, self%upper)
    allocate (self%lower(2, model%n_tool), source=huge(1.0_wp))
    allocate (self%upper(2, model%n_tool), source=-huge(1.0_wp))
    do t = 1, model%n_tool
      placement = state%placement(t)
      associate (surface => model%tool(t)%surface)
        do i = 0, 7
          corner = merge(surface%lower, surface%upper, [btest(i, 0), btest(i, 1), btest(i, 2)])
          at = across(self, placement%vector_to_global(corner) + placement%translation)
          self%lower(:, t) = min(self%lower(:, t), at)
          self%upper(:, t) = max(self%upper(:, t), at)
        end do
      end associate
    end do
  end subroutine set_bounds

  !> Return the coordinates of a point across the path, mm.
  pure function across(self, x) result(at)
    type(path_t), intent(in) :: self
    real(wp), intent(in) :: x(3)
    real(wp) :: at(2)

    real(wp) :: first(3)

    first = cshift([1.0_wp, 0.0_wp, 0.0_wp], -mod(maxloc(abs(self%direction), dim=1), 3))
    first = first - dot_product(first, self%direction)*self%direction
    first = first/norm2(first)
    at = [dot_product(first, x), dot_product(cross(self%direction, first), x)]
  end function across

  !> Return the tools that a node of the sheet faces.
  pure type(view_t) function new_view(model, state, path, node) result(self)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(path_t), intent(in) :: path
    integer, intent(in) :: node

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: inside
    integer :: t

    inside = depth*model%thickness_at(node)
    if (model%candidate_of(node) > 0) inside = inside &
        + deflection_at(model, state, model%candidate_of(node))
    allocate (self%gap(model%n_tool), source=huge(1.0_wp))
    allocate (self%slope(model%n_tool), self%normal(3, model%n_tool), source=0.0_wp)
    do t = 1, model%n_tool
      if (.not. (path%acts(t) .and. model%member(t, node))) cycle
      hint = hint_t()
      call find_on_tool(model%tool(t), state%placement(t), state%x(:, node), hint, &
          model%tolerance%tool_search, inside, hit, path%normal(:, node))
      if (.not. hit%found) cycle
      if (dot_product(hit%normal, path%normal(:, node)) > -facing) cycle
      self%gap(t) = merge(hit%distance, 0.0_wp, hit%distance > 0.0_wp)
      self%normal(:, t) = hit%normal
      self%slope(t) = abs(dot_product(hit%normal, path%direction))
    end do
  end function new_view

  !> Whether the normals of two tools are opposite, which form the sheet between them.
  pure logical function are_parallel(first, second)
    real(wp), intent(in) :: first(3), second(3)

    are_parallel = -dot_product(first, second) >= parallel
  end function are_parallel

  !> Find where a line from a node meets the front of a tool.
  pure subroutine meet(model, state, view, node, tool, direction, length, normal)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(view_t), intent(in) :: view
    integer, intent(in) :: node, tool
    !> Unit vector.
    real(wp), intent(in) :: direction(3)
    !> mm; huge if it does not meet it.
    real(wp), intent(out) :: length
    !> Of the tool there.
    real(wp), intent(out) :: normal(3)

    type(hint_t) :: hint
    type(hit_t) :: hit
    integer :: i

    associate (t => model%thickness_at(node))
      normal = view%normal(:, tool)
      if (view%gap(tool) <= near*t .and. view%slope(tool) >= flat) then
        length = view%gap(tool)/view%slope(tool)
        return
      end if
      length = 0.0_wp
      do i = 1, most_steps
        hint = hint_t()
        call find_on_tool(model%tool(tool), state%placement(tool), &
            state%x(:, node) + length*direction, hint, model%tolerance%tool_search, &
            wrong_side_depth*t, hit)
        if (.not. hit%found .or. hit%distance < -depth*t) exit
        normal = hit%normal
        if (hit%distance <= met*t .and. dot_product(normal, direction) < -flat) return
        length = length + max(hit%distance, met*t)
      end do
      length = huge(1.0_wp)
    end associate
  end subroutine meet

  !> Return the node of a column on the face that a tool moves against, and that on the other one;
  !> 0 if the node given is not its top, or the tool has no candidate in it.
  pure function nodes_of_column(model, path, top, tool) result(node)
    type(model_t), intent(in) :: model
    type(path_t), intent(in) :: path
    integer, intent(in) :: top, tool
    integer :: node(2)

    node = [top, model%column(1, top)]
    if (model%column(2, top) /= top .or. node(1) == node(2)) node = 0
    if (node(1) == 0) return
    if (.not. any(model%member(tool, node))) then
      node = 0
    else if (all(model%member(tool, node))) then
      if (dot_product(path%normal(:, node(2)) - path%normal(:, node(1)), &
          path%direction) < 0.0_wp) then
        node = node([2, 1])
      end if
    else if (model%member(tool, node(2))) then
      node = node([2, 1])
    end if
  end function nodes_of_column

  !> Make a place.
  pure type(place_t) function new_place(state, node, distance, tool) result(self)
    type(state_t), intent(in) :: state
    integer, intent(in) :: node, tool
    real(wp), intent(in) :: distance

    self = place_t(distance, node, state%x(:, node), tool)
  end function new_place

end module dd3_report_tool_view
