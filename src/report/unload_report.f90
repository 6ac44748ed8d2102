! SPDX-License-Identifier: GPL-3.0-or-later
!> Reports on the supports that the program chooses for an unloaded sheet: which they are, whether
!> the forces on the sheet are in equilibrium without them, and their reactions.
module dd3_report_unload_report
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_model_model, only : model_t
  use dd3_model_reactions, only : reactions
  use dd3_model_rigid_motion, only : new_rigid_motion, rigid_motion_t
  use dd3_model_rigid_supports, only : name_of_support
  use dd3_model_state, only : state_t
  use dd3_model_terms_floating, only : floating_supports, spring_force, &
      spring_stiffness
  use dd3_model_terms_list, only : external_forces, final_forces, largest_force
  implicit none
  private
  public :: imbalance_warning, add_reactions, unload_note

  !> Resultants below this fraction of the forces on the sheet, and reactions at the end below this
  !> fraction of the largest force that faded, are those that the tolerance of the corrector leaves.
  real(wp), parameter :: notable = 1.0e-2_wp, notable_reaction = 1.0e-3_wp
  !> Strain whose force on the square of the thickness is the smallest scale of the reactions.
  real(wp), parameter :: negligible_strain = 1.0e-3_wp

contains

  !> Return a note on the supports chosen for the running phase; empty without any.
  function unload_note(model, state) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    type(rigid_motion_t) :: body
    integer :: k

    text = ""
    associate (phase => model%phase(state%phase))
      if (size(phase%support, 2) == 0) return
      call new_body(body, model, state)
      do k = 1, size(phase%support, 2)
        text = text//", "//name_of_support(phase%support(:, k))
      end do
      text = "phase '"//phase%name//"': the sheet is free to "//body%free_motion()// &
          "; held there by "//text(3:)
    end associate
  end function unload_note

  !> Make the body of the sheet with its prescribed directions, but for the supports chosen.
  subroutine new_body(body, model, state)
    type(rigid_motion_t), intent(out) :: body
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    call new_rigid_motion(body, state%x)
    call body%hold_prescribed(state%x, model%phase(state%phase)%led())
  end subroutine new_body

  !> Return a warning if the forces on the sheet at the start of the running phase, or the loads
  !> that stay on it, are not in equilibrium in the motions that the chosen supports stop; empty
  !> otherwise.
  function imbalance_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the start of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: force(3, model%n_node), resultant

    text = ""
    associate (phase => model%phase(state%phase))
      if (size(phase%support, 2) == 0) return
      force = final_forces(state%term, model, state%configuration_t)
      resultant = free_resultant(model, state, force)
      if (resultant > notable*sum(norm2(force, dim=1))) then
        text = "the loads on the sheet are not in equilibrium in phase '"//phase%name// &
            "': the chosen supports carry "//to_text(resultant, 3)//" N of them"
        return
      end if
      if (any(phase%withdrawn)) return
      force = external_forces(state%term, model, state%configuration_t)
      resultant = free_resultant(model, state, force)
      if (resultant > notable*sum(norm2(force, dim=1))) text = &
          "the forces that fade in phase '"//phase%name// &
          "' are not in equilibrium: the chosen supports carry "//to_text(resultant, 3)// &
          " N of them at its start"
    end associate
  end function imbalance_warning

  !> Return the size of the resultant of nodal forces in the motions that the chosen supports stop,
  !> N; moments are divided by the size of the sheet.
  function free_resultant(model, state, force) result(resultant)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    real(wp) :: resultant

    type(rigid_motion_t) :: body
    real(wp) :: projector(6, 6), total(6)
    integer :: n

    call new_body(body, model, state)
    call body%free_projector(projector, n)
    total = 0.0_wp
    do n = 1, size(force, 2)
      total = total + body%condition(state%x(:, n), force(:, n))
    end do
    resultant = norm2(matmul(projector, total))
  end function free_resultant

  !> Add the largest reaction of the supports chosen for the running phase, as a warning if it is
  !> not small; no-op without chosen supports.
  subroutine add_reactions(model, state, notes)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    type(message_list_t), intent(inout) :: notes

    real(wp), allocatable :: reaction(:)
    integer, allocatable :: support(:, :)
    real(wp) :: all_reactions(3, model%n_node), stiffness(3), scale
    integer :: k

    associate (phase => model%phase(state%phase))
      if (size(phase%support, 2) == 0) return
      support = floating_supports(model, state)
      allocate (reaction(size(support, 2)))
      all_reactions = reactions(model, state)
      stiffness = spring_stiffness(model, state)
      do k = 1, size(support, 2)
        associate (node => support(1, k), axis => support(2, k))
          reaction(k) = all_reactions(axis, node)
          if (phase%floats) reaction(k) = &
              spring_force(stiffness(axis), state, node, axis)
        end associate
      end do
      k = maxloc(abs(reaction), dim=1)
      scale = max(negligible_strain*model%least_shear()*model%thickness**2, &
          largest_force(state%term))
      if (state%sheet%fades) scale = max(scale, &
          maxval(norm2(state%sheet%fading_force, dim=1)))
      call notes%add_new(merge("W107", "N103", abs(reaction(k)) > notable_reaction*scale), &
          "phase '"//phase%name//"': the largest reaction of the "// &
          "chosen supports is "//to_text(abs(reaction(k)), 3)//" N ("// &
          name_of_support(support(:, k))//")")
    end associate
  end subroutine add_reactions

end module dd3_report_unload_report
