! SPDX-License-Identifier: GPL-3.0-or-later
!> Levels of a divided sheet near a cut. The layer of new quadrilaterals and the columns that move
!> need a grid without bound columns: near the cut all quadrilaterals get the highest level there.
module dd3_sheet_cut_levels
  use dd3_element_table, only : element_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_marks, only : quad_levels
  use dd3_sheet_refine, only : refine_sheet
  use dd3_sheet_refinement, only : refinement_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: divide_near_cut

contains

  !> Divide the quadrilaterals near a cut that have not the highest level there.
  pure subroutine divide_near_cut(sheet, grid, element, stays, n_ring, divided)
    type(sheet_t), intent(inout) :: sheet
    !> Grid of its mesh.
    type(grid_t), intent(in) :: grid
    type(element_t), intent(in) :: element
    !> Whether each column stays, `(n_column)`.
    logical, intent(in) :: stays(:)
    !> Rings of quadrilaterals that are near, beside those that the cut crosses.
    integer, intent(in) :: n_ring
    !> Whether any had to be divided: the sheet has another grid now.
    logical, intent(out) :: divided

    type(sheet_t) :: refined
    type(refinement_t) :: origin
    logical :: marked(sheet%mesh%n_element), uneven(grid%n_quad)
    integer :: q

    divided = .false.
    if (.not. allocated(sheet%mesh%level)) return
    call find_uneven(sheet%mesh, grid, stays, n_ring, uneven)
    divided = any(uneven)
    if (.not. divided) return
    do q = 1, grid%n_quad
      marked(grid%element(:, q)) = uneven(q)
    end do
    call refine_sheet(sheet, grid, element, marked, refined, origin)
    sheet = refined
  end subroutine divide_near_cut

  !> Find the quadrilaterals near the cut of a lower level than others there.
  pure subroutine find_uneven(mesh, grid, stays, n_ring, uneven)
    type(mesh_t), intent(in) :: mesh
    type(grid_t), intent(in) :: grid
    logical, intent(in) :: stays(:)
    integer, intent(in) :: n_ring
    logical, intent(out) :: uneven(:)

    logical :: near(grid%n_quad), column(grid%n_column)
    integer :: level(grid%n_quad), q, ring

    do q = 1, grid%n_quad
      near(q) = any(stays(grid%corner(:, q))) .and. .not. all(stays(grid%corner(:, q)))
    end do
    do ring = 1, n_ring
      column = .false.
      do q = 1, grid%n_quad
        if (near(q)) column(grid%corner(:, q)) = .true.
      end do
      do q = 1, grid%n_quad
        near(q) = any(column(grid%corner(:, q)))
      end do
    end do
    level = quad_levels(mesh, grid)
    uneven = near .and. level < maxval(level, mask=near)
  end subroutine find_uneven

end module dd3_sheet_cut_levels
