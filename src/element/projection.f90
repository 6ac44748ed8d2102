! SPDX-License-Identifier: GPL-3.0-or-later
!> Kinematics of elements whose dilatation is projected on functions N_k of the natural coordinates
!> (Hughes 1980, B-bar; Nagtegaal, Parks & Rice 1974). With a_pk = N_k at point p, the groups have
!> the volumes v_k = sum_p a_pk w j, V_k when committed, and the dilatation of the increment at a
!> point is theta_p = sum_k a_pk v_k/V_k. Its relative change is sum_k c_pk g_k.du, with the
!> fractions c_pk = a_pk (v_k/V_k)/theta_p and the mean gradients g_k = (1/v_k) sum_p a_pk w j G.
module dd3_element_projection
  use dd3_base_kinds, only : wp
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: project_gradients, project_dilatations, project_mean_stress

contains

  !> Evaluate the volume and mean gradients of each group, and the fractions of no increment.
  pure subroutine project_gradients(n_entry, n_point, n_group, projection, work, bad_point)
    !> Three times the number of nodes, number of points and of groups.
    integer, intent(in) :: n_entry, n_point, n_group
    !> a_pk.
    real(wp), intent(in) :: projection(n_point, n_group)
    !> Holds `gradient` and `weight`; sets `mean_gradient`, `volume` and `fraction`.
    type(element_work_t), intent(inout) :: work
    !> Point nearest to a group whose volume is not positive, or 0.
    integer, intent(out) :: bad_point

    real(wp) :: factor(n_point, n_group)
    integer :: k

    bad_point = 0
    do k = 1, n_group
      factor(:, k) = work%weight*projection(:, k)
      work%volume(k) = sum(factor(:, k))
      if (.not. work%volume(k) > 0.0_wp) then
        bad_point = maxloc(projection(:, k), dim=1)
        return
      end if
      factor(:, k) = factor(:, k)/work%volume(k)
    end do
    call mean_gradients(n_entry, n_point, n_group, factor, work%gradient, work%mean_gradient)
    work%fraction(:, :) = projection
  end subroutine project_gradients

  !> Kernel: sum the gradients with the factors of each group.
  pure subroutine mean_gradients(n_entry, n_point, n_group, factor, gradient, mean_gradient)
    integer, intent(in) :: n_entry, n_point, n_group
    !> a_pk w j/v_k.
    real(wp), intent(in) :: factor(n_point, n_group)
    !> Gradients of the shape functions and their means, 1/mm.
    real(wp), intent(in) :: gradient(n_entry, n_point)
    real(wp), intent(out) :: mean_gradient(n_entry, n_group)

    integer :: k, p

    mean_gradient = 0.0_wp
    do k = 1, n_group
      do p = 1, n_point
        mean_gradient(:, k) = mean_gradient(:, k) + factor(p, k)*gradient(:, p)
      end do
    end do
  end subroutine mean_gradients

  !> Evaluate the dilatation of each point and the fractions of the groups in its change.
  pure subroutine project_dilatations(n_point, n_group, projection, work, bad_point)
    integer, intent(in) :: n_point, n_group
    !> a_pk.
    real(wp), intent(in) :: projection(n_point, n_group)
    !> Holds `weight_committed` and `volume`; sets `volume_committed`, `dilatation` and `fraction`.
    type(element_work_t), intent(inout) :: work
    !> Point whose dilatation, or nearest to a group whose volume is not positive; or 0.
    integer, intent(out) :: bad_point

    integer :: k, p

    bad_point = 0
    do k = 1, n_group
      work%volume_committed(k) = dot_product(work%weight_committed, projection(:, k))
      if (.not. work%volume_committed(k) > 0.0_wp) then
        bad_point = maxloc(projection(:, k), dim=1)
        return
      end if
      work%fraction(:, k) = projection(:, k)*(work%volume(k)/work%volume_committed(k))
    end do
    do p = 1, n_point
      work%dilatation(p) = sum(work%fraction(p, :))
      if (.not. work%dilatation(p) > 0.0_wp) then
        bad_point = p
        return
      end if
      work%fraction(p, :) = work%fraction(p, :)/work%dilatation(p)
    end do
  end subroutine project_dilatations

  !> Evaluate Pi_k = sum_p c_pk w j tr T/3 of each group.
  pure subroutine project_mean_stress(n_point, work)
    integer, intent(in) :: n_point
    !> Holds `cauchy`, `weight` and `fraction`; sets `mean_stress_integral`.
    type(element_work_t), intent(inout) :: work

    integer :: p

    work%mean_stress_integral = 0.0_wp
    do p = 1, n_point
      associate (t => work%cauchy(:, :, p))
        work%mean_stress_integral = work%mean_stress_integral + work%fraction(p, :) &
            *(work%weight(p)*(t(1, 1) + t(2, 2) + t(3, 3))/3.0_wp)
      end associate
    end do
  end subroutine project_mean_stress

end module dd3_element_projection
