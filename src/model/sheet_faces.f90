! SPDX-License-Identifier: GPL-3.0-or-later
!> Faces on the boundary of the sheet and their outward normals.
module dd3_model_sheet_faces
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : cross
  use dd3_mesh_hexahedra, only : same_nodes
  implicit none
  private
  public :: sheet_faces_t, new_sheet_faces, area_vector, face_area, face_normal, part_of_nine

  !> Quadrilaterals between neighbouring nodes of a face with 9 nodes, in the order of the table.
  integer, parameter :: part_of_nine(4, 4) = &
      reshape([1, 5, 9, 8, 5, 2, 6, 9, 9, 6, 3, 7, 8, 9, 7, 4], [4, 4])

  !> Faces that belong to one element only.
  type :: sheet_faces_t
    integer :: n = 0
    !> Their corners, counter-clockwise seen from outside, `(4, n)`, and their elements, `(n)`.
    integer, allocatable :: corner(:, :), element(:)
    !> All their nodes, corners first, `(n_face_node, n)`.
    integer, allocatable :: node(:, :)
  end type sheet_faces_t

contains

  !> Find the faces on the boundary. Faces are compared with those that have the same lowest node.
  pure subroutine new_sheet_faces(self, element, connectivity)
    type(sheet_faces_t), intent(out) :: self
    type(element_t), intent(in) :: element
    !> `(element%n_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)

    integer :: corner(4, element%n_face*size(connectivity, 2))
    integer :: previous(size(corner, 2)), last(maxval(connectivity))
    logical :: inner(size(corner, 2))
    integer :: e, f, i, k

    last = 0
    inner = .false.
    do e = 1, size(connectivity, 2)
      do f = 1, element%n_face
        i = f + element%n_face*(e - 1)
        corner(:, i) = connectivity(element%face(:4, f), e)
        associate (lowest => last(minval(corner(:, i))))
          k = lowest
          do while (k > 0)
            if (same_nodes(corner(:, k), corner(:, i))) exit
            k = previous(k)
          end do
          if (k > 0) inner([k, i]) = .true.
          previous(i) = lowest
          lowest = i
        end associate
      end do
    end do
    self%n = count(.not. inner)
    self%element = pack([((i - 1)/element%n_face + 1, i=1, size(inner))], .not. inner)
    self%corner = corner(:, pack([(i, i=1, size(inner))], .not. inner))
    allocate (self%node(element%n_face_node, self%n))
    k = 0
    do i = 1, size(inner)
      if (inner(i)) cycle
      k = k + 1
      f = modulo(i - 1, element%n_face) + 1
      self%node(:, k) = connectivity(element%face(:, f), self%element(k))
    end do
  end subroutine new_sheet_faces

  !> Return twice the area of a face along its outward normal, mm2.
  pure function area_vector(x) result(area)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: area(3)

    area = cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2))
  end function area_vector

  !> Return the area of a face from its diagonals, exact for plane faces with straight edges, mm2.
  pure real(wp) function face_area(x)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)

    face_area = 0.5_wp*norm2(area_vector(x))
  end function face_area

  !> Return the outward unit normal at the centre of a face; zero if the face has no area.
  pure function face_normal(x) result(normal)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: normal(3)

    normal = area_vector(x)
    normal = normal/max(norm2(normal), tiny(1.0_wp))
  end function face_normal

end module dd3_model_sheet_faces
