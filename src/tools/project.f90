! SPDX-License-Identifier: GPL-3.0-or-later
!> Closest-point projection of a node on a patch: Newton's method on half the squared distance,
!> within bounds of the parameters.
!>
!> phi(u,v) = |S(u,v) - x|^2 / 2, gradient g_a = (S - x).S_a, Hessian
!> h_ab = S_a.S_b + (S - x).S_ab. Bounds at which -g points outwards are active. If the Hessian is
!> not positive definite, its Gauss-Newton part S_a.S_b, the metric, is used. Steps are cut at the
!> bounds and halved until phi decreases (Armijo). If this fails, the iteration restarts from the
!> best point of a 33 x 33 grid; if that fails too, the grid point is improved by golden sections.
!> For a parallelogram phi is quadratic and solved directly. Source: Bertsekas, SIAM J. Control
!> Optim. 20 (1982) 221-246 (projected Newton); Armijo, Pacific J. Math. 16 (1966) 1-3.
module dd3_tools_project
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t, n_sample
  use dd3_tools_golden_section, only : best_of_grid, project_by_sections
  use dd3_tools_projection, only : projection_t, evaluate_projection
  implicit none
  private
  public :: project, project_globally

  !> Largest numbers of Newton iterations and of halvings of a step.
  integer, parameter :: most_iterations = 30, most_halvings = 20
  !> Converged if each gradient component is below this, relative to its factors.
  real(wp), parameter :: gradient_tolerance = 1.0e-14_wp
  !> Converged if the steps of the parameters are below this.
  real(wp), parameter :: step_tolerance = 1.0e-15_wp

