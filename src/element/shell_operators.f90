! SPDX-License-Identifier: GPL-3.0-or-later
!> Derivatives of the natural strains of the solid-shell in the nodal positions, first and second;
!> see dd3_element_shell_strain.
module dd3_element_shell_operators
  use dd3_base_kinds, only : wp
  use dd3_element_shell_modes, only : natural_resultants
  use dd3_element_shell_plane, only : reduce_operators, reduce_resultants
  use dd3_element_shell_strain, only : along, edge, split
  use dd3_element_shell_work, only : edge_shape, n_column, n_corner, n_natural, shear_of, &
      shear_slope_of, shell_work_t, thickness_strain
  implicit none
  private
  public :: strain_operators, initial_stress

contains

  !> Evaluate the derivatives of the natural strains in the nodal positions.
  pure subroutine strain_operators(x, shell)
    !> Trial positions of the nodes, mm.
    real(wp), intent(in) :: x(3, 8)
    !> Gets `operator`.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: mid(3, 4), director(3, 4)
    integer :: j, q

    call split(x, mid, director)
    shell%operator = 0.0_wp
    do q = 1, n_column
      associate (m => shell%trial%membrane(:, :, q), b => shell%trial%bending(:, :, q), &
          slope => shell%slope(:, :, q), row => shell%operator(:, :, q))
        do j = 1, 2
          call add_row(m(:, j), slope(:, j), 0, row(:, 3*j - 2))
          call add_row(m(:, j), slope(:, j), 12, row(:, 3*j - 1))
          call add_row(b(:, j), slope(:, j), 0, row(:, 3*j - 1))
          call add_row(b(:, j), slope(:, j), 12, row(:, 3*j))
          call add_row(m(:, j), slope(:, 3 - j), 0, row(:, 7))
          call add_row(m(:, j), slope(:, 3 - j), 12, row(:, 8))
          call add_row(b(:, j), slope(:, 3 - j), 0, row(:, 8))
          call add_row(b(:, j), slope(:, 3 - j), 12, row(:, 9))
        end do
        call assumed_operators(mid, director, q, shell, row)
        do j = 1, n_natural
          row(:, j) = shell%strain_factor(j)*row(:, j)
        end do
        call to_nodes(row)
      end associate
    end do
    call reduce_operators(shell)
  end subroutine strain_operators

  !> Add the derivatives of a scalar product of a vector with interpolated corner vectors.
  pure subroutine add_row(vector, factor, first, row)
    real(wp), intent(in) :: vector(3), factor(4)
    !> Where the corner vectors begin: 0 for the mid-surface, 12 for the directors.
    integer, intent(in) :: first
    real(wp), intent(inout) :: row(24)

    integer :: a, at

    do a = 1, n_corner
      at = first + 3*a
      row(at - 2:at) = row(at - 2:at) + factor(a)*vector
    end do
  end subroutine add_row

  !> Set the derivatives of the assumed strains at a column, in mid-surface and directors.
  pure subroutine assumed_operators(mid, director, q, shell, row)
    real(wp), intent(in) :: mid(3, 4), director(3, 4)
    !> Column.
    integer, intent(in) :: q
    !> Provides shape functions and weight.
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(inout) :: row(24, n_natural)

    real(wp) :: tangent(3), normal(3), weight
    integer :: a, i, j

    weight = 0.25_wp*shell%centre_weight
    do a = 1, n_corner
      row(10 + 3*a:12 + 3*a, thickness_strain) = (shell%shape(a, q) - weight)*director(:, a) &
          + 0.25_wp*weight*sum(director, dim=2)
    end do
    do a = 1, 4
      i = 3*edge(1, a)
      j = 3*edge(2, a)
      tangent = 0.25_wp*edge_shape(a, q)*(mid(:, edge(2, a)) - mid(:, edge(1, a)))
      normal = 0.25_wp*edge_shape(a, q)*(director(:, edge(1, a)) + director(:, edge(2, a)))
      associate (shear => row(:, shear_of(along(a))))
        shear(12 + i - 2:12 + i) = shear(12 + i - 2:12 + i) + tangent
        shear(12 + j - 2:12 + j) = shear(12 + j - 2:12 + j) + tangent
        shear(j - 2:j) = shear(j - 2:j) + normal
        shear(i - 2:i) = shear(i - 2:i) - normal
      end associate
      associate (slope => row(12 + 1:, shear_slope_of(along(a))))
        slope(j - 2:j) = slope(j - 2:j) + 0.5_wp*edge_shape(a, q)*director(:, edge(2, a))
        slope(i - 2:i) = slope(i - 2:i) - 0.5_wp*edge_shape(a, q)*director(:, edge(1, a))
      end associate
    end do
  end subroutine assumed_operators

  !> Turn derivatives in mid-surface and directors into those in the nodes.
  pure subroutine to_nodes(row)
    real(wp), intent(inout) :: row(24, n_natural)

    real(wp) :: mid(12), director(12)
    integer :: k

    do k = 1, n_natural
      mid = 0.5_wp*row(1:12, k)
      director = 0.5_wp*row(13:24, k)
      row(1:12, k) = mid - director
      row(13:24, k) = mid + director
    end do
  end subroutine to_nodes

  !> Evaluate the resultants times the second derivatives of the natural strains, which are the same
  !> in the three directions of space.
  pure subroutine initial_stress(shell, factor)
    !> Holds the resultants.
    type(shell_work_t), intent(in) :: shell
    !> Node by node, N/mm.
    real(wp), intent(out) :: factor(8, 8)

    real(wp) :: mm(4, 4), md(4, 4), dd(4, 4), n(n_natural), force(n_natural, n_column), t, weight
    integer :: a, b, i, j, k, l, q

    weight = 0.25_wp*shell%centre_weight
    force = natural_resultants(shell)
    call reduce_resultants(shell, force)
    mm = 0.0_wp
    md = 0.0_wp
    dd = 0.0_wp
    do q = 1, n_column
      n = shell%strain_factor*force(:, q)
      associate (slope => shell%slope(:, :, q))
        do b = 1, n_corner
          do j = 1, 2
            k = 3*j - 2
            mm(:, b) = mm(:, b) + slope(:, j)*(n(k)*slope(b, j) + n(7)*slope(b, 3 - j))
            md(:, b) = md(:, b) + slope(:, j)*(n(k + 1)*slope(b, j) + n(8)*slope(b, 3 - j))
            dd(:, b) = dd(:, b) + slope(:, j)*(n(k + 2)*slope(b, j) + n(9)*slope(b, 3 - j))
          end do
          dd(b, b) = dd(b, b) + n(thickness_strain)*(shell%shape(b, q) - weight)
          dd(:, b) = dd(:, b) + 0.25_wp*weight*n(thickness_strain)
        end do
        do a = 1, 4
          i = edge(1, a)
          j = edge(2, a)
          t = 0.25_wp*edge_shape(a, q)*n(shear_of(along(a)))
          do l = 1, 2
            k = edge(l, a)
            md(j, k) = md(j, k) + t
            md(i, k) = md(i, k) - t
          end do
          t = 0.5_wp*edge_shape(a, q)*n(shear_slope_of(along(a)))
          dd(j, j) = dd(j, j) + t
          dd(i, i) = dd(i, i) - t
        end do
      end associate
    end do
    factor(1:4, 1:4) = 0.25_wp*(mm - md - transpose(md) + dd)
    factor(1:4, 5:8) = 0.25_wp*(mm + md - transpose(md) - dd)
    factor(5:8, 1:4) = 0.25_wp*(mm - md + transpose(md) - dd)
    factor(5:8, 5:8) = 0.25_wp*(mm + md + transpose(md) + dd)
  end subroutine initial_stress

end module dd3_element_shell_operators
