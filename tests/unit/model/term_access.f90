! SPDX-License-Identifier: GPL-3.0-or-later
!> The terms of a state by their types.
module term_access
  use dd3_model_state, only : state_t
  use dd3_model_terms_drawbeads, only : drawbeads_t
  use dd3_model_terms_loads, only : loads_t
  use dd3_model_terms_pressures, only : pressures_t
  use dd3_model_terms_released, only : released_t
  use dd3_model_terms_viscous, only : viscous_t
  implicit none
  private
  public :: drawbeads_of, loads_of, pressures_of, released_of, viscous_of

contains

  !> Return the draw-beads.
  function drawbeads_of(state) result(term)
    type(state_t), target, intent(in) :: state
    type(drawbeads_t), pointer :: term

    integer :: k

    term => null()
    do k = 1, size(state%term)
      select type (found => state%term(k)%of)
      type is (drawbeads_t)
        term => found
      end select
    end do
  end function drawbeads_of

  !> Return the loads.
  function loads_of(state) result(term)
    type(state_t), target, intent(in) :: state
    type(loads_t), pointer :: term

    integer :: k

    term => null()
    do k = 1, size(state%term)
      select type (found => state%term(k)%of)
      type is (loads_t)
        term => found
      end select
    end do
  end function loads_of

  !> Return the pressures.
  function pressures_of(state) result(term)
    type(state_t), target, intent(in) :: state
    type(pressures_t), pointer :: term

    integer :: k

    term => null()
    do k = 1, size(state%term)
      select type (found => state%term(k)%of)
      type is (pressures_t)
        term => found
      end select
    end do
  end function pressures_of

  !> Return the forces of lost constraints.
  function released_of(state) result(term)
    type(state_t), target, intent(in) :: state
    type(released_t), pointer :: term

    integer :: k

    term => null()
    do k = 1, size(state%term)
      select type (found => state%term(k)%of)
      type is (released_t)
        term => found
      end select
    end do
  end function released_of

  !> Return the viscous forces.
  function viscous_of(state) result(term)
    type(state_t), target, intent(in) :: state
    type(viscous_t), pointer :: term

    integer :: k

    term => null()
    do k = 1, size(state%term)
      select type (found => state%term(k)%of)
      type is (viscous_t)
        term => found
      end select
    end do
  end function viscous_of

end module term_access