contains

  !> Find the closest point near a known one.
  pure subroutine project(patch, x, lower, upper, projection, iterations)
    type(patch_t), intent(in) :: patch
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> `uv` is the initial point on entry.
    type(projection_t), intent(inout) :: projection
    !> Newton iterations from the initial point.
    integer, intent(out), optional :: iterations

    real(wp) :: relative(3)
    integer :: taken
    logical :: ok

    relative = x - patch%centre
    if (present(iterations)) iterations = 0
    if (patch%flat) then
      call project_flat(patch, relative, lower, upper, projection)
      return
    end if
    call newton(patch, relative, lower, upper, projection, taken, ok)
    if (present(iterations)) iterations = taken
    if (ok) return
    call best_of_grid(patch, relative, lower, upper, projection%uv)
    call newton(patch, relative, lower, upper, projection, taken, ok)
    if (.not. ok) call project_by_sections(patch, x, lower, upper, projection)
  end subroutine project

  !> Find the closest point of the whole patch, from the local minima of the stored grid.
  pure subroutine project_globally(patch, x, lower, upper, projection)
    type(patch_t), intent(in) :: patch
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    type(projection_t), intent(out) :: projection

    type(projection_t) :: other
    real(wp) :: square(0:n_sample, 0:n_sample), relative(3), cell
    integer :: i, j, n, start(2)

    projection%uv = 0.5_wp
    if (patch%flat) then
      call project(patch, x, lower, upper, projection)
      return
    end if
    relative = x - patch%centre
    n = patch%n_interval
    do j = 0, n
      do i = 0, n
        square(i, j) = sum((patch%sample(:, i, j) - relative)**2)
      end do
    end do
    start = minloc(square(:n, :n)) - 1
    projection%uv = real(start, wp)/real(n, wp)
    call project(patch, x, lower, upper, projection)
    cell = patch%size/real(n, wp)
    do j = 0, n
      do i = 0, n
        if (all(abs([i, j] - start) <= 1)) cycle
        if (square(i, j) > (projection%distance + cell)**2) cycle
        if (any(square(max(i - 1, 0):min(i + 1, n), max(j - 1, 0):min(j + 1, n)) &
            < square(i, j))) cycle
        other%uv = real([i, j], wp)/real(n, wp)
        call project(patch, x, lower, upper, other)
        if (other%distance < projection%distance) projection = other
      end do
    end do
  end subroutine project_globally

  !> Find the closest point of a parallelogram. The minimum of a quadratic function within bounds is
  !> the free minimum or lies on one of the bounds that the free minimum violates.
  pure subroutine project_flat(patch, x, lower, upper, projection)
    type(patch_t), intent(in) :: patch
    !> Position of the node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    type(projection_t), intent(inout) :: projection

    real(wp) :: metric(3), g(2), free(2)

    projection%second = 0.0_wp
    projection%first(:, 1) = patch%control(:, 1, 0) - patch%control(:, 0, 0)
    projection%first(:, 2) = patch%control(:, 0, 1) - patch%control(:, 0, 0)
    projection%offset = patch%homogeneous(1:3, 0, 0) - x
    call gradient_and_metric(projection, g, metric)
    free(1) = (metric(3)*g(2) - metric(2)*g(1))/(metric(1)*metric(2) - metric(3)**2)
    free(2) = -(g(2) + metric(3)*free(1))/metric(2)
    projection%uv = free
    projection%active = 0
    if (any(free < lower .or. free > upper)) then
      call bounded_minimum(g, metric, free, lower, upper, projection%uv)
      where (projection%uv <= lower) projection%active = -1
      where (projection%uv >= upper) projection%active = 1
    end if
    projection%offset = projection%offset + projection%uv(1)*projection%first(:, 1) &
        + projection%uv(2)*projection%first(:, 2)
    projection%distance = sqrt(dot_product(projection%offset, projection%offset))
  end subroutine project_flat

  !> Find the minimum of a quadratic function on the bounds that its free minimum violates.
  pure subroutine bounded_minimum(g, metric, free, lower, upper, uv)
    !> Gradient at u = v = 0; second derivatives uu, vv, uv.
    real(wp), intent(in) :: g(2), metric(3)
    !> Free minimum.
    real(wp), intent(in) :: free(2)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    real(wp), intent(inout) :: uv(2)

    real(wp) :: trial(2), value, best
    integer :: a, b

    best = huge(1.0_wp)
    do a = 1, 2
      if (free(a) >= lower(a) .and. free(a) <= upper(a)) cycle
      b = 3 - a
      trial(a) = min(max(free(a), lower(a)), upper(a))
      trial(b) = min(max(-(g(b) + metric(3)*trial(a))/metric(b), lower(b)), upper(b))
      value = dot_product(trial, g) + 0.5_wp*(metric(1)*trial(1)**2 + metric(2)*trial(2)**2) &
          + metric(3)*trial(1)*trial(2)
      if (value >= best) cycle
      best = value
      uv = trial
    end do
  end subroutine bounded_minimum

  !> Run Newton's method from `projection%uv`.
  pure subroutine newton(patch, x, lower, upper, projection, iteration, ok)
    type(patch_t), intent(in) :: patch
    !> Position of the node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Initial point on entry.
    type(projection_t), intent(inout) :: projection
    !> Number of the last iteration.
    integer, intent(out) :: iteration
    !> True if converged.
    logical, intent(out) :: ok

    type(projection_t) :: trial
    real(wp) :: g(2), metric(3), step(2), slope, slack, length
    integer :: halving

    ok = .false.
    projection%uv = min(max(projection%uv, lower), upper)
    call evaluate_projection(patch, x, projection)
    do iteration = 1, most_iterations
      call gradient_and_metric(projection, g, metric)
      call find_active_bounds(projection%uv, lower, upper, g, projection%active)
      length = patch%size + projection%distance
      ok = all(projection%active /= 0 .or. abs(g) <= gradient_tolerance*length*sqrt(metric(1:2)))
      if (ok) return
      call newton_step(projection, g, metric, step)
      slack = 4.0_wp*epsilon(1.0_wp)*length*(projection%distance + epsilon(1.0_wp)*length)
      do halving = 0, most_halvings
        trial%uv = min(max(projection%uv + step, lower), upper)
        slope = dot_product(g, trial%uv - projection%uv)
        if (slope >= 0.0_wp .and. halving == 0) then
          step = merge(-g/max(metric(1:2), tiny(1.0_wp)), 0.0_wp, projection%active == 0)
          cycle
        end if
        call evaluate_projection(patch, x, trial)
        if (0.5_wp*(trial%distance**2 - projection%distance**2) <= 1.0e-4_wp*slope + slack) exit
        step = 0.5_wp*step
      end do
      if (halving > most_halvings) return
      ok = all(abs(trial%uv - projection%uv) <= step_tolerance)
      projection = trial
      if (ok) then
        call gradient_and_metric(projection, g, metric)
        call find_active_bounds(projection%uv, lower, upper, g, projection%active)
        return
      end if
    end do
  end subroutine newton

  !> Evaluate the gradient of phi and the metric S_u.S_u, S_v.S_v, S_u.S_v.
  pure subroutine gradient_and_metric(projection, g, metric)
    type(projection_t), intent(in) :: projection
    !> mm2.
    real(wp), intent(out) :: g(2), metric(3)

    g(1) = dot_product(projection%offset, projection%first(:, 1))
    g(2) = dot_product(projection%offset, projection%first(:, 2))
    metric(1) = dot_product(projection%first(:, 1), projection%first(:, 1))
    metric(2) = dot_product(projection%first(:, 2), projection%first(:, 2))
    metric(3) = dot_product(projection%first(:, 1), projection%first(:, 2))
  end subroutine gradient_and_metric

  !> Find the bounds at which the descent direction points outwards.
  pure subroutine find_active_bounds(uv, lower, upper, g, active)
    real(wp), intent(in) :: uv(2)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Gradient of phi.
    real(wp), intent(in) :: g(2)
    !> -1, 0 or 1 for u and v.
    integer, intent(out) :: active(2)

    active = 0
    where (uv <= lower .and. g >= 0.0_wp) active = -1
    where (uv >= upper .and. g <= 0.0_wp) active = 1
  end subroutine find_active_bounds

  !> Evaluate the Newton step of the parameters without active bound.
  pure subroutine newton_step(projection, g, metric, step)
    type(projection_t), intent(in) :: projection
    !> Gradient of phi and metric.
    real(wp), intent(in) :: g(2), metric(3)
    real(wp), intent(out) :: step(2)

    real(wp), parameter :: positive = 1.0e-10_wp
    real(wp) :: h(3), determinant
    integer :: a

    do a = 1, 3
      h(a) = metric(a) + dot_product(projection%offset, projection%second(:, a))
    end do
    if (all(projection%active == 0)) then
      determinant = h(1)*h(2) - h(3)**2
      if (min(h(1), h(2)) <= 0.0_wp .or. determinant <= positive*metric(1)*metric(2)) then
        h = metric
        determinant = h(1)*h(2) - h(3)**2
      end if
      if (determinant > positive*metric(1)*metric(2)) then
        step(1) = (h(3)*g(2) - h(2)*g(1))/determinant
        step(2) = (h(3)*g(1) - h(1)*g(2))/determinant
        return
      end if
    end if
    do a = 1, 2
      step(a) = 0.0_wp
      if (projection%active(a) /= 0) cycle
      if (h(a) <= positive*metric(a)) h(a) = metric(a)
      step(a) = -g(a)/max(h(a), tiny(1.0_wp))
      step(a) = max(-1.0_wp, min(1.0_wp, step(a)))
    end do
  end subroutine newton_step

end module dd3_tools_project
