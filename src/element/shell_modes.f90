!> Modes of the solid-shell's enhanced strains, with parameters that are internal to the element and
!> to the increment.
!>
!> 1. Thickness strain linear in zeta, e_33 += zeta (a_1 + a_2 xi + a_3 eta): bending contracts one
!>    half of a section and dilates the other (Buechter, Ramm & Roehl 1994; Klinkel & Wagner 1997).
!> 2. Directors that are quadratic along the edges, d += b (1 - xi^2) G^1 and likewise along eta, a
!>    parameter for each edge. A shear force changes the moment along the edge, so its curvature is
!>    linear: e_11 += -2 xi zeta b. The shear strain, constant along the edge, gets the mean of the
!>    new part, 2 e_13 += 2/3 b (the quadrilateral DKMQ, Katili 1993). Eliminating b from an elastic
!>    beam leaves the residual bending flexibility a^2/(12 EI) of MacNeal 1978: a beam loaded at its
!>    nodes has the exact deflection. Without b the difference between the chord and the mean
!>    of the directors would be shear alone.
!>
!> The directors add the square of their displacement's derivative, (2 xi zeta b)^2/2 |G^1|^2, to
!> e_11. Its second derivative times the stress is the initial stress of b: without it a stretched
!> sheet would be unstable at a tangent modulus of twice the stress, not of the stress.
!>
!> They also add to e_33. With the contravariant metric a^ij of the mid-surface the mean director
!> has the square g_33 = (normal part)^2 + a^ij g_i3 g_j3, in which b changes g_i3 by its shear s_i:
!>   e_33 += a^ij (g_i3 + 2 e_i3 + s_i/2) s_j,   s_i = 2/3 b,   e_i3 without it.
!> Where b relieves the shear of a tilt between two tools the fibres are upright again and have
!> their former length. Without these terms the pressure would do work, and the sheet would buckle.
!>
!> In torsion the change of the twisting moment across the edge balances the shear force, and no
!> bending belongs to it. It does so within about a thickness: the shear of b is multiplied by
!> w^2/(w^2 + t^2) in an element of width w. Where elements lie on one another, tractions between
!> them balance it, and b has no shear: it would be too large at any size of the elements.
!>
!> Strains that are linear in zeta are transformed with the base at the centre and (j_0/j), so that
!> they do no work in a constant state of bending (Simo & Rifai 1990).
module dd3_element_shell_modes
  use dd3_base_kinds, only : wp
  use dd3_element_shell_work, only : bending_strain, mode_of, mode_shape, n_column, n_general, &
      n_mode, n_natural, n_parameter, plane_point, shear_of, shell_work_t, thickness_strain
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: set_modes, enhance, enhanced_rates, tilt_operators, natural_resultants, mode_forces

  !> Coefficient of zeta^2 that a mode of the directors has.
  integer, parameter, public :: square_strain(n_mode) = [0, 3, 6]

