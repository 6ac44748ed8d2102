! SPDX-License-Identifier: GPL-3.0-or-later
!> Exact tangent moduli of the incremental update: dT = c : d + w T - T w for any change of shape
!> d + w, d symmetric, w skew.
!>
!> In the eigenbasis of the log strain E = ln U, with h_ij = E_i - E_j, the rates are
!>   dE_ij = d_ij h_ij/sinh(h_ij),   (R^T dR)_ij = w_ij - tanh(h_ij/2) d_ij
!> (d, w in the unrotated frame). Both are functions of the commutator ad(d) = E d - d E, so no
!> eigenbasis is needed. Let Z be the 3x6 matrix that maps d (Kelvin) to the commutator's axial
!> vector (times sqrt 2), B = Z Z^T, Z_T the same for the stress, and C the material's
!> d stress/d strain. Then
!>   c = C - (C Z^T P(B) - Z_T^T S(B)) Z,   P(x^2) = (1 - x/sinh x)/x^2,   S(x^2) = tanh(x/2)/x.
!> B has the eigenvalues h_ij^2. P and S are power series if these are small; otherwise they use the
!> eigenvectors of E, the k-th of which is the axial vector of the pair (i,j). Rates of U and R:
!> Hill, Aspects of invariance in solid mechanics, 1978.
module dd3_element_moduli
  use dd3_base_kinds, only : half_sqrt2, wp
  use dd3_linalg_tensor, only : kelvin_rotation, symmetric_eigen, tensor_from_kelvin
  implicit none
  private
  public :: point_moduli, material_moduli, commutator

  !> Largest trace of B for the power series; their remainder is under 1e-14 of the moduli.
  real(wp), parameter :: series_limit = 1.0e-3_wp

