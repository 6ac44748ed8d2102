!> Polynomial and rational Bézier patches of any degree, and their derivatives.
!>
!> S(u,v) = sum B_i^m(u) B_j^n(v) w_ij P_ij / sum B_i^m(u) B_j^n(v) w_ij. The Bernstein polynomials
!> are computed by the triangular recurrence B_i^k = (1-t) B_i^(k-1) + t B_(i-1)^(k-1), which adds
!> only positive numbers within the patch and is stable for any degree. Derivatives are differences
!> of the polynomials of the next lower degrees; rational patches are evaluated in homogeneous
!> coordinates with the quotient rule.
!> Source: Farin, Curves and Surfaces for CAGD, 5th ed. (2002), chapters 4, 5, 13, 14; Piegl and
!> Tiller, The NURBS Book, 2nd ed. (1997), algorithm A1.3 and section 4.5.
module dd3_contact_bezier
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: patch_t, new_patch, evaluate, evaluate_relative, position_at, normal_at, unit_normal
  public :: largest_degree, n_sample

  !> Largest degree of a patch in u or v.
  integer, parameter :: largest_degree = 25
  !> Intervals in u and v of the grid of stored points.
  integer, parameter :: n_sample = 8
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
    !> Control points, `(3, 0:degree(1), 0:degree(2))`, mm.
    real(wp), allocatable :: control(:, :, :)
    !> Control points relative to `centre`, multiplied by their weights, and the weights,
    !> `(4, 0:degree(1), 0:degree(2))`.
    real(wp), allocatable :: homogeneous(:, :, :)
    !> Points on a regular grid of parameters, relative to `centre`, mm; not allocated if flat.
    real(wp), allocatable :: sample(:, :, :)
    !> Centre of the bounding box, mm.
    real(wp) :: centre(3) = 0.0_wp
    !> Bounding box of the control points, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Diagonal of the bounding box, mm.
    real(wp) :: size = 0.0_wp
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
    integer :: i

    call set_grid(self, point)
    do i = 1, 3
      self%length(i, 1) = polygon_length(point(:, :, (i - 1)*n_sample/2))
      self%length(i, 2) = polygon_length(point(:, (i - 1)*n_sample/2, :))
    end do
    self%shorter_side = min(mean(self%length(:, 1)), mean(self%length(:, 2)))
    if (self%flat) return
    allocate (self%sample(3, 0:n_sample, 0:n_sample))
    do i = 1, 3
      self%sample(i, :, :) = point(i, :, :) - self%centre(i)
    end do

  contains

    pure real(wp) function mean(length)
      real(wp), intent(in) :: length(3)

      mean = length(1)/3.0_wp + length(2)/3.0_wp + length(3)/3.0_wp
    end function mean

  end subroutine measure

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

  !> Evaluate the Bernstein polynomials of a degree and their first two derivatives.
  pure subroutine bernstein(degree, t, b)
    !> At least 1.
    integer, intent(in) :: degree
    real(wp), intent(in) :: t
    !> Values, first and second derivatives in `b(0:degree, 0:2)`.
    real(wp), intent(out) :: b(0:largest_degree, 0:2)

    real(wp) :: s, factor
    integer :: k, i

    s = 1.0_wp - t
    if (degree == 1) then
      b(0, :) = [s, -1.0_wp, 0.0_wp]
      b(1, :) = [t, 1.0_wp, 0.0_wp]
      return
    end if
    b(0, 0) = 1.0_wp
    do k = 1, degree
      if (k == degree - 1) b(0:k - 1, 2) = b(0:k - 1, 0)
      if (k == degree) b(0:k - 1, 1) = b(0:k - 1, 0)
      b(k, 0) = t*b(k - 1, 0)
      do i = k - 1, 1, -1
        b(i, 0) = s*b(i, 0) + t*b(i - 1, 0)
      end do
      b(0, 0) = s*b(0, 0)
    end do
    factor = real(degree, wp)
    b(degree, 1) = factor*b(degree - 1, 1)
    do i = degree - 1, 1, -1
      b(i, 1) = factor*(b(i - 1, 1) - b(i, 1))
    end do
    b(0, 1) = -factor*b(0, 1)
    factor = real(degree*(degree - 1), wp)
    b(degree - 1:degree, 2) = 0.0_wp
    do i = degree, 2, -1
      b(i, 2) = factor*(b(i, 2) - 2.0_wp*b(i - 1, 2) + b(i - 2, 2))
    end do
    b(1, 2) = factor*(b(1, 2) - 2.0_wp*b(0, 2))
    b(0, 2) = factor*b(0, 2)
  end subroutine bernstein

  !> Evaluate the Bernstein polynomials of a degree.
  pure subroutine bernstein_values(degree, t, b)
    !> At least 1.
    integer, intent(in) :: degree
    real(wp), intent(in) :: t
    !> `b(0:degree)`.
    real(wp), intent(out) :: b(0:largest_degree)

    integer :: k, i

    b(0) = 1.0_wp
    do k = 1, degree
      b(k) = t*b(k - 1)
      do i = k - 1, 1, -1
        b(i) = (1.0_wp - t)*b(i) + t*b(i - 1)
      end do
      b(0) = (1.0_wp - t)*b(0)
    end do
  end subroutine bernstein_values

  !> Return a point of the patch, mm.
  pure function position_at(self, u, v) result(point)
    type(patch_t), intent(in) :: self
    real(wp), intent(in) :: u, v
    real(wp) :: point(3)

    real(wp) :: first(3, 2), second(3, 3)

    call evaluate(self, u, v, point, first, second)
  end function position_at

  !> Return the unit normal S_u x S_v, at a degenerate point that of a near one towards the centre.
  pure subroutine normal_at(self, u, v, normal, regular)
    type(patch_t), intent(in) :: self
    real(wp), intent(in) :: u, v
    !> Unit normal, or zero.
    real(wp), intent(out) :: normal(3)
    !> False if no near point has a normal.
    logical, intent(out) :: regular

    real(wp) :: point(3), first(3, 2), second(3, 3), step
    integer :: i

    step = 0.0_wp
    do i = 1, 4
      call evaluate(self, u + step*(0.5_wp - u), v + step*(0.5_wp - v), point, first, second)
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

end module dd3_contact_bezier
