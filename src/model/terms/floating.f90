! SPDX-License-Identifier: GPL-3.0-or-later
!> Springs in place of the chosen supports of a sheet from which tools are withdrawn, which floats
!> between them. Rigid supports would take the forces of the forming at single nodes, as the tools
!> do not leave at the same rate: the springs are soft at first. Along the paths of the tools they
!> are stiff when these have opened by twice the thickness, so that the sheet does not follow a tool
!> on which it hangs. Across the paths they are stiff only when all tools have left: until then
!> these hold the sheet at another place than that of the start, and a stiff spring would pull at
!> one node against them. They are as many as the free rigid motions and have no force in the end.
module dd3_model_terms_floating
  use dd3_base_kinds, only : wp
  use dd3_element_kinematics, only : point_volumes
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : holds_row
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_rigid_supports, only : choose_supports
  use dd3_model_terms_term, only : term_t
  implicit none
  private
  public :: floating_t, bending_stiffness, floating_supports, spring_stiffness, spring_force

  !> The term.
  type, extends(term_t) :: floating_t
    private
    !> Node and axis of each spring in the running increment, `(2, n)`.
    integer, allocatable :: support(:, :)
  contains
    procedure :: begin_increment
    procedure :: add_force
    procedure :: add_stiffness
  end type floating_t

  !> Stiffness over that of the sheet in bending, G V t**2/L**4 with the volume V, the thickness t
  !> and the size L: at the start, and when the tools have opened by so many thicknesses, along and
  !> across their paths.
  real(wp), parameter :: soft = 0.1_wp, along = 1.0e4_wp, across = 100.0_wp, opened = 2.0_wp
  !> Cosine between a path and an axis from which the axis counts as along it.
  real(wp), parameter :: least_cosine = 0.2_wp
  !> Least factor on a nodal direction in the choice of the supports; 1 in the plane of the sheet.
  real(wp), parameter :: across_sheet = 0.05_wp

contains

  !> Choose the supports of the increment.
  subroutine begin_increment(self, model, committed)
    class(floating_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: committed

    self%support = floating_supports(model, committed)
  end subroutine begin_increment

  !> Return node and axis of each spring, `(2, n)`: the supports of the phase when all tools have
  !> left. Before, a spring takes the force that strips the sheet from a tool on which it hangs: it
  !> pulls in the plane of the sheet where it can, at a wall, as it would dent a bottom.
  function floating_supports(model, state) result(support)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    integer, allocatable :: support(:, :)

    real(wp) :: weight(3, model%n_node)
    integer :: n

    associate (phase => model%phase(state%phase), x => state%start%x)
      support = phase%support
      if (.not. phase%floats .or. state%open) return
      weight = 1.0_wp
      do n = 1, model%n_node
        if (model%fibre_end(n) == 0) cycle
        associate (fibre => x(:, model%fibre_end(n)) - x(:, n))
          weight(:, n) = max(across_sheet, sqrt(max(0.0_wp, 1.0_wp - fibre**2/sum(fibre**2))))
        end associate
      end do
      call choose_supports(x, phase%prescribed, support, model%bound_nodes(), weight)
    end associate
  end function floating_supports

  !> Return the stiffness of the springs along the axes, N/mm.
  pure function spring_stiffness(model, state) result(stiffness)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    real(wp) :: stiffness(3)

    real(wp) :: path

    associate (phase => model%phase(state%phase))
      path = phase%most_opened(state%progress)
      stiffness = merge(along, across, state%open .or. open_along(phase))
      stiffness = soft*(stiffness/soft)**min(1.0_wp, path/(opened*model%thickness)) &
          *bending_stiffness(model)
    end associate
  end function spring_stiffness

  !> Whether a tool is withdrawn along an axis, in which the sheet could hang on it, `(3)`.
  pure function open_along(phase) result(along_axis)
    type(phase_t), intent(in) :: phase
    logical :: along_axis(3)

    integer :: axis

    do axis = 1, 3
      along_axis(axis) = any(phase%withdrawn .and. abs(phase%move(axis, :)) &
          >= least_cosine*norm2(phase%move, dim=1))
    end do
  end function open_along

  !> Return the stiffness of the sheet in bending, N/mm.
  pure real(wp) function bending_stiffness(model)
    type(model_t), intent(in) :: model

    real(wp) :: x(3, model%n_node), volume(model%element%n_point), total
    integer :: e

    x = model%start_positions()
    total = 0.0_wp
    do e = 1, model%n_element
      call point_volumes(model%element, x(:, model%connectivity(:, e)), volume)
      total = total + sum(volume)
    end do
    bending_stiffness = model%least_shear()*total*model%thickness**2 &
        /maxval(maxval(x, dim=2) - minval(x, dim=2))**4
  end function bending_stiffness

  !> Return the force of a spring at a node along an axis, N.
  pure real(wp) function spring_force(stiffness, state, node, axis) result(force)
    !> N/mm.
    real(wp), intent(in) :: stiffness
    class(configuration_t), intent(in) :: state
    integer, intent(in) :: node, axis

    force = -stiffness*(state%x(axis, node) - state%start%x(axis, node))
  end function spring_force

  !> Add the forces on the nodes.
  subroutine add_force(self, model, state, force)
    class(floating_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    real(wp), intent(inout) :: force(:, :)

    real(wp) :: stiffness(3)
    integer :: i

    associate (phase => model%phase(state%phase))
      if (.not. (phase%floats .and. allocated(self%support))) return
      stiffness = spring_stiffness(model, state)
      do i = 1, size(self%support, 2)
        associate (node => self%support(1, i), axis => self%support(2, i))
          force(axis, node) = force(axis, node) + spring_force(stiffness(axis), state, node, axis)
        end associate
      end do
    end associate
  end subroutine add_force

  !> Add the stiffness of the springs.
  subroutine add_stiffness(self, model, state, stiffness)
    class(floating_t), intent(in) :: self
    type(model_t), intent(in) :: model
    type(configuration_t), intent(in) :: state
    type(block_matrix_t), intent(inout) :: stiffness

    real(wp) :: spring(3)
    integer :: k, i

    associate (phase => model%phase(state%phase), value => stiffness%value)
      if (.not. (phase%floats .and. allocated(self%support))) return
      spring = spring_stiffness(model, state)
      do i = 1, size(self%support, 2)
        associate (node => self%support(1, i), axis => self%support(2, i))
          if (.not. holds_row(stiffness, node)) cycle
          k = stiffness%diagonal(node)
          value(axis, axis, k) = value(axis, axis, k) + spring(axis)
        end associate
      end do
    end associate
  end subroutine add_stiffness

end module dd3_model_terms_floating
