! SPDX-License-Identifier: GPL-3.0-or-later
!> First-order strain and rotation increments of a trial displacement at the points, for the limits
!> on the increment.
module dd3_element_rate
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : kelvin_from_tensor
  implicit none
  private
  public :: element_rate

contains

  !> Evaluate strain increments in the material frame, with the mean dilatation, and rotations; call
  !> `element_gradients` first.
  subroutine element_rate(element, du, rotation_committed, work)
    type(element_t), intent(in) :: element
    !> Trial displacement, mm.
    real(wp), intent(in) :: du(:, :)
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    !> Sets `strain_increment` and `rotation_increment`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: l(3, 3), q(3, 3), excess
    real(wp) :: mean(element%n_group)
    integer :: g, i, p

    do g = 1, element%n_group
      mean(g) = mean_dilatation(element%n_node, du, work%mean_gradient(:, :, g))
    end do
    do p = 1, element%n_point
      g = element%group(p)
      l = displacement_gradient(element%n_node, du, work%gradient(:, :, p))
      work%rotation_increment(p) = 0.5_wp*norm2([l(3, 2) - l(2, 3), l(1, 3) - l(3, 1), &
          l(2, 1) - l(1, 2)])
      l = 0.5_wp*(l + transpose(l))
      if (g > 0) then
        excess = l(1, 1) + l(2, 2) + l(3, 3)
        if (allocated(element%projection)) then
          excess = (dot_product(work%fraction(p, :), mean) - excess)/3.0_wp
        else
          excess = (mean(g) - excess)/3.0_wp
        end if
        do i = 1, 3
          l(i, i) = l(i, i) + excess
        end do
      end if
      q = rotation_committed(:, :, p)
      work%strain_increment(:, p) = kelvin_from_tensor(matmul(transpose(q), matmul(l, q)))
    end do
  end subroutine element_rate

  !> Return the displacement gradient, the sum of u_a (x) G_a.
  pure function displacement_gradient(n_node, du, gradient) result(l)
    integer, intent(in) :: n_node
    !> Displacements, mm.
    real(wp), intent(in) :: du(3, n_node)
    !> Gradients of the shape functions, 1/mm.
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

  !> Return the trace of the group's mean displacement gradient.
  pure function mean_dilatation(n_node, du, mean_gradient) result(dilatation)
    integer, intent(in) :: n_node
    !> Displacements, mm.
    real(wp), intent(in) :: du(3, n_node)
    !> Mean gradients of the shape functions, 1/mm.
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