contains

  !> Evaluate the moduli in the global frame, Kelvin.
  pure subroutine point_moduli(strain, stress, tangent, rotation, moduli)
    !> Logarithmic strain increment, Kelvin, material frame.
    real(wp), intent(in) :: strain(6)
    !> Cauchy stress, MPa, Kelvin, material frame.
    real(wp), intent(in) :: stress(6)
    !> d stress/d strain, MPa, material frame.
    real(wp), intent(in) :: tangent(6, 6)
    !> Trial material axes, as columns.
    real(wp), intent(in) :: rotation(3, 3)
    !> Moduli, MPa.
    real(wp), intent(out) :: moduli(6, 6)

    real(wp) :: c(6, 6), cr(6, 6), r(6, 6)
    integer :: j, k

    call material_moduli(strain, stress, tangent, c)
    r = kelvin_rotation(rotation)
    do j = 1, 6
      cr(:, j) = 0.0_wp
      do k = 1, 6
        cr(:, j) = cr(:, j) + c(:, k)*r(j, k)
      end do
    end do
    do j = 1, 6
      moduli(:, j) = 0.0_wp
      do k = 1, 6
        moduli(:, j) = moduli(:, j) + r(:, k)*cr(k, j)
      end do
    end do
  end subroutine point_moduli

  !> Evaluate the moduli in the material frame, Kelvin. At zero strain they are the tangent.
  pure subroutine material_moduli(strain, stress, tangent, moduli)
    !> Logarithmic strain increment, Kelvin, material frame.
    real(wp), intent(in) :: strain(6)
    !> Cauchy stress, MPa, Kelvin, material frame.
    real(wp), intent(in) :: stress(6)
    !> d stress/d strain, MPa, material frame.
    real(wp), intent(in) :: tangent(6, 6)
    !> Moduli, MPa.
    real(wp), intent(out) :: moduli(6, 6)

    real(wp) :: z(3, 6), zt(3, 6), b(3, 3), p(3, 3), s(3, 3), cz(6, 3), x(6, 3)
    integer :: i, j

    if (all(abs(strain) <= 0.0_wp)) then
      moduli = tangent
      return
    end if
    call commutator(strain, z)
    call commutator(stress, zt)
    do j = 1, 3
      do i = 1, 3
        b(i, j) = z(i, 1)*z(j, 1) + z(i, 2)*z(j, 2) + z(i, 3)*z(j, 3) + z(i, 4)*z(j, 4) &
            + z(i, 5)*z(j, 5) + z(i, 6)*z(j, 6)
      end do
    end do
    if (b(1, 1) + b(2, 2) + b(3, 3) <= series_limit) then
      call small_functions(b, p, s)
    else
      call large_functions(strain, p, s)
    end if
    do j = 1, 3
      cz(:, j) = tangent(:, 1)*z(j, 1) + tangent(:, 2)*z(j, 2) + tangent(:, 3)*z(j, 3) &
          + tangent(:, 4)*z(j, 4) + tangent(:, 5)*z(j, 5) + tangent(:, 6)*z(j, 6)
    end do
    do j = 1, 3
      do i = 1, 6
        x(i, j) = cz(i, 1)*p(1, j) + cz(i, 2)*p(2, j) + cz(i, 3)*p(3, j) &
            - zt(1, i)*s(1, j) - zt(2, i)*s(2, j) - zt(3, i)*s(3, j)
      end do
    end do
    do j = 1, 6
      moduli(:, j) = tangent(:, j) - x(:, 1)*z(1, j) - x(:, 2)*z(2, j) - x(:, 3)*z(3, j)
    end do
  end subroutine material_moduli

  !> Return the matrix Z that maps d (Kelvin) to sqrt(2) times the axial vector of E d - d E.
  pure subroutine commutator(kelvin, z)
    !> E, Kelvin.
    real(wp), intent(in) :: kelvin(6)
    real(wp), intent(out) :: z(3, 6)

    real(wp) :: e23, e31, e12

    e23 = half_sqrt2*kelvin(4)
    e31 = half_sqrt2*kelvin(5)
    e12 = half_sqrt2*kelvin(6)
    z(1, :) = [0.0_wp, kelvin(4), -kelvin(4), kelvin(3) - kelvin(2), -e12, e31]
    z(2, :) = [-kelvin(5), 0.0_wp, kelvin(5), e12, kelvin(1) - kelvin(3), -e23]
    z(3, :) = [kelvin(6), -kelvin(6), 0.0_wp, -e31, e23, kelvin(2) - kelvin(1)]
  end subroutine commutator

  !> Evaluate P(B) and S(B) by power series.
  pure subroutine small_functions(b, p, s)
    real(wp), intent(in) :: b(3, 3)
    real(wp), intent(out) :: p(3, 3), s(3, 3)

    real(wp) :: bb(3, 3)
    integer :: j

    do j = 1, 3
      bb(:, j) = b(:, 1)*b(1, j) + b(:, 2)*b(2, j) + b(:, 3)*b(3, j)
    end do
    p = (-7.0_wp/360.0_wp)*b + (31.0_wp/15120.0_wp)*bb
    s = (-1.0_wp/24.0_wp)*b + (1.0_wp/240.0_wp)*bb
    do j = 1, 3
      p(j, j) = p(j, j) + 1.0_wp/6.0_wp
      s(j, j) = s(j, j) + 0.5_wp
    end do
  end subroutine small_functions

  !> Evaluate P(B) and S(B) from the eigenvectors of E.
  pure subroutine large_functions(strain, p, s)
    !> E, Kelvin.
    real(wp), intent(in) :: strain(6)
    real(wp), intent(out) :: p(3, 3), s(3, 3)

    real(wp) :: values(3), vectors(3, 3), h
    integer :: j, k

    call symmetric_eigen(tensor_from_kelvin(strain), values, vectors)
    p = 0.0_wp
    s = 0.0_wp
    do k = 1, 3
      h = abs(values(1 + mod(k, 3)) - values(1 + mod(k + 1, 3)))
      do j = 1, 3
        p(:, j) = p(:, j) + strain_factor(h)*vectors(:, k)*vectors(j, k)
        s(:, j) = s(:, j) + spin_factor(h)*vectors(:, k)*vectors(j, k)
      end do
    end do
  end subroutine large_functions

  !> Return (1 - h/sinh h)/h^2.
  pure real(wp) function strain_factor(h) result(factor)
    !> Difference of two log stretches.
    real(wp), intent(in) :: h

    real(wp) :: y

    if (h < 0.3_wp) then
      y = h*h
      factor = 1.0_wp/6.0_wp - y*(7.0_wp/360.0_wp - y*(31.0_wp/15120.0_wp &
          - y*(127.0_wp/604800.0_wp - y*(73.0_wp/3421440.0_wp &
          - y*(1414477.0_wp/653837184000.0_wp - y*8191.0_wp/37362124800.0_wp)))))
    else
      factor = (1.0_wp - h/sinh(h))/(h*h)
    end if
  end function strain_factor

  !> Return tanh(h/2)/h.
  pure real(wp) function spin_factor(h) result(factor)
    !> Difference of two log stretches.
    real(wp), intent(in) :: h

    if (h < 1.0e-5_wp) then
      factor = 0.5_wp - h*h/24.0_wp
    else
      factor = tanh(0.5_wp*h)/h
    end if
  end function spin_factor

end module dd3_element_moduli
