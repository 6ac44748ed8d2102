!> A single material point without a mesh: each component of strain or stress is led to a goal, in
!> axes that need not be those of the material, by Newton's method on the consistent tangent. What
!> does not converge in one step is taken in halves, quarters and so on.
module dd3_material_point
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry
  use dd3_linalg_tensor, only : kelvin_rotation, solve_small
  use dd3_material_material, only : material_t
  implicit none
  private
  public :: point_state_t, new_point_state, lead_point, strain_point, global_stress

  !> Most iterations of a step, most halvings of a step.
  integer, parameter :: iteration_limit = 40, halving_limit = 12
  !> Largest error of a stress, relative to the stresses there are and to Young's modulus.
  real(wp), parameter :: tolerance = 1.0e-9_wp, smallest = 1.0e-12_wp
  !> Largest strain increment of one iteration.
  real(wp), parameter :: longest = 0.2_wp
  !> Largest strain that a stress may lead to: beyond it laws mean nothing.
  real(wp), parameter :: largest_strain = 10.0_wp

  !> The state of a point.
  type :: point_state_t
    !> Stress in the axes of the material, Kelvin, MPa.
    real(wp) :: stress(6) = 0.0_wp
    !> Internal variables.
    real(wp), allocatable :: internal(:)
    !> Sum of the logarithmic strain increments in the axes of the goals, Kelvin.
    real(wp) :: strain(6) = 0.0_wp
    !> Axes of the material as columns.
    real(wp) :: axes(3, 3) = 0.0_wp
    !> Whether the last step was plastic.
    logical :: plastic = .false.
  end type point_state_t

