! SPDX-License-Identifier: GPL-3.0-or-later
!> Workspace of the solid-shell's kernels, and what they share: the numbering of the generalised
!> strains and of the points.
!>
!> The element has four columns of integration points, at the 2 x 2 Gauss points of the plane. The
!> covariant strains of a column are polynomials in zeta, with 14 coefficients that are the same for
!> all its points (Green-Lagrange, shear strains doubled):
!>   e_11, e_22, 2 e_12 : three coefficients each, of 1, zeta, zeta^2;
!>   e_33, 2 e_23, 2 e_13 : constant, from the assumed strains;
!>   2 e_23, 2 e_13 : a second coefficient each, of zeta.
!> The 15th is the enhanced thickness strain, times zeta.
module dd3_element_shell_work
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: columns_t, shell_work_t, new_shell_work
  public :: n_column, n_corner, n_natural, n_general, n_mode, n_parameter, corner, plane_point
  public :: membrane_strain, bending_strain, thickness_strain, shear_of, shear_slope_of, mode_of, &
      edge_shape, mode_shape, natural_strain, powers_of

  !> Number of columns of points, of corners in the plane, and of generalised strains without and
  !> with the enhanced one.
  integer, parameter :: n_column = 4, n_corner = 4, n_natural = 14, n_general = 15
  !> Positions of the coefficients of 1 and of zeta in e_11, e_22 and 2 e_12; of e_33; and of those
  !> of 1 and of zeta in the shears 2 e_13, 2 e_23 of the edges along xi and eta.
  integer, parameter :: membrane_strain(3) = [1, 4, 7], bending_strain(3) = [2, 5, 8], &
      thickness_strain = 10, shear_of(2) = [12, 11], shear_slope_of(2) = [14, 13]
  !> Strain to which a coefficient belongs, in the order e_11, e_22, 2 e_12, e_33, 2 e_23, 2 e_13,
  !> enhanced.
  integer, parameter :: natural_strain(n_general) = [1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 5, 6, 5, 6, 7]
  !> Number of modes of enhanced strain (thickness, directors along xi and along eta, mid-surface
  !> along xi and along eta), and of their parameters.
  integer, parameter :: n_mode = 5, n_parameter = 11
  !> xi and eta of the corners in the order of the nodes; those of the columns are smaller by
  !> sqrt(3).
  real(wp), parameter :: corner(2, n_corner) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, &
      1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp], [2, n_corner])
  real(wp), parameter :: plane_point(2, n_column) = corner/sqrt(3.0_wp)
  !> Mode of a parameter, and its shape in the plane at the columns: 1, xi, eta for the thickness,
  !> 1 at an edge and 0 at the one across for directors and mid-surface.
  integer, parameter :: mode_of(n_parameter) = [1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
  integer, private :: i
  !> Linear function at the columns that is 1 at an edge and 0 at the one across; edges eta = -1,
  !> eta = 1, xi = -1, xi = 1.
  real(wp), parameter :: edge_shape(4, n_column) = reshape([( &
      0.5_wp - 0.5_wp*plane_point(2, i), 0.5_wp + 0.5_wp*plane_point(2, i), &
      0.5_wp - 0.5_wp*plane_point(1, i), 0.5_wp + 0.5_wp*plane_point(1, i), i=1, n_column)], &
      [4, n_column])
  real(wp), parameter :: mode_shape(n_parameter, n_column) = reshape([([1.0_wp, &
      plane_point(:, i), edge_shape(:, i), edge_shape(:, i)], i=1, n_column)], &
      [n_parameter, n_column])

  !> Position as a function of zeta in the columns, x = x_0 + zeta d: tangents and directors.
  type :: columns_t
    !> dx_0/dxi and dx_0/deta, and those of the director, mm: `(3,2,n_column)`.
    real(wp) :: membrane(3, 2, n_column), bending(3, 2, n_column)
    !> Director d, half the thickness, mm: `(3,n_column)`.
    real(wp) :: director(3, n_column)
  end type columns_t

  !> Data of one element.
  type :: shell_work_t
    !> Shape functions of the plane and their derivatives in xi and eta at the columns.
    real(wp) :: shape(n_corner, n_column), slope(n_corner, 2, n_column)
    !> Committed and trial geometry of the columns, and their increment.
    type(columns_t) :: committed, trial
    !> Weight of the mean director in the mean thickness strain, 0 to 1.
    real(wp) :: centre_weight = 0.0_wp
    !> Factors of the natural strains: below 1 for those linear in zeta where directors differ, and
    !> a/(4 t) for the shears linear in zeta.
    real(wp) :: strain_factor(n_natural) = 1.0_wp
    !> Factors of the membrane strains in the parts of their shear that are linear in xi and in eta,
    !> and the strains to be removed for parts of 1: `(3,2,n_column)`.
    real(wp) :: shear_part(3, 2, n_column), shear_removed(3, 2, n_column)
    !> Generalised strains: `strain(n_general,n_column)`.
    real(wp) :: strain(n_general, n_column)
    !> Their derivatives in the amounts of the modes of enhanced strain, 1/mm2:
    !> `mode(n_general,n_mode,n_column)`; and the squares of the derivatives in xi and eta of the
    !> motion that the modes of an edge add, for amounts of 1, 1/mm4: `mode_square(2,n_column)`.
    real(wp) :: mode(n_general, n_mode, n_column), mode_square(2, n_column)
    !> Contravariant metric of the mid-surface, 1/mm2, and g_13, g_23 of the mean director, mm2, at
    !> the centre in the committed configuration.
    real(wp) :: surface_metric(2, 2), transverse_metric(2)
    !> Derivatives of the thickness strain in the shear strains 2 e_13, 2 e_23, due to the modes of
    !> the directors.
    real(wp) :: tilt(2, n_column)
    !> Derivatives of the natural strains in the nodal positions, 1/mm:
    !> `operator(24,n_natural,n_column)`.
    real(wp) :: operator(24, n_natural, n_column)
    !> Forces conjugate to the generalised strains, N mm: `resultant(n_general,n_column)`.
    real(wp) :: resultant(n_general, n_column)
    !> Contravariant vector of zeta, 1/mm, and Jacobian determinant, mm3, at the element's centre in
    !> the committed configuration.
    real(wp) :: centre_normal(3), centre_jacobian
    !> Contravariant base vectors, as columns, of the trial configuration before its rotation in the
    !> material frame, 1/mm: `base(3,3,n_point)`.
    real(wp), allocatable :: base(:, :, :)
    !> Vector of zeta at the centre, so transformed, times (j_0/j)^(1/2): `normal(3,n_point)`.
    real(wp), allocatable :: normal(:, :)
    !> Quadrature weight times Jacobian in the trial configuration, mm3: `volume(n_point)`.
    real(wp), allocatable :: volume(:)
  end type shell_work_t

contains

  !> Return the powers of zeta of the coefficients; the enhanced strain has its own.
  pure function powers_of(zeta) result(power)
    real(wp), intent(in) :: zeta
    real(wp) :: power(n_general)

    power = [1.0_wp, zeta, zeta*zeta, 1.0_wp, zeta, zeta*zeta, 1.0_wp, zeta, zeta*zeta, 1.0_wp, &
        1.0_wp, 1.0_wp, zeta, zeta, 1.0_wp]
  end function powers_of

  !> Allocate the workspace and evaluate the shape functions.
  subroutine new_shell_work(self, n_point)
    type(shell_work_t), intent(out) :: self
    !> Number of integration points of the element.
    integer, intent(in) :: n_point

    integer :: a, q

    do q = 1, n_column
      do a = 1, n_corner
        associate (part => 1.0_wp + plane_point(:, q)*corner(:, a))
          self%shape(a, q) = 0.25_wp*part(1)*part(2)
          self%slope(a, 1, q) = 0.25_wp*corner(1, a)*part(2)
          self%slope(a, 2, q) = 0.25_wp*corner(2, a)*part(1)
        end associate
      end do
    end do
    allocate (self%base(3, 3, n_point), self%normal(3, n_point), self%volume(n_point))
  end subroutine new_shell_work

end module dd3_element_shell_work
