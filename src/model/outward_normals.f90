!> Outward normals of the sheet at the contact points. A tool touches the sheet where their normals
!> are opposite; this tells the side of the tool's surface on which a point belongs.
module dd3_model_outward_normals
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: outward_normals, nodal_normals

contains

  !> Return the outward unit normals at the nodes, `(3, n_node)`: the mean over the contact faces at
  !> a node, by area; zero for a node without contact faces.
  pure function nodal_normals(model, x) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: normal(:, :)

    real(wp) :: area(3)
    integer :: f, i

    allocate (normal(3, model%n_node), source=0.0_wp)
    if (.not. allocated(model%contact_face)) return
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)), &
          node => model%face%node(:, model%contact_face(f)))
        area = cross(x(:, corner(3)) - x(:, corner(1)), x(:, corner(4)) - x(:, corner(2)))
        do i = 1, size(node)
          normal(:, node(i)) = normal(:, node(i)) + area
        end do
      end associate
    end do
    do i = 1, model%n_node
      normal(:, i) = unit(normal(:, i))
    end do
  end function nodal_normals

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
