! SPDX-License-Identifier: GPL-3.0-or-later
!> Integration of a point's stress and internal variables over a strain increment in equal substeps,
!> with the derivative of the final stress in the whole strain.
module dd3_material_update
  use dd3_base_kinds, only : wp, i8
  use dd3_material_composition, only : composition_t, evolve_internal_variables
  use dd3_material_return_mapping, only : step_t, integrate_step
  implicit none
  private
  public :: substeps_t, integrate, differentiate, all_finite

  !> Equal substeps of a strain increment.
  type :: substeps_t
    integer :: count = 1
    !> Time of the whole increment, s; 0 without a time.
    real(wp) :: time = 0.0_wp
    !> Derivatives in the whole strain of the stress, MPa, and of the plastic strain, carried from
    !> substep to substep; see `carries_derivatives`.
    real(wp) :: stress_slope(6, 6), plastic_slope(6)
  end type substeps_t

  !> Step of the central differences, in strain.
  real(wp), parameter :: difference = 1.0e-7_wp

contains

  !> Integrate a strain increment.
  pure subroutine integrate(laws, substeps, stress, start, strain, internal_variables, step)
    type(composition_t), intent(in) :: laws
    type(substeps_t), intent(inout) :: substeps
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress(6), start(laws%n_internal)
    !> Strain increment.
    real(wp), intent(in) :: strain(6)
    !> Internal variables at the end; valid if the step converged.
    real(wp), intent(out) :: internal_variables(laws%n_internal)
    !> The last substep; holds the stress at the end.
    type(step_t), intent(out) :: step

    if (substeps%count > 1) then
      call integrate_substeps(laws, substeps, stress, start, strain, internal_variables, step)
    else
      step%frequency = frequency_of(substeps)
      call integrate_step(laws, stress, start, strain, step)
      if (step%converged) call evolve_internal_variables(laws, start, step%increment, &
          step%frequency, step%stress, step%direction, internal_variables)
    end if
  end subroutine integrate

  !> Return the inverse of the time of a substep, 1/s; 0 without a time.
  pure real(wp) function frequency_of(substeps)
    type(substeps_t), intent(in) :: substeps

    frequency_of = 0.0_wp
    if (substeps%time > 0.0_wp) frequency_of = real(substeps%count, wp)/substeps%time
  end function frequency_of

  !> Integrate a strain increment in several substeps; stop at the first that fails.
  pure subroutine integrate_substeps(laws, substeps, stress, start, strain, internal_variables, &
      step)
    type(composition_t), intent(in) :: laws
    type(substeps_t), intent(inout) :: substeps
    real(wp), intent(in) :: stress(6), start(laws%n_internal), strain(6)
    real(wp), intent(out) :: internal_variables(laws%n_internal)
    type(step_t), intent(out) :: step

    real(wp) :: substep_stress(6), substep_start(laws%n_internal), substep_strain(6)
    integer :: n

    substeps%stress_slope = 0.0_wp
    substeps%plastic_slope = 0.0_wp
    substep_stress = stress
    substep_strain = strain/real(substeps%count, wp)
    internal_variables = start
    step%frequency = frequency_of(substeps)
    do n = 1, substeps%count
      substep_start = internal_variables
      call integrate_step(laws, substep_stress, substep_start, substep_strain, step)
      if (.not. step%converged) return
      substep_stress = step%stress
      call evolve_internal_variables(laws, substep_start, step%increment, step%frequency, &
          step%stress, step%direction, internal_variables)
      if (carries_derivatives(laws)) call chain(laws, step, substeps)
    end do
  end subroutine integrate_substeps

  !> Return whether the derivatives are carried from substep to substep: the state is stress and
  !> plastic strain only, and the elastic stiffness does not depend on it.
  pure logical function carries_derivatives(laws)
    type(composition_t), intent(in) :: laws

    carries_derivatives = laws%symmetric .and. laws%n_internal - laws%n_reported == 1 &
        .and. .not. laws%softens
  end function carries_derivatives

  !> Evaluate the consistent tangent of a strain increment that has been integrated. Over several
  !> substeps whose derivatives are not carried, by central differences.
  pure subroutine differentiate(laws, substeps, stress, start, strain, step, tangent)
    type(composition_t), intent(in) :: laws
    type(substeps_t), intent(inout) :: substeps
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress(6), start(laws%n_internal)
    !> Strain increment.
    real(wp), intent(in) :: strain(6)
    !> The last substep; `converged` is cleared if the differences fail.
    type(step_t), intent(inout) :: step
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)

    if (substeps%count == 1) then
      call step_tangent(laws, step, tangent)
    else if (carries_derivatives(laws)) then
      tangent = substeps%stress_slope
    else
      call central_differences(laws, substeps, stress, start, strain, tangent, step%converged)
    end if
  end subroutine differentiate

  !> Evaluate the consistent tangent of a strain increment by central differences.
  pure subroutine central_differences(laws, substeps, stress, start, strain, tangent, success)
    type(composition_t), intent(in) :: laws
    type(substeps_t), intent(inout) :: substeps
    real(wp), intent(in) :: stress(6), start(laws%n_internal), strain(6)
    real(wp), intent(out) :: tangent(6, 6)
    !> Whether all integrations converged.
    logical, intent(out) :: success

    real(wp) :: moved(6), ignored(laws%n_internal)
    type(step_t) :: ahead, behind
    integer :: j

    do j = 1, 6
      moved = strain
      moved(j) = strain(j) + difference
      call integrate(laws, substeps, stress, start, moved, ignored, ahead)
      moved(j) = strain(j) - difference
      call integrate(laws, substeps, stress, start, moved, ignored, behind)
      success = ahead%converged .and. behind%converged
      if (.not. success) return
      tangent(:, j) = (ahead%stress - behind%stress)/(2*difference)
    end do
  end subroutine central_differences

  !> Evaluate the consistent tangent of one step: elastic, or dT = (I + dX/dxi) dxi + dX/dp dp.
  pure subroutine step_tangent(laws, step, tangent)
    type(composition_t), intent(in) :: laws
    type(step_t), intent(in) :: step
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)

    integer :: j

    if (.not. step%plastic) then
      tangent = step%stiffness*laws%elasticity%stiffness
      return
    end if
    tangent = step%block
    if (.not. laws%kinematic) return
    tangent = tangent + matmul(step%back%gradient, step%block)
    do j = 1, 6
      tangent(:, j) = tangent(:, j) + step%row(j)*step%back%slope
    end do
  end subroutine step_tangent

  !> Carry the derivatives of stress and plastic strain over one substep.
  pure subroutine chain(laws, step, substeps)
    type(composition_t), intent(in) :: laws
    type(step_t), intent(in) :: step
    type(substeps_t), intent(inout) :: substeps

    real(wp) :: driving(6, 6), n
    integer :: j

    n = real(substeps%count, wp)
    if (.not. step%plastic) then
      substeps%stress_slope = substeps%stress_slope + laws%elasticity%stiffness/n
      return
    end if
    driving = matmul(laws%elasticity%compliance, substeps%stress_slope)
    do j = 1, 6
      driving(j, j) = driving(j, j) + 1.0_wp/n
    end do
    substeps%stress_slope = matmul(step%block, driving)
    do j = 1, 6
      substeps%stress_slope(:, j) = substeps%stress_slope(:, j) &
          + step%column*(step%flow%slope*substeps%plastic_slope(j))
    end do
    substeps%plastic_slope = substeps%plastic_slope*(1 + step%corner*step%flow%slope) &
        + matmul(step%row, driving)
  end subroutine chain

  !> Return whether no number is NaN or infinite, by their bits, as a comparison could trap.
  pure logical function all_finite(stress, internal_variables, strain)
    real(wp), intent(in) :: stress(6), internal_variables(:), strain(6)

    !> Bits of the exponent.
    integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)
    integer :: i

    all_finite = .true.
    do i = 1, 6
      if (iand(transfer(stress(i), 0_i8), exponent_bits) == exponent_bits) all_finite = .false.
      if (iand(transfer(strain(i), 0_i8), exponent_bits) == exponent_bits) all_finite = .false.
    end do
    do i = 1, size(internal_variables)
      if (iand(transfer(internal_variables(i), 0_i8), exponent_bits) == exponent_bits) then
        all_finite = .false.
      end if
    end do
  end function all_finite

end module dd3_material_update
