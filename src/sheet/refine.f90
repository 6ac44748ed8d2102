! SPDX-License-Identifier: GPL-3.0-or-later
!> Refinement of a sheet: quadrilaterals are divided into four, through all layers. New columns of
!> nodes lie on the surface curved by the directions of the columns (dd3_sheet_surface_point), in
!> each layer, then as well as now, so that a flat blank stays flat and a bent sheet keeps its
!> shape; those of elements without enhanced strains, whose edges stay straight, lie in the middle.
!> On the border they lie on its smooth curve in the initial sheet (dd3_sheet_border), and where the
!> deformation of their element takes them from there: a round rim stays round.
module dd3_sheet_refine
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_sheet_border, only : border_t, bulge, new_border
  use dd3_sheet_division, only : division_t, new_division
  use dd3_sheet_divided_mesh, only : new_divided_mesh
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_marks, only : balance, marked_quads, quad_levels
  use dd3_sheet_refinement, only : find_sources, refinement_t
  use dd3_sheet_sheet, only : sheet_t
  use dd3_sheet_surface_point, only : edge_point, face_point, surface_point_t
  implicit none
  private
  public :: refine_sheet

contains

  !> Divide the marked quadrilaterals of a sheet of elements with eight nodes, and those that the
  !> balance of the levels needs beside them.
  pure subroutine refine_sheet(sheet, grid, element, marked, refined, origin)
    type(sheet_t), intent(in) :: sheet
    !> Grid of its mesh.
    type(grid_t), intent(in) :: grid
    type(element_t), intent(in) :: element
    !> A mark on any element of a quadrilateral counts, `(n_element)`.
    logical, intent(in) :: marked(:)
    type(sheet_t), intent(out) :: refined
    type(refinement_t), intent(out) :: origin

    type(division_t) :: division
    logical :: divided(grid%n_quad)
    integer, allocatable :: node(:, :)
    real(wp), allocatable :: x(:, :)
    integer :: k

    divided = marked_quads(grid, marked)
    call balance(grid, quad_levels(sheet%mesh, grid), divided)
    call new_division(division, sheet%mesh, grid, divided)
    call new_divided_mesh(sheet%mesh, grid, division, refined%mesh, node, origin)
    call find_sources(origin, grid, sheet%mesh, element, divided)
    refined%element = sheet%element
    refined%thickness_points = sheet%thickness_points
    refined%material = sheet%material
    refined%digest = sheet%digest
    refined%has_state = sheet%has_state
    refined%report = sheet%report
    refined%warnings = sheet%warnings
    if (element%n_enhanced > 0) then
      call place_nodes(sheet%mesh%x, node, division, refined%mesh%x)
      call place_nodes(sheet%x, node, division, refined%x)
    else
      refined%mesh%x = origin%interpolate_nodal(sheet%mesh%x)
      refined%x = origin%interpolate_nodal(sheet%x)
    end if
    if (allocated(sheet%earlier)) then
      allocate (refined%earlier(3, size(refined%x, 2), size(sheet%earlier, 3)))
      do k = 1, size(sheet%earlier, 3)
        if (element%n_enhanced > 0) then
          call place_nodes(sheet%earlier(:, :, k), node, division, x)
        else
          x = origin%interpolate_nodal(sheet%earlier(:, :, k))
        end if
        refined%earlier(:, :, k) = x
      end do
    end if
    call round_border(sheet, grid, node, division, refined)
    if (.not. sheet%has_state) return
    call origin%carry_points(sheet%stress, refined%stress)
    call origin%carry_points(sheet%internal_variables, refined%internal_variables)
    call origin%carry_axes(sheet%orientation, refined%orientation)
  end subroutine refine_sheet

  !> Move the new columns of the border onto its smooth curve.
  pure subroutine round_border(sheet, grid, node, division, refined)
    !> Before the division.
    type(sheet_t), intent(in) :: sheet
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: node(0:, :)
    type(division_t), intent(in) :: division
    type(sheet_t), intent(inout) :: refined

    type(border_t) :: border
    real(wp) :: initial(3, 2), part(2)
    integer :: column(4), i, j, k, q

    call new_border(border, grid)
    do q = 1, grid%n_quad
      if (.not. division%divided(q)) cycle
      do i = 1, 4
        if (.not. border%edge(i, q)) cycle
        associate (corner => cshift(grid%corner(:, q), i - 1))
          column = [border%beside(1, corner(1)), corner(:2), border%beside(2, corner(2))]
          do k = 0, ubound(node, 1)
            initial = edge_and_width(sheet%mesh%x(:, node(k, corner)))
            part = parts_along(bulge(sheet%mesh%x(:, node(k, merge(column, corner(1), &
                column > 0))), column([1, 4]) > 0), initial)
            associate (new => node(k, division%middle(i, q)))
              refined%mesh%x(:, new) = refined%mesh%x(:, new) + matmul(initial, part)
              refined%x(:, new) = refined%x(:, new) &
                  + matmul(edge_and_width(sheet%x(:, node(k, corner))), part)
              if (.not. allocated(sheet%earlier)) cycle
              do j = 1, size(sheet%earlier, 3)
                refined%earlier(:, new, j) = refined%earlier(:, new, j) &
                    + matmul(edge_and_width(sheet%earlier(:, node(k, corner), j)), part)
              end do
            end associate
          end do
        end associate
      end do
    end do
  end subroutine round_border

  !> Return the first edge of a quadrilateral, and the vector from its middle to that of the edge
  !> across.
  pure function edge_and_width(x) result(vector)
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: vector(3, 2)

    vector(:, 1) = x(:, 2) - x(:, 1)
    vector(:, 2) = 0.5_wp*(x(:, 3) + x(:, 4) - x(:, 1) - x(:, 2))
  end function edge_and_width

  !> Return the parts of a vector along two others, in their plane.
  pure function parts_along(vector, base) result(part)
    real(wp), intent(in) :: vector(3), base(3, 2)
    real(wp) :: part(2)

    real(wp) :: metric(2, 2), right(2)

    metric = matmul(transpose(base), base)
    right = matmul(vector, base)
    part(1) = metric(2, 2)*right(1) - metric(1, 2)*right(2)
    part(2) = metric(1, 1)*right(2) - metric(1, 2)*right(1)
    part = part/(metric(1, 1)*metric(2, 2) - metric(1, 2)**2)
  end function parts_along

  !> Set the positions of the nodes.
  pure subroutine place_nodes(x, node, division, new)
    !> Positions of the old nodes, `(3, n)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node(0:, :)
    type(division_t), intent(in) :: division
    !> Positions of all nodes, `(3, n)`, mm.
    real(wp), allocatable, intent(out) :: new(:, :)

    type(surface_point_t) :: middle, centre
    integer :: c, k

    middle = edge_point([1, 2], [3, 4], 0.5_wp)
    centre = face_point([1, 2, 3, 4], [5, 6, 7, 8], 0.5_wp, 0.5_wp)
    allocate (new(3, max(size(x, 2), maxval(node))))
    new(:, :size(x, 2)) = x
    do c = 1, division%n_column
      if (division%parent(1, c) == 0) cycle
      do k = 0, ubound(node, 1)
        if (division%parent(3, c) == 0) then
          new(:, node(k, c)) = middle%position(surface(division%parent(:2, c), k))
        else
          new(:, node(k, c)) = centre%position(surface(division%parent(:, c), k))
        end if
      end do
    end do

  contains

    !> Return the nodes of columns at a height, then points beside them along the columns.
    pure function surface(column, height)
      integer, intent(in) :: column(:), height
      real(wp) :: surface(3, 2*size(column))

      surface(:, :size(column)) = x(:, node(height, column))
      surface(:, size(column) + 1:) = surface(:, :size(column)) &
          - (x(:, node(ubound(node, 1), column)) - x(:, node(0, column)))
    end function surface

  end subroutine place_nodes

end module dd3_sheet_refine
