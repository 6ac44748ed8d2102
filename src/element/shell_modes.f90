! SPDX-License-Identifier: GPL-3.0-or-later
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
!> 3. A mid-surface that is quadratic along the edges, x_0 += c (1 - xi^2) G^1 and likewise along
!>    eta, a parameter for each edge: e_11 += -2 xi c (Simo & Rifai 1990; Andelfinger & Ramm 1993).
!>    The force along the edge is then the same at its ends. A sheet that is bent under tension
!>    stretches where its curvature changes; with a constant membrane strain the end that is not
!>    being bent would hold it back. And the area of each column can change with its thickness, as
!>    plastic flow at constant volume demands.
!>
!> The derivative of the added motion has the square (2 xi)^2 (c + zeta b)^2 |G^1|^2, half of which
!> is in e_11. Its second derivatives times the stress are the initial stress of b and c: without it
!> a stretched sheet would be unstable at a tangent modulus of twice the stress, not of the stress.
!>
!> The directors also add to e_33. With the contravariant metric a^ij of the mid-surface the mean
!> director has the square g_33 = (normal part)^2 + a^ij g_i3 g_j3, in which b changes g_i3 by its
!> shear s_i:
!>   e_33 += a^ij (g_i3 + 2 e_i3 + s_i/2) s_j,   s_i = 2/3 b,   e_i3 without it.
!> Where b relieves the shear of a tilt between two tools the fibres are upright again and have
!> their former length. Without these terms the pressure would do work, and the sheet would buckle.
!>
!> In torsion the change of the twisting moment across the edge balances the shear force, and no
!> bending belongs to it. It does so within about a thickness: the shear of b is multiplied by
!> w^2/(w^2 + t^2) in an element of width w. Where elements lie on one another, tractions between
!> them balance it, and b has no shear: it would be too large at any size of the elements.
!>
!> The strains of the modes are transformed with the base at the centre and (j_0/j), so that they do
!> no work in a constant state of membrane stress and of bending (Simo & Rifai 1990).
module dd3_element_shell_modes
  use dd3_base_kinds, only : wp
  use dd3_element_shell_work, only : bending_strain, membrane_strain, mode_of, mode_shape, &
      n_column, n_general, n_mode, n_natural, n_parameter, plane_point, shear_of, shell_work_t, &
      thickness_strain
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: contravariant_metric, set_modes, enhance, enhanced_rates, tilt_operators, &
      natural_resultants, mode_forces, second_derivatives

  !> Modes of the mid-surface and of the directors along xi, and along eta; and the coefficients of
  !> 1, zeta, zeta^2 in e_11 and in e_22.
  integer, parameter :: mid_mode(2) = [4, 5], director_mode(2) = [2, 3]
  integer, parameter :: direct_strain(3, 2) = reshape([1, 2, 3, 4, 5, 6], [3, 2])

