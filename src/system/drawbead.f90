! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of the draw-beads on the nodes and their stiffness. The points of a bead are found in the
!> committed state and keep their place in the material for the increment, so that the restraining
!> force depends on the displacements through the slip alone. The next increment finds new points;
!> each interval passes on the means of force and slip path over its points. An interval beside the
!> sheet has no force and keeps its slip path.
module dd3_system_drawbead
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_model_bead_points, only : bead_point_t, covered_length, find_bead_points
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: place_beads, evaluate_beads, add_bead_stiffness, remaining_bead_load, &
      normal_fraction, presses_by_bead

  !> Openings of the tools, in thicknesses of the sheet, at which a draw-bead has left it, and at
  !> which its normal force, elastic between the tools, has ended.
  real(wp), parameter :: height = 5.0_wp, elastic = 0.1_wp

contains

  !> Return the fraction of the restraint with which a draw-bead acts: that of a withdrawn tool has
  !> left the sheet when the tools have opened by `height` thicknesses.
  pure real(wp) function grip(model, state, bead)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: bead

    grip = closed(model, state, bead, height)
  end function grip

  !> Return the fraction that is left of what acts in a bead until its tool, without one the farthest
  !> of all, has opened by so many thicknesses.
  pure real(wp) function closed(model, state, bead, opening)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: bead
    real(wp), intent(in) :: opening

    real(wp) :: distance

    closed = 1.0_wp
    associate (phase => model%phase(state%phase), tool => model%drawbead(bead)%tool)
      if (.not. phase%bead_leaves(bead)) return
      if (tool > 0) then
        distance = phase%opened(tool, state%progress)
      else
        distance = phase%most_opened(state%progress)
      end if
    end associate
    closed = max(0.0_wp, 1.0_wp - distance/(opening*model%thickness))
  end function closed

  !> Whether the normal force of a draw-bead of a withdrawn tool still acts.
  pure logical function presses_by_bead(model, state, tool)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool

    integer :: b

    presses_by_bead = .false.
    do b = 1, size(model%drawbead)
      if (model%drawbead(b)%tool /= tool .or. .not. abs(model%drawbead(b)%normal) > 0.0_wp) cycle
      if (model%phase(state%phase)%bead_leaves(b)) presses_by_bead = presses_by_bead &
          .or. closed(model, state, b, elastic) > 0.0_wp
    end do
  end function presses_by_bead

  !> Find the points of the active beads for the next increment, with the stiffness of slips that
  !> continue.
  subroutine place_beads(point, model, committed)
    type(bead_point_t), allocatable, intent(inout) :: point(:)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed

    integer :: p

    if (size(committed%bead_total, 2) == 0) then
      point = [bead_point_t ::]
      return
    end if
    call find_bead_points(model, model%phase(committed%phase)%bead_active, committed%x, point)
    do p = 1, size(point)
      associate (i => point(p)%interval, share => grip(model, committed, point(p)%bead))
        point(p)%stiffness = 0.0_wp
        if (share > 0.0_wp) point(p)%stiffness = share*model%drawbead(point(p)%bead) &
            %sliding_stiffness(committed%bead_force(i)/share, committed%bead_path(i))
      end associate
    end do
  end subroutine place_beads

  !> Evaluate the forces of the beads in a trial state.
  subroutine evaluate_beads(point, model, committed, trial)
    !> Get the stiffness.
    type(bead_point_t), intent(inout) :: point(:)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: committed
    !> Gets forces, path and lengths.
    type(state_t), intent(inout) :: trial

    real(wp) :: weight(size(trial%bead_force)), fraction(size(trial%bead_normal)), force, path
    integer :: p, b

    weight = 0.0_wp
    fraction = normal_fraction(trial)*[(closed(model, trial, b, elastic), b=1, size(fraction))]
    trial%bead_force = 0.0_wp
    trial%bead_path = 0.0_wp
    trial%bead_load = 0.0_wp
    trial%bead_total = 0.0_wp
    trial%bead_restraint = 0.0_wp
    do p = 1, size(point)
      associate (i => point(p)%interval, bead => model%drawbead(point(p)%bead), &
          share => grip(model, trial, point(p)%bead))
        force = 0.0_wp
        path = committed%bead_path(i)
        if (share > 0.0_wp) call bead%restrain(committed%bead_force(i)/share, &
            committed%bead_path(i), slip(point(p), bead%tool, committed, trial), force, path, &
            point(p)%stiffness)
        force = share*force
        point(p)%stiffness = share*point(p)%stiffness
        call add_load(point(p), force, fraction(point(p)%bead)*bead%normal, trial)
        weight(i) = weight(i) + point(p)%weight
        trial%bead_force(i) = trial%bead_force(i) + point(p)%weight*force
        trial%bead_path(i) = trial%bead_path(i) + point(p)%weight*path
        trial%bead_restraint(point(p)%bead) = trial%bead_restraint(point(p)%bead) &
            + point(p)%weight*abs(force)
      end associate
    end do
    where (weight > 0.0_wp)
      trial%bead_force = trial%bead_force/weight
      trial%bead_path = trial%bead_path/weight
    end where
    do b = 1, size(trial%bead_length)
      trial%bead_length(b) = 0.0_wp
      if (grip(model, trial, b) > 0.0_wp) trial%bead_length(b) = covered_length(point, b)
      if (.not. model%phase(trial%phase)%bead_active(b)) cycle
      associate (bead => model%drawbead(b))
        do p = bead%offset + 1, bead%offset + size(bead%line, 3)
          if (weight(p) <= 0.0_wp) trial%bead_path(p) = committed%bead_path(p)
        end do
      end associate
    end do
  end subroutine evaluate_beads

  !> Return the slip at a point since the committed state, mm.
  pure real(wp) function slip(point, tool, committed, trial)
    type(bead_point_t), intent(in) :: point
    !> Tool that carries the bead; 0 for none.
    integer, intent(in) :: tool
    type(state_t), intent(in) :: committed, trial

    real(wp) :: motion(3)

    motion = matmul(trial%x(:, point%node) - committed%x(:, point%node), point%shape)
    if (tool > 0) motion = motion - (trial%tool_displacement(:, tool) &
        - committed%tool_displacement(:, tool))
    slip = dot_product(point%across, motion)
  end function slip

  !> Return the fraction of the normal force of each draw-bead that acts: it grows to 1 over the
  !> phase in which the bead begins to act and, if that ended early, over the next one.
  pure function normal_fraction(state) result(fraction)
    type(state_t), intent(in) :: state
    real(wp) :: fraction(size(state%bead_normal))

    fraction = state%bead_normal + (1.0_wp - state%bead_normal)*state%progress
  end function normal_fraction

  !> Add the force of a bead on the sheet at a point to those of the nodes and of the bead.
  pure subroutine add_load(point, restraint, normal, state)
    type(bead_point_t), intent(in) :: point
    !> Restraining and normal force, N/mm.
    real(wp), intent(in) :: restraint, normal
    type(state_t), intent(inout) :: state

    real(wp) :: force(3)
    integer :: a

    force = -restraint*point%direction
    force(3) = force(3) + normal
    do a = 1, size(point%node)
      state%bead_load(:, point%node(a)) = state%bead_load(:, point%node(a)) &
          + point%weight*point%shape(a)*force
    end do
    state%bead_total(:, point%bead) = state%bead_total(:, point%bead) + point%weight*force
  end subroutine add_load

  !> Return the forces on the nodes of the beads that are still active in a phase that follows a
  !> state, `(3, n_node)`, N.
  function remaining_bead_load(model, number, state) result(load)
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> State at the end of the phase before.
    type(state_t), intent(in) :: state
    real(wp), allocatable :: load(:, :)

    type(bead_point_t), allocatable :: point(:)
    type(state_t) :: start

    start = state
    call find_bead_points(model, model%phase(number)%bead_active &
        .and. .not. model%phase(number)%bead_new, state%x, point)
    call evaluate_beads(point, model, state, start)
    load = start%bead_load
  end function remaining_bead_load

  !> Add the stiffness of the beads to that of the sheet.
  subroutine add_bead_stiffness(stiffness, point)
    type(block_matrix_t), intent(inout) :: stiffness
    !> Evaluated.
    type(bead_point_t), intent(in) :: point(:)

    integer :: p, a, b, i, k

    do p = 1, size(point)
      associate (this => point(p))
        do a = 1, size(this%node)
          if (.not. holds_row(stiffness, this%node(a))) cycle
          do b = 1, size(this%node)
            k = position_of(stiffness, this%node(a), this%node(b))
            do i = 1, 3
              stiffness%value(:, i, k) = stiffness%value(:, i, k) + this%stiffness*this%weight &
                  *this%shape(a)*this%shape(b)*this%across(i)*this%direction
            end do
          end do
        end do
      end associate
    end do
  end subroutine add_bead_stiffness

end module dd3_system_drawbead
