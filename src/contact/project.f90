!> Closest point of one patch: Newton's method on half the squared distance, kept inside the
!> patch's bounds.
!>
!> phi(u,v) = |S(u,v) - x|^2 / 2, gradient g_a = (S - x).S_a, Hessian
!> h_ab = S_a.S_b + (S - x).S_ab. Bounds at which -g points outwards are active. Where the Hessian
!> is not positive definite its Gauss-Newton part is taken. Steps are cut at the bounds and halved
!> until they descend (Armijo). If this fails it starts anew from a 33 x 33 grid, and if that
!> fails too the best point of the grid is improved by golden sections along u and v in turn. A
!> parallelogram is solved at once. Source: Bertsekas, SIAM J. Control Optim. 20 (1982) 221-246
!> (projected Newton); Armijo, Pacific J. Math. 16 (1966) 1-3; Kiefer, Proc. Amer. Math. Soc. 4
!> (1953) 502-506 (golden section).
module dd3_contact_project
  use dd3_base_kinds, only : wp
  use dd3_contact_bezier, only : patch_t, evaluate_relative, n_sample
  implicit none
  private
  public :: foot_t, project, project_globally, project_by_sections

  !> Newton iterations, and halvings of one step.
  integer, parameter :: most_iterations = 30, most_halvings = 20
  !> Gradients below this share of their parts are zero.
  real(wp), parameter :: zero_gradient = 1.0e-14_wp
  !> Steps of the parameters below this are none.
  real(wp), parameter :: zero_step = 1.0e-15_wp
  !> Intervals of the fine grid.
  integer, parameter :: n_fine = 32

  !> Foot of the perpendicular from a node to a patch.
  type :: foot_t
    !> Parameters u, v.
    real(wp) :: at(2)
    !> From the node to the foot: S - x, mm.
    real(wp) :: to_foot(3)
    !> S_u, S_v, mm.
    real(wp) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp) :: second(3, 3)
    !> -1 or 1 where u (v) is held at its lower or upper bound, else 0.
    integer :: side(2)
    !> Distance of the node from the foot, mm.
    real(wp) :: distance
  end type foot_t

