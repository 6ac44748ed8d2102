! SPDX-License-Identifier: GPL-3.0-or-later
!> Thickness of the sheet at cells and nodes, for any element. In an element the directors, from the
!> bottom to the top of the columns of nodes, splay where the sheet is bent: in an element whose
!> ends are turned by theta against each other they are longer than the thickness by the factor
!> 1/cos(theta/2). The thickness of a cell is therefore the length of the mean director along the
!> normal of the middle surface at the centre, which pure bending and stretching give exactly; that
!> at a node is the mean of the cells that share it.
module dd3_model_sheet_thickness
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: sheet_thickness

  !> Corners of a face.
  integer, parameter :: n_corner = 4

contains

  !> Evaluate the thickness; zero where there is no column of nodes.
  pure subroutine sheet_thickness(model, x, nodal, cell)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(n_node)` and `(n_element)`, mm.
    real(wp), intent(out) :: nodal(:), cell(:)

    integer, allocatable :: local(:)
    integer :: sharing(model%n_node), e, i

    local = pack([(i, i=1, model%element%n_node)], model%element%node(3, :) < -0.5_wp)
    nodal = 0.0_wp
    sharing = 0
    do e = 1, model%n_element
      cell(e) = at_centre(model, x, model%connectivity(local, e), local)
      associate (bottom => model%column(1, model%connectivity(local, e)))
        nodal(bottom) = nodal(bottom) + cell(e)
        sharing(bottom) = sharing(bottom) + 1
      end associate
    end do
    nodal = nodal(model%column(1, :))/real(max(1, sharing(model%column(1, :))), wp)
  end subroutine sheet_thickness

  !> Return the vector from the bottom to the top of the column of a node, mm.
  pure function director(model, x, node)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node
    real(wp) :: director(3)

    director = x(:, model%column(2, node)) - x(:, model%column(1, node))
  end function director

  !> Return the thickness at the centre of an element, mm.
  pure real(wp) function at_centre(model, x, node, local) result(thickness)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the lower face, and their numbers in the element.
    integer, intent(in) :: node(:), local(:)

    real(wp) :: middle(3, size(node)), d(3, size(node)), tangent(3, 2), normal(3)
    integer :: a

    do a = 1, size(node)
      d(:, a) = director(model, x, node(a))
      middle(:, a) = x(:, model%column(1, node(a))) + 0.5_wp*d(:, a)
    end do
    tangent = 0.0_wp
    do a = 1, n_corner
      tangent = tangent + matmul(middle, transpose(model%element%node_slope(:2, local, local(a))))
    end do
    normal = cross(tangent(:, 1), tangent(:, 2))
    thickness = abs(dot_product(matmul(d, weights_at_centre(size(node))), normal))/norm2(normal)
  end function at_centre

  !> Return the shape functions of a face at its centre: bilinear, serendipity or biquadratic.
  pure function weights_at_centre(n) result(weight)
    !> Number of its nodes, the corners first, the centre last.
    integer, intent(in) :: n
    real(wp) :: weight(n)

    select case (n)
    case (n_corner)
      weight = 0.25_wp
    case (8)
      weight(:n_corner) = -0.25_wp
      weight(n_corner + 1:) = 0.5_wp
    case default
      weight = 0.0_wp
      weight(n) = 1.0_wp
    end select
  end function weights_at_centre

end module dd3_model_sheet_thickness
