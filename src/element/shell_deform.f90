! SPDX-License-Identifier: GPL-3.0-or-later
!> Deformation of the solid-shell at its integration points.
!>
!> With the committed material axes Q and the contravariant base G^i of the committed configuration,
!> the Green strain in the material frame is
!>   e = sum e_ij Q^T G^i (x) Q^T G^j
!>       + (j_0/j) zeta (a_1 + a_2 xi + a_3 eta) Q^T G_0^3 (x) Q^T G_0^3,
!> e_ij the natural strains with the modes of `shell_modes`, j and 0 the Jacobian determinant and
!> the centre of the element. Of the thickness strain one parameter is sufficient on parallelograms;
!> the two others make bending exact on any flat element. Then C = I + 2 e, U = C^(1/2), and the
!> strain increment of the material is ln U. The material axes of a column rotate with R of the
!> compatible F = R U_F in its middle: directors turn with the mid-surface but for their shear,
!> which is constant in zeta.
module dd3_element_shell_deform
  use dd3_base_kinds, only : sqrt2, wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, &
      cause_inverted, cause_inverted_strain
  use dd3_element_log_strain, only : polar_rotation, rotate_axes, stretch_of_green
  use dd3_element_shell_modes, only : enhance, enhanced_rates, set_modes
  use dd3_element_shell_plane, only : set_plane_shear
  use dd3_element_shell_strain, only : column_geometry, set_weights, natural_rates, &
      natural_strains
  use dd3_element_shell_work, only : columns_t, n_column, n_general, n_natural, shell_work_t
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : cross, determinant
  implicit none
  private
  public :: shell_deform, shell_linearise, shell_rate

