! SPDX-License-Identifier: GPL-3.0-or-later
!> Linear problem of an iteration or a prediction, and the step of the unknowns that solves it.
module dd3_system_linear_problem
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: linear_problem_t, new_linear_problem, unknowns_t

  !> Unknowns of the increment, or a step of them.
  type :: unknowns_t
    !> Positions of the nodes, `(3, n_node)`, or displacements, mm.
    real(wp), allocatable :: x(:, :)
    !> Parameters of the enhanced strains, `(n_enhanced, n_element)`.
    real(wp), allocatable :: enhanced(:, :)
    !> Contact forces, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda(:, :)
    !> Displacements of the tools, `(3, n_tool)`, mm, and the rotation vectors of those that tilt,
    !> rad.
    real(wp), allocatable :: tool(:, :), tilt(:, :)
  contains
    procedure :: scaled
  end type unknowns_t

  !> Unknowns, right-hand sides and prescribed values of one linear problem.
  type :: linear_problem_t
    !> Whether a node keeps its place, as those outside a region, `(n_node)`. The linear system is
    !> solved without it.
    logical, allocatable :: held(:)
    !> Contact points that are evaluated, and whose forces are unknown, in ascending order.
    integer, allocatable :: point(:)
    !> Residual r_A of the equilibrium of the nodes, contact forces included, `(3, n_node)`, N, and
    !> that with the forces F_equ of the contact law; of several ranks each has those of its nodes.
    real(wp), allocatable :: residual(:, :), law_residual(:, :)
    !> Forces on the bound nodes that their parents carry, contact forces included, `(3, n_bound)`,
    !> N.
    real(wp), allocatable :: bound_force(:, :)
    !> Residual F_equ - lambda of the contact law at the candidates, `(3, n_contact)`, N.
    real(wp), allocatable :: contact_residual(:, :)
    !> Prescribed displacement increments of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: prescribed(:, :)
    !> Positions that the nodes with prescribed displacements have to reach, `(3, n_node)`, mm, and
    !> whether the prediction may not reach them.
    real(wp), allocatable :: target(:, :)
    logical :: missed = .false.
    !> Prescribed displacement increments of the tools that are not pressed or have no contact,
    !> `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_prescribed(:, :)
    !> Residual of the balance of the pressed tools, `(3, n_tool)`: along their lines, N, and of
    !> those that tilt about its axes, N.mm.
    real(wp), allocatable :: tool_residual(:, :)
    !> Stiffness of the supports of the pressed tools against their unknowns, `(3, 3, n_tool)`, and
    !> whether they lie on spacers, `(n_tool)`.
    real(wp), allocatable :: tool_stiffness(:, :, :)
    logical, allocatable :: supported(:)
    !> Right-hand side of the reduced system, `(3*n_row)`; of several ranks each has its rows.
    real(wp), allocatable :: rhs(:)
    !> Solution: displacements of the nodes, then the unknowns of the tools that can be
    !> pressed, `(3*n_row)`.
    real(wp), allocatable :: solution(:)
  end type linear_problem_t

contains

  !> Return a fraction of a step.
  pure type(unknowns_t) function scaled(self, fraction)
    class(unknowns_t), intent(in) :: self
    real(wp), intent(in) :: fraction

    scaled = unknowns_t(fraction*self%x, fraction*self%enhanced, fraction*self%lambda, &
        fraction*self%tool, fraction*self%tilt)
  end function scaled

  !> Allocate a linear problem, in which nothing is held, and set it to zero.
  subroutine new_linear_problem(self, model, n_row)
    type(linear_problem_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> Number of block rows of the reduced system.
    integer, intent(in) :: n_row

    integer :: c

    self%point = [(c, c=1, model%n_contact)]
    allocate (self%held(model%n_node), source=.false.)
    allocate (self%residual(3, model%n_node), self%prescribed(3, model%n_node), source=0.0_wp)
    allocate (self%target(3, model%n_node), self%law_residual(3, model%n_node), source=0.0_wp)
    allocate (self%contact_residual(3, model%n_contact), source=0.0_wp)
    allocate (self%bound_force(3, model%n_bound), source=0.0_wp)
    allocate (self%tool_prescribed(3, model%n_tool), self%tool_residual(3, model%n_tool), &
        source=0.0_wp)
    allocate (self%tool_stiffness(3, 3, model%n_tool), source=0.0_wp)
    allocate (self%supported(model%n_tool), source=.false.)
    allocate (self%rhs(3*n_row), self%solution(3*n_row), source=0.0_wp)
  end subroutine new_linear_problem

end module dd3_system_linear_problem
