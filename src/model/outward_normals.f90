! SPDX-License-Identifier: GPL-3.0-or-later
!> Outward normals of the sheet at the contact points. A tool touches the sheet where their normals
!> are opposite; this tells the side of the tool's surface on which a point belongs.
module dd3_model_outward_normals
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : area_vector, sheet_faces_t
  implicit none
  private
  public :: outward_normals, nodal_normals, mean_normals

contains

  !> Return the outward unit normals at the nodes, `(3, n_node)`: the mean over the contact faces at
  !> a node, by area; zero for a node without contact faces.
  pure function nodal_normals(model, x) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: normal(:, :)

    normal = mean_normals(model%face, model%contact_face, x)
  end function nodal_normals

  !> Return the means of the outward unit normals of some faces at their nodes, `(3, n_node)`, by
  !> area; zero for other nodes.
  pure function mean_normals(face, number, x) result(normal)
    type(sheet_faces_t), intent(in) :: face
    !> Numbers of the faces.
    integer, intent(in) :: number(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: normal(3, size(x, 2))

    integer :: f, i

    normal = 0.0_wp
    do f = 1, size(number)
      associate (node => face%node(:, number(f)), area => area_vector(x(:, &
          face%corner(:, number(f)))))
        do i = 1, size(node)
          normal(:, node(i)) = normal(:, node(i)) + area
        end do
      end associate
    end do
    do i = 1, size(x, 2)
      normal(:, i) = unit(normal(:, i))
    end do
  end function mean_normals

  !> Return the outward unit normals at the contact points, `(3, n_contact)`: between nodes, the
  !> mean of those of the nodes.
  pure function outward_normals(model, x) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: normal(:, :)

    real(wp) :: at_node(3, model%n_node)
    integer :: c

    at_node = nodal_normals(model, x)
    allocate (normal(3, model%n_contact))
    do c = 1, model%n_contact
      associate (point => model%contact_point(c))
        normal(:, c) = unit(matmul(at_node(:, point%node(:point%n_surface)), &
            point%weight(:point%n_surface)))
      end associate
    end do
  end function outward_normals

  !> Return a vector divided by its length; zero for zero.
  pure function unit(vector)
    real(wp), intent(in) :: vector(3)
    real(wp) :: unit(3)

    unit = vector/max(norm2(vector), tiny(1.0_wp))
  end function unit

end module dd3_model_outward_normals
