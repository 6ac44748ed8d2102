! SPDX-License-Identifier: GPL-3.0-or-later
!> Region of the sheet: the system of a few free nodes, with their elements and contact points. All
!> other nodes and the tools are held: their block rows are not solved. It has its own matrix,
!> linear problem and solver; tangents, workspaces, enhanced strains and contact are those of the
!> sheet, lent while it is in use.
!>
!> Of several ranks each evaluates its elements and points; matrix and forces are summed, and all
!> get the solution of one.
module dd3_system_region
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : this_rank
  use dd3_linalg_auto_solver, only : make_auto_solver
  use dd3_linalg_solver, only : solver_options_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_linear_problem, only : new_linear_problem
  use dd3_system_system, only : new_stiffness_pattern, set_elements, system_t
  implicit none
  private
  public :: new_region, lend

contains

  !> Make the system of a region. Its solver is `auto` whatever the run has: it solves on each rank
  !> alone.
  subroutine new_region(self, model, state, chosen)
    !> What the sheet lends is missing.
    type(system_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> The free nodes, `(n_node)`.
    logical, intent(in) :: chosen(:)

    integer, allocatable :: elements(:)
    integer :: e, i

    elements = pack([(e, e=1, model%n_element)], &
        [(any(chosen(model%connectivity(:, e))), e=1, model%n_element)])
    call new_stiffness_pattern(self%matrix, model, elements)
    call make_auto_solver(self%solver, solver_options_t(method="auto", ilu_level=0, &
        tolerance=1.0e-10_wp, iterations=20, ordering="none"))
    call self%solver%setup(self%matrix, rows=pack([(i, i=1, model%n_node)], chosen))
    associate (place => model%part%place(elements))
      call set_elements(self, model, pack(place, place > 0))
    end associate
    call new_linear_problem(self%problem, model, self%matrix%n)
    associate (problem => self%problem)
      problem%held = .not. chosen
      problem%point = pack(problem%point, acts_on(model, chosen))
      problem%target = state%x
    end associate
    self%partition%gathers = .true.
    self%matrix%owner = rows_added(model, chosen, self%matrix%n)
  end subroutine new_region

  !> Return whether the forces of the contact points act on chosen nodes.
  pure function acts_on(model, chosen) result(acts)
    type(model_t), intent(in) :: model
    logical, intent(in) :: chosen(:)
    logical :: acts(model%n_contact)

    integer :: c

    do c = 1, model%n_contact
      associate (point => model%contact_point(c))
        acts(c) = any(chosen(point%node(:point%n_node)))
      end associate
    end do
  end function acts_on

  !> Return the rank that adds the stiffness of the terms to each block row; -1 for those that are
  !> held, whose blocks may be missing.
  function rows_added(model, chosen, n_row) result(owner)
    type(model_t), intent(in) :: model
    logical, intent(in) :: chosen(:)
    integer, intent(in) :: n_row
    integer :: owner(n_row)

    owner = -1
    if (model%part%divided) then
      owner(:model%n_node) = merge(model%part%node_owner, -1, chosen)
    else
      owner(:model%n_node) = merge(this_rank(), -1, chosen)
    end if
  end function rows_added

  !> Hand on what the systems of sheet and region share.
  subroutine lend(from, to)
    type(system_t), intent(inout) :: from, to

    call move_alloc(from%tangent, to%tangent)
    call move_alloc(from%element, to%element)
    call move_alloc(from%enhanced, to%enhanced)
    call move_alloc(from%contact, to%contact)
    call move_alloc(from%formulation, to%formulation)
  end subroutine lend

end module dd3_system_region
