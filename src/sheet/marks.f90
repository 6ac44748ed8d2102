! SPDX-License-Identifier: GPL-3.0-or-later
!> Marks of the quadrilaterals of a sheet that are to be divided. After the division, those with a
!> column in common differ by one level at most, so that no node at the end of an edge with a bound
!> node is bound itself.
!>
!> Before the division, quadrilaterals on both sides of a bound column have one end of its edge in
!> common: neighbours are found by common columns alone.
module dd3_sheet_marks
  use dd3_mesh_mesh, only : mesh_t
  use dd3_sheet_grid, only : grid_t
  implicit none
  private
  public :: balance, find_levels, mark_balanced, marked_quads, quad_levels

contains

  !> Complete the marks of elements that are asked to be divided: all of a quadrilateral, and what
  !> the balance of the levels needs. Those of the highest level lose their marks.
  pure subroutine mark_balanced(mesh, grid, most_level, marked)
    type(mesh_t), intent(in) :: mesh
    !> Grid of the mesh.
    type(grid_t), intent(in) :: grid
    !> Highest level.
    integer, intent(in) :: most_level
    !> A mark on any element of a quadrilateral counts, `(n_element)`.
    logical, intent(inout) :: marked(:)

    logical :: quad(grid%n_quad)
    integer :: level(grid%n_quad), q

    level = quad_levels(mesh, grid)
    quad = marked_quads(grid, marked) .and. level < most_level
    call balance(grid, level, quad)
    do q = 1, grid%n_quad
      marked(grid%element(:, q)) = quad(q)
    end do
  end subroutine mark_balanced

  !> Return the levels of the quadrilaterals.
  pure function quad_levels(mesh, grid) result(level)
    type(mesh_t), intent(in) :: mesh
    type(grid_t), intent(in) :: grid
    integer :: level(grid%n_quad)

    level = 0
    if (allocated(mesh%level)) level = mesh%level(grid%element(1, :))
  end function quad_levels

  !> Find the levels of a mesh with bound nodes whose levels are not known: across a bound column
  !> they differ by one, across other edges they are the same; the lowest one is 0. They stay
  !> unknown where the mesh was not made by divisions.
  pure subroutine find_levels(mesh, grid)
    type(mesh_t), intent(inout) :: mesh
    !> Grid of the mesh.
    type(grid_t), intent(in) :: grid

    integer, parameter :: unknown = -huge(1)
    integer :: level(grid%n_quad), waiting(grid%n_quad), across(3), change, first, i, k, n, q

    level = unknown
    do first = 1, grid%n_quad
      if (level(first) /= unknown) cycle
      level(first) = 0
      waiting(1) = first
      n = 1
      do while (n > 0)
        q = waiting(n)
        n = n - 1
        do i = 1, 4
          across = [grid%neighbour(i, q), grid%over_bound(:, i, q)]
          change = 0
          ! The larger one has two across the edge.
          if (across(2) > 0) change = merge(1, -1, across(3) > 0)
          do k = 1, 3
            if (across(k) == 0) cycle
            if (level(across(k)) == unknown) then
              level(across(k)) = level(q) + change
              n = n + 1
              waiting(n) = across(k)
            else if (level(across(k)) /= level(q) + change) then
              return
            end if
          end do
        end do
      end do
    end do
    level = level - minval(level)
    allocate (mesh%level(mesh%n_element))
    do q = 1, grid%n_quad
      mesh%level(grid%element(:, q)) = level(q)
    end do
  end subroutine find_levels

  !> Return whether any element of each quadrilateral is marked.
  pure function marked_quads(grid, marked) result(quad)
    type(grid_t), intent(in) :: grid
    !> `(n_element)`.
    logical, intent(in) :: marked(:)
    logical :: quad(grid%n_quad)

    integer :: q

    do q = 1, grid%n_quad
      quad(q) = any(marked(grid%element(:, q)))
    end do
  end function marked_quads

  !> Mark the neighbours of a lower level, and theirs in turn.
  pure subroutine balance(grid, level, marked)
    type(grid_t), intent(in) :: grid
    !> `(n_quad)`.
    integer, intent(in) :: level(:)
    logical, intent(inout) :: marked(:)

    integer :: waiting(grid%n_quad), i, k, n, q

    n = count(marked)
    waiting(:n) = pack([(q, q=1, grid%n_quad)], marked)
    do while (n > 0)
      q = waiting(n)
      n = n - 1
      do i = 1, 4
        associate (c => grid%corner(i, q))
          do k = grid%first(c), grid%first(c + 1) - 1
            associate (other => grid%quad_at(k))
              if (marked(other) .or. level(other) >= level(q)) cycle
              marked(other) = .true.
              n = n + 1
              waiting(n) = other
            end associate
          end do
        end associate
      end do
    end do
  end subroutine balance

end module dd3_sheet_marks
