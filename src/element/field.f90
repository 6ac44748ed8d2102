!> What the output needs from an element: means over the cell, values at the nodes, thickness,
!> volume.
module dd3_element_field
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  implicit none
  private
  public :: cell_mean, nodal_values, element_thickness, element_volume

contains

  !> Volume-weighted mean of the points' values.
  pure subroutine cell_mean(element, weight, value, mean)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Weight times Jacobian, mm3: `weight(n_point)`.
    real(wp), intent(in) :: weight(element%n_point)
    !> Values: `value(:,n_point)`.
    real(wp), intent(in) :: value(:, :)
    !> Their mean.
    real(wp), intent(out) :: mean(size(value, 1))

    integer :: p

    mean = 0.0_wp
    do p = 1, element%n_point
      mean = mean + weight(p)*value(:, p)
    end do
    mean = mean/sum(weight)
  end subroutine cell_mean

  !> Extrapolates the points' values to the nodes.
  pure subroutine nodal_values(element, value, nodal)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Values at the points: `value(:,n_point)`.
    real(wp), intent(in) :: value(:, :)
    !> Values at the nodes: `nodal(:,n_node)`.
    real(wp), intent(out) :: nodal(size(value, 1), element%n_node)

    integer :: a, p

    nodal = 0.0_wp
    do p = 1, element%n_point
      do a = 1, element%n_node
        nodal(:, a) = nodal(:, a) + element%extrapolation(a, p)*value(:, p)
      end do
    end do
  end subroutine nodal_values

  !> Thickness, mm: mean distance between the nodes that face each other along zeta.
  pure real(wp) function element_thickness(element, x) result(thickness)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Positions, mm: `x(3,n_node)`.
    real(wp), intent(in) :: x(3, element%n_node)

    integer :: i

    thickness = 0.0_wp
    do i = 1, element%n_pair
      thickness = thickness + norm2(x(:, element%pair(2, i)) - x(:, element%pair(1, i)))
    end do
    thickness = thickness/real(element%n_pair, wp)
  end function element_thickness

  !> Volume, mm3.
  pure real(wp) function element_volume(element, x) result(volume)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Positions, mm: `x(3,n_node)`.
    real(wp), intent(in) :: x(3, element%n_node)

    real(wp) :: j(3, 3)
    integer :: p

    volume = 0.0_wp
    do p = 1, element%n_point
      j = matmul(x, transpose(element%dshape(:, :, p)))
      volume = volume + element%weight(p)*( &
               j(1, 1)*(j(2, 2)*j(3, 3) - j(2, 3)*j(3, 2)) &
               + j(1, 2)*(j(2, 3)*j(3, 1) - j(2, 1)*j(3, 3)) &
               + j(1, 3)*(j(2, 1)*j(3, 2) - j(2, 2)*j(3, 1)))
    end do
  end function element_volume

end module dd3_element_field