contains

  !> The state of a point that has borne nothing yet.
  subroutine new_point_state(self, material, axes)
    !> The state.
    type(point_state_t), intent(out) :: self
    !> The material.
    type(material_t), intent(in) :: material
    !> Axes of the material as columns.
    real(wp), intent(in) :: axes(3, 3)

    self%axes = axes
    allocate (self%internal(material%n_internal))
    self%internal = 0.0_wp
  end subroutine new_point_state

  !> Stress in the axes of the goals, Kelvin, MPa.
  pure function global_stress(self) result(stress)
    !> The state.
    type(point_state_t), intent(in) :: self
    real(wp) :: stress(6)

    stress = matmul(kelvin_rotation(self%axes), self%stress)
  end function global_stress

  !> Leads a point from its state straight to a goal.
  pure subroutine lead_point(self, material, by_stress, goal, verdict)
    !> The state; left where the last part ended that went well.
    type(point_state_t), intent(inout) :: self
    !> The material.
    type(material_t), intent(in) :: material
    !> Whether the goal of a component is a stress.
    logical, intent(in) :: by_stress(6)
    !> Stress (MPa) or strain of each component at the end, Kelvin.
    real(wp), intent(in) :: goal(6)
    !> How it ended.
    type(verdict_t), intent(out) :: verdict

    real(wp) :: start(6), done, part
    integer :: halvings

    start = merge(global_stress(self), self%strain, by_stress)
    done = 0.0_wp
    part = 1.0_wp
    halvings = 0
    do
      call take_part(self, material, by_stress, start + min(1.0_wp, done + part)*(goal - start), &
                     verdict)
      if (verdict%outcome == verdict_converged) then
        done = done + part
        if (done >= 1.0_wp) return
      else
        halvings = halvings + 1
        if (halvings > halving_limit) return
        part = 0.5_wp*part
      end if
    end do
  end subroutine lead_point

  !> Leads a point to a goal in one step; the state stays where that fails.
  pure subroutine take_part(self, material, by_stress, goal, verdict)
    !> The state.
    type(point_state_t), intent(inout) :: self
    !> The material.
    type(material_t), intent(in) :: material
    !> See `lead_point`.
    logical, intent(in) :: by_stress(6)
    !> See `lead_point`.
    real(wp), intent(in) :: goal(6)
    !> How it ended.
    type(verdict_t), intent(out) :: verdict

    type(point_state_t) :: trial
    real(wp) :: turn(6, 6), tangent(6, 6), increment(6), change(6), now(6)
    integer :: iteration
    logical :: regular, within

    within = .true.
    turn = kelvin_rotation(self%axes)
    now = global_stress(self)
    increment = 0.0_wp
    call material%continuum_tangent(self%stress, self%internal, self%plastic, tangent)
    change = merge(goal - now, goal - self%strain, by_stress)
    trial = self
    do iteration = 1, iteration_limit
      call solve_mixed(turn, tangent, by_stress, change, regular)
      if (.not. regular) exit
      increment = increment + change*min(1.0_wp, longest/max(norm2(change), longest))
      call material%update(self%stress, self%internal, matmul(increment, turn), trial%stress, &
                           trial%internal, tangent, trial%plastic, verdict)
      if (verdict%outcome /= verdict_converged) return
      now = global_stress(trial)
      change = merge(goal - now, goal - self%strain - increment, by_stress)
      if (norm2(merge(change, 0.0_wp, by_stress)) &
          <= tolerance*max(norm2(now), norm2(merge(goal, 0.0_wp, by_stress))) &
             + smallest*material%young .and. &
          norm2(merge(0.0_wp, change, by_stress)) <= smallest) then
        within = .not. any(by_stress .and. abs(self%strain + increment) > largest_strain)
        if (.not. within) exit
        self%stress = trial%stress
        self%internal = trial%internal
        self%plastic = trial%plastic
        self%strain = self%strain + increment
        return
      end if
    end do
    verdict%outcome = verdict_retry
    verdict%norm = norm2(merge(change, 0.0_wp, by_stress))
    verdict%reason = "no strain is found for the stress asked for; "//to_text(verdict%norm, 4)// &
                     " MPa are left"
    if (.not. regular) verdict%reason = "the stress asked for cannot be borne: the tangent is "// &
                                        "singular"
    if (.not. within) verdict%reason = "the stress asked for wants a strain beyond "// &
                                       to_text(largest_strain)
    verdict%reason = trim(verdict%reason)//"; the flow stress is "// &
                     to_text(material%flow_stress(self%internal), 4)//" MPa"
  end subroutine take_part

  !> The change of strain from the changes of stress and strain asked for.
  pure subroutine solve_mixed(turn, tangent, by_stress, change, regular)
    !> Turns Kelvin vectors from the axes of the material.
    real(wp), intent(in) :: turn(6, 6)
    !> d stress/d strain in the axes of the material, MPa.
    real(wp), intent(in) :: tangent(6, 6)
    !> Which components are stresses.
    logical, intent(in) :: by_stress(6)
    !> What is asked for; then the change of strain.
    real(wp), intent(inout) :: change(6)
    !> Whether there is one.
    logical, intent(out) :: regular

    real(wp) :: matrix(6, 6), right(6, 1), scale
    integer :: i

    matrix = matmul(turn, matmul(tangent, transpose(turn)))
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

  !> Strains a point by a logarithmic strain increment, then turns its axes.
  pure subroutine strain_point(self, material, strain, rotation, verdict)
    !> The state; unchanged where it fails.
    type(point_state_t), intent(inout) :: self
    !> The material.
    type(material_t), intent(in) :: material
    !> Logarithmic strain increment in fixed axes, Kelvin.
    real(wp), intent(in) :: strain(6)
    !> Rotation that follows the stretch.
    real(wp), intent(in) :: rotation(3, 3)
    !> How it ended.
    type(verdict_t), intent(out) :: verdict

    type(point_state_t) :: trial
    real(wp) :: tangent(6, 6)

    trial = self
    call material%update(self%stress, self%internal, matmul(strain, kelvin_rotation(self%axes)), &
                         trial%stress, trial%internal, tangent, trial%plastic, verdict)
    if (verdict%outcome /= verdict_converged) return
    trial%axes = matmul(rotation, self%axes)
    self = trial
  end subroutine strain_point

end module dd3_material_point
