! SPDX-License-Identifier: GPL-3.0-or-later
!> Internal forces of the solid-shell. S = J U^-1 T U^-1 is the second Piola-Kirchhoff stress on the
!> committed configuration, T the Cauchy stress before the rotation of the increment, so the forces
!>   f = sum w j (de/dx) : S
!> have no derivative of the rotation in them. With the base vectors U^-1 G^i of `shell_deform` the
!> stresses conjugate to the natural strains are w j J (U^-1 G^i) . T . (U^-1 G^j).
module dd3_element_shell_force
  use dd3_base_kinds, only : inverse_sqrt2, wp
  use dd3_element_shell_modes, only : mode_forces, tilt_operators
  use dd3_element_shell_operators, only : strain_operators
  use dd3_element_shell_work, only : n_column, n_natural, natural_strain, &
      powers_of, shell_work_t
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: shell_stress, shell_force, point_operator

contains

  !> Evaluate the stresses conjugate to the natural strains and their resultants; call
  !> `shell_deform` and set `work%stress` first.
  subroutine shell_stress(element, work)
    type(element_t), intent(in) :: element
    !> Sets `shell%resultant`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: operator(6, 7), stress(7), zeta
    integer :: c, k, n, p, q

    n = element%n_point/n_column
    associate (shell => work%shell)
      shell%resultant = 0.0_wp
      do q = 1, n_column
        do k = 1, n
          p = (q - 1)*n + k
          zeta = element%point(3, p)
          operator = point_operator(shell%base(:, :, p), shell%normal(:, p), zeta)
          do c = 1, 7
            stress(c) = shell%volume(p)*dot_product(operator(:, c), work%stress(:, p))
          end do
          shell%resultant(:, q) = shell%resultant(:, q) &
              + powers_of(zeta)*stress(natural_strain)
        end do
      end do
    end associate
  end subroutine shell_stress

  !> Evaluate the internal forces, also those of the enhanced parameters; call `shell_stress` first.
  subroutine shell_force(element, work)
    type(element_t), intent(in) :: element
    !> Sets `force` and `enhanced_force`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: force(24)
    integer :: k, q

    associate (shell => work%shell)
      call strain_operators(work%x_trial, shell)
      call tilt_operators(shell)
      force = 0.0_wp
      do q = 1, n_column
        do k = 1, n_natural
          force = force + shell%resultant(k, q)*shell%operator(:, k, q)
        end do
      end do
      work%enhanced_force(:) = mode_forces(shell)
      work%force(:, :) = reshape(force, [3, element%n_node])
    end associate
  end subroutine shell_force

  !> Return the factors of the six natural strain rates and of the enhanced one in the rate of
  !> deformation U^-1 (de) U^-1, Kelvin, material frame, as columns.
  pure function point_operator(base, normal, zeta) result(operator)
    !> Base vectors as columns, and the enhanced direction.
    real(wp), intent(in) :: base(3, 3), normal(3)
    real(wp), intent(in) :: zeta
    real(wp) :: operator(6, 7)

    operator(:, 1) = kelvin_dyad(base(:, 1), base(:, 1))
    operator(:, 2) = kelvin_dyad(base(:, 2), base(:, 2))
    operator(:, 3) = kelvin_dyad(base(:, 1), base(:, 2))
    operator(:, 4) = kelvin_dyad(base(:, 3), base(:, 3))
    operator(:, 5) = kelvin_dyad(base(:, 2), base(:, 3))
    operator(:, 6) = kelvin_dyad(base(:, 1), base(:, 3))
    operator(:, 7) = zeta*kelvin_dyad(normal, normal)
  end function point_operator

  !> Return the symmetric part of a (x) b, Kelvin.
  pure function kelvin_dyad(a, b) result(kelvin)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: kelvin(6)

    kelvin(1:3) = a*b
    kelvin(4) = inverse_sqrt2*(a(2)*b(3) + a(3)*b(2))
    kelvin(5) = inverse_sqrt2*(a(3)*b(1) + a(1)*b(3))
    kelvin(6) = inverse_sqrt2*(a(1)*b(2) + a(2)*b(1))
  end function kelvin_dyad

end module dd3_element_shell_force
