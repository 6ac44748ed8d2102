! SPDX-License-Identifier: GPL-3.0-or-later
!> Hexahedron with 27 nodes, products of quadratic Lagrange polynomials (Zienkiewicz & Taylor, The
!> Finite Element Method, 1989, chap. 7), and selective reduced integration: 3 x 3 x 3 Gauss points,
!> the dilatation of 2 x 2 x 2 points (Hughes 1980, B-bar). It is projected on the trilinear
!> functions N_k that are 1 at one of those points and 0 at the others: for a dilatation that is
!> quadratic in each natural coordinate this is interpolation between them.
module dd3_element_hex27
  use dd3_base_kinds, only : wp
  use dd3_element_gauss, only : gauss_legendre
  use dd3_element_hex8, only : hex8_shape
  use dd3_element_table, only : element_t, new_table, complete_table, set_table_point
  implicit none
  private
  public :: new_hex27, hex27_shape, quadratic_node, quadratic_face, set_quadratic_points

  !> Natural coordinates of the nodes, in VTK's order: corners, edges, faces, centre.
  integer, parameter :: quadratic_node(3, 27) = reshape([ &
      -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, &
      0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, &
      -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, &
      -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0], [3, 27])
  !> Nodes of the faces -xi, +xi, -eta, +eta, -zeta, +zeta: corners, edges, centre.
  integer, parameter :: quadratic_face(9, 6) = reshape([ &
      1, 5, 8, 4, 17, 16, 20, 12, 21, 2, 3, 7, 6, 10, 19, 14, 18, 22, &
      1, 2, 6, 5, 9, 18, 13, 17, 23, 4, 8, 7, 3, 20, 15, 19, 11, 24, &
      1, 4, 3, 2, 12, 11, 10, 9, 25, 5, 6, 7, 8, 13, 14, 15, 16, 26], [9, 6])
  real(wp), parameter :: root3 = sqrt(3.0_wp)

contains

  !> Fill the table.
  subroutine new_hex27(self)
    type(element_t), intent(out) :: self

    call new_table(self, "hex27", n_node=27, n_point=27)
    self%title = "27 nodes, 3x3x3 points, dilatation of 2x2x2 (selective reduced integration)"
    self%vtk_type = 29
    self%node = real(quadratic_node, wp)
    self%pair = reshape([1, 5, 2, 6, 3, 7, 4, 8, 9, 13, 10, 14, 11, 15, 12, 16, 25, 26], [2, 9])
    self%face = quadratic_face
    self%face_weight = [1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 4.0_wp, 4.0_wp, 4.0_wp, 4.0_wp, &
        16.0_wp]/36.0_wp
    call set_quadratic_points(self)
    call complete_table(self, hex27_shape)
  end subroutine new_hex27

  !> Set the 3 x 3 x 3 points, the projection of the dilatation, and the extrapolation: that of the
  !> same trilinear functions, fitted by least squares.
  subroutine set_quadratic_points(self)
    !> With its nodes.
    type(element_t), intent(inout) :: self

    real(wp) :: abscissa(3), weight(3), at_node(8), slope(3, 8)
    integer :: a, i, j, k, p

    call gauss_legendre(3, abscissa, weight)
    allocate (self%projection(27, 8))
    self%group = 1
    do k = 1, 3
      do j = 1, 3
        do i = 1, 3
          p = i + 3*(j - 1) + 9*(k - 1)
          call set_table_point(self, p, [abscissa(i), abscissa(j), abscissa(k)], &
              weight(i)*weight(j)*weight(k))
          call hex8_shape(root3*self%point(:, p), self%projection(p, :), slope)
        end do
      end do
    end do
    ! The functions are orthonormal.
    do a = 1, self%n_node
      call hex8_shape(root3*self%node(:, a), at_node, slope)
      self%extrapolation(a, :) = self%weight*matmul(self%projection, at_node)
    end do
  end subroutine set_quadratic_points

  !> Evaluate N_a = L_a(xi) L_a(eta) L_a(zeta) and its derivatives.
  pure subroutine hex27_shape(natural, shape, dshape)
    real(wp), intent(in) :: natural(3)
    real(wp), intent(out) :: shape(:), dshape(:, :)

    real(wp) :: value(3, -1:1), slope(3, -1:1)
    integer :: a

    value(:, -1) = 0.5_wp*natural*(natural - 1.0_wp)
    value(:, 0) = (1.0_wp - natural)*(1.0_wp + natural)
    value(:, 1) = 0.5_wp*natural*(natural + 1.0_wp)
    slope(:, -1) = natural - 0.5_wp
    slope(:, 0) = -2.0_wp*natural
    slope(:, 1) = natural + 0.5_wp
    do a = 1, 27
      associate (i => quadratic_node(1, a), j => quadratic_node(2, a), k => quadratic_node(3, a))
        shape(a) = value(1, i)*value(2, j)*value(3, k)
        dshape(1, a) = slope(1, i)*value(2, j)*value(3, k)
        dshape(2, a) = value(1, i)*slope(2, j)*value(3, k)
        dshape(3, a) = value(1, i)*value(2, j)*slope(3, k)
      end associate
    end do
  end subroutine hex27_shape

end module dd3_element_hex27
