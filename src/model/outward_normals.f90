! SPDX-License-Identifier: GPL-3.0-or-later
!> Outward normals of the sheet at the contact points. A tool touches the sheet where their normals
!> are opposite; this tells the side of the tool's surface on which a point belongs.
module dd3_model_outward_normals
  use dd3_base_kinds, only : wp
  use dd3_model_contact_data, only : all_faces, side_faces
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : area_vector, sheet_faces_t
  implicit none
  private
  public :: normals_for_tools, outward_normals, nodal_normals, mean_normals

contains

  !> Return the outward unit normals at the nodes for the tools that touch a kind of faces,
  !> `(3, n_node)`: the mean over these faces at a node, by area, or over the others at a node
  !> without one; zero for a node without contact faces.
  pure function nodal_normals(model, x, kind) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kind
    real(wp), allocatable :: normal(:, :)

    logical :: chosen(size(model%contact_face))
    real(wp), allocatable :: other(:, :)

    chosen = model%faces_of_kind(kind)
    normal = mean_normals(model%face, pack(model%contact_face, chosen), x)
    if (all(chosen)) return
    other = mean_normals(model%face, pack(model%contact_face, .not. chosen), x)
    where (spread(norm2(normal, dim=1) <= 0.0_wp, 1, 3)) normal = other
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

  !> Return the outward unit normals at the contact points for the tools that touch a kind of faces,
  !> `(3, n_contact)`: between nodes, the mean of those of the nodes.
  pure function outward_normals(model, x, kind) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kind
    real(wp), allocatable :: normal(:, :)

    real(wp) :: at_node(3, model%n_node)
    integer :: c

    at_node = nodal_normals(model, x, kind)
    allocate (normal(3, model%n_contact))
    do c = 1, model%n_contact
      associate (point => model%contact_point(c))
        normal(:, c) = unit(matmul(at_node(:, point%node(:point%n_surface)), &
            point%weight(:point%n_surface)))
      end associate
    end do
  end function outward_normals

  !> Return the outward unit normals at the contact points for the tools that touch each kind of
  !> faces, `(3, n_contact, all_faces)`; zero for a kind that no tool touches.
  pure function normals_for_tools(model, x) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: normal(:, :, :)

    integer :: kind

    allocate (normal(3, model%n_contact, all_faces), source=0.0_wp)
    do kind = side_faces, all_faces
      if (any(model%touched_faces == kind)) normal(:, :, kind) = outward_normals(model, x, kind)
    end do
  end function normals_for_tools

  !> Return a vector divided by its length; zero for zero.
  pure function unit(vector)
    real(wp), intent(in) :: vector(3)
    real(wp) :: unit(3)

    unit = vector/max(norm2(vector), tiny(1.0_wp))
  end function unit

end module dd3_model_outward_normals
