! SPDX-License-Identifier: GPL-3.0-or-later
!> Topology of a mesh of hexahedra: faces, neighbours, and the shape of the elements at their
!> corners. The corners are numbered as in VTK, bottom face first.
module dd3_mesh_hexahedra
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: corner_natural, edge_axis, edge_ends, face_corner, find_neighbours, neighbours_t, &
      corner_shape, same_nodes

  !> Natural coordinates of the corners.
  integer, parameter :: corner_natural(3, 8) = reshape([ &
      -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
      -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
  !> Corners of the faces -xi, +xi, -eta, +eta, -zeta, +zeta.
  integer, parameter :: face_corner(4, 6) = reshape([ &
      1, 5, 8, 4, 2, 3, 7, 6, 1, 2, 6, 5, 4, 8, 7, 3, 1, 4, 3, 2, 5, 6, 7, 8], [4, 6])
  !> Corners at the ends of the edges, and the natural axes along them.
  integer, parameter :: edge_ends(2, 12) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 8, 8, &
      5, 1, 5, 2, 6, 3, 7, 4, 8], [2, 12])
  integer, parameter :: edge_axis(12) = [1, 2, 1, 2, 1, 2, 1, 2, 3, 3, 3, 3]

  !> Neighbours across the faces.
  type :: neighbours_t
    !> Element across each face, and its face there, `(6, n_element)`; 0 on the boundary.
    integer, allocatable :: element(:, :), face(:, :)
    !> Faces of three elements or more: first, second and later element, `(3, n)`.
    integer, allocatable :: branch(:, :)
  end type neighbours_t

contains

  !> Find the neighbours. Faces are compared with those that have the same lowest node.
  pure subroutine find_neighbours(self, corner, n_node)
    type(neighbours_t), intent(out) :: self
    !> Nodes at the corners, `(8, n_element)`.
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: n_node

    integer, allocatable :: previous(:), last(:), branch(:, :)
    integer :: e, f, i, k, n_branch

    allocate (previous(6*size(corner, 2)), last(n_node), source=0)
    allocate (self%element(6, size(corner, 2)), self%face(6, size(corner, 2)), source=0)
    allocate (branch(3, 64))
    n_branch = 0
    do e = 1, size(corner, 2)
      do f = 1, 6
        i = f + 6*(e - 1)
        associate (lowest => last(minval(corner(face_corner(:, f), e))))
          k = lowest
          do while (k > 0)
            if (same_nodes(nodes_of(corner, k), nodes_of(corner, i))) exit
            k = previous(k)
          end do
          previous(i) = lowest
          lowest = i
        end associate
        if (k == 0) cycle
        call join(self, k, i, branch, n_branch)
      end do
    end do
    self%branch = branch(:, :n_branch)
  end subroutine find_neighbours

  !> Make two faces neighbours, or note a face that has a neighbour already.
  pure subroutine join(self, a, b, branch, n_branch)
    type(neighbours_t), intent(inout) :: self
    !> Numbers of the faces: face + 6*(element - 1).
    integer, intent(in) :: a, b
    integer, intent(inout) :: branch(:, :), n_branch

    integer :: element(2), face(2)

    element = ([a, b] - 1)/6 + 1
    face = modulo([a, b] - 1, 6) + 1
    if (self%element(face(1), element(1)) > 0) then
      if (n_branch == size(branch, 2)) return
      n_branch = n_branch + 1
      branch(:, n_branch) = [element(1), self%element(face(1), element(1)), element(2)]
      return
    end if
    self%element(face(1), element(1)) = element(2)
    self%element(face(2), element(2)) = element(1)
    self%face(face(1), element(1)) = face(2)
    self%face(face(2), element(2)) = face(1)
  end subroutine join

  !> Return the nodes of a face.
  pure function nodes_of(corner, i) result(node)
    integer, intent(in) :: corner(:, :)
    !> Number of the face: face + 6*(element - 1).
    integer, intent(in) :: i
    integer :: node(4)

    node = corner(face_corner(:, modulo(i - 1, 6) + 1), (i - 1)/6 + 1)
  end function nodes_of

  !> Whether two faces have the same corners.
  pure logical function same_nodes(a, b)
    integer, intent(in) :: a(4), b(4)

    integer :: i

    same_nodes = all([(any(b == a(i)), i=1, 4)])
  end function same_nodes

  !> Return the scaled Jacobian at each corner: the triple product of the unit vectors along the
  !> three edges; -1 to 1, and 0 if an edge has no length.
  pure function corner_shape(x) result(shape)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 8)
    real(wp) :: shape(8)

    real(wp) :: edge(3, 3)
    integer :: a, i

    do a = 1, 8
      do i = 1, 3
        edge(:, i) = real(corner_natural(i, a), wp)*(x(:, a) - x(:, partner(a, i)))
        edge(:, i) = edge(:, i)/max(norm2(edge(:, i)), tiny(1.0_wp))
      end do
      shape(a) = edge(1, 1)*(edge(2, 2)*edge(3, 3) - edge(3, 2)*edge(2, 3)) &
          + edge(2, 1)*(edge(3, 2)*edge(1, 3) - edge(1, 2)*edge(3, 3)) &
          + edge(3, 1)*(edge(1, 2)*edge(2, 3) - edge(2, 2)*edge(1, 3))
    end do
  end function corner_shape

  !> Return the other corner of the edge along an axis.
  pure integer function partner(a, axis)
    integer, intent(in) :: a, axis

    integer, parameter :: other(8, 3) = reshape([ &
        2, 1, 4, 3, 6, 5, 8, 7, 4, 3, 2, 1, 8, 7, 6, 5, 5, 6, 7, 8, 1, 2, 3, 4], [8, 3])

    partner = other(a, axis)
  end function partner

end module dd3_mesh_hexahedra
