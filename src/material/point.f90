! SPDX-License-Identifier: GPL-3.0-or-later
!> A single material point without a mesh: each component of strain or stress is driven to a target,
!> in axes that need not be those of the material, by Newton's method on the consistent tangent. A
!> path that fails in one step is divided into halves, quarters and so on.
module dd3_material_point
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_no_strain, &
      cause_singular_tangent, cause_strain_bound
  use dd3_linalg_tensor, only : kelvin_rotation, solve_small
  use dd3_material_material, only : material_t
  implicit none
  private
  public :: material_point_t, new_material_point, drive_to_target, apply_strain, global_stress

  !> Limits of the iterations of a step and of its halvings.
  integer, parameter :: iteration_limit = 40, halving_limit = 12
  !> Largest error of a stress, relative to the stresses present and to Young's modulus.
  real(wp), parameter :: tolerance = 1.0e-9_wp, smallest = 1.0e-12_wp
  !> Largest strain increment of one iteration.
  real(wp), parameter :: longest = 0.2_wp
  !> Largest strain accepted for a target stress.
  real(wp), parameter :: largest_strain = 10.0_wp

  !> A material point and its state.
  type :: material_point_t
    !> Stress in the axes of the material, Kelvin, MPa.
    real(wp) :: stress(6) = 0.0_wp
    real(wp), allocatable :: internal_variables(:)
    !> Sum of the logarithmic strain increments in the axes of the targets, Kelvin.
    real(wp) :: strain(6) = 0.0_wp
    !> Axes of the material as columns.
    real(wp) :: axes(3, 3) = 0.0_wp
    !> Whether plastic flow occurred in the last step.
    logical :: plastic = .false.
  end type material_point_t

