!> Mean dilatation of the solid-shell: of the natural strains that are constant through the
!> thickness all columns of the element get the same dilatation, in which the thickness strain
!> counts in part.
!>
!> In its plane the element is bilinear, and nodes share their thickness: where it bends in its
!> plane or thins unevenly, thickness strain and in-plane strain cannot balance in each column, and
!> plastic flow at constant volume would lock (selective reduced integration, Hughes 1980). With the
!> whole dilatation averaged, however, nothing but shear would resist a thickness that changes in
!> turns from node to node. With a fraction f of the thickness strain the elastic volume resists
!> such turns with (1 - f)^2.
!>
!> With the metric G_ij of the committed configuration the dilatation averaged is
!>   G^11 e_11 + G^22 e_22 + 2 G^12 e_12 + f (G^33 e_33 + 2 G^23 e_23 + 2 G^13 e_13),
!> and the strains of a dilatation are G_ij/3. The map is linear; its adjoint applies to the
!> resultants.
module dd3_element_shell_dilatation
  use dd3_base_kinds, only : wp
  use dd3_element_shell_work, only : n_column, n_natural, shell_work_t
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: set_dilatation, average_dilatation, average_resultants

  !> Coefficients of e_11, e_22, 2 e_12, e_33, 2 e_23, 2 e_13 that are constant in zeta.
  integer, parameter :: constant(6) = [1, 4, 7, 10, 11, 12]
  !> Fraction f of the thickness strain (docs/solid_shell.md, Formulation).
  real(wp), parameter :: thickness_fraction = 1.0_wp/3.0_wp

contains

  !> Evaluate the metric of the columns in the committed configuration.
  pure subroutine set_dilatation(shell)
    !> Holds the committed columns; gets `column_jacobian`, `column_fraction`, `trace` and
    !> `dilatation`. The strains stay as they are if a determinant is not positive.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: g(3, 3), base(3, 3), inverse(6)
    integer :: q

    shell%trace = 0.0_wp
    shell%dilatation = 0.0_wp
    shell%column_fraction = 0.0_wp
    do q = 1, n_column
      g(:, 1:2) = shell%committed%membrane(:, :, q)
      g(:, 3) = shell%committed%director(:, q)
      base(:, 1) = cross(g(:, 2), g(:, 3))
      base(:, 2) = cross(g(:, 3), g(:, 1))
      base(:, 3) = cross(g(:, 1), g(:, 2))
      shell%column_jacobian(q) = dot_product(g(:, 1), base(:, 1))
      if (.not. shell%column_jacobian(q) > 0.0_wp) cycle
      inverse = metric(base)/shell%column_jacobian(q)**2
      shell%trace(:, q) = [inverse(:3), thickness_fraction*inverse(4:)]
      shell%dilatation(:, q) = metric(g)*[1.0_wp, 1.0_wp, 2.0_wp, 1.0_wp, 2.0_wp, 2.0_wp]/3.0_wp
    end do
    if (all(shell%column_jacobian > 0.0_wp)) then
      shell%column_fraction = shell%column_jacobian/sum(shell%column_jacobian)
    else
      shell%trace = 0.0_wp
    end if
  end subroutine set_dilatation

  !> Return the scalar products 11, 22, 12, 33, 23, 13 of three vectors.
  pure function metric(g) result(product)
    real(wp), intent(in) :: g(3, 3)
    real(wp) :: product(6)

    product = [dot_product(g(:, 1), g(:, 1)), dot_product(g(:, 2), g(:, 2)), &
        dot_product(g(:, 1), g(:, 2)), dot_product(g(:, 3), g(:, 3)), &
        dot_product(g(:, 2), g(:, 3)), dot_product(g(:, 1), g(:, 3))]
  end function metric

  !> Give the strains that are constant in zeta the mean dilatation.
  pure subroutine average_dilatation(shell, strain)
    type(shell_work_t), intent(in) :: shell
    !> Of the columns, or their derivatives.
    real(wp), intent(inout) :: strain(:, :)

    real(wp) :: excess(n_column)
    integer :: q

    do q = 1, n_column
      excess(q) = dot_product(shell%trace(:, q), strain(constant, q))
    end do
    excess = excess - dot_product(shell%column_fraction, excess)
    do q = 1, n_column
      strain(constant, q) = strain(constant, q) - excess(q)*shell%dilatation(:, q)
    end do
  end subroutine average_dilatation

  !> Turn forces conjugate to the natural strains into those before the dilatation is averaged.
  pure subroutine average_resultants(shell, force)
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(inout) :: force(n_natural, n_column)

    real(wp) :: pressure(n_column)
    integer :: q

    do q = 1, n_column
      pressure(q) = dot_product(shell%dilatation(:, q), force(constant, q))
    end do
    pressure = pressure - shell%column_fraction*sum(pressure)
    do q = 1, n_column
      force(constant, q) = force(constant, q) - pressure(q)*shell%trace(:, q)
    end do
  end subroutine average_resultants

end module dd3_element_shell_dilatation
