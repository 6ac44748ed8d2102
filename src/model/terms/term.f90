! SPDX-License-Identifier: GPL-3.0-or-later
!> Term of the equilibrium: something that acts on the nodes of the sheet, with its part of the
!> state and all that it does to forces, stiffness, work and results. The state has a list of them
!> (list.f90), and the corrector knows the list alone. A procedure that a term does not need does
!> nothing.
!>
!> The sheet has r = F_int - F_ext + lambda = 0, F_ext being the sum over the terms.
module dd3_model_terms_term
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_state_visitor, only : state_visitor_t
  implicit none
  private
  public :: term_t, term_box_t, extended

  !> The term.
  type, abstract :: term_t
  contains
    procedure :: lose
    procedure :: begin_phase
    procedure :: begin_increment
    procedure :: add_rate
    procedure :: evaluate
    procedure(add_force_interface), deferred :: add_force
    procedure :: add_final_force
    procedure :: add_stiffness
    procedure :: add_tool_force
    procedure :: accept
    procedure :: dissipated
    procedure :: magnitude
    procedure :: columns
    procedure :: values
    procedure :: extend
    procedure :: walk
  end type term_t

  !> Element of a list of terms.
  type :: term_box_t
    class(term_t), allocatable :: of
  end type term_box_t

  abstract interface
    !> Add the forces on the nodes in a configuration.
    subroutine add_force_interface(self, model, state, force)
      import :: configuration_t, model_t, term_t, wp
      class(term_t), intent(in) :: self
      type(model_t), intent(in) :: model
      type(configuration_t), intent(in) :: state
      !> `(3, n_node)`, N.
      real(wp), intent(inout) :: force(:, :)
    end subroutine add_force_interface
  end interface

contains

  !> Give up the forces that do not act in a phase any more: they become forces of lost constraints,
  !> which fade over it.
  subroutine lose(self, model, number, state, force, lost)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Number of the phase.
    integer, intent(in) :: number
    !> At the end of the phase before.
    type(configuration_t), intent(in) :: state
    !> Forces of the nodes on lost constraints, `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)
    !> Set where something was given up.
    logical, intent(inout) :: lost
  end subroutine lose

  !> Set what the term starts a phase from.
  subroutine begin_phase(self, model, number, state)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: number
    !> At the end of the phase before.
    type(configuration_t), intent(in) :: state
  end subroutine begin_phase

  !> Set what is fixed in the next increment. The committed state has it before the prediction, and
  !> every trial state gets it.
  subroutine begin_increment(self, model, committed)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
  end subroutine begin_increment

  !> Add the change of the forces on the nodes by a step of the progress, at the positions of the
  !> committed state, for the prediction.
  subroutine add_rate(self, model, committed, step, force)
    class(term_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed
    !> Of the progress of the phase.
    real(wp), intent(in) :: step
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)
  end subroutine add_rate

  !> Evaluate what the forces and their stiffness are taken from, in a trial state.
  subroutine evaluate(self, model, committed, trial)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed, trial
  end subroutine evaluate

  !> Add the forces on the nodes that stay at the end of the running phase, at the present
  !> positions.
  subroutine add_final_force(self, model, state, force)
    class(term_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)
  end subroutine add_final_force

  !> Add the stiffness, the negative derivative of the forces in the positions of the nodes.
  subroutine add_stiffness(self, model, state, stiffness)
    class(term_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    !> Of several ranks each has the rows that it holds.
    type(block_matrix_t), intent(inout) :: stiffness
  end subroutine add_stiffness

  !> Add the forces of the sheet on the tools that belong to the term.
  subroutine add_tool_force(self, model, force)
    class(term_t), intent(in) :: self
    type(model_t), intent(in) :: model
    !> `(3, n_tool)`, N.
    real(wp), intent(inout) :: force(:, :)
  end subroutine add_tool_force

  !> Set the work of an increment that is accepted. It is part of the work of the external forces,
  !> from which a term takes what is that of tools, or dissipated.
  subroutine accept(self, model, old, new)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: old
    !> Has the work of external forces and tools.
    type(configuration_t), intent(inout) :: new
  end subroutine accept

  !> Return the work that the term has dissipated since the start of the job, mJ.
  pure real(wp) function dissipated(self)
    class(term_t), intent(in) :: self

    dissipated = 0.0_wp
  end function dissipated

  !> Return the size of the forces in the running phase, N.
  pure real(wp) function magnitude(self)
    class(term_t), intent(in) :: self

    magnitude = 0.0_wp
  end function magnitude

  !> Return the names and the units of the columns in history.csv, each after a comma.
  pure subroutine columns(self, model, names, units)
    class(term_t), intent(in) :: self
    type(model_t), intent(in) :: model
    character(len=:), allocatable, intent(inout) :: names, units
  end subroutine columns

  !> Append the values of these columns.
  pure subroutine values(self, row)
    class(term_t), intent(in) :: self
    real(wp), allocatable, intent(inout) :: row(:)
  end subroutine values

  !> Carry over what the term has for each node, or for parts of the mesh, to a refined sheet; new
  !> nodes have no forces if the term does not distribute them anew.
  subroutine extend(self, old_model, model, state)
    class(term_t), intent(inout) :: self
    type(model_t), intent(in) :: old_model
    !> On the refined sheet.
    type(model_t), intent(in) :: model
    !> On the refined sheet, but for its forces.
    type(configuration_t), intent(in) :: state
  end subroutine extend

  !> Return values of nodes with zeros for those that are new.
  pure function extended(values, n_node) result(all)
    !> `(3, n_old_node)`.
    real(wp), intent(in) :: values(:, :)
    integer, intent(in) :: n_node
    real(wp) :: all(3, n_node)

    all(:, :size(values, 2)) = values
    all(:, size(values, 2) + 1:) = 0.0_wp
  end function extended

  !> Pass every component that decides how the run continues to a visitor.
  subroutine walk(self, visitor)
    class(term_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor
  end subroutine walk

end module dd3_model_terms_term
