! SPDX-License-Identifier: GPL-3.0-or-later
!> Solid-shell: 8 nodes, 2 x 2 columns of integration points through the thickness, assumed natural
!> transverse shear and thickness strain, enhanced thickness strain, mid-surface and directors that
!> are quadratic along the edges. For small angles between its sections one layer bends exactly
!> whatever the ratio of its length to its thickness. zeta runs through the thickness, from nodes
!> 1-4 to nodes 5-8.
!>
!> Kernels: `shell_deform` (strain increments, with `shell_strain` and `shell_modes`),
!> `shell_force`, `shell_stiffness`.
!> Sources: Dvorkin & Bathe 1984 and Hauptmann & Schweizerhof 1998 (assumed shear), Betsch & Stein
!> 1995 (assumed thickness strain), Buechter, Ramm & Roehl 1994 and Klinkel & Wagner 1997 (enhanced
!> thickness strain), Simo & Rifai 1990 and Andelfinger & Ramm 1993 (enhanced membrane strain),
!> Katili 1993 (directors).
module dd3_element_solid_shell
  use dd3_base_kinds, only : wp
  use dd3_element_gauss, only : gauss_legendre
  use dd3_element_hex8, only : hex8_shape, set_hex8_faces
  use dd3_element_shell_deform, only : shell_deform, shell_linearise, shell_rate
  use dd3_element_shell_force, only : shell_force, shell_stress
  use dd3_element_shell_stiffness, only : shell_stiffness
  use dd3_element_shell_work, only : corner, n_column, n_parameter, plane_point
  use dd3_element_table, only : complete_table, element_t, new_table, set_table_point
  implicit none
  private
  public :: new_solid_shell

contains

  !> Fill the table for n points in each column; those of a column follow one another, upwards.
  subroutine new_solid_shell(self, n)
    type(element_t), intent(out) :: self
    integer, intent(in) :: n

    real(wp) :: height(n), weight(n)
    integer :: k, p, q

    call new_table(self, "solid_shell", n_node=8, n_point=n_column*n)
    self%title = "8 nodes, 2x2 columns of points, assumed shear, enhanced thickness strain"
    self%n_thickness_point = n
    self%n_enhanced = n_parameter
    call set_hex8_faces(self)
    call gauss_legendre(n, height, weight)
    do q = 1, n_column
      do k = 1, n
        p = (q - 1)*n + k
        call set_table_point(self, p, [plane_point(:, q), height(k)], weight(k))
      end do
    end do
    call extrapolate(n, height, self%extrapolation)
    call complete_table(self, hex8_shape)
    self%deform => shell_deform
    self%linearise => shell_linearise
    self%set_stress => shell_stress
    self%evaluate_force => shell_force
    self%evaluate_stiffness => shell_stiffness
    self%evaluate_rate => shell_rate
  end subroutine new_solid_shell

  !> Set the factors of the nodal values: linear in zeta from the two points nearest to the face, as
  !> the stress has kinks within, and bilinear in the plane.
  pure subroutine extrapolate(n, height, factor)
    integer, intent(in) :: n
    !> zeta of the points.
    real(wp), intent(in) :: height(n)
    !> `(node, point)`.
    real(wp), intent(out) :: factor(:, :)

    real(wp) :: plane, slope
    integer :: a, q

    factor = 0.0_wp
    slope = (1.0_wp - height(n))/(height(n) - height(n - 1))
    do q = 1, n_column
      do a = 1, 4
        plane = 0.25_wp*(1.0_wp + 3.0_wp*corner(1, a)*plane_point(1, q)) &
            *(1.0_wp + 3.0_wp*corner(2, a)*plane_point(2, q))
        factor(a, (q - 1)*n + 1) = plane*(1.0_wp + slope)
        factor(a, (q - 1)*n + 2) = -plane*slope
        factor(a + 4, q*n - 1) = -plane*slope
        factor(a + 4, q*n) = factor(a + 4, q*n) + plane*(1.0_wp + slope)
      end do
    end do
  end subroutine extrapolate

end module dd3_element_solid_shell
