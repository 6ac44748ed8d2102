! SPDX-License-Identifier: GPL-3.0-or-later
!> Exact derivative of the solid-shell's forces, with the enhanced parameters condensed.
!>
!> With dT = c : d + w T - T w (dd3_element_moduli) the second Piola-Kirchhoff stress changes by
!>   dS = J U^-1 (c : d - d T - T d + tr(d) T) U^-1,   d = U^-1 (de) U^-1,
!> so the moduli of a column are sum w j J P^T (c - 2 T_sym + T (x) I) P over its points, P the
!> factors of the generalised strain rates in d. The stiffness is B^T H B + the resultants times the
!> second derivatives of the natural strains. The enhanced parameters a, whose forces r_a are zero
!> in equilibrium, follow the displacement (stored condensation):
!>   da = -K_aa^-1 (r_a + K_au du),
!>   K du = -(r_u - K_ua K_aa^-1 r_a),   K = K_uu - K_ua K_aa^-1 K_au.
module dd3_element_shell_stiffness
  use dd3_base_kinds, only : half_sqrt2, wp
  use dd3_element_moduli, only : material_moduli
  use dd3_element_shell_force, only : point_operator, shell_force
  use dd3_element_shell_modes, only : second_derivatives
  use dd3_element_shell_operators, only : initial_stress
  use dd3_element_shell_work, only : mode_of, mode_shape, n_column, n_general, n_mode, n_natural, &
      n_parameter, natural_strain, powers_of, shell_work_t
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  use dd3_linalg_tensor, only : solve_small
  implicit none
  private
  public :: shell_stiffness

