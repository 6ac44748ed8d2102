! SPDX-License-Identifier: GPL-3.0-or-later
!> What acts on the sheet beside its contact with the tools and its supports: the list of the terms,
!> and the sums over it. A new term has its file and a line in `new_terms`.
module dd3_model_terms_list
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_terms_drawbeads, only : new_drawbeads
  use dd3_model_terms_floating, only : floating_t
  use dd3_model_terms_loads, only : new_loads
  use dd3_model_terms_pressures, only : new_pressures
  use dd3_model_terms_released, only : new_released
  use dd3_model_terms_term, only : term_box_t, term_t
  use dd3_model_terms_viscous, only : viscous_t
  implicit none
  private
  public :: new_terms, begin_increment, evaluate_terms, external_forces, final_forces
  public :: rate_of_forces, add_stiffness, dissipated_work, largest_force

contains

  !> Make the terms of a model, without forces.
  subroutine new_terms(terms, model)
    type(term_box_t), allocatable, intent(out) :: terms(:)
    type(model_t), intent(in) :: model

    allocate (terms(0))
    call append(terms, new_released(model))
    call append(terms, new_loads(model))
    call append(terms, new_pressures(model))
    call append(terms, new_drawbeads(model))
    call append(terms, floating_t())
    call append(terms, viscous_t())
  end subroutine new_terms

  !> Append a term to a list.
  subroutine append(terms, term)
    type(term_box_t), allocatable, intent(inout) :: terms(:)
    class(term_t), intent(in) :: term

    type(term_box_t) :: box

    allocate (box%of, source=term)
    terms = [terms, box]
  end subroutine append

  !> Set what is fixed in the next increment.
  subroutine begin_increment(terms, model, committed)
    type(term_box_t), intent(inout) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed

    integer :: k

    do k = 1, size(terms)
      call terms(k)%of%begin_increment(model, committed)
    end do
  end subroutine begin_increment

  !> Evaluate the terms in a trial state.
  subroutine evaluate_terms(terms, model, committed, trial)
    type(term_box_t), intent(inout) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial

    integer :: k

    do k = 1, size(terms)
      call terms(k)%of%evaluate(model, committed, trial)
    end do
  end subroutine evaluate_terms

  !> Return the sum of the forces on the nodes, `(3, n_node)`, N.
  function external_forces(terms, model, state) result(force)
    type(term_box_t), intent(in) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    integer :: k

    force = 0.0_wp
    do k = 1, size(terms)
      call terms(k)%of%add_force(model, state, force)
    end do
  end function external_forces

  !> Return the sum of the forces on the nodes that stay at the end of the running phase, `(3,
  !> n_node)`, N.
  function final_forces(terms, model, state) result(force)
    type(term_box_t), intent(in) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp) :: force(3, model%n_node)

    integer :: k

    force = 0.0_wp
    do k = 1, size(terms)
      call terms(k)%of%add_final_force(model, state, force)
    end do
  end function final_forces

  !> Return the change of the forces by a step of the progress, `(3, n_node)`, N.
  function rate_of_forces(terms, model, committed, step) result(force)
    type(term_box_t), intent(in) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
    real(wp), intent(in) :: step
    real(wp) :: force(3, model%n_node)

    integer :: k

    force = 0.0_wp
    do k = 1, size(terms)
      call terms(k)%of%add_rate(model, committed, step, force)
    end do
  end function rate_of_forces

  !> Add the stiffness of the terms to that of the sheet.
  subroutine add_stiffness(terms, model, state, stiffness)
    type(term_box_t), intent(in) :: terms(:)
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    integer :: k

    do k = 1, size(terms)
      call terms(k)%of%add_stiffness(model, state, stiffness)
    end do
  end subroutine add_stiffness

  !> Return the work that the terms have dissipated since the start of the job, mJ.
  pure real(wp) function dissipated_work(terms) result(work)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    work = 0.0_wp
    do k = 1, size(terms)
      work = work + terms(k)%of%dissipated()
    end do
  end function dissipated_work

  !> Return the size of the largest forces of a term in the running phase, N.
  pure real(wp) function largest_force(terms) result(force)
    type(term_box_t), intent(in) :: terms(:)

    integer :: k

    force = 0.0_wp
    do k = 1, size(terms)
      force = max(force, terms(k)%of%magnitude())
    end do
  end function largest_force

end module dd3_model_terms_list
