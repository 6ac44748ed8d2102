! SPDX-License-Identifier: GPL-3.0-or-later
!> Natural strains of the solid-shell: the covariant Green-Lagrange strain of the increment,
!>   e_ij = (G_i . u,j + G_j . u,i + u,i . u,j)/2,
!> evaluated from the displacement increment u, and its derivative in the nodal positions. In a
!> rigid rotation it vanishes to round-off.
!>
!> Transverse shear and thickness strain are assumed: e_13 is linear in eta between its values at
!> (0,-1,0) and (0,1,0), e_23 linear in xi between (-1,0,0) and (1,0,0) (Dvorkin & Bathe 1984), and
!> e_33 bilinear between those at the corners of the mid-surface (Betsch & Stein 1995; Hauptmann &
!> Schweizerhof 1998).
!>
!> Directors that tilt in turns to both sides are longer between two tools, and no assumed shear
!> resists: under pressure across the sheet they would buckle. Therefore the mean of e_33 is that of
!> the mean director, which does not tilt, if the element is flat in the initial mesh;
!> `centre_weight` is its weight.
!>
!> Directors of different length at the ends of an edge, |d_j| and |d_i|, have a shear besides that
!> is linear in zeta: 2 e_13 += zeta ((|d_j|^2 - |d_i|^2) - (|D_j|^2 - |D_i|^2))/4, D the committed
!> ones. In a sheet most of it is relieved, as its sections warp; but without any of it a sheet in
!> tension would neck within an element at the strain of its largest force, since the mid-surface
!> is quadratic. With the strain multiplied by a/(4 t), a the length of the element, the difference
!> of thickness is resisted by G/48 beside E_t - sigma at any length, and by less and less in a mesh
!> that is refined.
!>
!> An element bent to the angle theta then keeps the thickness t in its middle: its directors have
!> the length t/cos(theta/2), and the strain linear in zeta is 2 tan(theta/2) over the length in
!> place of theta. In the increment it is multiplied by cos(theta/2)^2, the derivative of one in the
!> other, taken from the committed configuration.
!>
!> Internally the element has mid-surface positions m_A = (bottom + top)/2 and directors
!> d_A = (top - bottom)/2 at its corners.
module dd3_element_shell_strain
  use dd3_base_kinds, only : wp
  use dd3_element_shell_plane, only : reduce_strains
  use dd3_element_shell_work, only : bending_strain, columns_t, corner, edge_shape, n_column, &
      n_corner, n_natural, shear_of, shear_slope_of, shell_work_t, thickness_strain
  implicit none
  private
  public :: column_geometry, set_weights, natural_strains, natural_rates
  public :: along, edge, split

  !> Corners at the ends of the edges eta = -1, eta = 1 (along xi) and xi = -1, xi = 1 (along eta).
  integer, parameter :: edge(2, 4) = reshape([1, 2, 4, 3, 1, 4, 2, 3], [2, 4])
  !> Direction of these edges.
  integer, parameter :: along(4) = [1, 1, 2, 2]
  !> Length of an edge over the thickness with the whole shear of directors of different length.
  real(wp), parameter :: whole_shear = 4.0_wp

