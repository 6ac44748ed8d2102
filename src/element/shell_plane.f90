! SPDX-License-Identifier: GPL-3.0-or-later
!> Shear strain of the solid-shell in its plane.
!>
!> An element with straight edges that bends in its plane shears: u_1 = xi eta has e_11 = eta/a and
!> 2 e_12 = xi/b, with the edges a along xi and b along eta, and this shear has (a/b)^2 G/E of the
!> energy of bending. The parts of 2 e_12 that are linear in xi and in eta are therefore multiplied
!> by 2 b/(5 a) and 2 a/(5 b), at most 1: a sixteenth of the energy of bending is left in elastic
!> material, at any ratio of the edges. Without them (reduced integration of the shear) nothing
!> would resist a tilt in turns of the edges of an element that is compressed in its plane.
!>
!> The part is taken from the shear in the base of the element's centre,
!>   2 e_12 = 2 G_1 . e . G_2,   d = 3/4 sum xi 2 e_12 over the columns,
!> and removed as (j_0/j) xi d G^1 (x) G^2: it vanishes in a constant strain and does no work in a
!> constant stress, so that distorted elements pass the patch test (Simo & Rifai 1990).
module dd3_element_shell_plane
  use dd3_base_kinds, only : wp
  use dd3_element_shell_modes, only : contravariant_metric
  use dd3_element_shell_work, only : membrane_strain, n_column, n_natural, plane_point, shell_work_t
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: set_plane_shear, reduce_strains, reduce_operators, reduce_resultants

  !> Part of the shear that is left in an element with equal edges.
  real(wp), parameter :: kept = 0.4_wp

contains

  !> Evaluate the parts of the shear in the committed configuration; call `set_modes` first.
  pure subroutine set_plane_shear(shell)
    !> Gets `shear_part` and `shear_removed`; without positive determinants they are zero.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: g(3, 2), m(2, 2), n(2, 2), ratio, jacobian, removed(2)
    integer :: j, q

    shell%shear_part = 0.0_wp
    shell%shear_removed = 0.0_wp
    if (.not. shell%centre_jacobian > 0.0_wp) return
    g = 0.25_wp*sum(shell%committed%membrane, dim=3)
    ratio = norm2(g(:, 2))/norm2(g(:, 1))
    removed = 1.0_wp - min(1.0_wp, kept*[ratio, 1.0_wp/ratio])
    do q = 1, n_column
      associate (tangent => shell%committed%membrane(:, :, q))
        jacobian = dot_product(cross(tangent(:, 1), tangent(:, 2)), shell%committed%director(:, q))
        if (.not. jacobian > 0.0_wp) cycle
        m = matmul(contravariant_metric(tangent), matmul(transpose(tangent), g))
        n = matmul(shell%surface_metric, matmul(transpose(g), tangent))
      end associate
      do j = 1, 2
        shell%shear_part(:, j, q) = 0.75_wp*plane_point(j, q)*[2.0_wp*m(1, 1)*m(1, 2), &
            2.0_wp*m(2, 1)*m(2, 2), m(1, 1)*m(2, 2) + m(1, 2)*m(2, 1)]
        shell%shear_removed(:, j, q) = removed(j)*plane_point(j, q)*shell%centre_jacobian/jacobian &
            *[n(1, 1)*n(2, 1), n(1, 2)*n(2, 2), n(1, 1)*n(2, 2) + n(1, 2)*n(2, 1)]
      end do
    end do
  end subroutine set_plane_shear

  !> Reduce the shear in natural strains.
  pure subroutine reduce_strains(shell, strain)
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(inout) :: strain(n_natural, n_column)

    real(wp) :: part(2)
    integer :: q

    part = 0.0_wp
    do q = 1, n_column
      part = part + matmul(strain(membrane_strain, q), shell%shear_part(:, :, q))
    end do
    do q = 1, n_column
      strain(membrane_strain, q) = strain(membrane_strain, q) &
          - matmul(shell%shear_removed(:, :, q), part)
    end do
  end subroutine reduce_strains

  !> Reduce the shear in the derivatives of the natural strains.
  pure subroutine reduce_operators(shell)
    !> Gets `operator`.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: part(24, 2)
    integer :: i, j, q

    part = 0.0_wp
    do q = 1, n_column
      do j = 1, 2
        do i = 1, 3
          part(:, j) = part(:, j) &
              + shell%shear_part(i, j, q)*shell%operator(:, membrane_strain(i), q)
        end do
      end do
    end do
    do q = 1, n_column
      do i = 1, 3
        associate (row => shell%operator(:, membrane_strain(i), q))
          row = row - shell%shear_removed(i, 1, q)*part(:, 1) &
              - shell%shear_removed(i, 2, q)*part(:, 2)
        end associate
      end do
    end do
  end subroutine reduce_operators

  !> Turn forces conjugate to the reduced strains into those conjugate to the whole ones.
  pure subroutine reduce_resultants(shell, force)
    type(shell_work_t), intent(in) :: shell
    !> N mm.
    real(wp), intent(inout) :: force(n_natural, n_column)

    real(wp) :: part(2)
    integer :: q

    part = 0.0_wp
    do q = 1, n_column
      part = part + matmul(force(membrane_strain, q), shell%shear_removed(:, :, q))
    end do
    do q = 1, n_column
      force(membrane_strain, q) = force(membrane_strain, q) &
          - matmul(shell%shear_part(:, :, q), part)
    end do
  end subroutine reduce_resultants

end module dd3_element_shell_plane
