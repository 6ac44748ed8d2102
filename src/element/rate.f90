!> Strain and rotation of a trial displacement at the points, to first order, for the limits on the
!> step.
module dd3_element_rate
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : kelvin_from_tensor
  implicit none
  private
  public :: element_rate

contains

  !> Strain increments in the material frame, with the mean dilatation, and rotations, after
  !> `element_gradients`.
  subroutine element_rate(element, du, rotation, work)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Trial displacement, mm: `du(3,n_node)`.
    real(wp), intent(in) :: du(3, element%n_node)
    !> Material axes as columns: `rotation(3,3,n_point)`.
    real(wp), intent(in) :: rotation(3, 3, element%n_point)
    !> `strain_increment` and `rotation_increment` are set.
    type(element_work_t), intent(inout) :: work

    real(wp) :: l(3, 3), q(3, 3), own
    integer :: g, i, p

    do p = 1, element%n_point
      g = element%group(p)
      l = displacement_gradient(element%n_node, du, work%gradient(:, :, p))
      work%rotation_increment(p) = 0.5_wp*norm2([l(3, 2) - l(2, 3), l(1, 3) - l(3, 1), &
                                                 l(2, 1) - l(1, 2)])
      l = 0.5_wp*(l + transpose(l))
      if (g > 0) then
        own = l(1, 1) + l(2, 2) + l(3, 3)
        own = (mean_dilatation(element%n_node, du, work%mean_gradient(:, :, g)) - own)/3.0_wp
        do i = 1, 3
          l(i, i) = l(i, i) + own
        end do
      end if
      q = rotation(:, :, p)
      work%strain_increment(:, p) = kelvin_from_tensor(matmul(transpose(q), matmul(l, q)))
    end do
  end subroutine element_rate

  !> Sum of u_a times G_a.
  pure function displacement_gradient(n_node, du, gradient) result(l)
    !> Number of nodes.
    integer, intent(in) :: n_node
    !> Displacements, mm.
    real(wp), intent(in) :: du(3, n_node)
    !> Gradients, 1/mm.
    real(wp), intent(in) :: gradient(n_node, 3)
    real(wp) :: l(3, 3)

    integer :: a, j

    l = 0.0_wp
    do a = 1, n_node
      do j = 1, 3
        l(:, j) = l(:, j) + du(:, a)*gradient(a, j)
      end do
    end do
  end function displacement_gradient

  !> Trace of the mean displacement gradient.
  pure function mean_dilatation(n_node, du, mean_gradient) result(dilatation)
    !> Number of nodes.
    integer, intent(in) :: n_node
    !> Displacements, mm.
    real(wp), intent(in) :: du(3, n_node)
    !> Mean gradients, 1/mm.
    real(wp), intent(in) :: mean_gradient(n_node, 3)
    real(wp) :: dilatation

    integer :: a

    dilatation = 0.0_wp
    do a = 1, n_node
      dilatation = dilatation + du(1, a)*mean_gradient(a, 1) + du(2, a)*mean_gradient(a, 2) &
                   + du(3, a)*mean_gradient(a, 3)
    end do
  end function mean_dilatation

end module dd3_element_rate