contains

  !> Initialise a point in the undeformed state.
  subroutine new_material_point(self, material, axes)
    type(material_point_t), intent(out) :: self
    type(material_t), intent(in) :: material
    !> Axes of the material as columns.
    real(wp), intent(in) :: axes(3, 3)

    self%axes = axes
    allocate (self%internal_variables(material%n_internal))
    self%internal_variables = 0.0_wp
  end subroutine new_material_point

  !> Return the stress in the axes of the targets, Kelvin, MPa.
  pure function global_stress(self) result(stress)
    type(material_point_t), intent(in) :: self
    real(wp) :: stress(6)

    stress = matmul(kelvin_rotation(self%axes), self%stress)
  end function global_stress

  !> Drive a point on a straight path to a target.
  pure subroutine drive_to_target(self, material, by_stress, target, time, verdict)
    !> On failure, the state after the last step that converged.
    type(material_point_t), intent(inout) :: self
    type(material_t), intent(in) :: material
    !> Whether the target of a component is a stress.
    logical, intent(in) :: by_stress(6)
    !> Stress (MPa) or strain of each component at the end, Kelvin.
    real(wp), intent(in) :: target(6)
    !> Time of the path, s; 0 for none.
    real(wp), intent(in) :: time
    type(verdict_t), intent(out) :: verdict

    real(wp) :: start(6), done, fraction
    integer :: halvings

    start = merge(global_stress(self), self%strain, by_stress)
    done = 0.0_wp
    fraction = 1.0_wp
    halvings = 0
    do
      call drive_in_one_step(self, material, by_stress, &
          start + min(1.0_wp, done + fraction)*(target - start), fraction*time, verdict)
      if (verdict%outcome == verdict_converged) then
        done = done + fraction
        if (done >= 1.0_wp) return
      else
        halvings = halvings + 1
        if (halvings > halving_limit) return
        fraction = 0.5_wp*fraction
      end if
    end do
  end subroutine drive_to_target

  !> Drive a point to a target in one step; on failure the state is unchanged.
  pure subroutine drive_in_one_step(self, material, by_stress, target, time, verdict)
    type(material_point_t), intent(inout) :: self
    type(material_t), intent(in) :: material
    logical, intent(in) :: by_stress(6)
    real(wp), intent(in) :: target(6)
    !> Time of the step, s; 0 for none.
    real(wp), intent(in) :: time
    type(verdict_t), intent(out) :: verdict

    type(material_point_t) :: trial
    real(wp) :: rotation(6, 6), tangent(6, 6), increment(6), change(6), stress(6), stress_error
    integer :: iteration
    logical :: regular, within

    within = .true.
    rotation = kelvin_rotation(self%axes)
    stress = global_stress(self)
    increment = 0.0_wp
    call material%continuum_tangent(self%stress, self%internal_variables, self%plastic, tangent)
    change = merge(target - stress, target - self%strain, by_stress)
    trial = self
    do iteration = 1, iteration_limit
      call solve_mixed(rotation, tangent, by_stress, change, regular)
      if (.not. regular) exit
      increment = increment + change*min(1.0_wp, longest/max(norm2(change), longest))
      call material%update(self%stress, self%internal_variables, matmul(increment, rotation), &
          trial%stress, trial%internal_variables, tangent, trial%plastic, verdict, time)
      if (verdict%outcome /= verdict_converged) return
      stress = global_stress(trial)
      change = merge(target - stress, target - self%strain - increment, by_stress)
      stress_error = norm2(merge(change, 0.0_wp, by_stress))
      if (stress_error <= tolerance*max(norm2(stress), norm2(merge(target, 0.0_wp, by_stress))) &
          + smallest*material%young .and. norm2(merge(0.0_wp, change, by_stress)) <= smallest) then
        within = .not. any(by_stress .and. abs(self%strain + increment) > largest_strain)
        if (.not. within) exit
        trial%strain = self%strain + increment
        self = trial
        return
      end if
    end do
    verdict%outcome = verdict_retry
    verdict%norm = norm2(merge(change, 0.0_wp, by_stress))
    verdict%cause = cause_no_strain
    if (.not. regular) verdict%cause = cause_singular_tangent
    if (.not. within) verdict%cause = cause_strain_bound
    verdict%value(:2) = [merge(verdict%norm, largest_strain, within), &
        material%flow_stress(self%internal_variables)]
  end subroutine drive_in_one_step

  !> Solve for the change of strain that gives prescribed changes of stress and strain.
  pure subroutine solve_mixed(rotation, tangent, by_stress, change, regular)
    !> Rotation of Kelvin vectors from the axes of the material.
    real(wp), intent(in) :: rotation(6, 6)
    !> d stress/d strain in the axes of the material, MPa.
    real(wp), intent(in) :: tangent(6, 6)
    !> Which components are stresses.
    logical, intent(in) :: by_stress(6)
    !> The prescribed changes, then the change of strain.
    real(wp), intent(inout) :: change(6)
    !> Whether there is a solution.
    logical, intent(out) :: regular

    real(wp) :: matrix(6, 6), right(6, 1), scale
    integer :: i

    matrix = matmul(rotation, matmul(tangent, transpose(rotation)))
    scale = maxval(abs(matrix))
    do i = 1, 6
      if (by_stress(i)) then
        matrix(i, :) = matrix(i, :)/scale
        change(i) = change(i)/scale
      else
        matrix(i, :) = 0.0_wp
        matrix(i, i) = 1.0_wp
      end if
    end do
    right(:, 1) = change
    call solve_small(6, 1, matrix, right, regular)
    if (regular) change = right(:, 1)
  end subroutine solve_mixed

  !> Apply a logarithmic strain increment to a point, then rotate its axes.
  pure subroutine apply_strain(self, material, strain, rotation, time, verdict)
    !> Unchanged on failure.
    type(material_point_t), intent(inout) :: self
    type(material_t), intent(in) :: material
    !> Logarithmic strain increment in fixed axes, Kelvin.
    real(wp), intent(in) :: strain(6)
    !> Rotation that follows the stretch.
    real(wp), intent(in) :: rotation(3, 3)
    !> Time of the increment, s; 0 for none.
    real(wp), intent(in) :: time
    type(verdict_t), intent(out) :: verdict

    type(material_point_t) :: trial
    real(wp) :: tangent(6, 6)

    trial = self
    call material%update(self%stress, self%internal_variables, &
        matmul(strain, kelvin_rotation(self%axes)), trial%stress, trial%internal_variables, &
        tangent, trial%plastic, verdict, time)
    if (verdict%outcome /= verdict_converged) return
    trial%axes = matmul(rotation, self%axes)
    self = trial
  end subroutine apply_strain

end module dd3_material_point
