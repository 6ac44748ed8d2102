! SPDX-License-Identifier: GPL-3.0-or-later
!> Kinematics of an element: gradients in the trial configuration, their means over the groups that
!> share a mean dilatation, volumes, and the deformation gradient of the increment. Mean dilatation
!> after Nagtegaal, Parks & Rice (1974): det F is replaced by J_0 = v/V of the group, with the mean
!> gradient g_a = (1/v) sum w j G_a.
module dd3_element_kinematics
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_inverted
  use dd3_element_projection, only : project_dilatations, project_gradients
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : determinant
  implicit none
  private
  public :: element_kinematics, element_gradients, point_volumes

contains

  !> Evaluate the kinematics of an increment.
  subroutine element_kinematics(element, x_committed, x_trial, work, verdict)
    type(element_t), intent(in) :: element
    !> Committed and trial positions of the nodes, mm.
    real(wp), intent(in) :: x_committed(3, element%n_node), x_trial(3, element%n_node)
    !> Sets gradients, weights, volumes, deformation gradients and dilatations.
    type(element_work_t), intent(inout) :: work
    !> Retry, with the point, if a Jacobian determinant is not positive.
    type(verdict_t), intent(out) :: verdict

    integer :: bad_point

    call element_gradients(element, x_trial, work, verdict)
    if (verdict%outcome /= verdict_converged) return
    associate (n => element%n_node, m => element%n_point)
      if (n == 8 .and. m == 8) then
        call jacobians(24, 8, element%slope, x_committed, work%jacobian_committed)
      else
        call jacobians(3*m, n, element%slope, x_committed, work%jacobian_committed)
      end if
      call deformation_gradients(m, element%weight, work%jacobian_committed, work%jacobian, &
          work%deformation, work%weight_committed, bad_point)
      if (bad_point > 0) then
        call record_failure(verdict, bad_point)
        return
      end if
      if (allocated(element%projection)) then
        call project_dilatations(m, element%n_group, element%projection, work, bad_point)
        if (bad_point > 0) call record_failure(verdict, bad_point)
      else
        call dilatations(m, element%n_group, element%group, work)
      end if
    end associate
  end subroutine element_kinematics

  !> Evaluate gradients, weights and volumes in one configuration.
  subroutine element_gradients(element, x, work, verdict)
    type(element_t), intent(in) :: element
    !> Positions of the nodes, mm.
    real(wp), intent(in) :: x(3, element%n_node)
    !> Sets `gradient`, `mean_gradient`, `weight` and `volume`.
    type(element_work_t), intent(inout) :: work
    !> Retry, with the point, if a Jacobian determinant is not positive.
    type(verdict_t), intent(out) :: verdict

    integer :: bad_point

    associate (n => element%n_node, m => element%n_point, g => element%n_group)
      ! Constant sizes let the compiler specialise each kernel for hex8.
      if (n == 8 .and. m == 8 .and. g == 1) then
        call jacobians(24, 8, element%slope, x, work%jacobian)
        call gradients(8, 8, element%slope_row, element%weight, work%jacobian, work%gradient, &
            work%weight, bad_point)
        if (bad_point == 0) call mean_gradients(24, 8, 1, element%group, work%weight, &
            work%gradient, work%mean_gradient, work%volume)
      else
        call jacobians(3*m, n, element%slope, x, work%jacobian)
        call gradients(n, m, element%slope_row, element%weight, work%jacobian, work%gradient, &
            work%weight, bad_point)
        if (bad_point > 0) then
          continue
        else if (allocated(element%projection)) then
          call project_gradients(3*n, m, g, element%projection, work, bad_point)
        else
          call mean_gradients(3*n, m, g, element%group, work%weight, work%gradient, &
              work%mean_gradient, work%volume)
        end if
      end if
    end associate
    verdict%outcome = verdict_converged
    if (bad_point > 0) call record_failure(verdict, bad_point)
  end subroutine element_gradients

  !> Evaluate the volumes that the points stand for in one configuration.
  pure subroutine point_volumes(element, x, volume)
    type(element_t), intent(in) :: element
    !> Positions of the nodes, mm.
    real(wp), intent(in) :: x(3, element%n_node)
    !> mm3.
    real(wp), intent(out) :: volume(element%n_point)

    real(wp) :: jacobian(3, element%n_point, 3), matrix(3, 3)
    integer :: p

    associate (n => element%n_node, m => element%n_point)
      if (n == 8 .and. m == 8) then
        call jacobians(24, 8, element%slope, x, jacobian)
      else
        call jacobians(3*m, n, element%slope, x, jacobian)
      end if
      do p = 1, m
        matrix = transpose(jacobian(:, p, :))
        volume(p) = element%weight(p)*determinant(matrix)
      end do
    end associate
  end subroutine point_volumes

  !> Record the point whose Jacobian determinant is not positive.
  subroutine record_failure(verdict, point)
    type(verdict_t), intent(inout) :: verdict
    integer, intent(in) :: point

    verdict%outcome = verdict_retry
    verdict%cause = cause_inverted
    verdict%point = point
  end subroutine record_failure

  !> Evaluate dx/dxi at all points: `jacobian(q,i)`, q over natural directions and points.
  pure subroutine jacobians(n_slope, n_node, slope, x, jacobian)
    !> Three times the number of points, number of nodes.
    integer, intent(in) :: n_slope, n_node
    !> Derivatives of the shape functions.
    real(wp), intent(in) :: slope(n_slope, n_node)
    !> Positions, mm.
    real(wp), intent(in) :: x(3, n_node)
    !> dx/dxi, mm.
    real(wp), intent(out) :: jacobian(n_slope, 3)

    integer :: a, i

    jacobian = 0.0_wp
    do i = 1, 3
      do a = 1, n_node
        jacobian(:, i) = jacobian(:, i) + slope(:, a)*x(i, a)
      end do
    end do
  end subroutine jacobians

  !> Kernel: evaluate G_a = (dN_a/dxi)(dxi/dx) and w j at all points.
  pure subroutine gradients(n_node, n_point, slope, weight, jacobian, gradient, volume_weight, &
      bad_point)
    integer, intent(in) :: n_node, n_point
    !> Derivatives of the shape functions.
    real(wp), intent(in) :: slope(n_node, 3, n_point)
    !> Quadrature weights.
    real(wp), intent(in) :: weight(n_point)
    !> dx/dxi, mm.
    real(wp), intent(in) :: jacobian(3, n_point, 3)
    !> Gradients of the shape functions, 1/mm.
    real(wp), intent(out) :: gradient(n_node, 3, n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(out) :: volume_weight(n_point)
    !> First point whose determinant is not positive, or 0.
    integer, intent(out) :: bad_point

    real(wp) :: inverse(3, 3), det
    integer :: a, i, p

    bad_point = 0
    do p = 1, n_point
      call invert_transposed(jacobian(:, p, 1), jacobian(:, p, 2), jacobian(:, p, 3), inverse, det)
      if (.not. det > 0.0_wp) then
        bad_point = p
        return
      end if
      volume_weight(p) = weight(p)*det
      do i = 1, 3
        do a = 1, n_node
          gradient(a, i, p) = slope(a, 1, p)*inverse(1, i) + slope(a, 2, p)*inverse(2, i) &
              + slope(a, 3, p)*inverse(3, i)
        end do
      end do
    end do
  end subroutine gradients

  !> Invert the matrix with the rows a, b, c; zero if the determinant is not positive.
  pure subroutine invert_transposed(a, b, c, inverse, det)
    real(wp), intent(in) :: a(3), b(3), c(3)
    real(wp), intent(out) :: inverse(3, 3)
    real(wp), intent(out) :: det

    real(wp) :: u(3), v(3), w(3), factor

    u = [b(2)*c(3) - b(3)*c(2), b(3)*c(1) - b(1)*c(3), b(1)*c(2) - b(2)*c(1)]
    v = [c(2)*a(3) - c(3)*a(2), c(3)*a(1) - c(1)*a(3), c(1)*a(2) - c(2)*a(1)]
    w = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
    det = a(1)*u(1) + a(2)*u(2) + a(3)*u(3)
    factor = 0.0_wp
    if (det > 0.0_wp) factor = 1.0_wp/det
    inverse(:, 1) = u*factor
    inverse(:, 2) = v*factor
    inverse(:, 3) = w*factor
  end subroutine invert_transposed

  !> Kernel: evaluate the volume and mean gradients of each group.
  pure subroutine mean_gradients(n_entry, n_point, n_group, group, weight, gradient, &
      mean_gradient, volume)
    !> Three times the number of nodes, number of points and of groups.
    integer, intent(in) :: n_entry, n_point, n_group
    !> Group of each point, or 0.
    integer, intent(in) :: group(n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(in) :: weight(n_point)
    !> Gradients of the shape functions, 1/mm.
    real(wp), intent(in) :: gradient(n_entry, n_point)
    !> Means of the gradients, 1/mm.
    real(wp), intent(out) :: mean_gradient(n_entry, n_group)
    !> Volumes, mm3.
    real(wp), intent(out) :: volume(n_group)

    integer :: g, p

    volume = 0.0_wp
    mean_gradient = 0.0_wp
    do p = 1, n_point
      g = group(p)
      if (g == 0) cycle
      volume(g) = volume(g) + weight(p)
      mean_gradient(:, g) = mean_gradient(:, g) + weight(p)*gradient(:, p)
    end do
    do g = 1, n_group
      mean_gradient(:, g) = mean_gradient(:, g)/volume(g)
    end do
  end subroutine mean_gradients

  !> Evaluate F = (dx_trial/dxi)(dxi/dx_committed) and w j of the committed configuration.
  pure subroutine deformation_gradients(n_point, weight, committed, trial, deformation, &
      weight_committed, bad_point)
    integer, intent(in) :: n_point
    !> Quadrature weights.
    real(wp), intent(in) :: weight(n_point)
    !> dx/dxi in both configurations, mm.
    real(wp), intent(in) :: committed(3, n_point, 3), trial(3, n_point, 3)
    real(wp), intent(out) :: deformation(3, 3, n_point)
    !> Weight times Jacobian of the committed configuration, mm3.
    real(wp), intent(out) :: weight_committed(n_point)
    !> First point whose determinant is not positive, or 0.
    integer, intent(out) :: bad_point

    real(wp) :: inverse(3, 3), det
    integer :: i, j, p

    bad_point = 0
    do p = 1, n_point
      call invert_transposed(committed(:, p, 1), committed(:, p, 2), committed(:, p, 3), inverse, &
          det)
      if (.not. det > 0.0_wp) then
        bad_point = p
        return
      end if
      weight_committed(p) = weight(p)*det
      do j = 1, 3
        do i = 1, 3
          deformation(i, j, p) = trial(1, p, i)*inverse(1, j) + trial(2, p, i)*inverse(2, j) &
              + trial(3, p, i)*inverse(3, j)
        end do
      end do
    end do
  end subroutine deformation_gradients

  !> Evaluate the dilatation of each point: v/V of its group, or its own.
  pure subroutine dilatations(n_point, n_group, group, work)
    integer, intent(in) :: n_point, n_group
    !> Group of each point, or 0.
    integer, intent(in) :: group(n_point)
    !> Sets `volume_committed` and `dilatation`.
    type(element_work_t), intent(inout) :: work

    integer :: g, p

    work%volume_committed(1:n_group) = 0.0_wp
    do p = 1, n_point
      g = group(p)
      if (g == 0) cycle
      work%volume_committed(g) = work%volume_committed(g) + work%weight_committed(p)
    end do
    do p = 1, n_point
      g = group(p)
      if (g > 0) then
        work%dilatation(p) = work%volume(g)/work%volume_committed(g)
      else
        work%dilatation(p) = work%weight(p)/work%weight_committed(p)
      end if
    end do
  end subroutine dilatations

end module dd3_element_kinematics
