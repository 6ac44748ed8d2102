! SPDX-License-Identifier: GPL-3.0-or-later
!> Path along which a tool is withdrawn from the sheet: its line of motion, or that of another tool
!> where it has none, or an axis, away from the faces of the sheet that it may touch.
module dd3_setup_withdrawal
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : outward_normals
  implicit none
  private
  public :: withdrawal

  !> Smallest cosine between a line of motion and the mean normal of the faces along which a tool is
  !> withdrawn: along a line in the plane of the sheet it would not leave it.
  real(wp), parameter :: least_cosine = 0.2_wp
  !> Length of the mean of unit normals below which the faces have no side.
  real(wp), parameter :: no_side = 0.05_wp

contains

  !> Return the displacement that withdraws a tool, mm: the largest extent of the sheet, farther
  !> than it can spring.
  function withdrawal(model, tool, line) result(path)
    !> With its tools and candidates, all on this rank.
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    !> Unit vectors along the lines of motion of the tools until now, `(3, n_tool)`; zero for one
    !> that has not moved.
    real(wp), intent(in) :: line(:, :)
    real(wp) :: path(3)

    real(wp) :: x(3, model%n_node), side(3), direction(3)

    x = model%start_positions()
    side = side_of(model, tool, x)
    direction = line_towards(side, line, tool)
    path = sign(maxval(maxval(x, dim=2) - minval(x, dim=2)), dot_product(direction, side))*direction
  end function withdrawal

  !> Return the side of the sheet on which a tool lies, a unit vector: the mean outward normal of
  !> the faces that it may touch or, where these point to all sides, the direction from the middle
  !> of the sheet to that of the tool.
  function side_of(model, tool, x) result(side)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: side(3)

    side = sum(outward_normals(model, x, model%touched_faces(tool)), dim=2, &
        mask=spread(model%candidate(tool, :), 1, 3)) &
        /real(max(1, count(model%candidate(tool, :))), wp)
    associate (surface => model%tool(tool)%surface)
      if (norm2(side) < no_side) side = model%tool(tool)%position &
          + 0.5_wp*(surface%lower + surface%upper - minval(x, dim=2) - maxval(x, dim=2))
    end associate
    side = side/max(norm2(side), tiny(1.0_wp))
  end function side_of

  !> Return the line along which a tool leaves a side of the sheet: its own line of motion, else the
  !> first of another tool, else the axis nearest to the side.
  pure function line_towards(side, line, tool) result(direction)
    real(wp), intent(in) :: side(3)
    !> `(3, n_tool)`; zero for a tool without one.
    real(wp), intent(in) :: line(:, :)
    integer, intent(in) :: tool
    real(wp) :: direction(3)

    integer :: t

    direction = line(:, tool)
    if (abs(dot_product(direction, side)) >= least_cosine) return
    do t = 1, size(line, 2)
      direction = line(:, t)
      if (abs(dot_product(direction, side)) >= least_cosine) return
    end do
    direction = identity(:, maxloc(abs(side), dim=1))
  end function line_towards

end module dd3_setup_withdrawal
