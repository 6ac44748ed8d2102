! SPDX-License-Identifier: GPL-3.0-or-later
!> Polynomial and rational Bézier patches of any degree, and their derivatives.
!>
!> S(u,v) = sum B_i^m(u) B_j^n(v) w_ij P_ij / sum B_i^m(u) B_j^n(v) w_ij. Rational patches are
!> evaluated in homogeneous coordinates with the quotient rule.
!> Source: Farin, Curves and Surfaces for CAGD, 5th ed. (2002), chapters 4, 13, 14; Piegl and
!> Tiller, The NURBS Book, 2nd ed. (1997), section 4.5.
module dd3_tools_bezier
  use dd3_base_kinds, only : wp
  use dd3_tools_bernstein, only : bernstein, bernstein_values, largest_degree
  implicit none
  private
  public :: patch_t, new_patch, evaluate, evaluate_relative, position_at, normal_at, unit_normal
  public :: edge_points, evaluate_tangents, largest_degree, n_sample

  !> Largest number of intervals in u and v of the grid of stored points.
  integer, parameter :: n_sample = 8
  !> Largest degree of a patch with a coarser grid, and its largest distance from the surface,
  !> relative to the spacing along the shorter side: an arc of 9 degrees per interval.
  integer, parameter :: largest_coarse_degree = 3
  real(wp), parameter :: largest_coarse_distance = 0.02_wp
  !> Below this |S_u x S_v|, relative to the patch's size squared, the normal is undefined.
  real(wp), parameter :: degenerate_area = 1.0e-9_wp

  !> A Bézier patch.
  type :: patch_t
    !> Degrees in u and v.
    integer :: degree(2) = 0
    !> True if the weights are not all equal.
    logical :: rational = .false.
    !> True for a parallelogram: degrees 1 and 1, no twist.
    logical :: flat = .false.
    !> Intervals in u and v of the grid of stored points: 2, 4 or `n_sample`, by the curvature.
    integer :: n_interval = n_sample
    !> Bounding box of the control points, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Centre of the bounding box, mm.
    real(wp) :: centre(3) = 0.0_wp
    !> Diagonal of the bounding box, mm.
    real(wp) :: size = 0.0_wp
    !> Control points relative to `centre`, multiplied by their weights, and the weights,
    !> `(4, 0:degree(1), 0:degree(2))`.
    real(wp), allocatable :: homogeneous(:, :, :)
    !> Points on a regular grid of parameters, `(3, 0:n_interval, 0:n_interval)`, relative to
    !> `centre`, mm; not allocated if flat.
    real(wp), allocatable :: sample(:, :, :)
    !> Control points, `(3, 0:degree(1), 0:degree(2))`, mm.
    real(wp), allocatable :: control(:, :, :)
    !> Lengths of the parameter lines at 0, 1/2 and 1 of the other parameter: along u, along v, mm.
    real(wp) :: length(3, 2) = 0.0_wp
    !> Smaller of the mean lengths in u and v, mm.
    real(wp) :: shorter_side = 0.0_wp
    !> First line of the patch in its file, or 0.
    integer :: line = 0
  end type patch_t

