! SPDX-License-Identifier: GPL-3.0-or-later
!> Formulation of the contact: how the force of a point follows from its gap and slip, and how the
!> equations of the forces enter the linear system. There are two, `compliant_contact` and
!> `mixed_contact`; nothing else asks which one a phase has.
module dd3_system_formulation
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : column_squares
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_contact_work, only : contact_work_t
  use dd3_system_linear_problem, only : linear_problem_t, unknowns_t
  use dd3_system_partition, only : partition_t
  implicit none
  private
  public :: formulation_t

  !> The formulation.
  type, abstract :: formulation_t
    !> Whether the corrector may solve for a part of the nodes alone, and whether it balances
    !> pressed tools by their motion.
    logical :: eliminates = .false., balances_tools = .false.
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure(predict_interface), deferred :: predict
    procedure(reduce_interface), deferred :: reduce
    procedure(read_interface), deferred :: read_forces
    procedure :: squares
  end type formulation_t

  abstract interface
    !> Evaluate status, force and linearisation of the points in a trial state.
    subroutine evaluate_interface(self, contact, model, committed, trial, points)
      import :: contact_work_t, formulation_t, model_t, state_t
      class(formulation_t), intent(in) :: self
      type(contact_work_t), intent(inout) :: contact
      type(model_t), intent(in) :: model
      !> Origin of the slip.
      type(state_t), intent(in) :: committed
      !> Gets status, tool and closest points.
      type(state_t), intent(inout) :: trial
      !> Numbers of the points.
      integer, intent(in) :: points(:)
    end subroutine evaluate_interface

    !> Evaluate the contact of the predictor: the committed state with its stored status.
    subroutine predict_interface(self, contact, model, committed, touching)
      import :: contact_work_t, formulation_t, model_t, state_t
      class(formulation_t), intent(in) :: self
      type(contact_work_t), intent(inout) :: contact
      type(model_t), intent(in) :: model
      type(state_t), intent(in) :: committed
      !> Whether any point, of any rank, is in contact with each tool.
      logical, intent(in) :: touching(:)
    end subroutine predict_interface

    !> Add the contact to the linear system, the forces of the points eliminated.
    subroutine reduce_interface(self, matrix, problem, contact, partition, position, model, state)
      import :: block_matrix_t, contact_work_t, formulation_t, linear_problem_t, model_t, &
          partition_t, state_t
      class(formulation_t), intent(inout) :: self
      !> Stiffness of the sheet and the terms; with the rows of other ranks completed on return.
      type(block_matrix_t), intent(inout) :: matrix
      !> Gets the right-hand side.
      type(linear_problem_t), intent(inout) :: problem
      type(contact_work_t), intent(in) :: contact
      type(partition_t), intent(in) :: partition
      !> Of the blocks of the elements in the matrix.
      integer, intent(in) :: position(:, :, :)
      type(model_t), intent(in) :: model
      !> Of the linearisation.
      type(state_t), intent(in) :: state
    end subroutine reduce_interface

    !> Set the increments of the forces of the points from the displacements.
    subroutine read_interface(self, contact, problem, model, state, step)
      import :: contact_work_t, formulation_t, linear_problem_t, model_t, state_t, unknowns_t
      class(formulation_t), intent(in) :: self
      type(contact_work_t), intent(in) :: contact
      type(linear_problem_t), intent(in) :: problem
      type(model_t), intent(in) :: model
      !> State of the linearisation.
      type(state_t), intent(in) :: state
      !> Has the displacements.
      type(unknowns_t), intent(inout) :: step
    end subroutine read_interface
  end interface

contains

  !> Return the sums of the squares in the columns of the stiffness from which forces on the nodes
  !> follow, over the rows of this rank, `(3, n_node)`, (N/mm)2.
  function squares(self, matrix, n_node) result(square)
    class(formulation_t), intent(in) :: self
    !> Reduced.
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: n_node
    real(wp), allocatable :: square(:, :)

    square = column_squares(matrix, n_node)
  end function squares

end module dd3_system_formulation
