! SPDX-License-Identifier: GPL-3.0-or-later
!> Verdict of a numerical step. Numerics neither stop nor print; they return one of these, with the
!> cause of a failure and its data. `dd3_base_cause_text` makes the text.
module dd3_base_verdict
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: verdict_t, verdict_converged, verdict_retry, verdict_impossible

  !> The step succeeded.
  integer, parameter :: verdict_converged = 0
  !> The step failed; a smaller one may succeed.
  integer, parameter :: verdict_retry = 1
  !> The step failed and no smaller one will help.
  integer, parameter :: verdict_impossible = 2

  !> Causes of a failure, with the component of a verdict that holds their data.
  enum, bind(c)
    enumerator :: cause_none = 0
    !> A Jacobian determinant of an element is not positive, or the assumed strain has none:
    !> `element`, `point`.
    enumerator :: cause_inverted
    enumerator :: cause_inverted_strain
    !> Stress update: input that is not finite; strain increment, `value(1)`.
    enumerator :: cause_not_finite
    enumerator :: cause_large_strain
    !> Return mapping: largest component of the strain increment, plastic strain, trial stress over
    !> flow stress in the last substep, and residual: `value(1:4)`.
    enumerator :: cause_return_mapping
    !> Target stress of a material point: strain beyond the bound `value(1)`; singular tangent;
    !> residual `value(1)`, MPa. The flow stress is `value(2)`, MPa.
    enumerator :: cause_strain_bound
    enumerator :: cause_singular_tangent
    enumerator :: cause_no_strain
    !> A deformation gradient whose determinant is not positive.
    enumerator :: cause_gradient
    !> Linear solver: singular matrix, not enough memory, any other failure; `detail` is the
    !> solver's own text.
    enumerator :: cause_singular
    enumerator :: cause_solver_memory
    enumerator :: cause_solver
    !> Factors that cannot be written to the disk.
    enumerator :: cause_factor_files
    !> A pressed tool without contact: `tool`.
    enumerator :: cause_lost_tool
    !> A node that its supports hold inside a tool: `node`.
    enumerator :: cause_led_inside
    !> Displacement of a node in an iteration, `value(1)`, mm: `node`.
    enumerator :: cause_large_step
    !> Contact status that did not settle: `changing` candidates.
    enumerator :: cause_unsettled
    !> Residual at a node, `value(1)`, N: `node`.
    enumerator :: cause_residual
    !> Residual of a pressed tool, `value(1)`, N: `tool`.
    enumerator :: cause_tool_force
    !> A factor r with which the phase would not end.
    enumerator :: cause_no_progress
    !> Beyond the early end of the phase.
    enumerator :: cause_beyond_until
    enumerator :: cause_interrupted
  end enum
  public :: cause_none, cause_inverted, cause_inverted_strain, cause_not_finite, &
      cause_large_strain, cause_return_mapping, cause_strain_bound, cause_singular_tangent, &
      cause_no_strain, cause_gradient, cause_singular, cause_solver_memory, cause_solver, &
      cause_factor_files, cause_lost_tool, cause_led_inside, cause_large_step, cause_unsettled, &
      cause_residual, cause_tool_force, cause_no_progress, cause_beyond_until, cause_interrupted

  !> Result of a numerical step; initially a failure.
  type :: verdict_t
    !> One of the `verdict_*` values.
    integer :: outcome = verdict_impossible
    !> One of the `cause_*` values; `cause_none` if converged.
    integer :: cause = cause_none
    integer :: iterations = 0
    !> Norm of the residual, in the unit of the step.
    real(wp) :: norm = huge(1.0_wp)
    !> Location of the largest error: node, element, integration point, tool; 0 if not applicable.
    integer :: node = 0, element = 0, point = 0, tool = 0
    !> Block row of the matrix of a linear solver; who calls the solver turns it into a node or a
    !> tool and sets it back to 0.
    integer :: row = 0
    !> Data of the cause.
    real(wp) :: value(4) = 0.0_wp
    !> Number of contact candidates whose status changed in the last iterations.
    integer :: changing = 0
    !> Text of a linear solver.
    character(len=160) :: detail = ""
  end type verdict_t

end module dd3_base_verdict
