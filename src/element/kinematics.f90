!> Kinematics of an element: gradients at the current configuration, their means over the groups
!> that share a mean dilatation, volumes, and the deformation gradient of the increment. Mean
!> dilatation after Nagtegaal, Parks & Rice (1974): J_0 = v/V of the group replaces det F, and g_a =
!> (1/v) sum w j G_a goes with it.
module dd3_element_kinematics
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: element_kinematics, element_gradients

contains

  !> All kinematics of an increment that moves the nodes from `x_old` to `x_new`.
  subroutine element_kinematics(element, x_old, x_new, work, verdict)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Positions at the start of the increment, mm: `x_old(3,n_node)`.
    real(wp), intent(in) :: x_old(3, element%n_node)
    !> Positions now, mm: `x_new(3,n_node)`.
    real(wp), intent(in) :: x_new(3, element%n_node)
    !> Gradients, weights, volumes, deformation gradients and dilatations are set.
    type(element_work_t), intent(inout) :: work
    !> Retry, with the point, where an element is turned inside out.
    type(verdict_t), intent(out) :: verdict

    integer :: bad_point

    call element_gradients(element, x_new, work, verdict)
    if (verdict%outcome /= verdict_converged) return
    associate (n => element%n_node, m => element%n_point)
      if (n == 8 .and. m == 8) then
        call jacobians(24, 8, element%slope, x_old, work%jacobian_old)
      else
        call jacobians(3*m, n, element%slope, x_old, work%jacobian_old)
      end if
      call deform(m, element%weight, work%jacobian_old, work%jacobian, work%deformation, &
                  work%weight_old, bad_point)
      if (bad_point > 0) then
        call blame(verdict, bad_point)
        return
      end if
      call dilate(m, element%n_group, element%group, work)
    end associate
  end subroutine element_kinematics

  !> Gradients, weights and volumes at one configuration.
  subroutine element_gradients(element, x, work, verdict)
    !> The element's table.
    type(element_t), intent(in) :: element
    !> Positions, mm: `x(3,n_node)`.
    real(wp), intent(in) :: x(3, element%n_node)
    !> `gradient`, `mean_gradient`, `weight` and `volume` are set.
    type(element_work_t), intent(inout) :: work
    !> Retry, with the point, where an element is turned inside out.
    type(verdict_t), intent(out) :: verdict

    integer :: bad_point

    associate (n => element%n_node, m => element%n_point, g => element%n_group)
      ! Constant sizes let the compiler make a copy of each kernel for the commonest element.
      if (n == 8 .and. m == 8 .and. g == 1) then
        call jacobians(24, 8, element%slope, x, work%jacobian)
        call invert(8, 8, element%slope_row, element%weight, work%jacobian, work%gradient, &
                    work%weight, bad_point)
        if (bad_point == 0) call average(24, 8, 1, element%group, work%weight, work%gradient, &
                                         work%mean_gradient, work%volume)
      else
        call jacobians(3*m, n, element%slope, x, work%jacobian)
        call invert(n, m, element%slope_row, element%weight, work%jacobian, work%gradient, &
                    work%weight, bad_point)
        if (bad_point == 0) call average(3*n, m, g, element%group, work%weight, work%gradient, &
                                         work%mean_gradient, work%volume)
      end if
    end associate
    verdict%outcome = verdict_converged
    if (bad_point > 0) call blame(verdict, bad_point)
  end subroutine element_gradients

  !> Says which point is turned inside out.
  subroutine blame(verdict, point)
    !> The verdict.
    type(verdict_t), intent(inout) :: verdict
    !> The point.
    integer, intent(in) :: point

    verdict%outcome = verdict_retry
    verdict%reason = "an element is turned inside out"
    verdict%point = point
  end subroutine blame

  !> dx/dxi at all points: `jacobian(q,i)` with q running over natural direction and point.
  pure subroutine jacobians(n_slope, n_node, slope, x, jacobian)
    !> Three times the number of points, number of nodes.
    integer, intent(in) :: n_slope, n_node
    !> Derivatives of the shape functions.
    real(wp), intent(in) :: slope(n_slope, n_node)
    !> Positions, mm.
    real(wp), intent(in) :: x(3, n_node)
    !> The derivatives of the positions, mm.
    real(wp), intent(out) :: jacobian(n_slope, 3)

    real(wp) :: total
    integer :: a, i, q

    do i = 1, 3
      do q = 1, n_slope
        total = 0.0_wp
        do a = 1, n_node
          total = total + slope(q, a)*x(i, a)
        end do
        jacobian(q, i) = total
      end do
    end do
  end subroutine jacobians

  !> G_a = (dN_a/dxi)(dxi/dx) and w j at all points.
  pure subroutine invert(n_node, n_point, slope, weight, jacobian, gradient, volume_weight, &
                         bad_point)
    !> Sizes.
    integer, intent(in) :: n_node, n_point
    !> Derivatives of the shape functions.
    real(wp), intent(in) :: slope(n_node, 3, n_point)
    !> Quadrature weights.
    real(wp), intent(in) :: weight(n_point)
    !> dx/dxi, mm.
    real(wp), intent(in) :: jacobian(3, n_point, 3)
    !> Gradients, 1/mm.
    real(wp), intent(out) :: gradient(n_node, 3, n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(out) :: volume_weight(n_point)
    !> First point where the determinant is not positive, 0 where all are.
    integer, intent(out) :: bad_point

    real(wp) :: inverted(3, 3), det
    integer :: a, i, p

    bad_point = 0
    do p = 1, n_point
      call invert_transposed(jacobian(:, p, 1), jacobian(:, p, 2), jacobian(:, p, 3), inverted, det)
      if (.not. det > 0.0_wp) then
        bad_point = p
        return
      end if
      volume_weight(p) = weight(p)*det
      do i = 1, 3
        do a = 1, n_node
          gradient(a, i, p) = slope(a, 1, p)*inverted(1, i) + slope(a, 2, p)*inverted(2, i) &
                              + slope(a, 3, p)*inverted(3, i)
        end do
      end do
    end do
  end subroutine invert

  !> Inverse of the matrix whose rows are a, b, c; left alone where the determinant is not positive.
  pure subroutine invert_transposed(a, b, c, inverted, det)
    !> Rows.
    real(wp), intent(in) :: a(3), b(3), c(3)
    !> The inverse.
    real(wp), intent(out) :: inverted(3, 3)
    !> The determinant.
    real(wp), intent(out) :: det

    real(wp) :: u(3), v(3), w(3), factor

    u = [b(2)*c(3) - b(3)*c(2), b(3)*c(1) - b(1)*c(3), b(1)*c(2) - b(2)*c(1)]
    v = [c(2)*a(3) - c(3)*a(2), c(3)*a(1) - c(1)*a(3), c(1)*a(2) - c(2)*a(1)]
    w = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
    det = a(1)*u(1) + a(2)*u(2) + a(3)*u(3)
    factor = 0.0_wp
    if (det > 0.0_wp) factor = 1.0_wp/det
    inverted(:, 1) = u*factor
    inverted(:, 2) = v*factor
    inverted(:, 3) = w*factor
  end subroutine invert_transposed

  !> Volume and mean gradients of each group.
  pure subroutine average(n_entry, n_point, n_group, group, weight, gradient, mean_gradient, volume)
    !> Three times the number of nodes, number of points and of groups.
    integer, intent(in) :: n_entry, n_point, n_group
    !> Group of each point.
    integer, intent(in) :: group(n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(in) :: weight(n_point)
    !> Gradients, 1/mm.
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
  end subroutine average

  !> F = (dx_new/dxi)(dxi/dx_old) and w j at the start of the increment.
  pure subroutine deform(n_point, weight, old, new, deformation, weight_old, bad_point)
    !> Number of points.
    integer, intent(in) :: n_point
    !> Quadrature weights.
    real(wp), intent(in) :: weight(n_point)
    !> dx/dxi at the start of the increment and now, mm.
    real(wp), intent(in) :: old(3, n_point, 3), new(3, n_point, 3)
    !> Deformation gradients.
    real(wp), intent(out) :: deformation(3, 3, n_point)
    !> Weight times Jacobian, mm3.
    real(wp), intent(out) :: weight_old(n_point)
    !> First point where the determinant is not positive, 0 where all are.
    integer, intent(out) :: bad_point

    real(wp) :: inverted(3, 3), det
    integer :: i, j, p

    bad_point = 0
    do p = 1, n_point
      call invert_transposed(old(:, p, 1), old(:, p, 2), old(:, p, 3), inverted, det)
      if (.not. det > 0.0_wp) then
        bad_point = p
        return
      end if
      weight_old(p) = weight(p)*det
      do j = 1, 3
        do i = 1, 3
          deformation(i, j, p) = new(1, p, i)*inverted(1, j) + new(2, p, i)*inverted(2, j) &
                                 + new(3, p, i)*inverted(3, j)
        end do
      end do
    end do
  end subroutine deform

  !> The dilatation that the material sees: v/V of the point's group, or its own.
  pure subroutine dilate(n_point, n_group, group, work)
    !> Sizes.
    integer, intent(in) :: n_point, n_group
    !> Group of each point.
    integer, intent(in) :: group(n_point)
    !> `volume_old` and `dilatation` are set.
    type(element_work_t), intent(inout) :: work

    integer :: g, p

    work%volume_old(1:n_group) = 0.0_wp
    do p = 1, n_point
      g = group(p)
      if (g > 0) work%volume_old(g) = work%volume_old(g) + work%weight_old(p)
    end do
    do p = 1, n_point
      g = group(p)
      if (g > 0) then
        work%dilatation(p) = work%volume(g)/work%volume_old(g)
      else
        work%dilatation(p) = work%weight(p)/work%weight_old(p)
      end if
    end do
  end subroutine dilate

end module dd3_element_kinematics
