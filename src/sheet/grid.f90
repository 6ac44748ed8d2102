! SPDX-License-Identifier: GPL-3.0-or-later
!> A sheet as a grid of quadrilaterals: its elements seen through the thickness. Nodes above one
!> another form a column, elements above one another a quadrilateral.
module dd3_sheet_grid
  use dd3_base_kinds, only : wp
  use dd3_mesh_mesh, only : mesh_t
  implicit none
  private
  public :: edge_between, grid_t, list_quads, new_grid

  !> Grid of a sheet.
  type :: grid_t
    integer :: n_layer = 0, n_column = 0, n_quad = 0
    !> Nodes of the columns from the bottom, `(0:n_layer, n_column)`.
    integer, allocatable :: node(:, :)
    !> Columns at the corners of the quadrilaterals, counter-clockwise seen from above, `(4,
    !> n_quad)`, and their elements from the bottom, `(n_layer, n_quad)`.
    integer, allocatable :: corner(:, :), element(:, :)
    !> Quadrilateral across the edge from corner i to corner i + 1, `(4, n_quad)`; 0 for none.
    integer, allocatable :: neighbour(:, :)
    !> Quadrilaterals across an edge with a bound column, `(2, 4, n_quad)`: the two smaller ones, or
    !> the larger one and 0; 0 for none.
    integer, allocatable :: over_bound(:, :, :)
    !> Quadrilaterals at column c: `quad_at(first(c):first(c + 1) - 1)`.
    integer, allocatable :: quad_at(:), first(:)
  end type grid_t

