! SPDX-License-Identifier: GPL-3.0-or-later
!> What a phase prescribes at nodes: displacements, motions and supports. These are mesh data, by
!> node.
module dd3_model_nodal_conditions
  use dd3_base_kinds, only : wp
  use dd3_model_motions, only : motion_t
  use dd3_model_tolerances, only : tangential
  implicit none
  private
  public :: nodal_conditions_t, is_normal_held, is_slip_prescribed

  !> Conditions at nodes in a phase.
  type :: nodal_conditions_t
    !> Degrees of freedom with prescribed displacement, supports included, `(3, n_node)`.
    logical, allocatable :: prescribed(:, :)
    !> Supports chosen against free rigid motions of an unloaded sheet, in columns of node and axis,
    !> `(2, n)`. They are prescribed too, or springs while tools are withdrawn, between which the
    !> sheet floats.
    integer, allocatable :: support(:, :)
    logical :: floats = .false.
    !> Prescribed displacement over the phase, `(3, n_node)`, mm.
    real(wp), allocatable :: displacement(:, :)
    !> Directions that an earlier phase displaced and this one holds, as text: `x of 'tip', ...`.
    character(len=:), allocatable :: kept_displacements
    !> Rotations and bends of node sets.
    type(motion_t), allocatable :: motion(:)
  contains
    procedure :: held
    procedure :: led
  end type nodal_conditions_t

contains

  !> Whether the prescribed displacements of a node hold it along a normal.
  pure logical function is_normal_held(phase, node, normal)
    class(nodal_conditions_t), intent(in) :: phase
    integer, intent(in) :: node
    real(wp), intent(in) :: normal(3)

    is_normal_held = norm2(merge(0.0_wp, normal, phase%prescribed(:, node))) <= tangential
  end function is_normal_held

  !> Whether the prescribed displacements of a node make it slip over a tool. A smaller slip is
  !> round-off of positions and turns.
  pure logical function is_slip_prescribed(phase, node, normal, slip)
    class(nodal_conditions_t), intent(in) :: phase
    integer, intent(in) :: node
    !> Of the tool, and displacement of the node relative to it, mm.
    real(wp), intent(in) :: normal(3), slip(3)

    real(wp), parameter :: least_slip = 1.0e-9_wp
    real(wp) :: prescribed(3)

    prescribed = merge(slip, 0.0_wp, phase%prescribed(:, node))
    is_slip_prescribed = norm2(prescribed - dot_product(normal, prescribed)*normal) > least_slip
  end function is_slip_prescribed

  !> Return the directions that prescribed displacements and chosen supports hold, `(3, n_node)`.
  pure function held(self)
    class(nodal_conditions_t), intent(in) :: self
    logical, allocatable :: held(:, :)

    integer :: k

    held = self%prescribed
    do k = 1, size(self%support, 2)
      held(self%support(2, k), self%support(1, k)) = .true.
    end do
  end function held

  !> Return the directions that prescribed displacements hold without the chosen supports,
  !> `(3, n_node)`.
  pure function led(self)
    class(nodal_conditions_t), intent(in) :: self
    logical, allocatable :: led(:, :)

    integer :: k

    led = self%prescribed
    do k = 1, size(self%support, 2)
      led(self%support(2, k), self%support(1, k)) = .false.
    end do
  end function led

end module dd3_model_nodal_conditions
