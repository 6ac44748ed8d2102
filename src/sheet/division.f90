! SPDX-License-Identifier: GPL-3.0-or-later
!> Division of quadrilaterals of a sheet into four: columns in the middle of their edges and at
!> their centres, and which of all columns are bound afterwards.
module dd3_sheet_division
  use dd3_mesh_mesh, only : mesh_t
  use dd3_sheet_grid, only : edge_between, grid_t
  implicit none
  private
  public :: division_t, new_division

  !> A division of some quadrilaterals. The numbers of the new columns follow those of the old ones.
  type :: division_t
    integer :: n_column = 0
    !> Whether each quadrilateral is divided, `(n_quad)`.
    logical, allocatable :: divided(:)
    !> Columns between which each column is new: the ends of an edge, or the corners of a
    !> quadrilateral, and then 0; 0 for an old column, `(4, n_column)`.
    integer, allocatable :: parent(:, :)
    !> Column in the middle of each edge of the old quadrilaterals, from corner i to corner i + 1, 0
    !> for none, `(4, n_quad)`; column at the centre, 0 for one that is not divided, `(n_quad)`.
    integer, allocatable :: middle(:, :), centre(:)
    !> Ends of the edge to which each column is bound, 0 if it is not, `(2, n_column)`.
    integer, allocatable :: bound_to(:, :)
  contains
    procedure :: corners
  end type division_t

contains

  !> Divide quadrilaterals whose marks are balanced.
  pure subroutine new_division(self, mesh, grid, divided)
    type(division_t), intent(out) :: self
    type(mesh_t), intent(in) :: mesh
    !> Grid of the mesh.
    type(grid_t), intent(in) :: grid
    !> `(n_quad)`.
    logical, intent(in) :: divided(:)

    integer :: i, most, q

    self%divided = divided
    self%n_column = grid%n_column
    most = grid%n_column + 5*count(divided)
    allocate (self%parent(4, most), self%bound_to(2, most), source=0)
    allocate (self%middle(4, grid%n_quad), self%centre(grid%n_quad), source=0)
    if (allocated(mesh%bound)) call find_bound(self, mesh, grid)
    do q = 1, grid%n_quad
      if (.not. divided(q)) cycle
      do i = 1, 4
        if (self%middle(i, q) == 0) call divide_edge(self, grid, q, i)
      end do
      self%n_column = self%n_column + 1
      self%centre(q) = self%n_column
      self%parent(:, self%n_column) = grid%corner(:, q)
    end do
    ! Only now, as halves of edges are known by the columns that were bound to them.
    do q = 1, grid%n_quad
      if (.not. divided(q)) cycle
      do i = 1, 4
        if (self%middle(i, q) <= grid%n_column) self%bound_to(:, self%middle(i, q)) = 0
      end do
    end do
    self%parent = self%parent(:, :self%n_column)
    self%bound_to = self%bound_to(:, :self%n_column)
  end subroutine new_division

  !> Find the columns that are bound before the division.
  pure subroutine find_bound(self, mesh, grid)
    type(division_t), intent(inout) :: self
    type(mesh_t), intent(in) :: mesh
    type(grid_t), intent(in) :: grid

    integer :: bottom(mesh%n_node), c, i, k, n, q

    bottom = 0
    bottom(grid%node(0, :)) = [(c, c=1, grid%n_column)]
    do n = 1, size(mesh%bound, 2)
      c = bottom(mesh%bound(1, n))
      if (c == 0) cycle
      associate (ends => bottom(mesh%bound(2:, n)))
        self%bound_to(:, c) = ends
        do k = grid%first(ends(1)), grid%first(ends(1) + 1) - 1
          q = grid%quad_at(k)
          i = edge_between(grid%corner(:, q), ends)
          if (i > 0) self%middle(i, q) = c
        end do
      end associate
    end do
  end subroutine find_bound

  !> Make the column in the middle of an edge, for both quadrilaterals there. It is bound if an
  !> undivided one has the edge: the neighbour, or what the larger neighbour, which the balance has
  !> marked, is divided into.
  pure subroutine divide_edge(self, grid, quad, edge)
    type(division_t), intent(inout) :: self
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: quad, edge

    integer :: ends(2), c, i, other

    ends = grid%corner([edge, mod(edge, 4) + 1], quad)
    c = self%n_column + 1
    self%n_column = c
    self%parent(:2, c) = ends
    self%middle(edge, quad) = c
    other = grid%neighbour(edge, quad)
    if (other > 0) then
      i = edge_between(grid%corner(:, other), ends)
      self%middle(i, other) = c
      if (.not. self%divided(other)) self%bound_to(:, c) = ends
    else if (is_half(ends(1), ends(2)) .or. is_half(ends(2), ends(1))) then
      self%bound_to(:, c) = ends
    end if

  contains

    !> Whether an edge is half of one to which its first end was bound before the division.
    pure logical function is_half(from, to)
      integer, intent(in) :: from, to

      is_half = any(self%bound_to(:, from) == to)
    end function is_half

  end subroutine divide_edge

  !> Return the corners of a quarter of a divided quadrilateral. The quarter has the corner of its
  !> own number in common with the whole, and natural axes along those of the whole.
  pure function corners(self, grid, quad, quadrant)
    class(division_t), intent(in) :: self
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: quad, quadrant
    integer :: corners(4)

    integer :: next, before

    next = mod(quadrant, 4) + 1
    before = mod(quadrant + 2, 4) + 1
    corners(quadrant) = grid%corner(quadrant, quad)
    corners(next) = self%middle(quadrant, quad)
    corners(before) = self%middle(before, quad)
    corners(10 - quadrant - next - before) = self%centre(quad)
  end function corners

end module dd3_sheet_division