contains

  !> Find the grid of a mesh of elements with eight nodes.
  pure subroutine new_grid(self, mesh, regular)
    type(grid_t), intent(out) :: self
    type(mesh_t), intent(in) :: mesh
    !> Whether each column has the same number of layers.
    logical, intent(out) :: regular

    integer :: above(mesh%n_node), column_of(mesh%n_node), next(mesh%n_element)
    integer :: first_on(mesh%n_node), e, c, k, q
    logical :: has_below(mesh%n_node)

    above = 0
    has_below = .false.
    first_on = 0
    do e = 1, mesh%n_element
      associate (node => mesh%connectivity(:, e))
        above(node(:4)) = node(5:)
        has_below(node(5:)) = .true.
        next(e) = first_on(node(1))
        first_on(node(1)) = e
      end associate
    end do
    associate (bottom => pack([(k, k=1, mesh%n_node)], .not. has_below))
      self%n_column = size(bottom)
      self%n_layer = 0
      k = bottom(1)
      do while (above(k) > 0)
        k = above(k)
        self%n_layer = self%n_layer + 1
      end do
      allocate (self%node(0:self%n_layer, self%n_column), source=0)
      self%node(0, :) = bottom
    end associate
    regular = self%n_layer > 0
    do c = 1, merge(self%n_column, 0, regular)
      do k = 1, self%n_layer
        self%node(k, c) = above(self%node(k - 1, c))
        regular = regular .and. self%node(k, c) > 0
        if (.not. regular) return
      end do
      regular = regular .and. above(self%node(self%n_layer, c)) == 0
    end do
    if (.not. regular) return
    column_of = 0
    column_of(self%node(0, :)) = [(c, c=1, self%n_column)]
    self%n_quad = mesh%n_element/self%n_layer
    allocate (self%corner(4, self%n_quad), self%element(self%n_layer, self%n_quad))
    q = 0
    do e = 1, mesh%n_element
      if (has_below(mesh%connectivity(1, e))) cycle
      q = q + 1
      self%corner(:, q) = column_of(mesh%connectivity(:4, e))
      self%element(1, q) = e
      do k = 2, self%n_layer
        self%element(k, q) = element_on(mesh%connectivity(5:, self%element(k - 1, q)))
      end do
    end do
    call list_quads(self%corner, self%n_column, self%first, self%quad_at)
    call set_neighbours(self)
    allocate (self%over_bound(2, 4, self%n_quad), source=0)
    if (allocated(mesh%bound)) call set_over_bound(self, column_of, mesh%bound)

  contains

    !> Return the element whose lower nodes are given.
    pure integer function element_on(node)
      integer, intent(in) :: node(4)

      element_on = first_on(node(1))
      do while (any(mesh%connectivity(:4, element_on) /= node))
        element_on = next(element_on)
      end do
    end function element_on

  end subroutine new_grid

  !> List the quadrilaterals at each column: those at column c are `list(first(c):first(c + 1) -
  !> 1)`.
  pure subroutine list_quads(corner, n_column, first, list)
    !> `(4, n_quad)`.
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: n_column
    integer, allocatable, intent(out) :: first(:), list(:)

    integer :: filled(n_column), c, i, q

    allocate (first(n_column + 1), list(size(corner)))
    first = 0
    do q = 1, size(corner, 2)
      do i = 1, 4
        first(corner(i, q) + 1) = first(corner(i, q) + 1) + 1
      end do
    end do
    first(1) = 1
    do c = 1, n_column
      first(c + 1) = first(c) + first(c + 1)
    end do
    filled = first(:n_column)
    do q = 1, size(corner, 2)
      do i = 1, 4
        c = corner(i, q)
        list(filled(c)) = q
        filled(c) = filled(c) + 1
      end do
    end do
  end subroutine list_quads

  !> Find the quadrilaterals across the edges.
  pure subroutine set_neighbours(self)
    type(grid_t), intent(inout) :: self

    integer :: i, k, q, other

    allocate (self%neighbour(4, self%n_quad), source=0)
    do q = 1, self%n_quad
      do i = 1, 4
        associate (from => self%corner(i, q), to => self%corner(mod(i, 4) + 1, q))
          do k = self%first(from), self%first(from + 1) - 1
            other = self%quad_at(k)
            if (other /= q .and. any(self%corner(:, other) == to)) self%neighbour(i, q) = other
          end do
        end associate
      end do
    end do
  end subroutine set_neighbours

  !> Find the quadrilaterals across the edges with a bound column.
  pure subroutine set_over_bound(self, column_of, bound)
    type(grid_t), intent(inout) :: self
    !> Columns of the lowest nodes, 0 for the others, `(n_node)`.
    integer, intent(in) :: column_of(:)
    !> Bound nodes and the ends of their edges, `(3, n)`.
    integer, intent(in) :: bound(:, :)

    integer :: large, large_edge, small, small_edge, k, n

    do n = 1, size(bound, 2)
      associate (column => column_of(bound(:, n)))
        if (column(1) == 0) cycle
        call find_edge(self, column(2:), large, large_edge)
        if (large == 0) cycle
        do k = 1, 2
          call find_edge(self, column([1, k + 1]), small, small_edge)
          if (small == 0) cycle
          self%over_bound(k, large_edge, large) = small
          self%over_bound(1, small_edge, small) = large
        end do
      end associate
    end do
  end subroutine set_over_bound

  !> Find a quadrilateral with an edge between two columns; 0 for none.
  pure subroutine find_edge(self, ends, quad, edge)
    type(grid_t), intent(in) :: self
    integer, intent(in) :: ends(2)
    integer, intent(out) :: quad, edge

    integer :: k

    do k = self%first(ends(1)), self%first(ends(1) + 1) - 1
      quad = self%quad_at(k)
      edge = edge_between(self%corner(:, quad), ends)
      if (edge > 0) return
    end do
    quad = 0
  end subroutine find_edge

  !> Return the edge of a quadrilateral between two columns; 0 for none.
  pure integer function edge_between(corner, ends) result(edge)
    integer, intent(in) :: corner(4), ends(2)

    do edge = 4, 1, -1
      associate (own => corner([edge, mod(edge, 4) + 1]))
        if (all(own == ends) .or. all(own == ends([2, 1]))) return
      end associate
    end do
  end function edge_between

end module dd3_sheet_grid
