! SPDX-License-Identifier: GPL-3.0-or-later
!> Quadrilaterals of the sheet seen through its thickness: elements above one another, between the
!> same columns of nodes.
module dd3_model_element_columns
  use dd3_mesh_hexahedra, only : same_nodes
  use dd3_model_mesh_data, only : mesh_data_t
  implicit none
  private
  public :: element_columns_t, new_element_columns, n_corner

  !> Corners of a quadrilateral: the first nodes of an element.
  integer, parameter :: n_corner = 4

  !> Quadrilaterals of a sheet.
  type :: element_columns_t
    integer :: n = 0
    !> Lowest nodes of the columns at their corners, in the order of the elements, `(4, n)`.
    integer, allocatable :: corner(:, :)
    !> Quadrilateral of each element, `(n_element)`.
    integer, allocatable :: of_element(:)
    !> Quadrilateral across the edge from corner i to corner i + 1, `(4, n)`; 0 for none.
    integer, allocatable :: neighbour(:, :)
  end type element_columns_t

contains

  !> Find the quadrilaterals. They are compared with those that have the same lowest node.
  pure subroutine new_element_columns(self, mesh)
    type(element_columns_t), intent(out) :: self
    !> With its columns.
    class(mesh_data_t), intent(in) :: mesh

    integer :: first(mesh%n_node), next(mesh%n_element), corner(n_corner), e, q

    allocate (self%corner(n_corner, mesh%n_element), self%of_element(mesh%n_element))
    first = 0
    do e = 1, mesh%n_element
      corner = mesh%column(1, mesh%connectivity(:n_corner, e))
      q = first(minval(corner))
      do while (q > 0)
        if (same_nodes(corner, self%corner(:, q))) exit
        q = next(q)
      end do
      if (q == 0) then
        self%n = self%n + 1
        q = self%n
        self%corner(:, q) = corner
        next(q) = first(minval(corner))
        first(minval(corner)) = q
      end if
      self%of_element(e) = q
    end do
    self%corner = self%corner(:, :self%n)
    call set_neighbours(self, mesh%n_node)
  end subroutine new_element_columns

  !> Find the neighbours. Edges are compared with those that have the same lower node.
  pure subroutine set_neighbours(self, n_node)
    type(element_columns_t), intent(inout) :: self
    integer, intent(in) :: n_node

    !> Edge with a lower node that was found last, and the one before: i + 4*(q - 1).
    integer :: last(n_node), previous(n_corner*self%n), ends(2), i, q, k

    allocate (self%neighbour(n_corner, self%n), source=0)
    last = 0
    do q = 1, self%n
      do i = 1, n_corner
        ends = ends_of(i + n_corner*(q - 1))
        k = last(minval(ends))
        do while (k > 0)
          if (maxval(ends_of(k)) == maxval(ends)) exit
          k = previous(k)
        end do
        if (k > 0) then
          self%neighbour(i, q) = (k - 1)/n_corner + 1
          self%neighbour(modulo(k - 1, n_corner) + 1, (k - 1)/n_corner + 1) = q
        end if
        previous(i + n_corner*(q - 1)) = last(minval(ends))
        last(minval(ends)) = i + n_corner*(q - 1)
      end do
    end do

  contains

    !> Return the ends of an edge.
    pure function ends_of(edge) result(ends)
      integer, intent(in) :: edge
      integer :: ends(2)

      associate (i => modulo(edge - 1, n_corner) + 1, q => (edge - 1)/n_corner + 1)
        ends = self%corner([i, modulo(i, n_corner) + 1], q)
      end associate
    end function ends_of

  end subroutine set_neighbours

end module dd3_model_element_columns