contains

  !> Evaluate the geometry of the columns.
  pure subroutine column_geometry(x_committed, x_trial, shell)
    !> Positions of the nodes, mm.
    real(wp), intent(in) :: x_committed(3, 8), x_trial(3, 8)
    !> Gets the geometry.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: mid(3, 4), director(3, 4)

    call split(x_committed, mid, director)
    call set_columns(shell, mid, director, shell%committed)
    call split(x_trial, mid, director)
    call set_columns(shell, mid, director, shell%trial)
  end subroutine column_geometry

  !> Set the weight of the mean director in the mean thickness strain, the factors of the bending
  !> strains that belong to it, and those of the shears that are linear in zeta.
  pure subroutine set_weights(x_initial, x_committed, shell)
    !> Positions of the nodes, mm.
    real(wp), intent(in) :: x_initial(3, 8), x_committed(3, 8)
    !> Gets `centre_weight` and `strain_factor`.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: mid(3, 4), director(3, 4), middle, factor(2)
    integer :: j

    shell%centre_weight = mean_director_weight(x_initial)
    call split(x_committed, mid, director)
    middle = sum(sum(director, dim=2)**2)
    do j = 1, 2
      factor(j) = middle/(middle + sum(matmul(director, corner(j, :))**2))
    end do
    shell%strain_factor(bending_strain) = 1.0_wp - shell%centre_weight &
        *(1.0_wp - [factor, sqrt(factor(1)*factor(2))])
    do j = 1, 2
      shell%strain_factor(shear_slope_of(j)) = &
          sqrt(sum(matmul(mid, corner(j, :))**2)/middle)/whole_shear
    end do
  end subroutine set_weights

  !> Return the weight of the mean director in the mean thickness strain: 1 for an element that is
  !> flat in the initial mesh. On curved elements it would lock; the weight falls with the square of
  !> their rise over their thickness and is 0 from a rise of about an eighth on.
  pure real(wp) function mean_director_weight(x_initial) result(weight)
    !> Initial positions of the nodes, mm.
    real(wp), intent(in) :: x_initial(3, 8)

    real(wp) :: mid(3, 4), director(3, 4), mean(3), spread, length
    integer :: a

    call split(x_initial, mid, director)
    mean = 0.25_wp*sum(director, dim=2)
    spread = 0.0_wp
    length = 0.0_wp
    do a = 1, n_corner
      spread = spread + sum((director(:, a) - mean)**2)
      length = max(length, sum((mid(:, edge(2, a)) - mid(:, edge(1, a)))**2))
    end do
    weight = max(0.0_wp, 1.0_wp - 0.25_wp*spread*length/sum(mean**2)**2)
  end function mean_director_weight

  !> Evaluate the natural strains of an increment, without enhanced ones; call `column_geometry` and
  !> `set_weights` first.
  pure subroutine natural_strains(x_committed, x_trial, shell)
    !> Positions of the nodes, mm.
    real(wp), intent(in) :: x_committed(3, 8), x_trial(3, 8)
    !> Gets `strain`.
    type(shell_work_t), intent(inout) :: shell

    real(wp) :: mid(3, 4), director(3, 4), u(3, 4), ud(3, 4), strain(n_natural, n_column)
    type(columns_t) :: motion
    integer :: q

    call split(x_committed, mid, director)
    call split(x_trial - x_committed, u, ud)
    call set_columns(shell, u, ud, motion)
    do q = 1, n_column
      call in_plane_strains(shell%committed, motion, q, strain(:, q))
      call in_plane_squares(motion, q, strain(:, q))
    end do
    call assumed_strains(mid + 0.5_wp*u, director + 0.5_wp*ud, u, ud, shell, strain)
    call reduce_strains(shell, strain)
    do q = 1, n_column
      shell%strain(:, q) = [shell%strain_factor*strain(:, q), 0.0_wp]
    end do
  end subroutine natural_strains

  !> Evaluate the natural strains of first order of a displacement from the trial configuration.
  pure subroutine natural_rates(du, x, shell, strain, motion)
    !> Displacement and position of the nodes, mm.
    real(wp), intent(in) :: du(3, 8), x(3, 8)
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(out) :: strain(n_natural, n_column)
    !> Displacement of the columns.
    type(columns_t), intent(out) :: motion

    real(wp) :: mid(3, 4), director(3, 4), u(3, 4), ud(3, 4)
    integer :: q

    call split(x, mid, director)
    call split(du, u, ud)
    call set_columns(shell, u, ud, motion)
    do q = 1, n_column
      call in_plane_strains(shell%trial, motion, q, strain(:, q))
    end do
    call assumed_strains(mid, director, u, ud, shell, strain)
    call reduce_strains(shell, strain)
    do q = 1, n_column
      strain(:, q) = shell%strain_factor*strain(:, q)
    end do
  end subroutine natural_rates

  !> Split nodal vectors into those of the mid-surface and of the directors.
  pure subroutine split(x, mid, director)
    real(wp), intent(in) :: x(3, 8)
    real(wp), intent(out) :: mid(3, 4), director(3, 4)

    mid = 0.5_wp*(x(:, 1:4) + x(:, 5:8))
    director = 0.5_wp*(x(:, 5:8) - x(:, 1:4))
  end subroutine split

  !> Evaluate the tangents and directors of the columns.
  pure subroutine set_columns(shell, mid, director, columns)
    !> Provides the shape functions.
    type(shell_work_t), intent(in) :: shell
    !> At the corners, mm.
    real(wp), intent(in) :: mid(3, 4), director(3, 4)
    type(columns_t), intent(out) :: columns

    integer :: j, q

    do q = 1, n_column
      do j = 1, 2
        columns%membrane(:, j, q) = combine(mid, shell%slope(:, j, q))
        columns%bending(:, j, q) = combine(director, shell%slope(:, j, q))
      end do
      columns%director(:, q) = combine(director, shell%shape(:, q))
    end do
  end subroutine set_columns

  !> Return the sum of four vectors times their factors.
  pure function combine(vector, factor) result(total)
    real(wp), intent(in) :: vector(3, 4), factor(4)
    real(wp) :: total(3)

    total = vector(:, 1)*factor(1) + vector(:, 2)*factor(2) + vector(:, 3)*factor(3) &
        + vector(:, 4)*factor(4)
  end function combine

  !> Evaluate the coefficients of e_11, e_22 and 2 e_12 that are linear in the increment.
  pure subroutine in_plane_strains(at, of, q, strain)
    !> Geometry, and its increment.
    type(columns_t), intent(in) :: at, of
    !> Column.
    integer, intent(in) :: q
    real(wp), intent(inout) :: strain(n_natural)

    integer :: j

    associate (m => at%membrane(:, :, q), b => at%bending(:, :, q), um => of%membrane(:, :, q), &
        ub => of%bending(:, :, q))
      do j = 1, 2
        strain(3*j - 2) = dot_product(m(:, j), um(:, j))
        strain(3*j - 1) = dot_product(m(:, j), ub(:, j)) + dot_product(b(:, j), um(:, j))
        strain(3*j) = dot_product(b(:, j), ub(:, j))
      end do
      strain(7) = dot_product(m(:, 1), um(:, 2)) + dot_product(m(:, 2), um(:, 1))
      strain(8) = dot_product(m(:, 1), ub(:, 2)) + dot_product(b(:, 1), um(:, 2)) &
          + dot_product(m(:, 2), ub(:, 1)) + dot_product(b(:, 2), um(:, 1))
      strain(9) = dot_product(b(:, 1), ub(:, 2)) + dot_product(b(:, 2), ub(:, 1))
    end associate
  end subroutine in_plane_strains

  !> Add the coefficients of e_11, e_22 and 2 e_12 that are quadratic in the increment.
  pure subroutine in_plane_squares(of, q, strain)
    type(columns_t), intent(in) :: of
    !> Column.
    integer, intent(in) :: q
    real(wp), intent(inout) :: strain(n_natural)

    integer :: j

    associate (um => of%membrane(:, :, q), ub => of%bending(:, :, q))
      do j = 1, 2
        strain(3*j - 2) = strain(3*j - 2) + 0.5_wp*dot_product(um(:, j), um(:, j))
        strain(3*j - 1) = strain(3*j - 1) + dot_product(um(:, j), ub(:, j))
        strain(3*j) = strain(3*j) + 0.5_wp*dot_product(ub(:, j), ub(:, j))
      end do
      strain(7) = strain(7) + dot_product(um(:, 1), um(:, 2))
      strain(8) = strain(8) + dot_product(um(:, 1), ub(:, 2)) + dot_product(ub(:, 1), um(:, 2))
      strain(9) = strain(9) + dot_product(ub(:, 1), ub(:, 2))
    end associate
  end subroutine in_plane_squares

  !> Evaluate the assumed e_33, 2 e_23 and 2 e_13 of an increment. From the middle of the increment
  !> they are exact: (G_i + u,i/2).u,j + (G_j + u,j/2).u,i = 2 e_ij.
  pure subroutine assumed_strains(mid, director, u, ud, shell, strain)
    !> Geometry at the corners, and its increment, mm.
    real(wp), intent(in) :: mid(3, 4), director(3, 4), u(3, 4), ud(3, 4)
    !> Provides shape functions and weight.
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(inout) :: strain(n_natural, n_column)

    real(wp) :: sampled(4), sampled_slope(4), excess
    integer :: a, q

    do a = 1, n_corner
      sampled(a) = dot_product(director(:, a), ud(:, a))
    end do
    excess = dot_product(0.25_wp*sum(director, dim=2), 0.25_wp*sum(ud, dim=2)) &
        - 0.25_wp*sum(sampled)
    do q = 1, n_column
      strain(thickness_strain, q) = dot_product(shell%shape(:, q), sampled) &
          + shell%centre_weight*excess
    end do
    sampled_slope = 0.5_wp*(sampled(edge(2, :)) - sampled(edge(1, :)))
    do a = 1, 4
      sampled(a) = edge_shear(edge(1, a), edge(2, a))
    end do
    do q = 1, n_column
      strain(shear_of, q) = of_edges(sampled, q)
      strain(shear_slope_of, q) = of_edges(sampled_slope, q)
    end do

  contains

    !> Return the shear in the middle of an edge.
    pure real(wp) function edge_shear(i, j)
      integer, intent(in) :: i, j

      edge_shear = 0.25_wp*(dot_product(mid(:, j) - mid(:, i), ud(:, i) + ud(:, j)) &
          + dot_product(director(:, i) + director(:, j), u(:, j) - u(:, i)))
    end function edge_shear

  end subroutine assumed_strains

  !> Return the shears 2 e_13 and 2 e_23 at a column from those in the middle of the edges.
  pure function of_edges(sampled, q) result(shear)
    real(wp), intent(in) :: sampled(4)
    !> Column.
    integer, intent(in) :: q
    real(wp) :: shear(2)

    shear = [edge_shape(1, q)*sampled(1) + edge_shape(2, q)*sampled(2), &
        edge_shape(3, q)*sampled(3) + edge_shape(4, q)*sampled(4)]
  end function of_edges

end module dd3_element_shell_strain
