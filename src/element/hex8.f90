! SPDX-License-Identifier: GPL-3.0-or-later
!> Hexahedron with 8 nodes, 2 x 2 x 2 Gauss points and selective reduced integration: all points
!> share one mean dilatation (Nagtegaal, Parks & Rice 1974; Hughes 1980, the mean-dilatation form of
!> B-bar).
module dd3_element_hex8
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t, new_table, complete_table, set_table_point
  implicit none
  private
  public :: new_hex8, hex8_shape, set_hex8_faces

  !> Natural coordinates of the nodes, in VTK's order.
  real(wp), parameter :: corner(3, 8) = reshape([ &
      -1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, &
      1.0_wp, 1.0_wp, -1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      -1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, &
      1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp], [3, 8])

contains

  !> Fill the table; integration point p lies towards node p.
  subroutine new_hex8(self)
    type(element_t), intent(out) :: self

    real(wp), parameter :: root3 = sqrt(3.0_wp)
    real(wp) :: slope(3, 8)
    integer :: a

    call new_table(self, "hex8", n_node=8, n_point=8)
    self%title = "8 nodes, 2x2x2 points, mean dilatation (selective reduced integration)"
    self%group = 1
    call set_hex8_faces(self)
    do a = 1, 8
      call set_table_point(self, a, corner(:, a)/root3, 1.0_wp)
      call hex8_shape(root3*corner(:, a), self%extrapolation(a, :), slope)
    end do
    call complete_table(self, hex8_shape)
  end subroutine new_hex8

  !> Set nodes, pairs, faces and cell type of a hexahedron with 8 nodes.
  subroutine set_hex8_faces(self)
    type(element_t), intent(inout) :: self

    self%vtk_type = 12
    self%node = corner
    self%pair = reshape([1, 5, 2, 6, 3, 7, 4, 8], [2, 4])
    ! Faces in the order -xi, +xi, -eta, +eta, -zeta, +zeta.
    self%face = reshape([1, 5, 8, 4, 2, 3, 7, 6, 1, 2, 6, 5, 4, 8, 7, 3, 1, 4, 3, 2, 5, 6, 7, 8], &
        [4, 6])
    self%face_weight = [0.25_wp, 0.25_wp, 0.25_wp, 0.25_wp]
  end subroutine set_hex8_faces

  !> Evaluate N_a = (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a)/8 and its derivatives.
  pure subroutine hex8_shape(natural, shape, dshape)
    real(wp), intent(in) :: natural(3)
    real(wp), intent(out) :: shape(:), dshape(:, :)

    real(wp) :: part(3)
    integer :: a

    do a = 1, 8
      part = 1.0_wp + natural*corner(:, a)
      shape(a) = part(1)*part(2)*part(3)/8.0_wp
      dshape(1, a) = corner(1, a)*part(2)*part(3)/8.0_wp
      dshape(2, a) = corner(2, a)*part(3)*part(1)/8.0_wp
      dshape(3, a) = corner(3, a)*part(1)*part(2)/8.0_wp
    end do
  end subroutine hex8_shape

end module dd3_element_hex8
