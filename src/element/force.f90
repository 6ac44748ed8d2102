! SPDX-License-Identifier: GPL-3.0-or-later
!> Internal forces of an element: f_a = sum w j (s G_a + pi g_a), s and pi the deviator and the mean
!> of the Cauchy stress, g_a the group's mean gradient; sum w j T G_a for points without a group.
!> With a projection of the dilatation the sum of pi g_a is that of Pi_k g_a,k over its groups.
module dd3_element_force
  use dd3_base_kinds, only : half_sqrt2, wp
  use dd3_element_projection, only : project_mean_stress
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: element_cauchy, element_force, global_tensor

contains

  !> Transform the stresses to the global frame; call `element_strain` and set `work%stress` first.
  subroutine element_cauchy(element, work)
    type(element_t), intent(in) :: element
    !> Sets `cauchy` and `mean_stress_integral`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: s(3, 3)
    integer :: g, p

    work%mean_stress_integral = 0.0_wp
    do p = 1, element%n_point
      work%cauchy(:, :, p) = global_tensor(work%stress(:, p), work%rotation(:, :, p))
      g = element%group(p)
      if (g == 0) cycle
      s = work%weight(p)*work%cauchy(:, :, p)
      work%mean_stress_integral(g) = work%mean_stress_integral(g) &
          + (s(1, 1) + s(2, 2) + s(3, 3))/3.0_wp
    end do
    if (allocated(element%projection)) call project_mean_stress(element%n_point, work)
  end subroutine element_cauchy

  !> Evaluate the internal forces; call `element_cauchy` first.
  subroutine element_force(element, work)
    type(element_t), intent(in) :: element
    !> Sets `force`.
    type(element_work_t), intent(inout) :: work

    if (element%n_node == 8 .and. element%n_point == 8 .and. element%n_group == 1) then
      call add_forces(8, 8, 1, element%group, work%weight, work%cauchy, work%gradient, &
          work%mean_gradient, work%mean_stress_integral, work%force)
    else
      call add_forces(element%n_node, element%n_point, element%n_group, element%group, &
          work%weight, work%cauchy, work%gradient, work%mean_gradient, &
          work%mean_stress_integral, work%force)
    end if
  end subroutine element_force

  !> Return Q T Q^T, the global components of a tensor given in the material frame.
  pure function global_tensor(stress, q) result(cauchy)
    !> Tensor in the material frame, Kelvin.
    real(wp), intent(in) :: stress(6)
    !> Material axes as columns.
    real(wp), intent(in) :: q(3, 3)
    real(wp) :: cauchy(3, 3)

    real(wp) :: qt(3, 3), s(4:6)
    integer :: j

    s = half_sqrt2*stress(4:6)
    qt(:, 1) = q(:, 1)*stress(1) + q(:, 2)*s(6) + q(:, 3)*s(5)
    qt(:, 2) = q(:, 1)*s(6) + q(:, 2)*stress(2) + q(:, 3)*s(4)
    qt(:, 3) = q(:, 1)*s(5) + q(:, 2)*s(4) + q(:, 3)*stress(3)
    do j = 1, 3
      cauchy(:, j) = qt(:, 1)*q(j, 1) + qt(:, 2)*q(j, 2) + qt(:, 3)*q(j, 3)
    end do
  end function global_tensor

  !> Kernel: sum the forces over the points.
  pure subroutine add_forces(n_node, n_point, n_group, group, weight, cauchy, gradient, &
      mean_gradient, mean_stress_integral, force)
    integer, intent(in) :: n_node, n_point, n_group
    !> Group of each point, or 0.
    integer, intent(in) :: group(n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(in) :: weight(n_point)
    !> Cauchy stress, MPa, global frame.
    real(wp), intent(in) :: cauchy(3, 3, n_point)
    !> Gradients of the shape functions and their group means, 1/mm.
    real(wp), intent(in) :: gradient(n_node, 3, n_point), mean_gradient(n_node, 3, n_group)
    !> Volume integral of the mean stress of each group, N mm.
    real(wp), intent(in) :: mean_stress_integral(n_group)
    !> Forces, N.
    real(wp), intent(out) :: force(3, n_node)

    real(wp) :: by_node(n_node, 3), s(3, 3), mean
    integer :: g, i, p

    by_node = 0.0_wp
    do p = 1, n_point
      s = weight(p)*cauchy(:, :, p)
      if (group(p) > 0) then
        mean = (s(1, 1) + s(2, 2) + s(3, 3))/3.0_wp
        do i = 1, 3
          s(i, i) = s(i, i) - mean
        end do
      end if
      do i = 1, 3
        by_node(:, i) = by_node(:, i) + s(i, 1)*gradient(:, 1, p) + s(i, 2)*gradient(:, 2, p) &
            + s(i, 3)*gradient(:, 3, p)
      end do
    end do
    do g = 1, n_group
      by_node = by_node + mean_stress_integral(g)*mean_gradient(:, :, g)
    end do
    force = transpose(by_node)
  end subroutine add_forces

end module dd3_element_force