contains

  !> Evaluate strain increments and trial material axes.
  subroutine shell_deform(element, rotation_committed, work, verdict)
    type(element_t), intent(in) :: element
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    type(element_work_t), intent(inout) :: work
    !> Retry, with the point, if a Jacobian determinant is not positive or no stretch belongs to the
    !> assumed strain.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: rotation(3, 3)
    integer :: k, p, q

    verdict%outcome = verdict_converged
    associate (shell => work%shell, n => element%n_point/n_column)
      call column_geometry(work%x_committed, work%x_trial, shell)
      call set_modes(shell, element%stacked)
      call set_plane_shear(shell)
      call set_weights(work%x_initial, work%x_committed, shell)
      call natural_strains(work%x_committed, work%x_trial, shell)
      call enhance(shell, work%enhanced)
      do q = 1, n_column
        do k = 1, n
          p = (q - 1)*n + k
          call deform_point(q, p, element%point(3, p), rotation_committed(:, :, p), &
              element%weight(p), work, verdict)
          verdict%point = p
          if (verdict%outcome /= verdict_converged) return
        end do
        call rotate_column(shell, q, rotation, verdict)
        if (verdict%outcome /= verdict_converged) return
        do k = 1, n
          p = (q - 1)*n + k
          call rotate_axes(rotation, rotation_committed(:, :, p), work%rotation(:, :, p))
        end do
      end do
    end associate
  end subroutine shell_deform

  !> Evaluate the committed configuration without an increment.
  subroutine shell_linearise(element, rotation_committed, work, verdict)
    type(element_t), intent(in) :: element
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    type(element_work_t), intent(inout) :: work
    type(verdict_t), intent(out) :: verdict

    real(wp) :: enhanced(size(work%enhanced))

    enhanced = work%enhanced
    work%enhanced = 0.0_wp
    work%x_trial(:, :) = work%x_committed
    call shell_deform(element, rotation_committed, work, verdict)
    work%enhanced = enhanced
  end subroutine shell_linearise

  !> Deform a point.
  subroutine deform_point(q, p, zeta, axes, weight, work, verdict)
    !> Column and point.
    integer, intent(in) :: q, p
    real(wp), intent(in) :: zeta
    !> Committed material axes, as columns.
    real(wp), intent(in) :: axes(3, 3)
    !> Quadrature weight.
    real(wp), intent(in) :: weight
    type(element_work_t), intent(inout) :: work
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: base(3, 3), normal(3), jacobian
    real(wp) :: green(6), strain(6), inverse_stretch(6)
    logical :: positive
    integer :: i

    associate (shell => work%shell)
      call contravariant_base(shell%committed, q, zeta, base, jacobian)
      if (.not. (jacobian > 0.0_wp &
          .and. determinant(covariant_base(shell%trial, q, zeta)) > 0.0_wp)) then
        call refuse_inverted(verdict)
        return
      end if
      base = matmul(transpose(axes), base)
      normal = sqrt(shell%centre_jacobian/jacobian)*matmul(shell%centre_normal, axes)
      green = green_strain(base, natural_at(shell%strain(:, q), zeta))
      green = green + shell%strain(n_general, q)*zeta*dyad(normal, normal)
      call stretch_of_green(green, strain, inverse_stretch, positive)
      if (.not. positive) then
        verdict%outcome = verdict_retry
        verdict%cause = cause_inverted_strain
        return
      end if
      work%strain(1:3, p) = strain(1:3)
      work%strain(4:6, p) = sqrt2*strain(4:6)
      shell%volume(p) = weight*jacobian*exp(strain(1) + strain(2) + strain(3))
      do i = 1, 3
        shell%base(:, i, p) = symmetric_times(inverse_stretch, base(:, i))
      end do
      shell%normal(:, p) = symmetric_times(inverse_stretch, normal)
    end associate
  end subroutine deform_point

  !> Evaluate the rotation of a column in its middle, R of F = g_i (x) G^i.
  subroutine rotate_column(shell, q, rotation, verdict)
    type(shell_work_t), intent(in) :: shell
    !> Column.
    integer, intent(in) :: q
    real(wp), intent(out) :: rotation(3, 3)
    type(verdict_t), intent(inout) :: verdict

    real(wp) :: g(3, 3), base(3, 3), jacobian

    rotation = 0.0_wp
    call contravariant_base(shell%committed, q, 0.0_wp, base, jacobian)
    g = covariant_base(shell%trial, q, 0.0_wp)
    if (jacobian > 0.0_wp .and. determinant(g) > 0.0_wp) then
      rotation = polar_rotation(matmul(g, transpose(base)))
    else
      call refuse_inverted(verdict)
    end if
  end subroutine rotate_column

  !> State that a Jacobian determinant is not positive.
  subroutine refuse_inverted(verdict)
    type(verdict_t), intent(inout) :: verdict

    verdict%outcome = verdict_retry
    verdict%cause = cause_inverted
  end subroutine refuse_inverted

  !> Evaluate the contravariant base at a point.
  pure subroutine contravariant_base(at, q, zeta, base, jacobian)
    type(columns_t), intent(in) :: at
    !> Column.
    integer, intent(in) :: q
    real(wp), intent(in) :: zeta
    !> Base vectors as columns, 1/mm; zero if they do not exist.
    real(wp), intent(out) :: base(3, 3)
    !> Jacobian determinant, mm3; zero or less if the base does not exist.
    real(wp), intent(out) :: jacobian

    real(wp) :: g(3, 3)

    g = covariant_base(at, q, zeta)
    base(:, 1) = cross(g(:, 2), g(:, 3))
    base(:, 2) = cross(g(:, 3), g(:, 1))
    base(:, 3) = cross(g(:, 1), g(:, 2))
    jacobian = dot_product(g(:, 1), base(:, 1))
    if (jacobian > 0.0_wp) then
      base = base/jacobian
    else
      base = 0.0_wp
    end if
  end subroutine contravariant_base

  !> Return dx/dxi, dx/deta, dx/dzeta at a point as columns, mm.
  pure function covariant_base(at, q, zeta) result(g)
    type(columns_t), intent(in) :: at
    !> Column.
    integer, intent(in) :: q
    real(wp), intent(in) :: zeta
    real(wp) :: g(3, 3)

    g(:, 1) = at%membrane(:, 1, q) + zeta*at%bending(:, 1, q)
    g(:, 2) = at%membrane(:, 2, q) + zeta*at%bending(:, 2, q)
    g(:, 3) = at%director(:, q)
  end function covariant_base

  !> Return e_11, e_22, 2 e_12, e_33, 2 e_23, 2 e_13 at a height from their coefficients.
  pure function natural_at(coefficient, zeta) result(strain)
    real(wp), intent(in) :: coefficient(n_general)
    real(wp), intent(in) :: zeta
    real(wp) :: strain(6)

    integer :: k

    do k = 1, 3
      strain(k) = coefficient(3*k - 2) + zeta*(coefficient(3*k - 1) + zeta*coefficient(3*k))
    end do
    strain(4) = coefficient(10)
    strain(5:6) = coefficient(11:12) + zeta*coefficient(13:14)
  end function natural_at

  !> Return the tensor of natural strains, plain components 11 22 33 23 31 12.
  pure function green_strain(base, strain) result(green)
    !> Contravariant base vectors as columns, 1/mm.
    real(wp), intent(in) :: base(3, 3)
    !> In the order of `natural_at`.
    real(wp), intent(in) :: strain(6)
    real(wp) :: green(6)

    green = strain(1)*dyad(base(:, 1), base(:, 1)) + strain(2)*dyad(base(:, 2), base(:, 2)) &
        + strain(3)*dyad(base(:, 1), base(:, 2)) + strain(4)*dyad(base(:, 3), base(:, 3)) &
        + strain(5)*dyad(base(:, 2), base(:, 3)) + strain(6)*dyad(base(:, 1), base(:, 3))
  end function green_strain

  !> Return the symmetric part of a (x) b, plain components 11 22 33 23 31 12.
  pure function dyad(a, b) result(plain)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: plain(6)

    plain(1:3) = a*b
    plain(4) = 0.5_wp*(a(2)*b(3) + a(3)*b(2))
    plain(5) = 0.5_wp*(a(3)*b(1) + a(1)*b(3))
    plain(6) = 0.5_wp*(a(1)*b(2) + a(2)*b(1))
  end function dyad

  !> Return the product of a symmetric tensor, plain components, and a vector.
  pure function symmetric_times(s, v) result(w)
    real(wp), intent(in) :: s(6), v(3)
    real(wp) :: w(3)

    w(1) = s(1)*v(1) + s(6)*v(2) + s(5)*v(3)
    w(2) = s(6)*v(1) + s(2)*v(2) + s(4)*v(3)
    w(3) = s(5)*v(1) + s(4)*v(2) + s(3)*v(3)
  end function symmetric_times

  !> Evaluate the strain increments of first order in the material frame, and the rotations; call
  !> `shell_linearise` first.
  subroutine shell_rate(element, du, rotation_committed, work)
    type(element_t), intent(in) :: element
    !> Trial displacement, mm.
    real(wp), intent(in) :: du(:, :)
    !> Committed material axes, which `linearise` has used.
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    !> Holds the increment of the enhanced parameters; gets the increments.
    type(element_work_t), intent(inout) :: work

    real(wp) :: natural(n_natural, n_column), general(n_general, n_column), plain(6), spin(3), &
        gradient(3, 3)
    type(columns_t) :: motion
    integer :: i, k, n, p, q

    associate (shell => work%shell)
      call natural_rates(du, work%x_trial, shell, natural, motion)
      general(:n_natural, :) = natural
      general(n_general, :) = 0.0_wp
      call enhanced_rates(shell, work%enhanced, general)
      n = element%n_point/n_column
      do q = 1, n_column
        do k = 1, n
          p = (q - 1)*n + k
          associate (zeta => element%point(3, p), base => shell%base(:, :, p))
            plain = green_strain(base, natural_at(general(:, q), zeta)) &
                + general(n_general, q)*zeta*dyad(shell%normal(:, p), shell%normal(:, p))
            gradient = matmul(transpose(rotation_committed(:, :, p)), &
                covariant_base(motion, q, zeta))
            spin = 0.0_wp
            do i = 1, 3
              spin = spin + 0.5_wp*cross(base(:, i), gradient(:, i))
            end do
          end associate
          work%strain_increment(1:3, p) = plain(1:3)
          work%strain_increment(4:6, p) = sqrt2*plain(4:6)
          work%rotation_increment(p) = norm2(spin)
        end do
      end do
    end associate
  end subroutine shell_rate

end module dd3_element_shell_deform
