! SPDX-License-Identifier: GPL-3.0-or-later
!> Springs at the chosen supports of a sheet from which tools are withdrawn, which floats between
!> them. Rigid supports would take the forces of the forming at single nodes, as the tools do not
!> leave at the same rate: the springs are soft at first, and stiff when the tools have opened by
!> twice the thickness and only forces of bending are left, so that the sheet does not follow a tool
!> on which it hangs. They are as many as the free rigid motions and have no force in the end.
module dd3_model_terms_floating
  use dd3_base_kinds, only : wp
  use dd3_element_kinematics, only : point_volumes
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_partition, only : holds_row
  use dd3_model_configuration, only : configuration_t
  use dd3_model_model, only : model_t
  use dd3_model_terms_term, only : term_t
  implicit none
  private
  public :: floating_t, bending_stiffness, spring_stiffness, spring_force

  !> The term.
  type, extends(term_t) :: floating_t
  contains
    procedure :: add_force
    procedure :: add_stiffness
  end type floating_t

  !> Stiffness over that of the sheet in bending, G V t**2/L**4 with the volume V, the thickness t and
  !> the size L, at the start, and the decades by which it rises until the tools have opened by so
  !> many thicknesses.
  real(wp), parameter :: soft = 0.1_wp, decades = 5.0_wp, opened = 2.0_wp

contains

  !> Return the stiffness of the springs, N/mm.
  pure real(wp) function spring_stiffness(model, state)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state

    real(wp) :: distance

    distance = model%phase(state%phase)%most_opened(state%progress)
    spring_stiffness = soft*10.0_wp**(decades*min(1.0_wp, distance/(opened*model%thickness))) &
        *bending_stiffness(model)
  end function spring_stiffness

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

    real(wp) :: stiffness
    integer :: i

    associate (phase => model%phase(state%phase))
      if (.not. phase%floats) return
      stiffness = spring_stiffness(model, state)
      do i = 1, size(phase%support, 2)
        associate (node => phase%support(1, i), axis => phase%support(2, i))
          force(axis, node) = force(axis, node) + spring_force(stiffness, state, node, axis)
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

    real(wp) :: spring
    integer :: k, i

    associate (phase => model%phase(state%phase), value => stiffness%value)
      if (.not. phase%floats) return
      spring = spring_stiffness(model, state)
      do i = 1, size(phase%support, 2)
        associate (node => phase%support(1, i), axis => phase%support(2, i))
          if (.not. holds_row(stiffness, node)) cycle
          k = stiffness%diagonal(node)
          value(axis, axis, k) = value(axis, axis, k) + spring
        end associate
      end do
    end associate
  end subroutine add_stiffness

end module dd3_model_terms_floating
