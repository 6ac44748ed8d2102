! SPDX-License-Identifier: GPL-3.0-or-later
!> One step of the stress integration: elastic, or a return to the yield surface by backward Euler,
!> for any criterion, hardening law and back-stresses. Unknowns are the effective stress xi = T - X
!> and the plastic increment dp:
!>
!>     C^-1 (xi + X(xi, dp) - T_trial) + dp V(xi) = 0,     sb(xi) - Y(xi, dp) = 0
!>
!> solved by a damped Newton method (J. C. Simo and R. L. Taylor, 1985, 1986, for the method and its
!> consistent tangent). C is the elastic stiffness of the state at the start of the step; where
!> Young's modulus falls with the plastic strain, no term of its rate is in the stress. The 6x6
!> block of the matrix, positive definite for convex criteria, is inverted without pivoting (with,
!> if that fails), and the last unknown eliminated. The inverse of the last iteration gives the last
!> correction and the tangent.
module dd3_material_return_mapping
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : solve_small
  use dd3_material_composition, only : composition_t, plastic_work_t, back_stress_of, &
      flow_response_of, flow_stress_after, add_back_stresses, apply_factors, plastic_work, &
      stiffness_ratio
  use dd3_material_elasticity, only : elastic_strain, elastic_stress
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  implicit none
  private
  public :: step_t, integrate_step

  !> Limits of the Newton iterations of a step and of the halvings in an iteration.
  integer, parameter :: iteration_limit = 100, halving_limit = 20
  !> Strain error equivalent to a relative error of one in the yield condition.
  real(wp), parameter :: strain_weight = 1.0e-3_wp
  !> Norm of the residual below which one last correction ends the iteration.
  real(wp), parameter :: tolerance = 1.0e-8_wp
  !> Relative excess of the trial stress over the flow stress that still counts as elastic.
  real(wp), parameter :: elastic_margin = 1.0e-12_wp
  !> Smallest pivot of the matrix scaled to order one by the shear modulus.
  real(wp), parameter :: smallest_pivot = 1.0e-6_wp
  !> Smallest factor on the plastic increment in an iteration, where the flow stress depends on the
  !> rate: its slope may be unbounded at an increment of zero.
  real(wp), parameter :: least_part = 0.1_wp
  !> Unit vectors.
  real(wp), parameter :: unit(6, 6) = reshape([ &
    1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
    0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
    0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
    0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, &
    0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
    0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [6, 6])
  !> Relative excess below which the iteration starts with a step in the trial stress' normal.
  real(wp), parameter :: near_surface = 0.5_wp

  !> A step and the quantities its derivatives need.
  type :: step_t
    !> Inverse of the time of the step, 1/s; 0 without a time. Set before the integration.
    real(wp) :: frequency
    !> Whether the step converged; whether plastic flow occurred.
    logical :: converged, plastic
    !> Newton iterations.
    integer :: iterations
    !> Norm of the residual; ratio of equivalent trial stress to flow stress.
    real(wp) :: norm, overstress
    !> Elastic stiffness over that of the undeformed material, and its inverse.
    real(wp) :: stiffness, softness
    !> Trial stress and stress at the end, MPa.
    real(wp) :: trial(6), stress(6)
    !> Plastic increment.
    real(wp) :: increment
    !> Residual of the strain; equivalent stress less flow stress, MPa.
    real(wp) :: residual(6), excess
    !> Criterion, flow stress and back-stress at the end.
    type(flow_direction_t) :: direction
    type(flow_response_t) :: flow
    type(back_response_t) :: back
    !> Blocks of the inverse matrix: d xi/d strain, d xi/d stress, dp/d strain, dp/d stress.
    real(wp) :: block(6, 6), column(6), row(6), corner
  end type step_t

contains

  !> Integrate a strain increment in one step.
  pure subroutine integrate_step(laws, stress, start, strain, step)
    type(composition_t), intent(in) :: laws
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress(6), start(laws%n_internal)
    !> Strain increment.
    real(wp), intent(in) :: strain(6)
    !> Its frequency is set.
    type(step_t), intent(inout) :: step

    real(wp) :: effective(6), value

    step%stiffness = stiffness_ratio(laws, start(1))
    step%softness = 1/step%stiffness
    step%trial = stress + step%stiffness*elastic_stress(laws%elasticity, strain)
    effective = step%trial
    if (laws%kinematic) effective = effective - back_stress_of(laws, start)
    value = laws%criterion%value(effective)
    call flow_response_of(laws, start, step%frequency, step%flow)
    step%overstress = value/step%flow%value
    step%iterations = 0
    step%norm = 0.0_wp
    step%increment = 0.0_wp
    step%plastic = value > step%flow%value*(1 + elastic_margin)
    step%converged = .not. step%plastic
    step%stress = step%trial
    if (.not. step%plastic) return
    if (step%overstress < 1 + near_surface) then
      call start_by_normal(laws, start, effective, step)
      call iterate(laws, start, step)
      if (step%converged) return
      call flow_response_of(laws, start, step%frequency, step%flow)
    end if
    call start_radially(laws, start, effective, value, step)
    call iterate(laws, start, step)
  end subroutine integrate_step

  !> Set the start near the surface: the first Newton iteration from the trial stress.
  pure subroutine start_by_normal(laws, start, effective, step)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Trial stress less back-stress, MPa.
    real(wp), intent(in) :: effective(6)
    type(step_t), intent(inout) :: step

    real(wp) :: value, normal(6), flow(6), modulus

    call laws%criterion%gradient(effective, value, normal)
    flow = step%stiffness*elastic_stress(laws%elasticity, normal)
    modulus = dot_product(normal, flow)
    step%increment = first_increment(laws, start, effective, value, modulus, step)
    step%direction%stress = effective - step%increment*flow
  end subroutine start_by_normal

  !> Set the start far from the surface: a radial return, as for an isotropic material.
  pure subroutine start_radially(laws, start, effective, value, step)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Trial stress less back-stress, MPa.
    real(wp), intent(in) :: effective(6)
    !> Its equivalent stress, MPa.
    real(wp), intent(in) :: value
    type(step_t), intent(inout) :: step

    real(wp) :: modulus, mean

    modulus = 3*step%stiffness*laws%elasticity%shear
    step%increment = first_increment(laws, start, effective, value, modulus, step)
    mean = (effective(1) + effective(2) + effective(3))/3
    step%direction%stress = (1 - modulus*step%increment/value)*effective
    step%direction%stress(1:3) = step%direction%stress(1:3) + mean*modulus*step%increment/value
  end subroutine start_radially

  !> Return the plastic increment at which an equivalent stress that falls linearly meets the flow
  !> stress at the temperature of the start: by its slope there or, where it depends on the rate and
  !> may rise at once, by bisection.
  pure real(wp) function first_increment(laws, start, effective, value, modulus, step) &
      result(increment)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Trial stress less back-stress, its equivalent stress, and the fall of the latter per
    !> increment, MPa.
    real(wp), intent(in) :: effective(6), value, modulus
    !> With the flow stress of the start.
    type(step_t), intent(in) :: step

    !> Reduction of the interval.
    integer, parameter :: bisections = 20
    type(flow_direction_t) :: direction
    type(flow_response_t) :: flow
    real(wp) :: above
    integer :: i

    if (.not. laws%viscous) then
      increment = (value - step%flow%value)/(modulus + max(step%flow%slope, 0.0_wp))
      return
    end if
    call laws%criterion%second_derivative(effective, direction)
    increment = 0.0_wp
    above = (value - step%flow%value)/modulus
    do i = 1, bisections
      above = 0.5_wp*above
      call flow_stress_after(laws, start, increment + above, step%frequency, direction, &
          plastic_work_t(), flow)
      if (flow%value < value - modulus*(increment + above)) increment = increment + above
    end do
    increment = increment + above
  end function first_increment

  !> Iterate by Newton's method from `step%direction%stress` and `step%increment`.
  pure subroutine iterate(laws, start, step)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    type(step_t), intent(inout) :: step

    real(wp) :: change(6), change_of_increment
    logical :: regular, accepted
    integer :: iteration

    step%converged = .false.
    ! A copy, as the evaluation overwrites the step.
    change = step%direction%stress
    change_of_increment = step%increment
    call evaluate(laws, start, change, change_of_increment, step)
    do iteration = 1, iteration_limit
      step%iterations = step%iterations + 1
      call invert(laws, step, regular)
      if (.not. regular) return
      change = -matmul(step%block, step%residual) - step%excess*step%column
      change_of_increment = -dot_product(step%row, step%residual) - step%excess*step%corner
      if (step%norm < tolerance) then
        call finish(laws, start, change, change_of_increment, step)
        return
      end if
      call line_search(laws, start, change, change_of_increment, step, accepted)
      if (.not. accepted) return
    end do
  end subroutine iterate

  !> Evaluate criterion, laws and residual at an effective stress and a plastic increment.
  pure subroutine evaluate(laws, start, stress, increment, step)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Effective stress, MPa; plastic increment.
    real(wp), intent(in) :: stress(6), increment
    type(step_t), intent(inout) :: step

    type(plastic_work_t) :: work

    call laws%criterion%second_derivative(stress, step%direction)
    call laws%hardening%flow_stress(start(1), start(laws%first:laws%last), increment, &
        step%direction, step%flow)
    step%increment = increment
    step%stress = stress
    if (laws%kinematic) then
      call add_back_stresses(laws, start, increment, step%direction, step%back)
      step%stress = stress + step%back%value
    end if
    if (laws%heated) work = plastic_work(laws, increment, step%direction, step%back)
    if (laws%scaled) call apply_factors(laws, start, increment, step%frequency, work, step%flow)
    step%residual = step%softness*elastic_strain(laws%elasticity, step%stress - step%trial) &
        + increment*step%direction%gradient
    step%excess = step%direction%equivalent - step%flow%value
    step%norm = sqrt(dot_product(step%residual, step%residual)/strain_weight**2 &
        + (step%excess/step%flow%value)**2)
  end subroutine evaluate

  !> Apply the longest of the repeatedly halved changes that reduces the residual.
  pure subroutine line_search(laws, start, change, change_of_increment, step, accepted)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Newton's change of the effective stress, MPa, and of the plastic increment.
    real(wp), intent(in) :: change(6), change_of_increment
    type(step_t), intent(inout) :: step
    !> Whether there is one.
    logical, intent(out) :: accepted

    real(wp) :: stress(6), increment, norm, fraction, least
    integer :: halving

    stress = step%direction%stress
    increment = step%increment
    norm = step%norm
    fraction = 1.0_wp
    least = 0.0_wp
    if (laws%viscous) least = least_part*increment
    do halving = 0, halving_limit
      call evaluate(laws, start, stress + fraction*change, &
          max(least, increment + fraction*change_of_increment), step)
      accepted = step%norm < norm
      if (accepted) return
      fraction = 0.5_wp*fraction
    end do
  end subroutine line_search

  !> Apply the last correction.
  pure subroutine finish(laws, start, change, change_of_increment, step)
    type(composition_t), intent(in) :: laws
    !> Internal variables at the start.
    real(wp), intent(in) :: start(laws%n_internal)
    !> Newton's change of the effective stress, MPa, and of the plastic increment.
    real(wp), intent(in) :: change(6), change_of_increment
    type(step_t), intent(inout) :: step

    if (laws%symmetric) then
      step%stress = step%stress + change
      step%increment = max(0.0_wp, step%increment + change_of_increment)
    else
      call evaluate(laws, start, step%direction%stress + change, &
          max(0.0_wp, step%increment + change_of_increment), step)
    end if
    step%converged = .true.
  end subroutine finish

  !> Invert the matrix of the iteration [A, c; r, -Y'], A = C^-1 (I + dX/dxi) + dp H,
  !> c = C^-1 dX/dp + V, r = V - dY/dxi: A without pivoting, then elimination of the last unknown.
  pure subroutine invert(laws, step, regular)
    type(composition_t), intent(in) :: laws
    type(step_t), intent(inout) :: step
    !> Whether the matrix is regular.
    logical, intent(out) :: regular

    real(wp) :: row(6), modulus
    integer :: j

    call fill_matrix(laws, step, step%block, step%column, row)
    call invert_in_place(step%block, smallest_pivot/laws%elasticity%shear, regular)
    if (.not. regular) then
      call invert_with_pivots(laws, step, regular)
      return
    end if
    step%column = matmul(step%block, step%column)
    modulus = dot_product(step%column, row) + step%flow%slope
    regular = modulus > smallest_pivot*laws%elasticity%shear
    if (.not. regular) return
    step%corner = -1/modulus
    step%row = matmul(row, step%block)/modulus
    do j = 1, 6
      step%block(:, j) = step%block(:, j) - step%row(j)*step%column
    end do
    step%column = step%column/modulus
  end subroutine invert

  !> Fill the matrix of the iteration except its last entry, -Y'.
  pure subroutine fill_matrix(laws, step, matrix, column, row)
    type(composition_t), intent(in) :: laws
    type(step_t), intent(in) :: step
    !> A, c and r.
    real(wp), intent(out) :: matrix(6, 6), column(6), row(6)

    integer :: j

    matrix = laws%elasticity%compliance + step%increment*step%direction%second
    if (laws%softens) matrix = matrix + (step%softness - 1)*laws%elasticity%compliance
    column = step%direction%gradient
    row = step%direction%gradient
    if (laws%symmetric) return
    row = row - step%flow%gradient
    if (.not. laws%kinematic) return
    do j = 1, 6
      matrix(:, j) = matrix(:, j) &
          + step%softness*elastic_strain(laws%elasticity, step%back%gradient(:, j))
    end do
    column = column + step%softness*elastic_strain(laws%elasticity, step%back%slope)
  end subroutine fill_matrix

  !> Invert a positive definite 6x6 matrix by Gauss-Jordan sweeps without pivoting. The unit vectors
  !> avoid scalar stores between vector ones, which cost more than the arithmetic.
  pure subroutine invert_in_place(a, smallest, regular)
    real(wp), intent(inout) :: a(6, 6)
    !> Smallest acceptable pivot.
    real(wp), intent(in) :: smallest
    !> Whether all pivots are acceptable.
    logical, intent(out) :: regular

    real(wp) :: pivot, factor, column(6)
    integer :: j, k

    regular = .false.
    do k = 1, 6
      pivot = a(k, k)
      if (.not. pivot > smallest) return
      pivot = 1/pivot
      column = a(:, k) - unit(:, k)
      do j = 1, 6
        factor = pivot*a(k, j)
        a(:, j) = a(:, j) - factor*column
      end do
      a(:, k) = unit(:, k) - pivot*column
    end do
    regular = .true.
  end subroutine invert_in_place

  !> Invert the same matrix with pivoting, for laws that make A indefinite. Twice the shear modulus
  !> scales the matrix to order one.
  pure subroutine invert_with_pivots(laws, step, regular)
    type(composition_t), intent(in) :: laws
    type(step_t), intent(inout) :: step
    !> Whether the matrix is regular.
    logical, intent(out) :: regular

    real(wp) :: matrix(7, 7), inverse(7, 7), scale
    integer :: j

    scale = 2*laws%elasticity%shear
    call fill_matrix(laws, step, step%block, step%column, step%row)
    matrix(1:6, 1:6) = scale*step%block
    matrix(1:6, 7) = step%column
    matrix(7, 1:6) = step%row
    matrix(7, 7) = -step%flow%slope/scale
    inverse = 0.0_wp
    do j = 1, 7
      inverse(j, j) = 1.0_wp
    end do
    call solve_small(7, 7, matrix, inverse, regular)
    if (.not. regular) return
    step%block = scale*inverse(1:6, 1:6)
    step%column = inverse(1:6, 7)
    step%row = inverse(7, 1:6)
    step%corner = inverse(7, 7)/scale
  end subroutine invert_with_pivots

end module dd3_material_return_mapping
