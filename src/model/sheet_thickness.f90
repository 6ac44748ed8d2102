! SPDX-License-Identifier: GPL-3.0-or-later
!> Thickness of the sheet at cells and nodes, for any element. In an element the directors, from the
!> bottom to the top of the columns of nodes, splay where the sheet is bent: in an element whose ends
!> are turned by theta against each other they are longer than the thickness by the factor
!> 1/cos(theta/2). The thickness of a cell is therefore the length of the mean director along the
!> normal of the middle surface at the centre, which pure bending and stretching give exactly. At a
!> node it is the length of the director, without the splay of the elements that share it.
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
    real(wp) :: length(model%n_node), factor(model%n_node), splay
    integer :: sharing(model%n_node), e, i

    local = pack([(i, i=1, model%element%n_node)], model%element%node(3, :) < -0.5_wp)
    length = [(norm2(director(model, x, i)), i=1, model%n_node)]
    factor = 0.0_wp
    sharing = 0
    do e = 1, model%n_element
      call at_centre(model, x, model%connectivity(local, e), local, cell(e), splay)
      associate (bottom => model%column(1, model%connectivity(local, e)))
        factor(bottom) = factor(bottom) + splay
        sharing(bottom) = sharing(bottom) + 1
      end associate
    end do
    do i = 1, model%n_node
      associate (bottom => model%column(1, i))
        nodal(i) = length(bottom)
        if (sharing(bottom) > 0) nodal(i) = length(bottom)*factor(bottom)/real(sharing(bottom), wp)
      end associate
    end do
  end subroutine sheet_thickness

  !> Return the vector from the bottom to the top of the column of a node, mm.
  pure function director(model, x, node)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node
    real(wp) :: director(3)

    director = x(:, model%column(2, node)) - x(:, model%column(1, node))
  end function director

  !> Evaluate the thickness at the centre of the face of an element.
  pure subroutine at_centre(model, x, node, local, thickness, splay)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the lower face, and their numbers in the element.
    integer, intent(in) :: node(:), local(:)
    !> mm.
    real(wp), intent(out) :: thickness
    !> Thickness over the length of the directors interpolated there; 1 without a column.
    real(wp), intent(out) :: splay

    real(wp) :: weight(size(node)), middle(3, size(node)), d(3, size(node)), tangent(3, 2), normal(3)
    real(wp) :: length
    integer :: a

    weight = weights_at_centre(size(node))
    do a = 1, size(node)
      d(:, a) = director(model, x, node(a))
      middle(:, a) = x(:, model%column(1, node(a))) + 0.5_wp*d(:, a)
    end do
    tangent = 0.0_wp
    do a = 1, n_corner
      tangent = tangent + matmul(middle, transpose(model%element%node_slope(:2, local, local(a))))
    end do
    normal = cross(tangent(:, 1), tangent(:, 2))
    thickness = abs(dot_product(matmul(d, weight), normal))/norm2(normal)
    length = dot_product(norm2(d, dim=1), weight)
    splay = 1.0_wp
    if (length > 0.0_wp) splay = thickness/length
  end subroutine at_centre

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
