!> The update of a point over a strain increment: one step, or, where that fails, 2, 4 ... 64 equal
!> ones, with the derivative of the stress at the end in the whole strain.
module dd3_material_update
  use dd3_base_kinds, only : wp, i8
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, verdict_impossible
  use dd3_material_composition, only : composition_t, advance_internal
  use dd3_material_return_mapping, only : step_t, take_step
  implicit none
  private
  public :: update_point

  !> Most equal parts a strain increment is cut into.
  integer, parameter :: part_limit = 64
  !> Largest component of a strain increment that is tried at all.
  real(wp), parameter :: strain_limit = 10.0_wp
  !> Step of the central differences, in strain.
  real(wp), parameter :: difference = 1.0e-7_wp

contains

  !> Brings a point to the end of a strain increment.
  pure subroutine update_point(laws, least_parts, stress_old, internal_old, strain, &
                               stress, internal, tangent, plastic, verdict)
    !> The laws.
    type(composition_t), intent(in) :: laws
    !> Parts to begin with.
    integer, intent(in) :: least_parts
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress_old(6), internal_old(laws%n_internal)
    !> Strain increment.
    real(wp), intent(in) :: strain(6)
    !> Stress, MPa, and internal variables at the end.
    real(wp), intent(out) :: stress(6), internal(laws%n_internal)
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)
    !> Whether plastic flow took place in the (last part of the) increment.
    logical, intent(out) :: plastic
    !> How it ended; its place is left as it was.
    type(verdict_t), intent(inout) :: verdict
    type(step_t) :: step
    integer :: parts

    plastic = .false.
    verdict%outcome = verdict_impossible
    verdict%iterations = 0
    verdict%norm = 0.0_wp
    ! Blanking a text that is blank already would cost more than an elastic update.
    if (verdict%reason(1:1) /= " ") verdict%reason = ""
    if (.not. all_finite(laws%n_internal, stress_old, internal_old, strain)) then
      call give_up(laws, stress_old, internal_old, stress, internal, tangent)
      verdict%reason = "stress, strain or internal variables are no numbers"
      return
    end if
    if (any(abs(strain) > strain_limit)) then
      call give_up(laws, stress_old, internal_old, stress, internal, tangent)
      verdict%outcome = verdict_retry
      verdict%reason = "strain increment of "//to_text(maxval(abs(strain)), 4)//" is too large"
      return
    end if
    parts = least_parts
    do while (parts <= part_limit)
      if (parts == 1) then
        call whole_increment(laws, stress_old, internal_old, strain, &
                             stress, internal, tangent, step)
      else
        call in_parts(laws, parts, stress_old, internal_old, strain, &
                      stress, internal, tangent, step)
      end if
      verdict%iterations = verdict%iterations + step%iterations
      verdict%norm = step%norm
      if (step%converged) then
        verdict%outcome = verdict_converged
        plastic = step%plastic
        return
      end if
      parts = 2*parts
    end do
    call give_up(laws, stress_old, internal_old, stress, internal, tangent)
    verdict%outcome = verdict_retry
    verdict%reason = failure_text(internal_old, strain, step)
  end subroutine update_point

  !> Whether none of the numbers is a NaN or infinite; tests bits, as a comparison would trap.
  pure logical function all_finite(n, stress, internal, strain)
    !> Number of internal variables.
    integer, intent(in) :: n
    !> The numbers.
    real(wp), intent(in) :: stress(6), internal(n), strain(6)
    !> Bits of the exponent.
    integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)
    integer :: i

    all_finite = .true.
    do i = 1, 6
      if (iand(transfer(stress(i), 0_i8), exponent_bits) == exponent_bits) all_finite = .false.
      if (iand(transfer(strain(i), 0_i8), exponent_bits) == exponent_bits) all_finite = .false.
    end do
    do i = 1, n
      if (iand(transfer(internal(i), 0_i8), exponent_bits) == exponent_bits) all_finite = .false.
    end do
  end function all_finite

  !> Returns the state of the start with the elastic tangent.
  pure subroutine give_up(laws, stress_old, internal_old, stress, internal, tangent)
    !> The laws.
    type(composition_t), intent(in) :: laws
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress_old(6), internal_old(laws%n_internal)
    !> The same, and the elastic tangent, MPa.
    real(wp), intent(out) :: stress(6), internal(laws%n_internal), tangent(6, 6)

    stress = stress_old
    internal = internal_old
    tangent = laws%elasticity%stiffness
  end subroutine give_up

  !> The state that broke the update, in words.
  pure function failure_text(internal, strain, step) result(text)
    !> Internal variables at the start.
    real(wp), intent(in) :: internal(:)
    !> Strain increment.
    real(wp), intent(in) :: strain(6)
    !> The last step tried.
    type(step_t), intent(in) :: step
    character(len=:), allocatable :: text

    text = "return mapping fails: strain increment "//to_text(maxval(abs(strain)), 4)// &
           ", plastic strain "//to_text(internal(1), 4)//", trial/flow stress "// &
           to_text(step%overstress, 4)//" in the last part, residual "//to_text(step%norm, 4)
  end function failure_text

  !> The increment in one step.
  pure subroutine whole_increment(laws, stress_old, internal_old, strain, &
                                  stress, internal, tangent, step)
    !> See `update_point`.
    type(composition_t), intent(in) :: laws
    !> See `update_point`.
    real(wp), intent(in) :: stress_old(6), internal_old(laws%n_internal), strain(6)
    !> See `update_point`.
    real(wp), intent(out) :: stress(6), internal(laws%n_internal), tangent(6, 6)
    !> The step.
    type(step_t), intent(out) :: step

    call take_step(laws, stress_old, internal_old, strain, step)
    if (.not. step%converged) return
    stress = step%stress
    if (step%plastic) then
      call advance_internal(laws, internal_old, step%increment, step%direction, internal)
      call stress_by_strain(laws, step, tangent)
    else
      internal = internal_old
      tangent = laws%elasticity%stiffness
    end if
  end subroutine whole_increment

  !> Consistent tangent of a plastic step: dT = (I + dX/dxi) dxi + dX/dp dp.
  pure subroutine stress_by_strain(laws, step, tangent)
    !> The laws.
    type(composition_t), intent(in) :: laws
    !> The step.
    type(step_t), intent(in) :: step
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)
    integer :: j

    tangent = step%block
    if (.not. laws%kinematic) return
    tangent = tangent + matmul(step%back%gradient, step%block)
    do j = 1, 6
      tangent(:, j) = tangent(:, j) + step%row(j)*step%back%slope
    end do
  end subroutine stress_by_strain

  !> The increment in equal parts. The derivatives are carried from part to part; where the state is
  !> more than stress and plastic strain they are central differences of the whole.
  pure subroutine in_parts(laws, parts, stress_old, internal_old, strain, &
                           stress, internal, tangent, step)
    !> See `update_point`.
    type(composition_t), intent(in) :: laws
    !> Number of parts.
    integer, intent(in) :: parts
    !> See `update_point`.
    real(wp), intent(in) :: stress_old(6), internal_old(laws%n_internal), strain(6)
    !> See `update_point`.
    real(wp), intent(out) :: stress(6), internal(laws%n_internal), tangent(6, 6)
    !> The last step.
    type(step_t), intent(out) :: step
    real(wp) :: ahead(6), behind(6), moved(6), plastic_slope(6), moved_internal(laws%n_internal)
    type(step_t) :: moved_step
    integer :: j

    call follow_parts(laws, parts, stress_old, internal_old, strain, stress, internal, step, &
                      tangent, plastic_slope)
    if (laws%symmetric .and. laws%n_internal == 1) return
    do j = 1, 6
      if (.not. step%converged) return
      moved = strain
      moved(j) = strain(j) + difference
      call follow_parts(laws, parts, stress_old, internal_old, moved, ahead, moved_internal, &
                        moved_step)
      step%converged = moved_step%converged
      moved(j) = strain(j) - difference
      call follow_parts(laws, parts, stress_old, internal_old, moved, behind, moved_internal, &
                        moved_step)
      step%converged = step%converged .and. moved_step%converged
      tangent(:, j) = (ahead - behind)/(2*difference)
    end do
  end subroutine in_parts

  !> Takes the equal parts one after the other; stops at the first that fails.
  pure subroutine follow_parts(laws, parts, stress_old, internal_old, strain, stress, internal, &
                               step, stress_slope, plastic_slope)
    !> See `update_point`.
    type(composition_t), intent(in) :: laws
    !> Number of parts.
    integer, intent(in) :: parts
    !> See `update_point`.
    real(wp), intent(in) :: stress_old(6), internal_old(laws%n_internal), strain(6)
    !> See `update_point`.
    real(wp), intent(out) :: stress(6), internal(laws%n_internal)
    !> The last step.
    type(step_t), intent(out) :: step
    !> Derivatives in the whole strain of the stress, MPa, and of the plastic strain; right where
    !> the state is stress and plastic strain.
    real(wp), intent(out), optional :: stress_slope(6, 6), plastic_slope(6)
    real(wp) :: start(6), start_internal(laws%n_internal)
    integer :: part

    stress = stress_old
    internal = internal_old
    if (present(stress_slope)) stress_slope = 0.0_wp
    if (present(plastic_slope)) plastic_slope = 0.0_wp
    do part = 1, parts
      start = stress
      start_internal = internal
      call take_step(laws, start, start_internal, strain/real(parts, wp), step)
      if (.not. step%converged) return
      stress = step%stress
      if (step%plastic) then
        call advance_internal(laws, start_internal, step%increment, step%direction, internal)
      end if
      if (present(stress_slope)) call chain(laws, parts, step, stress_slope, plastic_slope)
    end do
  end subroutine follow_parts

  !> Carries the derivatives of stress and plastic strain over one part.
  pure subroutine chain(laws, parts, step, stress_slope, plastic_slope)
    !> The laws.
    type(composition_t), intent(in) :: laws
    !> Number of parts.
    integer, intent(in) :: parts
    !> The step of this part.
    type(step_t), intent(in) :: step
    !> Derivatives in the whole strain of the stress, MPa, and of the plastic strain.
    real(wp), intent(inout) :: stress_slope(6, 6), plastic_slope(6)
    real(wp) :: driving(6, 6)
    integer :: j

    if (.not. step%plastic) then
      stress_slope = stress_slope + laws%elasticity%stiffness/real(parts, wp)
      return
    end if
    driving = matmul(laws%elasticity%compliance, stress_slope)
    do j = 1, 6
      driving(j, j) = driving(j, j) + 1.0_wp/real(parts, wp)
    end do
    stress_slope = matmul(step%block, driving)
    do j = 1, 6
      stress_slope(:, j) = stress_slope(:, j) + step%column*(step%flow%slope*plastic_slope(j))
    end do
    plastic_slope = plastic_slope*(1 + step%corner*step%flow%slope) + matmul(step%row, driving)
  end subroutine chain

end module dd3_material_update