contains

  !> Evaluate the condensed stiffness; call `shell_stress` and set `work%tangent` first.
  subroutine shell_stiffness(element, work)
    type(element_t), intent(in) :: element
    !> Sets `stiffness`, `enhanced_gain`, `enhanced_offset`, `condensed_force`, `unfollowed`, and
    !> the forces.
    type(element_work_t), intent(inout) :: work

    real(wp) :: moduli(n_general, n_general), uu(24, 24), aa(n_parameter, n_parameter)
    real(wp), dimension(24, n_parameter) :: ua, au
    integer :: q

    call shell_force(element, work)
    uu = 0.0_wp
    ua = 0.0_wp
    au = 0.0_wp
    aa = 0.0_wp
    do q = 1, n_column
      call column_moduli(q, element%n_point/n_column, element, work, moduli)
      call add_column(q, moduli, work%shell, uu, ua, au, aa)
    end do
    call add_initial_stress(work%shell, uu)
    call condense(ua, au, aa, uu, work)
    call to_blocks(uu, work%stiffness)
  end subroutine shell_stiffness

  !> Integrate the moduli of the generalised strains over a column.
  pure subroutine column_moduli(q, n, element, work, moduli)
    !> Column, and the number of its points.
    integer, intent(in) :: q, n
    type(element_t), intent(in) :: element
    type(element_work_t), intent(in) :: work
    !> N mm.
    real(wp), intent(out) :: moduli(n_general, n_general)

    real(wp) :: operator(6, 7), c(6, 6), co(6, 7), point(7, 7), zeta, factor(n_general), &
        row(n_general, 7)
    integer :: i, j, k, m, p

    moduli = 0.0_wp
    do k = 1, n
      p = (q - 1)*n + k
      zeta = element%point(3, p)
      operator = point_operator(work%shell%base(:, :, p), work%shell%normal(:, p), zeta)
      call material_moduli(work%strain(:, p), work%stress(:, p), work%tangent(:, :, p), c)
      call add_stress_terms(work%stress(:, p), c)
      do j = 1, 7
        co(:, j) = 0.0_wp
        do i = 1, 6
          co(:, j) = co(:, j) + (work%shell%volume(p)*operator(i, j))*c(:, i)
        end do
        do i = 1, 7
          point(i, j) = operator(1, i)*co(1, j) + operator(2, i)*co(2, j) &
              + operator(3, i)*co(3, j) + operator(4, i)*co(4, j) + operator(5, i)*co(5, j) &
              + operator(6, i)*co(6, j)
        end do
      end do
      factor = powers_of(zeta)
      do j = 1, 7
        row(:, j) = factor*point(natural_strain, j)
      end do
      do m = 1, n_general
        moduli(:, m) = moduli(:, m) + factor(m)*row(:, natural_strain(m))
      end do
    end do
  end subroutine column_moduli

  !> Add d -> tr(d) T - d T - T d to moduli, Kelvin.
  pure subroutine add_stress_terms(stress, c)
    !> T, MPa, Kelvin.
    real(wp), intent(in) :: stress(6)
    real(wp), intent(inout) :: c(6, 6)

    !> The components of a symmetric tensor that share an index with each shear 23, 31, 12.
    integer, parameter :: first(3) = [2, 3, 1], second(3) = [3, 1, 2]
    integer :: i, j

    do j = 1, 3
      c(:, j) = c(:, j) + stress
      c(j, j) = c(j, j) - 2.0_wp*stress(j)
    end do
    do j = 1, 3
      associate (a => first(j), b => second(j), s => 3 + j)
        c(a, s) = c(a, s) - stress(s)
        c(b, s) = c(b, s) - stress(s)
        c(s, a) = c(s, a) - stress(s)
        c(s, b) = c(s, b) - stress(s)
        c(s, s) = c(s, s) - stress(a) - stress(b)
        do i = 1, 3
          if (i /= j) c(3 + i, s) = c(3 + i, s) - half_sqrt2*stress(12 - s - i)
        end do
      end associate
    end do
  end subroutine add_stress_terms

  !> Add the stiffness of a column.
  pure subroutine add_column(q, moduli, shell, uu, ua, au, aa)
    !> Column.
    integer, intent(in) :: q
    !> N mm.
    real(wp), intent(in) :: moduli(n_general, n_general)
    type(shell_work_t), intent(in) :: shell
    !> Derivatives of the forces of nodes and parameters, in nodes and parameters; au transposed.
    real(wp), intent(inout) :: uu(24, 24), aa(n_parameter, n_parameter)
    real(wp), dimension(24, n_parameter), intent(inout) :: ua, au

    real(wp) :: hb(n_natural), hm(n_general, n_mode), mh(n_general, n_mode), own(n_mode, n_mode)
    real(wp), dimension(24, n_mode) :: second, node_mode, mode_node
    integer :: b, i, k, m

    associate (operator => shell%operator(:, :, q), mode => shell%mode(:, :, q), &
        shape => mode_shape(:, q))
      do b = 1, 24
        hb = 0.0_wp
        do k = 1, n_natural
          hb = hb + operator(b, k)*moduli(:n_natural, k)
        end do
        do k = 1, n_natural
          uu(:, b) = uu(:, b) + hb(k)*operator(:, k)
        end do
      end do
      call second_derivatives(shell, q, own, second)
      hm = matmul(moduli, mode)
      mh = matmul(transpose(moduli), mode)
      own = own + matmul(transpose(mode), hm)
      node_mode = second + matmul(operator, hm(:n_natural, :))
      mode_node = second + matmul(operator, mh(:n_natural, :))
      do i = 1, n_parameter
        m = mode_of(i)
        ua(:, i) = ua(:, i) + shape(i)*node_mode(:, m)
        au(:, i) = au(:, i) + shape(i)*mode_node(:, m)
        aa(:, i) = aa(:, i) + shape(i)*shape*own(mode_of, m)
      end do
    end associate
  end subroutine add_column

  !> Add the part of the initial stress, the same in the three directions of space.
  pure subroutine add_initial_stress(shell, uu)
    type(shell_work_t), intent(in) :: shell
    real(wp), intent(inout) :: uu(24, 24)

    real(wp) :: factor(8, 8)
    integer :: a, b, i

    call initial_stress(shell, factor)
    do b = 1, 8
      do a = 1, 8
        do i = 1, 3
          uu(3*a - 3 + i, 3*b - 3 + i) = uu(3*a - 3 + i, 3*b - 3 + i) + factor(a, b)
        end do
      end do
    end do
  end subroutine add_initial_stress

  !> Eliminate the enhanced parameters. If their stiffness is singular they keep their values.
  subroutine condense(ua, au, aa, uu, work)
    !> `au` is transposed.
    real(wp), intent(in) :: ua(24, n_parameter), au(24, n_parameter), aa(n_parameter, n_parameter)
    real(wp), intent(inout) :: uu(24, 24)
    !> Holds the forces of the parameters; sets gain, offset, condensed and unfollowed forces.
    type(element_work_t), intent(inout) :: work

    real(wp) :: matrix(n_parameter, n_parameter), solution(n_parameter, 25), force(24)
    real(wp) :: square(24)
    logical :: regular
    integer :: b, i

    matrix = aa
    solution(:, 1:24) = transpose(au)
    solution(:, 25) = work%enhanced_force
    call solve_small(n_parameter, 25, matrix, solution, regular)
    if (.not. regular) solution = 0.0_wp
    do b = 1, 24
      do i = 1, n_parameter
        uu(:, b) = uu(:, b) - ua(:, i)*solution(i, b)
      end do
      square(b) = sum(matmul(ua, solution(:, b))**2)
    end do
    work%unfollowed(:, :, 1) = reshape(square, [3, 8])
    work%unfollowed(:, :, 2) = reshape(sum(au**2, dim=2), [3, 8])
    force = 0.0_wp
    do i = 1, n_parameter
      force = force + ua(:, i)*solution(i, 25)
    end do
    work%condensed_force(:, :) = reshape(force, [3, 8])
    work%enhanced_offset(:) = solution(:, 25)
    work%enhanced_gain(:, :, :) = reshape(solution(:, 1:24), [n_parameter, 3, 8])
  end subroutine condense

  !> Copy a stiffness into the blocks of the workspace.
  pure subroutine to_blocks(uu, stiffness)
    real(wp), intent(in) :: uu(3, 8, 3, 8)
    real(wp), intent(out) :: stiffness(3, 3, 8, 8)

    integer :: a, b

    do a = 1, 8
      do b = 1, 8
        stiffness(:, :, b, a) = uu(:, a, :, b)
      end do
    end do
  end subroutine to_blocks

end module dd3_element_shell_stiffness
