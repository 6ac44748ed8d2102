! SPDX-License-Identifier: GPL-3.0-or-later
!> Work and slip of an accepted increment. Forces are the means of those before and after it, so
!> that the sums approximate the integrals to second order in the increment.
module dd3_process_work
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks, this_rank
  use dd3_contact_operator, only : status_gap, status_slip
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_energy, only : modulus_energy_increment, plastic_work_increment
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_state, only : state_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_tools_placement, only : point_displacement
  implicit none
  private
  public :: add_work

contains

  !> Add work and slip of an increment to those of the new state.
  subroutine add_work(model, contact, old, new)
    type(model_t), intent(in) :: model
    !> Contact of the new state.
    type(contact_work_t), intent(in) :: contact
    type(state_t), intent(in) :: old
    type(state_t), intent(inout) :: new

    real(wp) :: moved(3, model%n_node), faded
    integer :: k

    moved = new%x - old%x
    faded = 0.0_wp
    if (new%sheet%fades) faded = 0.5_wp*sum(moved*( &
        model%phase(old%phase)%fading(old%progress)*old%sheet%fading_force &
        + model%phase(new%phase)%fading(new%progress)*new%sheet%fading_force))
    new%work%internal = old%work%internal + faded &
        + 0.5_wp*sum((old%sheet%internal_force + new%sheet%internal_force)*moved)
    new%work%plastic = old%work%plastic + plastic_work_increment(model, old, new)
    new%work%modulus = old%work%modulus + modulus_energy_increment(model, old, new)
    call add_external_work(model, old, moved, new)
    new%work%external = new%work%external + faded
    call add_contact_work(model, contact, old, new)
    do k = 1, size(new%term)
      call new%term(k)%of%accept(model, old%configuration_t, new%configuration_t)
    end do
  end subroutine add_work

  !> Add the work of loads and of supports that move.
  subroutine add_external_work(model, old, moved, new)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: old
    !> Displacements in the increment, `(3, n_node)`, mm.
    real(wp), intent(in) :: moved(:, :)
    type(state_t), intent(inout) :: new

    real(wp) :: force(3, model%n_node), reaction(3, model%n_node)

    force = old%external_force + new%external_force
    reaction = reactions(model, old) + reactions(model, new)
    where (.not. model%phase(new%phase)%prescribed) reaction = 0.0_wp
    new%work%external = old%work%external + 0.5_wp*sum((force + reaction)*moved)
  end subroutine add_external_work

  !> Add the work of the tools, the friction work and the slip. A contact layer that advances to its
  !> place moves the sheet as the tool does, along its normal.
  subroutine add_contact_work(model, contact, old, new)
    type(model_t), intent(in) :: model
    type(contact_work_t), intent(in) :: contact
    type(state_t), intent(in) :: old
    type(state_t), intent(inout) :: new

    type(surface_point_t) :: point
    real(wp) :: force(3), tool_motion(3), normal(3), slip(3), advance, work(2)
    real(wp) :: duration
    integer :: c, tool

    work = 0.0_wp
    if (this_rank() == 0) work = [old%work%tools, old%work%friction]
    new%contact%slip_path = old%contact%slip_path
    new%contact%slip_speed = 0.0_wp
    duration = new%time - old%time
    do c = 1, model%n_contact
      tool = contact%tool(c)
      if (tool == 0) cycle
      force = 0.5_wp*(old%contact%lambda(:, c) + new%contact%lambda(:, c))
      point = model%contact_point(c)%at_place(new%contact%place(c))
      tool_motion = point_displacement(old%placement(tool), new%placement(tool), &
          point%position(new%x))
      slip = point%position(new%x) - point%position(old%x) - tool_motion
      normal = contact%normal(:, c)
      if (contact%committed_tool(c) == tool) then
        ! The chord along which a point slides over a radius is at right angles to the mean normal.
        normal = contact%committed_normal(:, c) + normal
        normal = normal/norm2(normal)
      end if
      slip = slip - dot_product(normal, slip)*normal
      advance = old%tools%layer_offset(tool) - new%tools%layer_offset(tool)
      work(1) = work(1) - dot_product(force, tool_motion + advance*normal)
      work(2) = work(2) + dot_product(force, slip)
      if (new%contact%status(c) == status_slip .and. old%contact%status(c) /= status_gap) then
        new%contact%slip_path(c) = new%contact%slip_path(c) + norm2(slip)
        if (duration > 0.0_wp) new%contact%slip_speed(c) = norm2(slip)/duration
      end if
    end do
    call sum_over_ranks(2, work)
    new%work%tools = work(1)
    new%work%friction = work(2)
  end subroutine add_contact_work

end module dd3_process_work
