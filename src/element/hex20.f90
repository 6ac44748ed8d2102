! SPDX-License-Identifier: GPL-3.0-or-later
!> Hexahedron with 20 nodes, the serendipity functions of Zienkiewicz & Taylor (The Finite Element
!> Method, 1989, chap. 7), with the points and the selective reduced integration of hex27.
module dd3_element_hex20
  use dd3_base_kinds, only : wp
  use dd3_element_hex27, only : quadratic_face, quadratic_node, set_quadratic_points
  use dd3_element_table, only : element_t, new_table, complete_table
  implicit none
  private
  public :: new_hex20, hex20_shape

contains

  !> Fill the table.
  subroutine new_hex20(self)
    type(element_t), intent(out) :: self

    call new_table(self, "hex20", n_node=20, n_point=27)
    self%title = "20 nodes, 3x3x3 points, dilatation of 2x2x2 (selective reduced integration)"
    self%vtk_type = 25
    self%node = real(quadratic_node(:, :20), wp)
    self%pair = reshape([1, 5, 2, 6, 3, 7, 4, 8, 9, 13, 10, 14, 11, 15, 12, 16], [2, 8])
    self%face = quadratic_face(:8, :)
    self%face_weight = [-1.0_wp, -1.0_wp, -1.0_wp, -1.0_wp, 4.0_wp, 4.0_wp, 4.0_wp, 4.0_wp]/12.0_wp
    call set_quadratic_points(self)
    call complete_table(self, hex20_shape)
  end subroutine new_hex20

  !> Evaluate the shape functions and their derivatives.
  pure subroutine hex20_shape(natural, shape, dshape)
    real(wp), intent(in) :: natural(3)
    real(wp), intent(out) :: shape(:), dshape(:, :)

    real(wp) :: c(3), part(3), slope(3), excess
    integer :: a, i

    do a = 1, 20
      c = real(quadratic_node(:, a), wp)
      ! Along an edge the bubble, otherwise the linear function.
      do i = 1, 3
        if (quadratic_node(i, a) == 0) then
          part(i) = (1.0_wp - natural(i))*(1.0_wp + natural(i))
          slope(i) = -2.0_wp*natural(i)
        else
          part(i) = 0.5_wp*(1.0_wp + natural(i)*c(i))
          slope(i) = 0.5_wp*c(i)
        end if
      end do
      shape(a) = part(1)*part(2)*part(3)
      dshape(1, a) = slope(1)*part(2)*part(3)
      dshape(2, a) = part(1)*slope(2)*part(3)
      dshape(3, a) = part(1)*part(2)*slope(3)
      if (a > 8) cycle
      excess = dot_product(natural, c) - 2.0_wp
      dshape(:, a) = dshape(:, a)*excess + shape(a)*c
      shape(a) = shape(a)*excess
    end do
  end subroutine hex20_shape

end module dd3_element_hex20