contains

  !> Foot near a known one.
  pure subroutine project(patch, x, lower, upper, foot, iterations)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> The foot; `at` is where to start.
    type(foot_t), intent(inout) :: foot
    !> Newton iterations from there.
    integer, intent(out), optional :: iterations

    real(wp) :: relative(3)
    integer :: taken
    logical :: ok

    relative = x - patch%centre
    if (present(iterations)) iterations = 0
    if (patch%flat) then
      call project_flat(patch, relative, lower, upper, foot)
      return
    end if
    call descend(patch, relative, lower, upper, foot, taken, ok)
    if (present(iterations)) iterations = taken
    if (ok) return
    call sample_finely(patch, relative, lower, upper, foot%at)
    call descend(patch, relative, lower, upper, foot, taken, ok)
    if (.not. ok) call project_by_sections(patch, x, lower, upper, foot)
  end subroutine project

  !> Foot without derivatives: the best point of the fine grid, improved by golden sections.
  pure subroutine project_by_sections(patch, x, lower, upper, foot)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> The foot.
    type(foot_t), intent(inout) :: foot

    real(wp) :: relative(3)

    relative = x - patch%centre
    call sample_finely(patch, relative, lower, upper, foot%at)
    call evaluate_foot(patch, relative, foot)
    call golden_sections(patch, relative, lower, upper, foot)
  end subroutine project_by_sections

  !> Foot nearest of all on a patch.
  pure subroutine project_globally(patch, x, lower, upper, foot)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> The foot.
    type(foot_t), intent(out) :: foot

    type(foot_t) :: other
    real(wp) :: square(0:n_sample, 0:n_sample), relative(3), cell
    integer :: i, j, start(2)

    foot%at = 0.5_wp
    if (patch%flat) then
      call project(patch, x, lower, upper, foot)
      return
    end if
    relative = x - patch%centre
    do j = 0, n_sample
      do i = 0, n_sample
        square(i, j) = sum((patch%sample(:, i, j) - relative)**2)
      end do
    end do
    start = minloc(square) - 1
    foot%at = real(start, wp)/n_sample
    call project(patch, x, lower, upper, foot)
    cell = patch%size/n_sample
    do j = 0, n_sample
      do i = 0, n_sample
        if (all(abs([i, j] - start) <= 1)) cycle
        if (square(i, j) > (foot%distance + cell)**2) cycle
        if (any(square(max(i - 1, 0):min(i + 1, n_sample), max(j - 1, 0):min(j + 1, n_sample)) &
                < square(i, j))) cycle
        other%at = real([i, j], wp)/n_sample
        call project(patch, x, lower, upper, other)
        if (other%distance < foot%distance) foot = other
      end do
    end do
  end subroutine project_globally

  !> Foot on a parallelogram: a quadratic function of two bounded variables has its least value
  !> where it has it without bounds, or on one of the bounds that this place violates.
  pure subroutine project_flat(patch, x, lower, upper, foot)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> The foot.
    type(foot_t), intent(inout) :: foot

    real(wp) :: origin(3), gram(3), g(2), free(2), trial(2), value, best
    integer :: a, b

    foot%second = 0.0_wp
    foot%first(:, 1) = patch%control(:, 1, 0) - patch%control(:, 0, 0)
    foot%first(:, 2) = patch%control(:, 0, 1) - patch%control(:, 0, 0)
    origin = patch%homogeneous(1:3, 0, 0) - x
    gram = [dot_product(foot%first(:, 1), foot%first(:, 1)), &
            dot_product(foot%first(:, 2), foot%first(:, 2)), &
            dot_product(foot%first(:, 1), foot%first(:, 2))]
    g(1) = dot_product(origin, foot%first(:, 1))
    g(2) = dot_product(origin, foot%first(:, 2))
    free(1) = (gram(3)*g(2) - gram(2)*g(1))/(gram(1)*gram(2) - gram(3)**2)
    free(2) = -(g(2) + gram(3)*free(1))/gram(2)
    foot%at = free
    foot%side = 0
    if (any(free < lower .or. free > upper)) then
      best = huge(1.0_wp)
      do a = 1, 2
        if (free(a) >= lower(a) .and. free(a) <= upper(a)) cycle
        b = 3 - a
        trial(a) = min(max(free(a), lower(a)), upper(a))
        trial(b) = min(max(-(g(b) + gram(3)*trial(a))/gram(b), lower(b)), upper(b))
        value = dot_product(trial, g) + 0.5_wp*(gram(1)*trial(1)**2 + gram(2)*trial(2)**2) &
                + gram(3)*trial(1)*trial(2)
        if (value >= best) cycle
        best = value
        foot%at = trial
      end do
      where (foot%at <= lower) foot%side = -1
      where (foot%at >= upper) foot%side = 1
    end if
    foot%to_foot = origin + foot%at(1)*foot%first(:, 1) + foot%at(2)*foot%first(:, 2)
    foot%distance = sqrt(dot_product(foot%to_foot, foot%to_foot))
  end subroutine project_flat

  !> Newton's method from `foot%at`.
  pure subroutine descend(patch, x, lower, upper, foot, iteration, ok)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Where to start; the foot.
    type(foot_t), intent(inout) :: foot
    !> The iteration it ended in.
    integer, intent(out) :: iteration
    !> Whether it converged.
    logical, intent(out) :: ok

    type(foot_t) :: trial
    real(wp) :: g(2), metric(3), step(2), slope, slack, reach
    integer :: halving

    ok = .false.
    foot%at = min(max(foot%at, lower), upper)
    call evaluate_foot(patch, x, foot)
    do iteration = 1, most_iterations
      call gradient_and_metric(foot, g, metric)
      call find_sides(foot%at, lower, upper, g, foot%side)
      reach = patch%size + foot%distance
      ok = all(foot%side /= 0 .or. abs(g) <= zero_gradient*reach*sqrt(metric(1:2)))
      if (ok) return
      call newton_step(foot, g, metric, step)
      slack = 4.0_wp*epsilon(1.0_wp)*reach*(foot%distance + epsilon(1.0_wp)*reach)
      do halving = 0, most_halvings
        trial%at = min(max(foot%at + step, lower), upper)
        slope = dot_product(g, trial%at - foot%at)
        if (slope >= 0.0_wp .and. halving == 0) then
          step = merge(-g/max(metric(1:2), tiny(1.0_wp)), 0.0_wp, foot%side == 0)
          cycle
        end if
        call evaluate_foot(patch, x, trial)
        if (0.5_wp*(trial%distance**2 - foot%distance**2) <= 1.0e-4_wp*slope + slack) exit
        step = 0.5_wp*step
      end do
      if (halving > most_halvings) return
      ok = all(abs(trial%at - foot%at) <= zero_step)
      foot = trial
      if (ok) then
        call gradient_and_metric(foot, g, metric)
        call find_sides(foot%at, lower, upper, g, foot%side)
        return
      end if
    end do
  end subroutine descend

  !> Point, derivatives and distance at `foot%at`.
  pure subroutine evaluate_foot(patch, x, foot)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> The foot.
    type(foot_t), intent(inout) :: foot

    call evaluate_relative(patch%degree(1), patch%degree(2), patch%rational, patch%homogeneous, &
                           foot%at(1), foot%at(2), foot%to_foot, foot%first, foot%second)
    foot%to_foot = foot%to_foot - x
    foot%side = 0
    foot%distance = sqrt(dot_product(foot%to_foot, foot%to_foot))
  end subroutine evaluate_foot

  !> Gradient of phi and the metric a_11, a_22, a_12.
  pure subroutine gradient_and_metric(foot, g, metric)
    !> The foot.
    type(foot_t), intent(in) :: foot
    !> The gradient.
    real(wp), intent(out) :: g(2)
    !> The metric.
    real(wp), intent(out) :: metric(3)

    g(1) = dot_product(foot%to_foot, foot%first(:, 1))
    g(2) = dot_product(foot%to_foot, foot%first(:, 2))
    metric(1) = dot_product(foot%first(:, 1), foot%first(:, 1))
    metric(2) = dot_product(foot%first(:, 2), foot%first(:, 2))
    metric(3) = dot_product(foot%first(:, 1), foot%first(:, 2))
  end subroutine gradient_and_metric

  !> Bounds at which the descent points outwards.
  pure subroutine find_sides(at, lower, upper, g, side)
    !> The parameters.
    real(wp), intent(in) :: at(2)
    !> Their bounds.
    real(wp), intent(in) :: lower(2), upper(2)
    !> The gradient.
    real(wp), intent(in) :: g(2)
    !> -1, 0 or 1 for u and v.
    integer, intent(out) :: side(2)

    side = 0
    where (at <= lower .and. g >= 0.0_wp) side = -1
    where (at >= upper .and. g <= 0.0_wp) side = 1
  end subroutine find_sides

  !> Newton step of the parameters that are not held.
  pure subroutine newton_step(foot, g, metric, step)
    !> The foot with its sides.
    type(foot_t), intent(in) :: foot
    !> The gradient.
    real(wp), intent(in) :: g(2)
    !> The metric.
    real(wp), intent(in) :: metric(3)
    !> The step.
    real(wp), intent(out) :: step(2)

    real(wp), parameter :: positive = 1.0e-10_wp
    real(wp) :: h(3), determinant
    integer :: a

    do a = 1, 3
      h(a) = metric(a) + dot_product(foot%to_foot, foot%second(:, a))
    end do
    if (all(foot%side == 0)) then
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
      if (foot%side(a) /= 0) cycle
      if (h(a) <= positive*metric(a)) h(a) = metric(a)
      step(a) = -g(a)/max(h(a), tiny(1.0_wp))
      step(a) = max(-1.0_wp, min(1.0_wp, step(a)))
    end do
  end subroutine newton_step

  !> Best point of the fine grid.
  pure subroutine sample_finely(patch, x, lower, upper, at)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Parameters of the best point.
    real(wp), intent(out) :: at(2)

    type(foot_t) :: foot
    real(wp) :: best
    integer :: i, j

    best = huge(1.0_wp)
    at = lower
    do j = 0, n_fine
      do i = 0, n_fine
        foot%at = lower + (upper - lower)*real([i, j], wp)/n_fine
        call evaluate_foot(patch, x, foot)
        if (foot%distance >= best) cycle
        best = foot%distance
        at = foot%at
      end do
    end do
  end subroutine sample_finely

  !> Improves a foot by golden sections along u and v in turn.
  pure subroutine golden_sections(patch, x, lower, upper, foot)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Where to start; the foot.
    type(foot_t), intent(inout) :: foot

    integer, parameter :: most_sweeps = 50
    real(wp), parameter :: golden = 0.6180339887498949_wp
    type(foot_t) :: left, right
    real(wp) :: a, b, previous
    integer :: sweep, direction

    do sweep = 1, most_sweeps
      previous = foot%distance
      do direction = 1, 2
        a = max(lower(direction), foot%at(direction) - 1.0_wp/n_fine)
        b = min(upper(direction), foot%at(direction) + 1.0_wp/n_fine)
        left = foot
        right = foot
        do while (b - a > 1.0e-9_wp)
          left%at(direction) = b - golden*(b - a)
          right%at(direction) = a + golden*(b - a)
          call evaluate_foot(patch, x, left)
          call evaluate_foot(patch, x, right)
          if (left%distance < right%distance) then
            b = right%at(direction)
          else
            a = left%at(direction)
          end if
        end do
        if (left%distance < foot%distance) foot = left
        if (right%distance < foot%distance) foot = right
      end do
      if (foot%distance >= previous*(1.0_wp - 1.0e-14_wp)) exit
    end do
    foot%side = 0
    where (foot%at - lower <= 1.0e-8_wp) foot%side = -1
    where (upper - foot%at <= 1.0e-8_wp) foot%side = 1
  end subroutine golden_sections

end module dd3_contact_project