contains

  !> Evaluate the modes in the committed configuration; call `column_geometry` first.
  pure subroutine set_modes(shell, stacked)
    !> Gets `mode`, `mode_square`, `surface_metric`, `transverse_metric`, `centre_normal` and
    !> `centre_jacobian`; without positive determinants there are no modes.
    type(shell_work_t), intent(inout) :: shell
    !> Whether elements lie on one another.
    logical, intent(in) :: stacked

    real(wp) :: g(3, 2), base(3, 3), director(3), scale, shear, c(2)
    integer :: i, j, q

    associate (at => shell%committed)
      ! The means of the columns, whose points lie symmetrically about the centre.
      g = 0.25_wp*sum(at%membrane, dim=3)
      director = 0.25_wp*sum(at%director, dim=2)
      base(:, 1) = cross(g(:, 2), director)
      base(:, 2) = cross(director, g(:, 1))
      base(:, 3) = cross(g(:, 1), g(:, 2))
      shell%centre_jacobian = dot_product(base(:, 3), director)
      shell%centre_normal = 0.0_wp
      shell%mode = 0.0_wp
      shell%mode_square = 0.0_wp
      shell%surface_metric = 0.0_wp
      shell%transverse_metric = 0.0_wp
      if (.not. min(shell%centre_jacobian, minval(shell%column_jacobian)) > 0.0_wp) return
      base = base/shell%centre_jacobian
      shell%centre_normal = base(:, 3)
      shell%mode(n_general, 1, :) = 1.0_wp
      shell%surface_metric = contravariant_metric(g)
      shell%transverse_metric = matmul(director, g)
      do j = 1, 2
        ! A parameter is the motion of the face times half the thickness, as for the thickness.
        scale = norm2(g(:, j))/norm2(director)
        shear = 2.0_wp/3.0_wp*scale*sum(g(:, 3 - j)**2)/(sum(g(:, 3 - j)**2) + sum(director**2))
        if (stacked) shear = 0.0_wp
        do q = 1, n_column
          do i = 1, 2
            c(i) = dot_product(base(:, j), at%membrane(:, i, q))
          end do
          shell%mode(bending_strain, 1 + j, q) = -2.0_wp*plane_point(j, q)*scale &
              *shell%centre_jacobian/shell%column_jacobian(q)*[c(1)**2, c(2)**2, 2.0_wp*c(1)*c(2)]
          shell%mode_square(1 + j, q) = sum((2.0_wp*plane_point(j, q)*scale*base(:, j))**2)
          shell%mode(shear_of(j), 1 + j, q) = shear
        end do
      end do
    end associate
  end subroutine set_modes

  !> Return the contravariant metric of a surface with two tangents.
  pure function contravariant_metric(tangent) result(inverse)
    real(wp), intent(in) :: tangent(3, 2)
    real(wp) :: inverse(2, 2)

    real(wp) :: metric(2, 2)

    metric = matmul(transpose(tangent), tangent)
    inverse(:, 1) = [metric(2, 2), -metric(1, 2)]
    inverse(:, 2) = [-metric(1, 2), metric(1, 1)]
    inverse = inverse/(metric(1, 1)*metric(2, 2) - metric(1, 2)**2)
  end function contravariant_metric

  !> Add the enhanced strains to the generalised ones.
  pure subroutine enhance(shell, enhanced)
    !> Gets also the derivatives `mode` and `tilt` at these parameters.
    type(shell_work_t), intent(inout) :: shell
    !> Parameters, mm2.
    real(wp), intent(in) :: enhanced(n_parameter)

    real(wp) :: amount(n_mode), transverse(2), shear(2), slope(2)
    integer :: j, k, m, q

    do q = 1, n_column
      amount = amounts(enhanced, q)
      transverse = shell%transverse_metric + shell%strain(shear_of, q)
      do j = 1, 2
        shear(j) = amount(1 + j)*shell%mode(shear_of(j), 1 + j, q)
      end do
      shell%tilt(:, q) = matmul(shell%surface_metric, shear)
      shell%strain(thickness_strain, q) = shell%strain(thickness_strain, q) &
          + dot_product(shell%tilt(:, q), transverse + 0.5_wp*shear)
      do m = 1, n_mode
        shell%strain(:, q) = shell%strain(:, q) + amount(m)*shell%mode(:, m, q)
        k = square_strain(m)
        if (k == 0) cycle
        shell%strain(k, q) = shell%strain(k, q) + 0.5_wp*shell%mode_square(m, q)*amount(m)**2
        shell%mode(k, m, q) = shell%mode_square(m, q)*amount(m)
      end do
      slope = matmul(shell%surface_metric, transverse + shear)
      do j = 1, 2
        shell%mode(thickness_strain, 1 + j, q) = shell%mode(shear_of(j), 1 + j, q)*slope(j)
      end do
    end do
  end subroutine enhance

  !> Add the rates of the enhanced strains to generalised rates.
  pure subroutine enhanced_rates(shell, enhanced, strain)
    type(shell_work_t), intent(in) :: shell
    !> Rates of the parameters, mm2.
    real(wp), intent(in) :: enhanced(n_parameter)
    real(wp), intent(inout) :: strain(n_general, n_column)

    integer :: q

    do q = 1, n_column
      strain(:, q) = strain(:, q) + matmul(shell%mode(:, :, q), amounts(enhanced, q))
    end do
  end subroutine enhanced_rates

  !> Return the amounts of the modes at a column.
  pure function amounts(enhanced, q) result(amount)
    real(wp), intent(in) :: enhanced(n_parameter)
    integer, intent(in) :: q
    real(wp) :: amount(n_mode)

    integer :: i

    amount = 0.0_wp
    do i = 1, n_parameter
      amount(mode_of(i)) = amount(mode_of(i)) + mode_shape(i, q)*enhanced(i)
    end do
  end function amounts

  !> Add the derivatives of the modes' thickness strain to those of the natural strains.
  pure subroutine tilt_operators(shell)
    !> Holds `tilt`; gets `operator`.
    type(shell_work_t), intent(inout) :: shell

    integer :: j, q

    do q = 1, n_column
      do j = 1, 2
        shell%operator(:, thickness_strain, q) = shell%operator(:, thickness_strain, q) &
            + shell%tilt(j, q)*shell%operator(:, shear_of(j), q)
      end do
    end do
  end subroutine tilt_operators

  !> Return the forces conjugate to the natural strains without modes, N mm.
  pure function natural_resultants(shell) result(force)
    !> Holds `tilt` and the resultants.
    type(shell_work_t), intent(in) :: shell
    real(wp) :: force(n_natural, n_column)

    integer :: q

    force = shell%resultant(:n_natural, :)
    do q = 1, n_column
      force(shear_of, q) = force(shear_of, q) + shell%tilt(:, q)*force(thickness_strain, q)
    end do
  end function natural_resultants

  !> Return the forces conjugate to the parameters, N/mm.
  pure function mode_forces(shell) result(force)
    !> Holds the resultants.
    type(shell_work_t), intent(in) :: shell
    real(wp) :: force(n_parameter)

    integer :: i, q

    force = 0.0_wp
    do q = 1, n_column
      do i = 1, n_parameter
        force(i) = force(i) + mode_shape(i, q) &
            *dot_product(shell%mode(:, mode_of(i), q), shell%resultant(:, q))
      end do
    end do
  end function mode_forces

end module dd3_element_shell_modes
