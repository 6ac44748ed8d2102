! SPDX-License-Identifier: GPL-3.0-or-later
!> Exact derivative of the internal forces with respect to the current positions.
!>
!> With dl = du_b (x) G_b, d = sym and w = skw of dl plus the mean-dilatation correction, the stress
!> rate is dT = c : d + w T - T w, c the tangent moduli of dd3_element_moduli in the global frame.
!> Per group, with pi = tr T/3, Pi = sum w j pi, S = T - pi I + (Pi/v) I, m = c : I
!> and c' = c - m (x) I/3:
!>   K_ab = sum w j G_a.[ dev c' : d + w S - S w + S tr(dl) - S dl^T ].G_b
!>          + p_a (x) g_b + g_a (x) q_b,
!>   p_a = sum w j dev(m) G_a/3,
!>   q_b = sum w j (tr c'/3 + pi I).G_b + (sum w j tr m/9 - Pi) g_b,
!> All terms with the mean gradients, their variation included, are outer products, formed once per
!> group. The sum over points and directions is one product of a (9 n_node) x (3 n_point) by a
!> (3 n_point) x n_node matrix.
!>
!> With a projection of the dilatation (dd3_element_projection), c_pk the fractions of its groups:
!>   S = T - pi I + sum_k (a_pk Pi_k/v_k) I, p_ak = sum c_pk w j dev(m) G_a/3,
!>   q_bk = sum c_pk w j (tr c'/3 + pi I).G_b + sum_l sum c_pk c_pl w j (tr m/9 - pi) g_bl,
!> and the outer products are summed over k.
module dd3_element_stiffness
  use dd3_base_kinds, only : half_sqrt2, wp
  use dd3_element_moduli, only : point_moduli
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t
  implicit none
  private
  public :: element_stiffness

  !> Index of a tensor component in a Kelvin vector.
  integer, parameter :: kelvin_index(3, 3) = reshape([1, 6, 5, 6, 2, 4, 5, 4, 3], [3, 3])
  !> Factors from the components of a Kelvin vector to those of the tensor.
  real(wp), parameter :: kelvin_factor(6) = [1.0_wp, 1.0_wp, 1.0_wp, half_sqrt2, &
      half_sqrt2, half_sqrt2]

contains

  !> Evaluate the stiffness; call `element_cauchy` and set `work%tangent` first.
  subroutine element_stiffness(element, work)
    type(element_t), intent(in) :: element
    !> Sets `stiffness`.
    type(element_work_t), intent(inout) :: work

    associate (n => element%n_node, m => element%n_point, g => element%n_group)
      if (n == 8 .and. m == 8 .and. g == 1) then
        call point_operators(8, 8, 1, element%group, work)
        call sum_points(72, 24, 8, work%contracted, work%gradient, work%stiffness)
        call add_outer(8, 1, work%row_factor, work%column_factor, work%mean_gradient, &
            work%stiffness)
      else
        if (allocated(element%projection)) then
          call projected_operators(n, m, g, element%projection, work)
        else
          call point_operators(n, m, g, element%group, work)
        end if
        call sum_points(9*n, 3*m, n, work%contracted, work%gradient, work%stiffness)
        call add_outer(n, g, work%row_factor, work%column_factor, work%mean_gradient, &
            work%stiffness)
      end if
    end associate
  end subroutine element_stiffness

  !> Evaluate the operator of each point, contracted with the column nodes' gradients, and the
  !> factors of the outer products.
  subroutine point_operators(n_node, n_point, n_group, group, work)
    integer, intent(in) :: n_node, n_point, n_group
    !> Group of each point, or 0.
    integer, intent(in) :: group(n_point)
    !> Sets `contracted`, `row_factor` and `column_factor`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: c(6, 6), s(3, 3), row(6), column(6), operator(3, 3, 3, 3), mean
    integer :: g, i, p

    work%row_factor = 0.0_wp
    work%column_factor = 0.0_wp
    work%bulk_integral = 0.0_wp
    do p = 1, n_point
      call point_moduli(work%strain(:, p), work%stress(:, p), work%tangent(:, :, p), &
          work%rotation(:, :, p), c)
      s = work%cauchy(:, :, p)
      g = group(p)
      if (g > 0) then
        mean = (s(1, 1) + s(2, 2) + s(3, 3))/3.0_wp
        call split_volume(c, row, column)
        work%bulk_integral(g) = work%bulk_integral(g) &
            + work%weight(p)*(row(1) + row(2) + row(3))/3.0_wp
        column(1:3) = column(1:3) + mean
        row(1:3) = row(1:3) - (row(1) + row(2) + row(3))/3.0_wp
        call add_factor(n_node, work%weight(p), row, work%gradient(:, :, p), &
            work%row_factor(:, :, g))
        call add_factor(n_node, work%weight(p), column, work%gradient(:, :, p), &
            work%column_factor(:, :, g))
        do i = 1, 3
          s(i, i) = s(i, i) - mean + work%mean_stress_integral(g)/work%volume(g)
        end do
      end if
      call point_operator(work%weight(p), c, s, operator)
      call contract(n_node, operator, work%gradient(:, :, p), work%contracted(:, :, :, :, p))
    end do
    do g = 1, n_group
      do i = 1, 3
        work%column_factor(:, i, g) = work%column_factor(:, i, g) &
            + (work%bulk_integral(g) - work%mean_stress_integral(g))*work%mean_gradient(:, i, g)
      end do
    end do
  end subroutine point_operators

  !> Evaluate the same for an element with a projection of the dilatation.
  subroutine projected_operators(n_node, n_point, n_group, projection, work)
    integer, intent(in) :: n_node, n_point, n_group
    !> a_pk.
    real(wp), intent(in) :: projection(n_point, n_group)
    !> Sets `contracted`, `row_factor` and `column_factor`.
    type(element_work_t), intent(inout) :: work

    real(wp) :: c(6, 6), s(3, 3), row(6), column(6), operator(3, 3, 3, 3), mean, bulk, &
        coupling(n_group, n_group), pressure(n_group), part(n_node, 3)
    integer :: i, k, l, p

    work%row_factor = 0.0_wp
    work%column_factor = 0.0_wp
    coupling = 0.0_wp
    pressure = work%mean_stress_integral/work%volume
    do p = 1, n_point
      call point_moduli(work%strain(:, p), work%stress(:, p), work%tangent(:, :, p), &
          work%rotation(:, :, p), c)
      s = work%cauchy(:, :, p)
      mean = (s(1, 1) + s(2, 2) + s(3, 3))/3.0_wp
      call split_volume(c, row, column)
      bulk = (row(1) + row(2) + row(3))/3.0_wp
      column(1:3) = column(1:3) + mean
      row(1:3) = row(1:3) - bulk
      call add_to_groups(row, work%row_factor)
      call add_to_groups(column, work%column_factor)
      do l = 1, n_group
        coupling(:, l) = coupling(:, l) &
            + (work%weight(p)*(bulk - mean)*work%fraction(p, l))*work%fraction(p, :)
      end do
      do i = 1, 3
        s(i, i) = s(i, i) - mean + dot_product(projection(p, :), pressure)
      end do
      call point_operator(work%weight(p), c, s, operator)
      call contract(n_node, operator, work%gradient(:, :, p), work%contracted(:, :, :, :, p))
    end do
    do k = 1, n_group
      do l = 1, n_group
        work%column_factor(:, :, k) = work%column_factor(:, :, k) &
            + coupling(k, l)*work%mean_gradient(:, :, l)
      end do
    end do

  contains

    !> Add w j times a symmetric tensor, applied to the gradients of point p, to all groups.
    subroutine add_to_groups(kelvin, factor)
      real(wp), intent(in) :: kelvin(6)
      real(wp), intent(inout) :: factor(n_node, 3, n_group)

      part = 0.0_wp
      call add_factor(n_node, work%weight(p), kelvin, work%gradient(:, :, p), part)
      do k = 1, n_group
        factor(:, :, k) = factor(:, :, k) + work%fraction(p, k)*part
      end do
    end subroutine add_to_groups

  end subroutine projected_operators

  !> Remove the group's volumetric part from the moduli: c becomes dev c'. Return the parts of the
  !> outer products.
  pure subroutine split_volume(c, row, column)
    !> Moduli, Kelvin, global frame.
    real(wp), intent(inout) :: c(6, 6)
    !> m/3, Kelvin.
    real(wp), intent(out) :: row(6)
    !> Trace of c' over its first index, divided by 3, Kelvin.
    real(wp), intent(out) :: column(6)

    integer :: j

    row = (c(:, 1) + c(:, 2) + c(:, 3))/3.0_wp
    do j = 1, 3
      c(:, j) = c(:, j) - row
    end do
    do j = 1, 6
      column(j) = (c(1, j) + c(2, j) + c(3, j))/3.0_wp
      c(1:3, j) = c(1:3, j) - column(j)
    end do
  end subroutine split_volume

  !> Add w j times a symmetric tensor applied to the gradients.
  pure subroutine add_factor(n_node, weight, kelvin, gradient, factor)
    integer, intent(in) :: n_node
    !> Weight times Jacobian, mm3.
    real(wp), intent(in) :: weight
    !> Tensor, Kelvin.
    real(wp), intent(in) :: kelvin(6)
    !> Gradients of the shape functions, 1/mm.
    real(wp), intent(in) :: gradient(n_node, 3)
    real(wp), intent(inout) :: factor(n_node, 3)

    real(wp) :: t(3)
    integer :: i

    do i = 1, 3
      t = weight*kelvin_factor(kelvin_index(:, i))*kelvin(kelvin_index(:, i))
      factor(:, i) = factor(:, i) + t(1)*gradient(:, 1) + t(2)*gradient(:, 2) + t(3)*gradient(:, 3)
    end do
  end subroutine add_factor

  !> Evaluate w j times d(stress part)_ij/d(dl)_kl, stored as `operator(i,k,l,j)`.
  pure subroutine point_operator(weight, c, s, operator)
    !> Weight times Jacobian, mm3.
    real(wp), intent(in) :: weight
    !> Moduli, Kelvin, global frame.
    real(wp), intent(in) :: c(6, 6)
    !> S, MPa.
    real(wp), intent(in) :: s(3, 3)
    real(wp), intent(out) :: operator(3, 3, 3, 3)

    real(wp) :: e(6, 6), h(3, 3)
    integer :: i, j, k, l

    do j = 1, 6
      e(:, j) = (weight*kelvin_factor(j))*kelvin_factor*c(:, j)
    end do
    h = (0.5_wp*weight)*s
    do j = 1, 3
      do l = 1, 3
        do k = 1, 3
          do i = 1, 3
            operator(i, k, l, j) = e(kelvin_index(i, j), kelvin_index(k, l))
          end do
          operator(k, k, l, j) = operator(k, k, l, j) + h(l, j)
          operator(l, k, l, j) = operator(l, k, l, j) - h(k, j)
        end do
        operator(:, l, l, j) = operator(:, l, l, j) + 2.0_wp*h(:, j)
        operator(:, j, l, j) = operator(:, j, l, j) - h(:, l)
      end do
      do k = 1, 3
        operator(:, k, j, j) = operator(:, k, j, j) - h(:, k)
      end do
    end do
  end subroutine point_operator

  !> Contract the operator with the column nodes' gradients: sum over l.
  pure subroutine contract(n_node, operator, gradient, contracted)
    integer, intent(in) :: n_node
    !> `operator(ik,l,j)`.
    real(wp), intent(in) :: operator(9, 3, 3)
    !> Gradients of the shape functions, 1/mm.
    real(wp), intent(in) :: gradient(n_node, 3)
    !> `contracted(ik,b,j)`.
    real(wp), intent(out) :: contracted(9, n_node, 3)

    integer :: b, j

    do j = 1, 3
      do b = 1, n_node
        contracted(:, b, j) = operator(:, 1, j)*gradient(b, 1) + operator(:, 2, j)*gradient(b, 2) &
            + operator(:, 3, j)*gradient(b, 3)
      end do
    end do
  end subroutine contract

  !> Sum over points and directions: multiply the contracted operators by the transposed gradients.
  pure subroutine sum_points(n_row, n_sum, n_node, contracted, gradient, stiffness)
    !> Nine times the number of nodes, three times the number of points, number of nodes.
    integer, intent(in) :: n_row, n_sum, n_node
    !> Left factor.
    real(wp), intent(in) :: contracted(n_row, n_sum)
    !> Right factor, transposed.
    real(wp), intent(in) :: gradient(n_node, n_sum)
    real(wp), intent(out) :: stiffness(n_row, n_node)

    integer :: a, q, r

    do a = 1, n_node
      stiffness(:, a) = 0.0_wp
      do q = 1, n_sum, 3
        do r = 1, n_row
          stiffness(r, a) = stiffness(r, a) + contracted(r, q)*gradient(a, q) &
              + contracted(r, q + 1)*gradient(a, q + 1) + contracted(r, q + 2)*gradient(a, q + 2)
        end do
      end do
    end do
  end subroutine sum_points

  !> Add the outer products of the groups.
  pure subroutine add_outer(n_node, n_group, row_factor, column_factor, mean_gradient, stiffness)
    integer, intent(in) :: n_node, n_group
    !> p_a and q_b, N/mm2.
    real(wp), intent(in) :: row_factor(n_node, 3, n_group), column_factor(n_node, 3, n_group)
    !> Mean gradients, 1/mm.
    real(wp), intent(in) :: mean_gradient(n_node, 3, n_group)
    real(wp), intent(inout) :: stiffness(3, 3, n_node, n_node)

    real(wp) :: p(3), s(3)
    integer :: a, b, g, k

    do g = 1, n_group
      do a = 1, n_node
        p = row_factor(a, :, g)
        s = mean_gradient(a, :, g)
        do b = 1, n_node
          do k = 1, 3
            stiffness(:, k, b, a) = stiffness(:, k, b, a) + p*mean_gradient(b, k, g) &
                + s*column_factor(b, k, g)
          end do
        end do
      end do
    end do
  end subroutine add_outer

end module dd3_element_stiffness
