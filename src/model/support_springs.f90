! SPDX-License-Identifier: GPL-3.0-or-later
!> Springs at the chosen supports of a sheet from which tools are withdrawn. Rigid supports would take
!> the forces of the forming at single nodes, as the tools do not leave at the same rate: they are
!> soft at first, so that the sheet floats between the tools, and stiff when these have opened by
!> twice the thickness and only forces of bending are left, so that the sheet does not follow a tool
!> on which it hangs. They are as many as the free rigid motions and have no force in the end.
module dd3_model_support_springs
  use dd3_base_kinds, only : wp
  use dd3_element_kinematics, only : point_volumes
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: add_support_springs, bending_stiffness, support_stiffness

  !> Stiffness over that of the sheet in bending, G V t**2/L**4 with the volume V, the thickness t and
  !> the size L, at the start, and the decades by which it rises until the tools have opened by so
  !> many thicknesses.
  real(wp), parameter :: soft = 0.1_wp, decades = 5.0_wp, opened = 2.0_wp

contains

  !> Return the stiffness of the springs, N/mm.
  pure real(wp) function support_stiffness(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: distance

    distance = model%phase(state%phase)%most_opened(state%progress)
    support_stiffness = soft*10.0_wp**(decades*min(1.0_wp, distance/(opened*model%thickness))) &
        *bending_stiffness(model)
  end function support_stiffness

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

  !> Add the forces of the springs to those on the nodes; no-op for a sheet that does not float.
  pure subroutine add_support_springs(model, state, force)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)

    real(wp) :: stiffness
    integer :: i

    associate (phase => model%phase(state%phase))
      if (.not. phase%floats) return
      stiffness = support_stiffness(model, state)
      do i = 1, size(phase%support, 2)
        associate (node => phase%support(1, i), axis => phase%support(2, i))
          force(axis, node) = force(axis, node) &
              - stiffness*(state%x(axis, node) - state%start%x(axis, node))
        end associate
      end do
    end associate
  end subroutine add_support_springs

end module dd3_model_support_springs
