! SPDX-License-Identifier: GPL-3.0-or-later
!> Algebra of 3-vectors, 3x3 tensors, Kelvin 6-vectors and small dense systems.
!>
!> Kelvin vectors (Thomson 1856; Mandel 1965; Mehrabadi and Cowin 1990, eq. 8) hold a symmetric
!> tensor as (11, 22, 33, sqrt(2) 23, sqrt(2) 31, sqrt(2) 12): the double contraction is the dot
!> product and a rotation of the axes is an orthogonal 6x6 matrix. Eigenvectors are found by Jacobi
!> rotations (Jacobi 1846; Rutishauser 1966).
module dd3_linalg_tensor
  use dd3_base_kinds, only : inverse_sqrt2, sqrt2, wp
  implicit none
  private
  public :: kelvin_factor
  public :: identity, kelvin_identity, kelvin_deviator_projector
  public :: kelvin_from_tensor, tensor_from_kelvin, kelvin_rotation, kelvin_deviator
  public :: determinant, inverse, symmetric_eigen
  public :: cross, rotation_about, solve_small

  !> Ratio of Kelvin to tensor components, for any order with the shears last.
  real(wp), parameter :: kelvin_factor(6) = [1.0_wp, 1.0_wp, 1.0_wp, sqrt2, sqrt2, sqrt2]
  real(wp), parameter :: third = 1.0_wp/3.0_wp

  !> Unit tensor of second order.
  real(wp), parameter :: identity(3, 3) = reshape([1.0_wp, 0.0_wp, 0.0_wp, &
                                                   0.0_wp, 1.0_wp, 0.0_wp, &
                                                   0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
  !> Unit tensor of second order as a Kelvin vector.
  real(wp), parameter :: kelvin_identity(6) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
  !> Kelvin matrix of the projection on the deviator.
  real(wp), parameter :: kelvin_deviator_projector(6, 6) = reshape( &
    [2*third, -third, -third, 0.0_wp, 0.0_wp, 0.0_wp, &
     -third, 2*third, -third, 0.0_wp, 0.0_wp, 0.0_wp, &
     -third, -third, 2*third, 0.0_wp, 0.0_wp, 0.0_wp, &
     0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, &
     0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
     0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [6, 6])

contains

  !> Return the Kelvin vector of the symmetric part of a tensor.
  pure function kelvin_from_tensor(t) result(v)
    real(wp), intent(in) :: t(3, 3)
    real(wp) :: v(6)

    v(1) = t(1, 1)
    v(2) = t(2, 2)
    v(3) = t(3, 3)
    v(4) = inverse_sqrt2*(t(2, 3) + t(3, 2))
    v(5) = inverse_sqrt2*(t(3, 1) + t(1, 3))
    v(6) = inverse_sqrt2*(t(1, 2) + t(2, 1))
  end function kelvin_from_tensor

  !> Return the symmetric tensor of a Kelvin vector.
  pure function tensor_from_kelvin(v) result(t)
    real(wp), intent(in) :: v(6)
    real(wp) :: t(3, 3)

    t(1, 1) = v(1)
    t(2, 2) = v(2)
    t(3, 3) = v(3)
    t(2, 3) = inverse_sqrt2*v(4)
    t(3, 1) = inverse_sqrt2*v(5)
    t(1, 2) = inverse_sqrt2*v(6)
    t(3, 2) = t(2, 3)
    t(1, 3) = t(3, 1)
    t(2, 1) = t(1, 2)
  end function tensor_from_kelvin

  !> Return the orthogonal 6x6 matrix R of a rotation q: R v = Kelvin(q t q^T) for v = Kelvin(t).
  pure function kelvin_rotation(q) result(r)
    real(wp), intent(in) :: q(3, 3)
    real(wp) :: r(6, 6)

    ! Pairs of indices of the shear components 23, 31, 12.
    integer, parameter :: first(3) = [2, 3, 1], second(3) = [3, 1, 2]
    integer :: i, j

    do j = 1, 3
      do i = 1, 3
        associate (a => first(i), b => second(i), c => first(j), d => second(j))
          r(i, j) = q(i, j)**2
          r(i, 3 + j) = sqrt2*q(i, c)*q(i, d)
          r(3 + i, j) = sqrt2*q(a, j)*q(b, j)
          r(3 + i, 3 + j) = q(a, c)*q(b, d) + q(a, d)*q(b, c)
        end associate
      end do
    end do
  end function kelvin_rotation

  !> Return the deviator of a Kelvin vector.
  pure function kelvin_deviator(v) result(s)
    real(wp), intent(in) :: v(6)
    real(wp) :: s(6)

    real(wp) :: mean

    mean = third*(v(1) + v(2) + v(3))
    s(1:3) = v(1:3) - mean
    s(4:6) = v(4:6)
  end function kelvin_deviator

  !> Return the determinant of a 3x3 matrix.
  pure real(wp) function determinant(a)
    real(wp), intent(in) :: a(3, 3)

    determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) &
        - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
  end function determinant

  !> Invert a 3x3 matrix by its cofactors.
  pure subroutine inverse(a, inverted, regular)
    real(wp), intent(in) :: a(3, 3)
    !> Inverse; zero if the matrix is singular.
    real(wp), intent(out) :: inverted(3, 3)
    logical, intent(out) :: regular

    real(wp) :: d, bound, factor

    inverted(1, 1) = a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)
    inverted(2, 1) = a(2, 3)*a(3, 1) - a(2, 1)*a(3, 3)
    inverted(3, 1) = a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1)
    d = a(1, 1)*inverted(1, 1) + a(1, 2)*inverted(2, 1) + a(1, 3)*inverted(3, 1)
    bound = abs(a(1, 1)*inverted(1, 1)) + abs(a(1, 2)*inverted(2, 1)) + abs(a(1, 3)*inverted(3, 1))
    regular = abs(d) > epsilon(1.0_wp)*bound .and. abs(d) > tiny(1.0_wp)
    if (.not. regular) then
      inverted = 0.0_wp
      return
    end if
    factor = 1.0_wp/d
    inverted(1, 2) = a(1, 3)*a(3, 2) - a(1, 2)*a(3, 3)
    inverted(2, 2) = a(1, 1)*a(3, 3) - a(1, 3)*a(3, 1)
    inverted(3, 2) = a(1, 2)*a(3, 1) - a(1, 1)*a(3, 2)
    inverted(1, 3) = a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2)
    inverted(2, 3) = a(1, 3)*a(2, 1) - a(1, 1)*a(2, 3)
    inverted(3, 3) = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
    inverted = factor*inverted
  end subroutine inverse

  !> Return the eigenvalues and orthonormal eigenvectors of a symmetric 3x3 matrix, in no particular
  !> order. Rotations by negligible off-diagonal entries are skipped, so a nearly diagonal matrix is
  !> cheap; equal eigenvalues are no special case.
  pure subroutine symmetric_eigen(a, values, vectors)
    !> Matrix; its lower triangle is not used.
    real(wp), intent(in) :: a(3, 3)
    real(wp), intent(out) :: values(3)
    !> Eigenvectors as columns.
    real(wp), intent(out) :: vectors(3, 3)

    ! Convergence is quadratic and takes three or four sweeps.
    integer, parameter :: max_sweeps = 12
    ! Off-diagonal entries below this count as zero: their squares would underflow.
    real(wp), parameter :: floor = 1.0e-150_wp
    real(wp) :: x, y, z, small
    integer :: sweep

    values = [a(1, 1), a(2, 2), a(3, 3)]
    x = a(2, 3)
    y = a(1, 3)
    z = a(1, 2)
    vectors = identity
    small = max(0.25_wp*epsilon(1.0_wp)*(sum(abs(values)) + abs(x) + abs(y) + abs(z)), floor)
    do sweep = 1, max_sweeps
      if (abs(x) + abs(y) + abs(z) <= small) exit
      if (abs(z) > 0.1_wp*small) then
        call rotate(values(1), values(2), z, y, x, vectors(:, 1), vectors(:, 2))
      end if
      if (abs(y) > 0.1_wp*small) then
        call rotate(values(1), values(3), y, z, x, vectors(:, 1), vectors(:, 3))
      end if
      if (abs(x) > 0.1_wp*small) then
        call rotate(values(2), values(3), x, z, y, vectors(:, 2), vectors(:, 3))
      end if
    end do
  end subroutine symmetric_eigen

  !> Apply the Jacobi rotation in the plane (p, q) that makes a_pq vanish.
  pure subroutine rotate(a_pp, a_qq, a_pq, a_rp, a_rq, v_p, v_q)
    real(wp), intent(inout) :: a_pp, a_qq, a_pq
    !> Entries that couple the plane with the third axis.
    real(wp), intent(inout) :: a_rp, a_rq
    !> Columns p and q of the eigenvectors.
    real(wp), intent(inout) :: v_p(3), v_q(3)

    real(wp) :: difference, t, c, s, v(3), w

    difference = a_qq - a_pp
    t = 2*a_pq/(difference + sign(sqrt(difference*difference + 4*a_pq*a_pq), difference))
    c = 1.0_wp/sqrt(1.0_wp + t*t)
    s = t*c
    a_pp = a_pp - t*a_pq
    a_qq = a_qq + t*a_pq
    a_pq = 0.0_wp
    w = a_rp
    a_rp = c*w - s*a_rq
    a_rq = s*w + c*a_rq
    v = v_p
    v_p = c*v - s*v_q
    v_q = s*v + c*v_q
  end subroutine rotate

  !> Return the cross product a x b.
  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
  end function cross

  !> Return the matrix of a rotation about an axis.
  !> Source: Rodrigues, J. Math. Pures Appl. 5 (1840) 380-440.
  pure function rotation_about(axis, angle) result(rotation)
    !> Unit vector, and the angle, rad.
    real(wp), intent(in) :: axis(3), angle
    real(wp) :: rotation(3, 3)

    integer :: j

    do j = 1, 3
      rotation(:, j) = cos(angle)*identity(:, j) + sin(angle)*cross(axis, identity(:, j)) &
          + (1.0_wp - cos(angle))*axis(j)*axis
    end do
  end function rotation_about

  !> Solve a small dense system for several right-hand sides, in place, by elimination with partial
  !> pivoting.
  pure subroutine solve_small(n, m, a, b, regular)
    !> Number of equations, and of right-hand sides.
    integer, intent(in) :: n, m
    !> Matrix; overwritten.
    real(wp), intent(inout) :: a(n, n)
    !> Right-hand sides, replaced by the solutions; undefined for a singular matrix.
    real(wp), intent(inout) :: b(n, m)
    !> False if a pivot is zero to round-off, relative to its column.
    logical, intent(out) :: regular

    real(wp) :: column(n), factor, largest, saved
    integer :: i, j, k, pivot

    regular = .false.
    do k = 1, n
      column(k) = 0.0_wp
      do i = 1, n
        if (abs(a(i, k)) > column(k)) column(k) = abs(a(i, k))
      end do
    end do
    do k = 1, n
      pivot = k
      largest = abs(a(k, k))
      do i = k + 1, n
        if (abs(a(i, k)) > largest) then
          pivot = i
          largest = abs(a(i, k))
        end if
      end do
      if (.not. largest > epsilon(1.0_wp)*column(k)) return
      if (pivot /= k) then
        do j = k, n
          saved = a(k, j)
          a(k, j) = a(pivot, j)
          a(pivot, j) = saved
        end do
        do j = 1, m
          saved = b(k, j)
          b(k, j) = b(pivot, j)
          b(pivot, j) = saved
        end do
      end if
      factor = 1.0_wp/a(k, k)
      do i = k + 1, n
        a(i, k) = a(i, k)*factor
      end do
      a(k, k) = factor
      do j = k + 1, n
        do i = k + 1, n
          a(i, j) = a(i, j) - a(i, k)*a(k, j)
        end do
      end do
      do j = 1, m
        do i = k + 1, n
          b(i, j) = b(i, j) - a(i, k)*b(k, j)
        end do
      end do
    end do
    do j = 1, m
      do k = n, 1, -1
        b(k, j) = b(k, j)*a(k, k)
        do i = 1, k - 1
          b(i, j) = b(i, j) - a(i, k)*b(k, j)
        end do
      end do
    end do
    regular = .true.
  end subroutine solve_small

end module dd3_linalg_tensor
