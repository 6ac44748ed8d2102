! SPDX-License-Identifier: GPL-3.0-or-later
!> Logarithmic strain increment E = ln U at the points, from the polar decomposition F = R U, in the
!> material frame, with the volume change replaced by the mean one. The material axes rotate with R,
!> so tensors stored in them need no rotation (Hughes 1984; Weber & Anand 1990).
!>
!> For small stretches, the usual case, E and R come from series in X = e (I+e)^-1 = tanh E,
!> e = (C-I)/2: E = artanh X and U^-1 = sqrt((I-X)/(I+X)), both with powers of X^2 up to X^8. Below
!> the limit on |e| the remainder is under 2e-16, and equal stretches need no special case. Larger
!> stretches use the eigenvalues of C.
module dd3_element_log_strain
  use dd3_base_kinds, only : sqrt2, wp
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : symmetric_eigen
  implicit none
  private
  public :: element_strain, polar_increment, polar_rotation, rotate_axes, stretch_of_green

  !> Largest Frobenius norm of e for the series.
  real(wp), parameter :: series_limit = 0.03_wp

contains

  !> Evaluate strain increments and trial material axes; call `element_kinematics` first.
  subroutine element_strain(element, rotation_committed, work)
    type(element_t), intent(in) :: element
    !> Committed material axes, as columns.
    real(wp), intent(in) :: rotation_committed(3, 3, element%n_point)
    !> Sets `strain` and `rotation`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: strain(6), r(3, 3), excess
    integer :: p

    do p = 1, element%n_point
      call polar_increment(work%deformation(:, :, p), strain, r)
      excess = (log(work%dilatation(p)) - strain(1) - strain(2) - strain(3))/3.0_wp
      strain(1:3) = strain(1:3) + excess
      call to_material(rotation_committed(:, :, p), strain, work%strain(:, p))
      call rotate_axes(r, rotation_committed(:, :, p), work%rotation(:, :, p))
    end do
  end subroutine element_strain

  !> Return E = ln U and R of F = R U, det F > 0.
  pure subroutine polar_increment(f, strain, rotation)
    !> Deformation gradient.
    real(wp), intent(in) :: f(3, 3)
    !> Logarithmic strain, plain components 11 22 33 23 31 12.
    real(wp), intent(out) :: strain(6)
    real(wp), intent(out) :: rotation(3, 3)

    real(wp) :: green(6), inverse_stretch(6)
    logical :: positive

    green = green_of(f)
    if (is_small(green)) then
      call small_stretch(green, strain, inverse_stretch)
    else
      call large_stretch(matmul(transpose(f), f), strain, inverse_stretch, positive)
    end if
    call multiply(f, inverse_stretch, rotation)
  end subroutine polar_increment

  !> Return R of F = R U, det F > 0.
  pure function polar_rotation(f) result(rotation)
    !> Deformation gradient.
    real(wp), intent(in) :: f(3, 3)
    real(wp) :: rotation(3, 3)

    real(wp) :: green(6), x(6), y(6), yy(6), strain(6), inverse_stretch(6)
    logical :: positive

    green = green_of(f)
    if (is_small(green)) then
      call powers_of_tanh(green, x, y, yy)
      call inverse_series(x, y, yy, inverse_stretch)
    else
      call large_stretch(matmul(transpose(f), f), strain, inverse_stretch, positive)
    end if
    call multiply(f, inverse_stretch, rotation)
  end function polar_rotation

  !> Return (F^T F - I)/2, plain components 11 22 33 23 31 12.
  pure function green_of(f) result(green)
    !> Deformation gradient.
    real(wp), intent(in) :: f(3, 3)
    real(wp) :: green(6)

    real(wp) :: h(3, 3)
    integer :: i

    h = f
    do i = 1, 3
      h(i, i) = h(i, i) - 1.0_wp
    end do
    green(1) = h(1, 1) + 0.5_wp*(h(1, 1)*h(1, 1) + h(2, 1)*h(2, 1) + h(3, 1)*h(3, 1))
    green(2) = h(2, 2) + 0.5_wp*(h(1, 2)*h(1, 2) + h(2, 2)*h(2, 2) + h(3, 2)*h(3, 2))
    green(3) = h(3, 3) + 0.5_wp*(h(1, 3)*h(1, 3) + h(2, 3)*h(2, 3) + h(3, 3)*h(3, 3))
    green(4) = 0.5_wp*(h(2, 3) + h(3, 2) + h(1, 2)*h(1, 3) + h(2, 2)*h(2, 3) + h(3, 2)*h(3, 3))
    green(5) = 0.5_wp*(h(3, 1) + h(1, 3) + h(1, 3)*h(1, 1) + h(2, 3)*h(2, 1) + h(3, 3)*h(3, 1))
    green(6) = 0.5_wp*(h(1, 2) + h(2, 1) + h(1, 1)*h(1, 2) + h(2, 1)*h(2, 2) + h(3, 1)*h(3, 2))
  end function green_of

  !> Evaluate ln U and U^-1 of a Green strain that need not belong to a deformation gradient.
  pure subroutine stretch_of_green(green, strain, inverse_stretch, positive)
    !> Green strain e = (C-I)/2, plain components 11 22 33 23 31 12.
    real(wp), intent(in) :: green(6)
    !> Logarithmic strain and U^-1, plain components; undefined if not `positive`.
    real(wp), intent(out) :: strain(6), inverse_stretch(6)
    !> Whether C is positive definite.
    logical, intent(out) :: positive

    real(wp) :: c(3, 3)
    integer :: i

    positive = .true.
    if (is_small(green)) then
      call small_stretch(green, strain, inverse_stretch)
      return
    end if
    c = 2.0_wp*reshape([green(1), green(6), green(5), green(6), green(2), green(4), &
        green(5), green(4), green(3)], [3, 3])
    do i = 1, 3
      c(i, i) = c(i, i) + 1.0_wp
    end do
    call large_stretch(c, strain, inverse_stretch, positive)
  end subroutine stretch_of_green

  !> Whether the series hold for a Green strain.
  pure logical function is_small(green)
    !> Plain components.
    real(wp), intent(in) :: green(6)

    is_small = green(1)**2 + green(2)**2 + green(3)**2 &
        + 2.0_wp*(green(4)**2 + green(5)**2 + green(6)**2) <= series_limit**2
  end function is_small

  !> Evaluate ln U and U^-1 by series in X = tanh E.
  pure subroutine small_stretch(green, strain, inverse_stretch)
    !> Green strain e = (C-I)/2, plain components.
    real(wp), intent(in) :: green(6)
    !> Logarithmic strain, plain components.
    real(wp), intent(out) :: strain(6)
    !> U^-1, plain components.
    real(wp), intent(out) :: inverse_stretch(6)

    real(wp) :: s(6), x(6), y(6), yy(6), inner(6)

    call powers_of_tanh(green, x, y, yy)
    inner = y/7.0_wp + yy/9.0_wp
    inner(1:3) = inner(1:3) + 0.2_wp
    call product_of(yy, inner, s)
    s = s + y/3.0_wp
    s(1:3) = s(1:3) + 1.0_wp
    call product_of(x, s, strain)
    call inverse_series(x, y, yy, inverse_stretch)
  end subroutine small_stretch

  !> Evaluate X = e (I+e)^-1, X^2 and X^4.
  pure subroutine powers_of_tanh(green, x, y, yy)
    !> Green strain e, plain components.
    real(wp), intent(in) :: green(6)
    !> Plain components.
    real(wp), intent(out) :: x(6), y(6), yy(6)

    real(wp) :: s(6), inner(6), det

    s = green
    s(1:3) = s(1:3) + 1.0_wp
    inner = [s(2)*s(3) - s(4)*s(4), s(3)*s(1) - s(5)*s(5), s(1)*s(2) - s(6)*s(6), &
        s(5)*s(6) - s(1)*s(4), s(6)*s(4) - s(2)*s(5), s(4)*s(5) - s(3)*s(6)]
    det = s(1)*inner(1) + s(6)*inner(6) + s(5)*inner(5)
    inner = inner/det
    call product_of(green, inner, x)
    call product_of(x, x, y)
    call product_of(y, y, yy)
  end subroutine powers_of_tanh

  !> Evaluate U^-1 = sqrt((I-X)/(I+X)).
  pure subroutine inverse_series(x, y, yy, inverse_stretch)
    !> X, X^2 and X^4, plain components.
    real(wp), intent(in) :: x(6), y(6), yy(6)
    !> Plain components.
    real(wp), intent(out) :: inverse_stretch(6)

    real(wp) :: s(6), inner(6)

    inner = (5.0_wp/16.0_wp)*y + (35.0_wp/128.0_wp)*yy
    inner(1:3) = inner(1:3) + 0.375_wp
    call product_of(yy, inner, s)
    s = s + 0.5_wp*y
    s(1:3) = s(1:3) + 1.0_wp
    call product_of(x, s, inner)
    inverse_stretch = s - inner
  end subroutine inverse_series

  !> Evaluate ln U and U^-1 from the eigenvalues of C = U^2.
  pure subroutine large_stretch(c, strain, inverse_stretch, positive)
    real(wp), intent(in) :: c(3, 3)
    !> Logarithmic strain, plain components.
    real(wp), intent(out) :: strain(6)
    !> U^-1, plain components.
    real(wp), intent(out) :: inverse_stretch(6)
    !> Whether C is positive definite; otherwise the results are zero.
    logical, intent(out) :: positive

    real(wp) :: values(3), vectors(3, 3), dyad(6)
    integer :: k

    call symmetric_eigen(c, values, vectors)
    positive = all(values > 0.0_wp)
    strain = 0.0_wp
    inverse_stretch = 0.0_wp
    if (.not. positive) return
    do k = 1, 3
      dyad(1:3) = vectors(:, k)*vectors(:, k)
      dyad(4:6) = vectors([2, 3, 1], k)*vectors([3, 1, 2], k)
      strain = strain + 0.5_wp*log(values(k))*dyad
      inverse_stretch = inverse_stretch + dyad/sqrt(values(k))
    end do
  end subroutine large_stretch

  !> Multiply two symmetric matrices that commute; the product is symmetric.
  pure subroutine product_of(a, b, c)
    !> Plain components 11 22 33 23 31 12.
    real(wp), intent(in) :: a(6), b(6)
    real(wp), intent(out) :: c(6)

    c(1) = a(1)*b(1) + a(6)*b(6) + a(5)*b(5)
    c(2) = a(6)*b(6) + a(2)*b(2) + a(4)*b(4)
    c(3) = a(5)*b(5) + a(4)*b(4) + a(3)*b(3)
    c(4) = a(6)*b(5) + a(2)*b(4) + a(4)*b(3)
    c(5) = a(5)*b(1) + a(4)*b(6) + a(3)*b(5)
    c(6) = a(1)*b(6) + a(6)*b(2) + a(5)*b(4)
  end subroutine product_of

  !> Multiply a matrix by a symmetric one.
  pure subroutine multiply(f, s, r)
    real(wp), intent(in) :: f(3, 3)
    !> Symmetric factor, plain components.
    real(wp), intent(in) :: s(6)
    real(wp), intent(out) :: r(3, 3)

    r(:, 1) = f(:, 1)*s(1) + f(:, 2)*s(6) + f(:, 3)*s(5)
    r(:, 2) = f(:, 1)*s(6) + f(:, 2)*s(2) + f(:, 3)*s(4)
    r(:, 3) = f(:, 1)*s(5) + f(:, 2)*s(4) + f(:, 3)*s(3)
  end subroutine multiply

  !> Return Q^T E Q as a Kelvin vector.
  pure subroutine to_material(q, plain, kelvin)
    !> Material axes as columns.
    real(wp), intent(in) :: q(3, 3)
    !> Tensor in the global frame, plain components.
    real(wp), intent(in) :: plain(6)
    !> Tensor in the material frame, Kelvin.
    real(wp), intent(out) :: kelvin(6)

    real(wp) :: eq(3, 3)

    eq(1, :) = plain(1)*q(1, :) + plain(6)*q(2, :) + plain(5)*q(3, :)
    eq(2, :) = plain(6)*q(1, :) + plain(2)*q(2, :) + plain(4)*q(3, :)
    eq(3, :) = plain(5)*q(1, :) + plain(4)*q(2, :) + plain(3)*q(3, :)
    kelvin(1) = q(1, 1)*eq(1, 1) + q(2, 1)*eq(2, 1) + q(3, 1)*eq(3, 1)
    kelvin(2) = q(1, 2)*eq(1, 2) + q(2, 2)*eq(2, 2) + q(3, 2)*eq(3, 2)
    kelvin(3) = q(1, 3)*eq(1, 3) + q(2, 3)*eq(2, 3) + q(3, 3)*eq(3, 3)
    kelvin(4) = sqrt2*(q(1, 2)*eq(1, 3) + q(2, 2)*eq(2, 3) + q(3, 2)*eq(3, 3))
    kelvin(5) = sqrt2*(q(1, 3)*eq(1, 1) + q(2, 3)*eq(2, 1) + q(3, 3)*eq(3, 1))
    kelvin(6) = sqrt2*(q(1, 1)*eq(1, 2) + q(2, 1)*eq(2, 2) + q(3, 1)*eq(3, 2))
  end subroutine to_material

  !> Return R Q, orthonormalised by one step of Q (3 I - Q^T Q)/2 so that round-off does not
  !> accumulate.
  pure subroutine rotate_axes(r, committed, trial)
    !> Rotation of the increment.
    real(wp), intent(in) :: r(3, 3)
    !> Material axes Q, as columns.
    real(wp), intent(in) :: committed(3, 3)
    !> Material axes R Q.
    real(wp), intent(out) :: trial(3, 3)

    real(wp) :: raw(3, 3), s(6)
    integer :: j

    do j = 1, 3
      raw(:, j) = r(:, 1)*committed(1, j) + r(:, 2)*committed(2, j) + r(:, 3)*committed(3, j)
    end do
    s(1) = raw(1, 1)**2 + raw(2, 1)**2 + raw(3, 1)**2
    s(2) = raw(1, 2)**2 + raw(2, 2)**2 + raw(3, 2)**2
    s(3) = raw(1, 3)**2 + raw(2, 3)**2 + raw(3, 3)**2
    s(4) = raw(1, 2)*raw(1, 3) + raw(2, 2)*raw(2, 3) + raw(3, 2)*raw(3, 3)
    s(5) = raw(1, 3)*raw(1, 1) + raw(2, 3)*raw(2, 1) + raw(3, 3)*raw(3, 1)
    s(6) = raw(1, 1)*raw(1, 2) + raw(2, 1)*raw(2, 2) + raw(3, 1)*raw(3, 2)
    s = -0.5_wp*s
    s(1:3) = s(1:3) + 1.5_wp
    call multiply(raw, s, trial)
  end subroutine rotate_axes

end module dd3_element_log_strain
