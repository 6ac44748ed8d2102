! SPDX-License-Identifier: GPL-3.0-or-later
!> Fixture of the tests with contact points between the nodes: a strip bent around a cylinder.
module bent_strip
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : identity, inverse
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state, state_t
  use dd3_system_contact, only : evaluate_contact, predictor_contact
  use dd3_system_internal, only : update_material
  use dd3_system_system, only : system_t
  use system_cases, only : load_model, load_system, random_values
  implicit none
  private
  public :: bend_strip, settle_contact, draw, punch, table, thickness

  character(len=*), parameter :: deck = "tests/unit/system/points.dat"
  integer, parameter :: draw = 2, punch = 1, table = 2
  !> Radius of the punch, height of its axis and thickness of the strip, mm.
  real(wp), parameter :: radius = 5.0_wp, axis = 5.5_wp, thickness = 0.5_wp

contains

  !> The strip bent around the punch in some steps, and moved at random in the last one. The contact
  !> forces follow from the law.
  subroutine bend_strip(model, system, committed, trial, setting)
    type(model_t), intent(out) :: model
    type(system_t), intent(out) :: system
    type(state_t), intent(out) :: committed, trial
    !> Another value of a parameter of the deck.
    character(len=*), intent(in), optional :: setting

    type(verdict_t) :: verdict
    real(wp), allocatable :: noise(:, :)
    integer :: k, seed

    call load_model(model, deck, setting)
    model%phase%layer = 0.2_wp
    call load_system(system, model)
    call new_state(committed, model)
    call new_state(trial, model)
    committed%phase = draw
    trial%phase = draw
    committed%tools%displacement(3, table) = -0.06_wp
    trial%tools%displacement(3, table) = -0.06_wp
    do k = 1, 8
      trial%x = bent(model, 0.125_wp*k)
      call update_material(system, model, committed, trial, .false., verdict)
      if (verdict%outcome /= verdict_converged) error stop "the strip cannot be bent"
      committed = trial
    end do
    call predictor_contact(system, model, committed)
    call settle_contact(model, system, committed, trial)
    committed = trial
    call predictor_contact(system, model, committed)
    allocate (noise(3, model%n_node))
    seed = 7
    call random_values(seed, noise)
    trial%x = committed%x + 0.008_wp*noise
    trial%tools%displacement(3, punch) = trial%tools%displacement(3, punch) - 0.001_wp
    trial%tools%load(:, punch) = [0.0_wp, 0.0_wp, -40.0_wp]
    call update_material(system, model, committed, trial, .true., verdict)
    if (verdict%outcome /= verdict_converged) error stop "the strip cannot be moved"
    call settle_contact(model, system, committed, trial)
  end subroutine bend_strip

  !> Return the strip bent around the punch by a fraction, with a gap that grows along it.
  function bent(model, fraction) result(x)
    type(model_t), intent(in) :: model
    real(wp), intent(in) :: fraction
    real(wp) :: x(3, model%n_node)

    real(wp) :: from_axis(model%n_node), angle(model%n_node)

    associate (x0 => model%x0)
      from_axis = radius + thickness - x0(3, :) + 0.02_wp + 0.02_wp*x0(1, :) + 0.004_wp*x0(2, :)
      angle = x0(1, :)/(radius + 0.5_wp*thickness)
      x(1, :) = x0(1, :) + fraction*(from_axis*sin(angle) - x0(1, :))
      x(2, :) = x0(2, :)
      x(3, :) = x0(3, :) + fraction*(axis - from_axis*cos(angle) - x0(3, :))
    end associate
  end function bent

  !> Solve for the contact forces of a state.
  subroutine settle_contact(model, system, committed, state)
    type(model_t), intent(in) :: model
    type(system_t), intent(inout) :: system
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: state

    real(wp) :: weight(3, 3)
    integer :: c, k
    logical :: regular

    do k = 1, 40
      call evaluate_contact(system, model, committed, state)
      do c = 1, model%n_contact
        associate (contact => system%contact)
          if (contact%status(c) == status_gap) then
            state%contact%lambda(:, c) = 0.0_wp
          else
            call inverse(identity - contact%e(:, :, c), weight, regular)
            state%contact%lambda(:, c) = state%contact%lambda(:, c) &
                + matmul(weight, contact%force(:, c) - state%contact%lambda(:, c))
          end if
        end associate
      end do
    end do
    call evaluate_contact(system, model, committed, state)
  end subroutine settle_contact

end module bent_strip
