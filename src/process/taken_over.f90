! SPDX-License-Identifier: GPL-3.0-or-later
!> Sheet that is taken over from another run: its forces out of balance, from tools and supports
!> that are gone, from a cut and from its transfer to another mesh, fade over the first phase.
module dd3_process_taken_over
  use dd3_base_error, only : error_t, fatal_error
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_state, only : state_t
  use dd3_model_terms_list, only : external_forces
  use dd3_model_terms_released, only : hold_released
  use dd3_system_internal, only : update_material
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: balance_sheet, take_up

contains

  !> Turn the internal forces of the sheet at the start into fading forces, where the first phase
  !> prescribes no displacement. A stress that lies outside the yield surface returns to it.
  subroutine balance_sheet(model, system, state, note, error)
    type(model_t), intent(in) :: model
    type(system_t), intent(inout) :: system
    !> Initial state.
    type(state_t), intent(inout) :: state
    !> What the log tells of it.
    character(len=:), allocatable, intent(out) :: note
    !> Set if an element is inverted.
    type(error_t), allocatable, intent(out) :: error

    real(wp) :: force(3, model%n_node), size_of(model%n_node)
    integer :: node

    call set_internal_forces(model, system, state, error)
    if (allocated(error)) return
    force = merge(0.0_wp, -state%sheet%internal_force, model%phase(1)%prescribed)
    call hold_released(state%term, force, spread(-1, 1, model%n_node), turns=.false.)
    state%external_force = external_forces(state%term, model, state%configuration_t)
    size_of = norm2(force, dim=1)
    node = maxloc(size_of, dim=1)
    note = "the sheet that is taken over has forces out of balance of up to "// &
        to_text(size_of(node), 3)//" N, at node "//to_text(node)//", which fade over phase '"// &
        model%phase(1)%name//"'"
  end subroutine balance_sheet

  !> Take up the computation on a refined sheet: its internal forces, and how far they are out of
  !> balance.
  subroutine take_up(model, system, state, imbalance, error)
    type(model_t), intent(in) :: model
    type(system_t), intent(inout) :: system
    type(state_t), intent(inout) :: state
    !> Norm of the forces out of balance over that of the internal forces; 0 without these.
    real(wp), intent(out) :: imbalance
    !> Set if an element is inverted.
    type(error_t), allocatable, intent(out) :: error

    real(wp) :: force(3, model%n_node)

    imbalance = 0.0_wp
    call set_internal_forces(model, system, state, error)
    if (allocated(error)) return
    force = reactions(model, state)
    associate (internal => norm2(state%sheet%internal_force))
      if (internal > 0.0_wp) imbalance = norm2(pack(force, &
          .not. model%phase(state%phase)%prescribed))/internal
    end associate
  end subroutine take_up

  !> Set stresses that the materials allow, and the internal forces.
  subroutine set_internal_forces(model, system, state, error)
    type(model_t), intent(in) :: model
    type(system_t), intent(inout) :: system
    type(state_t), intent(inout) :: state
    !> Set if an element is inverted.
    type(error_t), allocatable, intent(out) :: error

    type(state_t) :: updated
    type(verdict_t) :: verdict

    updated = state
    call update_material(system, model, state, updated, .false., verdict)
    if (verdict%outcome /= verdict_converged) then
      call fatal_error(error, "element "//to_text(verdict%element)// &
          " of the sheet that is taken over is inverted or has no valid stress", "E211")
      return
    end if
    state%sheet%stress = updated%sheet%stress
    state%sheet%internal_variables = updated%sheet%internal_variables
    state%sheet%internal_force = updated%sheet%internal_force
  end subroutine set_internal_forces

end module dd3_process_taken_over
