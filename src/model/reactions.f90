! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of a state that are not in balance at its nodes: what supports carry.
module dd3_model_reactions
  use dd3_base_kinds, only : wp
  use dd3_model_bound_nodes, only : give_to_parents
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: reactions, unbalanced_forces, size_of_internal_forces

contains

  !> Return the reactions of supports, `(3, n_node)`, N; zero at free nodes in equilibrium.
  function reactions(model, state) result(force)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    force = unbalanced_forces(model, state)
    call give_to_parents(model, state%x, force)
  end function reactions

  !> Return the internal forces less those of loads and tools, `(3, n_node)`, N.
  function unbalanced_forces(model, state) result(force)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    force = state%sheet%internal_force - state%external_force
    force = force + model%nodal_contact_forces(state%x, state%contact%lambda, state%contact%place)
  end function unbalanced_forces

  !> Return the norm of the nodal forces of the stresses, or of what is left of fading ones if that
  !> is larger, N.
  real(wp) function size_of_internal_forces(model, state) result(scale)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state

    scale = norm2(state%sheet%internal_force)
    if (state%sheet%fades) scale = max(scale, &
        model%phase(state%phase)%fading(state%progress)*norm2(state%sheet%fading_force))
  end function size_of_internal_forces

end module dd3_model_reactions