contains

  !> Evaluate the modes in the committed configuration; call `column_geometry` first.
  pure subroutine set_modes(shell, stacked)
    !> Gets `mode`, `mode_square`, `surface_metric`, `transverse_metric`, `centre_normal` and
    !> `centre_jacobian`; without positive determinants there are no modes.
    type(shell_work_t), intent(inout) :: shell
    !> Whether elements lie on one another.
    logical, intent(in) :: stacked

    real(wp) :: g(3, 2), base(3, 3), director(3), strain(3), jacobian(n_column), scale, c(2)
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
      do q = 1, n_column
        jacobian(q) = dot_product(cross(at%membrane(:, 1, q), at%membrane(:, 2, q)), &
            at%director(:, q))
      end do
      if (.not. (shell%centre_jacobian > 0.0_wp .and. all(jacobian > 0.0_wp))) return
      base = base/shell%centre_jacobian
      shell%centre_normal = base(:, 3)
      shell%mode(n_general, 1, :) = 1.0_wp
      shell%surface_metric = contravariant_metric(g)
      shell%transverse_metric = matmul(director, g)
      do j = 1, 2
        ! A parameter is the motion of the face times half the thickness, as for the thickness.
        scale = norm2(g(:, j))/norm2(director)
        if (.not. stacked) shell%mode(shear_of(j), director_mode(j), :) = 2.0_wp/3.0_wp*scale &
            *sum(g(:, 3 - j)**2)/(sum(g(:, 3 - j)**2) + sum(director**2))
        do q = 1, n_column
          do i = 1, 2
            c(i) = dot_product(base(:, j), at%membrane(:, i, q))
          end do
          strain = -2.0_wp*plane_point(j, q)*scale*shell%centre_jacobian/jacobian(q) &
              *[c(1)**2, c(2)**2, 2.0_wp*c(1)*c(2)]
          shell%mode(bending_strain, director_mode(j), q) = strain
          shell%mode(membrane_strain, mid_mode(j), q) = strain
          shell%mode_square(j, q) = sum((2.0_wp*plane_point(j, q)*scale*base(:, j))**2)
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
    integer :: j, m, q

    do q = 1, n_column
      amount = amounts(enhanced, q)
      transverse = shell%transverse_metric + shell%strain(shear_of, q)
      shear = amount(director_mode)*mode_shear(shell, q)
      shell%tilt(:, q) = matmul(shell%surface_metric, shear)
      shell%strain(thickness_strain, q) = shell%strain(thickness_strain, q) &
          + dot_product(shell%tilt(:, q), transverse + 0.5_wp*shear)
      do m = 1, n_mode
        shell%strain(:, q) = shell%strain(:, q) + amount(m)*shell%mode(:, m, q)
      end do
      slope = mode_shear(shell, q)*matmul(shell%surface_metric, transverse + shear)
      do j = 1, 2
        shell%mode(thickness_strain, director_mode(j), q) = slope(j)
        call add_square(shell, j, q, amount(mid_mode(j)), amount(director_mode(j)))
      end do
    end do
  end subroutine enhance

  !> Add half the square of the derivative of the added motion.
  pure subroutine add_square(shell, j, q, mid, director)
    !> Gets also the derivatives `mode`.
    type(shell_work_t), intent(inout) :: shell
    !> Direction and column.
    integer, intent(in) :: j, q
    !> Amounts of mid-surface and director, mm2.
    real(wp), intent(in) :: mid, director

    associate (square => shell%mode_square(j, q), k => direct_strain(:, j))
      shell%strain(k, q) = shell%strain(k, q) &
          + square*[0.5_wp*mid**2, mid*director, 0.5_wp*director**2]
      shell%mode(k(:2), mid_mode(j), q) = shell%mode(k(:2), mid_mode(j), q) &
          + square*[mid, director]
      shell%mode(k(2:), director_mode(j), q) = shell%mode(k(2:), director_mode(j), q) &
          + square*[mid, director]
    end associate
  end subroutine add_square

  !> Return the shear strains 2 e_13, 2 e_23 of amounts of 1 of the directors' modes.
  pure function mode_shear(shell, q) result(shear)
    type(shell_work_t), intent(in) :: shell
    !> Column.
    integer, intent(in) :: q
    real(wp) :: shear(2)

    integer :: j

    shear = [(shell%mode(shear_of(j), director_mode(j), q), j=1, 2)]
  end function mode_shear

  !> Evaluate the resultants of a column times the second derivatives of the strains.
  pure subroutine second_derivatives(shell, q, own, coupling)
    !> Holds the resultants and the operators of the shear strains.
    type(shell_work_t), intent(in) :: shell
    !> Column.
    integer, intent(in) :: q
    !> In two amounts, N/mm3, and in a nodal position and an amount, N/mm2.
    real(wp), intent(out) :: own(n_mode, n_mode), coupling(24, n_mode)

    real(wp) :: shear(2), force(3), factor(2)
    integer :: j

    own = 0.0_wp
    coupling = 0.0_wp
    shear = mode_shear(shell, q)
    do j = 1, 2
      associate (mid => mid_mode(j), director => director_mode(j))
        force = shell%mode_square(j, q)*shell%resultant(direct_strain(:, j), q)
        own(mid, mid) = force(1)
        own(mid, director) = force(2)
        own(director, mid) = force(2)
        own(director, director) = force(3)
        factor = shell%resultant(thickness_strain, q)*shear(j)*shell%surface_metric(:, j)
        own(director_mode, director) = own(director_mode, director) + factor*shear
        coupling(:, director) = matmul(shell%operator(:, shear_of, q), factor)
      end associate
    end do
  end subroutine second_derivatives

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