contains

  !> Make a patch from its control points.
  subroutine new_patch(self, control, weight, line)
    type(patch_t), intent(out) :: self
    !> Control points, `(3, m + 1, n + 1)`, u fastest, mm.
    real(wp), intent(in) :: control(:, :, :)
    !> Positive weights of the control points; all 1 by default.
    real(wp), intent(in), optional :: weight(:, :)
    !> First line of the patch in its file.
    integer, intent(in), optional :: line

    integer :: i, j, m, n
    real(wp) :: w

    m = size(control, 2) - 1
    n = size(control, 3) - 1
    self%degree = [m, n]
    if (present(line)) self%line = line
    allocate (self%control(3, 0:m, 0:n), self%homogeneous(4, 0:m, 0:n))
    self%control(:, :, :) = control
    self%lower = minval(minval(control, dim=3), dim=2)
    self%upper = maxval(maxval(control, dim=3), dim=2)
    self%centre = 0.5_wp*(self%lower + self%upper)
    self%size = sqrt(sum((self%upper - self%lower)**2))
    if (present(weight)) self%rational = any(abs(weight - weight(1, 1)) > 0.0_wp)
    do j = 0, n
      do i = 0, m
        w = 1.0_wp
        if (self%rational) w = weight(i + 1, j + 1)/weight(1, 1)
        self%homogeneous(1:3, i, j) = w*(self%control(:, i, j) - self%centre)
        self%homogeneous(4, i, j) = w
      end do
    end do
    if (m == 1 .and. n == 1 .and. .not. self%rational) then
      self%flat = all(abs(self%control(:, 0, 0) - self%control(:, 1, 0) - self%control(:, 0, 1) &
          + self%control(:, 1, 1)) <= 1.0e-14_wp*self%size)
    end if
    call measure(self)
  end subroutine new_patch

  !> Measure lengths on a grid of points; store it for curved patches, as the points from which a
  !> global projection starts.
  pure subroutine measure(self)
    type(patch_t), intent(inout) :: self

    real(wp) :: point(3, 0:n_sample, 0:n_sample)
    real(wp) :: distance
    integer :: i, step

    call set_grid(self, point)
    do i = 1, 3
      self%length(i, 1) = polygon_length(point(:, :, (i - 1)*n_sample/2))
      self%length(i, 2) = polygon_length(point(:, (i - 1)*n_sample/2, :))
    end do
    self%shorter_side = min(mean(self%length(:, 1)), mean(self%length(:, 2)))
    if (self%flat) return
    do while (all(self%degree <= largest_coarse_degree) .and. self%n_interval > 2)
      distance = largest_coarse_distance*self%shorter_side/real(self%n_interval/2, wp)
      if (coarse_distance(point, self%n_interval/2) > distance) exit
      self%n_interval = self%n_interval/2
    end do
    allocate (self%sample(3, 0:self%n_interval, 0:self%n_interval))
    step = n_sample/self%n_interval
    do i = 1, 3
      self%sample(i, :, :) = point(i, ::step, ::step) - self%centre(i)
    end do

  contains

    pure real(wp) function mean(length)
      real(wp), intent(in) :: length(3)

      mean = length(1)/3.0_wp + length(2)/3.0_wp + length(3)/3.0_wp
    end function mean

  end subroutine measure

  !> Return the largest distance of the middles of the edges and cells of a coarser grid from the
  !> points of equal parameters, mm.
  pure real(wp) function coarse_distance(point, n) result(distance)
    !> `(3, 0:n_sample, 0:n_sample)`, mm.
    real(wp), intent(in) :: point(:, 0:, 0:)
    !> Intervals of the coarser grid.
    integer, intent(in) :: n

    real(wp) :: chord(3)
    integer :: i, j, a, b, half

    distance = 0.0_wp
    half = n_sample/(2*n)
    do j = 0, 2*n
      b = modulo(j, 2)
      do i = 0, 2*n
        a = modulo(i, 2)
        if (a + b == 0) cycle
        chord = 0.25_wp*(point(:, half*(i - a), half*(j - b)) &
            + point(:, half*(i + a), half*(j - b)) + point(:, half*(i - a), half*(j + b)) &
            + point(:, half*(i + a), half*(j + b)))
        distance = max(distance, sum((point(:, half*i, half*j) - chord)**2))
      end do
    end do
    distance = sqrt(distance)
  end function coarse_distance

  !> Evaluate the points on a regular grid of parameters.
  pure subroutine set_grid(self, point)
    type(patch_t), intent(in) :: self
    !> mm.
    real(wp), intent(out) :: point(3, 0:n_sample, 0:n_sample)

    real(wp) :: b(0:largest_degree, 0:n_sample, 2), row(4, 0:largest_degree), p(4)
    integer :: i, j, k, l

    do i = 0, n_sample
      do k = 1, 2
        call bernstein_values(self%degree(k), real(i, wp)/n_sample, b(:, i, k))
      end do
    end do
    do i = 0, n_sample
      row(:, :self%degree(2)) = 0.0_wp
      do l = 0, self%degree(2)
        do k = 0, self%degree(1)
          row(:, l) = row(:, l) + b(k, i, 1)*self%homogeneous(:, k, l)
        end do
      end do
      do j = 0, n_sample
        p = 0.0_wp
        do l = 0, self%degree(2)
          p = p + b(l, j, 2)*row(:, l)
        end do
        if (self%rational) p(:3) = 1.0_wp/p(4)*p(:3)
        point(:, i, j) = p(:3) + self%centre
      end do
    end do
  end subroutine set_grid

  !> Return the length of a polygon, mm.
  pure real(wp) function polygon_length(point) result(length)
    !> Corners, mm.
    real(wp), intent(in) :: point(:, :)

    integer :: i

    length = 0.0_wp
    do i = 2, size(point, 2)
      length = length + sqrt(sum((point(:, i) - point(:, i - 1))**2))
    end do
  end function polygon_length

  !> Evaluate a point of the patch and its first and second derivatives.
  pure subroutine evaluate(self, u, v, point, first, second)
    type(patch_t), intent(in) :: self
    !> Parameters; outside 0 ... 1 the patch is extrapolated.
    real(wp), intent(in) :: u, v
    !> S, mm.
    real(wp), intent(out) :: point(3)
    !> S_u, S_v, mm.
    real(wp), intent(out) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp), intent(out) :: second(3, 3)

    call evaluate_relative(self%degree(1), self%degree(2), self%rational, self%homogeneous, u, v, &
        point, first, second)
    point = point + self%centre
  end subroutine evaluate

  !> Evaluate the first derivatives of the patch.
  pure subroutine evaluate_tangents(self, u, v, first)
    type(patch_t), intent(in) :: self
    real(wp), intent(in) :: u, v
    !> S_u, S_v, mm.
    real(wp), intent(out) :: first(3, 2)

    real(wp) :: bu(0:largest_degree, 0:2), bv(0:largest_degree, 0:2), row(4, 0:1), sums(4, 0:2)
    integer :: i, j

    call bernstein(self%degree(1), u, bu)
    call bernstein(self%degree(2), v, bv)
    sums = 0.0_wp
    do j = 0, self%degree(2)
      row = 0.0_wp
      do i = 0, self%degree(1)
        row(:, 0) = row(:, 0) + bu(i, 0)*self%homogeneous(:, i, j)
        row(:, 1) = row(:, 1) + bu(i, 1)*self%homogeneous(:, i, j)
      end do
      sums(:, 0) = sums(:, 0) + bv(j, 0)*row(:, 0)
      sums(:, 1) = sums(:, 1) + bv(j, 0)*row(:, 1)
      sums(:, 2) = sums(:, 2) + bv(j, 1)*row(:, 0)
    end do
    first = sums(1:3, 1:2)
    if (.not. self%rational) return
    do i = 1, 2
      first(:, i) = 1.0_wp/sums(4, 0)*(first(:, i) - sums(4, i)*(1.0_wp/sums(4, 0)*sums(1:3, 0)))
    end do
  end subroutine evaluate_tangents

  !> Kernel: evaluate a point relative to the patch's centre, with derivatives.
  pure subroutine evaluate_relative(m, n, rational, homogeneous, u, v, point, first, second)
    !> Degrees.
    integer, intent(in) :: m, n
    !> False if all weights are 1.
    logical, intent(in) :: rational
    !> Weighted control points and weights, mm.
    real(wp), intent(in) :: homogeneous(4, 0:m, 0:n)
    real(wp), intent(in) :: u, v
    !> S, mm.
    real(wp), intent(out) :: point(3)
    !> S_u, S_v, mm.
    real(wp), intent(out) :: first(3, 2)
    !> S_uu, S_vv, S_uv, mm.
    real(wp), intent(out) :: second(3, 3)

    real(wp) :: bu(0:largest_degree, 0:2), bv(0:largest_degree, 0:2)
    real(wp) :: row(4, 0:2), sums(4, 0:5), p(4)
    integer :: i, j

    call bernstein(m, u, bu)
    call bernstein(n, v, bv)
    sums = 0.0_wp
    do j = 0, n
      row = 0.0_wp
      do i = 0, m
        p = homogeneous(:, i, j)
        row(:, 0) = row(:, 0) + bu(i, 0)*p
        row(:, 1) = row(:, 1) + bu(i, 1)*p
        row(:, 2) = row(:, 2) + bu(i, 2)*p
      end do
      sums(:, 0) = sums(:, 0) + bv(j, 0)*row(:, 0)
      sums(:, 1) = sums(:, 1) + bv(j, 0)*row(:, 1)
      sums(:, 2) = sums(:, 2) + bv(j, 1)*row(:, 0)
      sums(:, 3) = sums(:, 3) + bv(j, 0)*row(:, 2)
      sums(:, 4) = sums(:, 4) + bv(j, 2)*row(:, 0)
      sums(:, 5) = sums(:, 5) + bv(j, 1)*row(:, 1)
    end do
    point = sums(1:3, 0)
    first = sums(1:3, 1:2)
    second = sums(1:3, 3:5)
    if (rational) call quotient_rule(sums(4, :), point, first, second)
  end subroutine evaluate_relative

  !> Convert the derivatives of w S and w to those of S.
  pure subroutine quotient_rule(w, point, first, second)
    !> w, w_u, w_v, w_uu, w_vv, w_uv.
    real(wp), intent(in) :: w(0:5)
    !> w S and its derivatives u, v, uu, vv, uv on entry, those of S on return.
    real(wp), intent(inout) :: point(3), first(3, 2), second(3, 3)

    real(wp) :: inverse

    inverse = 1.0_wp/w(0)
    point = inverse*point
    first(:, 1) = inverse*(first(:, 1) - w(1)*point)
    first(:, 2) = inverse*(first(:, 2) - w(2)*point)
    second(:, 1) = inverse*(second(:, 1) - 2.0_wp*w(1)*first(:, 1) - w(3)*point)
    second(:, 2) = inverse*(second(:, 2) - 2.0_wp*w(2)*first(:, 2) - w(4)*point)
    second(:, 3) = inverse*(second(:, 3) - w(1)*first(:, 2) - w(2)*first(:, 1) - w(5)*point)
  end subroutine quotient_rule

  !> Return a point of the patch, mm.
  pure function position_at(self, u, v) result(point)
    type(patch_t), intent(in) :: self
    real(wp), intent(in) :: u, v
    real(wp) :: point(3)

    real(wp) :: first(3, 2), second(3, 3)

    call evaluate(self, u, v, point, first, second)
  end function position_at

  !> Return points of an edge, mm.
  pure function edge_points(self, k, t) result(point)
    type(patch_t), intent(in) :: self
    !> Edge 1: u = 0, 2: u = 1, 3: v = 0, 4: v = 1.
    integer, intent(in) :: k
    !> Parameters.
    real(wp), intent(in) :: t(:)
    real(wp) :: point(3, size(t))

    real(wp) :: b(0:largest_degree), row(4, 0:largest_degree), p(4)
    integer :: i, s, degree

    degree = self%degree(merge(2, 1, k <= 2))
    do i = 0, degree
      select case (k)
      case (1, 2)
        row(:, i) = self%homogeneous(:, (k - 1)*self%degree(1), i)
      case default
        row(:, i) = self%homogeneous(:, i, (k - 3)*self%degree(2))
      end select
    end do
    do s = 1, size(t)
      call bernstein_values(degree, t(s), b)
      p = 0.0_wp
      do i = 0, degree
        p = p + b(i)*row(:, i)
      end do
      point(:, s) = p(:3)/p(4) + self%centre
    end do
  end function edge_points

  !> Return the unit normal S_u x S_v, at a degenerate point that of a near one towards the centre.
  pure subroutine normal_at(self, u, v, normal, regular)
    type(patch_t), intent(in) :: self
    real(wp), intent(in) :: u, v
    !> Unit normal, or zero.
    real(wp), intent(out) :: normal(3)
    !> False if no near point has a normal.
    logical, intent(out) :: regular

    real(wp) :: first(3, 2), step
    integer :: i

    step = 0.0_wp
    do i = 1, 4
      call evaluate_tangents(self, u + step*(0.5_wp - u), v + step*(0.5_wp - v), first)
      call unit_normal(self, first, normal, regular)
      if (regular) return
      step = max(1.0e-6_wp, 30.0_wp*step)
    end do
  end subroutine normal_at

  !> Return the unit normal from the first derivatives.
  pure subroutine unit_normal(self, first, normal, regular)
    type(patch_t), intent(in) :: self
    !> S_u, S_v, mm.
    real(wp), intent(in) :: first(3, 2)
    !> Unit normal, or zero.
    real(wp), intent(out) :: normal(3)
    !> False at a degenerate point.
    logical, intent(out) :: regular

    real(wp) :: length

    normal(1) = first(2, 1)*first(3, 2) - first(3, 1)*first(2, 2)
    normal(2) = first(3, 1)*first(1, 2) - first(1, 1)*first(3, 2)
    normal(3) = first(1, 1)*first(2, 2) - first(2, 1)*first(1, 2)
    length = sqrt(dot_product(normal, normal))
    regular = length > degenerate_area*self%size**2
    if (regular) then
      normal = normal/length
    else
      normal = 0.0_wp
    end if
  end subroutine unit_normal

end module dd3_tools_bezier
