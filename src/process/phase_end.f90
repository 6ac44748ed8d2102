! SPDX-License-Identifier: GPL-3.0-or-later
!> End of a phase and its outputs of fields, as progress of the phase.
module dd3_process_phase_end
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_settings_output, only : fields_at, fields_every, output_spec_t
  use dd3_settings_until, only : until_displacement
  implicit none
  private
  public :: phase_is_over, next_output_progress, until_met, until_value, until_fraction, &
      until_tolerance, progress_tolerance

  !> Tolerance of the progress at the end of a phase and at outputs.
  real(wp), parameter :: progress_tolerance = 1.0e-9_wp
  !> Relative tolerances of an early end by displacement and by force.
  real(wp), parameter :: displacement_tolerance = 1.0e-6_wp, force_tolerance = 1.0e-3_wp

contains

  !> Whether the running phase of a state is at its end or its early end.
  logical function phase_is_over(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    associate (phase => model%phase(state%phase))
      phase_is_over = state%progress >= 1.0_wp - progress_tolerance
      if (phase%until%tool > 0) phase_is_over = phase_is_over .or. until_met(phase, state)
    end associate
  end function phase_is_over

  !> Whether the condition of the early end is satisfied.
  logical function until_met(phase, state)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state

    real(wp) :: tolerance, value

    tolerance = until_tolerance(phase)
    value = abs(until_value(phase, state))
    if (state%start%until_from_below) then
      until_met = value >= phase%until%value*(1.0_wp - tolerance)
    else
      until_met = value <= phase%until%value*(1.0_wp + tolerance)
    end if
  end function until_met

  !> Return the quantity that ends a phase early: the displacement of its tool along its line since
  !> the start of the phase, mm, or the force on it along that line, N.
  pure real(wp) function until_value(phase, state) result(value)
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state

    associate (tool => phase%until%tool)
      if (phase%until%kind == until_displacement) then
        value = dot_product(phase%direction(:, tool), &
            state%tools%displacement(:, tool) - state%start%tool_displacement(:, tool))
      else
        value = dot_product(phase%direction(:, tool), state%tools%force(:, tool))
      end if
    end associate
  end function until_value

  !> Return the relative tolerance of the value that ends a phase early.
  pure real(wp) function until_tolerance(phase)
    type(phase_t), intent(in) :: phase

    until_tolerance = force_tolerance
    if (phase%until%kind == until_displacement) until_tolerance = displacement_tolerance
  end function until_tolerance

  !> Return the fraction of an increment, by linear interpolation, after which a phase ends early,
  !> if the increment has gone beyond that end by more than the tolerance; 1 otherwise.
  pure real(wp) function until_fraction(phase, before, after) result(fraction)
    type(phase_t), intent(in) :: phase
    !> States at the start and at the end of the increment.
    type(state_t), intent(in) :: before, after

    real(wp) :: old, new, excess
    logical :: from_below

    fraction = 1.0_wp
    if (phase%until%tool == 0) return
    from_below = before%start%until_from_below
    old = until_value(phase, before)
    new = until_value(phase, after)
    if (merge(new, old, from_below) < 0.0_wp) then
      old = -old
      new = -new
    end if
    excess = merge(1.0_wp, -1.0_wp, from_below)*(new - phase%until%value)
    if (excess <= until_tolerance(phase)*phase%until%value) return
    fraction = (phase%until%value - old)/(new - old)
  end function until_fraction

  !> Return the progress at the next output of fields; a huge value if none is left in the phase.
  pure real(wp) function next_output_progress(output, phase, state) result(progress)
    type(output_spec_t), intent(in) :: output
    type(phase_t), intent(in) :: phase
    type(state_t), intent(in) :: state

    real(wp) :: travel
    integer :: i

    progress = huge(1.0_wp)
    if (phase%length <= 0.0_wp) return
    travel = phase%path(0.0_wp, state%progress)
    select case (output%fields)
    case (fields_every)
      associate (interval => output%fields_value(1))
        progress = phase%progress_after((aint(travel/interval + progress_tolerance) + 1)*interval)
      end associate
    case (fields_at)
      do i = 1, size(output%fields_value)
        if (output%fields_value(i) <= travel + progress_tolerance*phase%length) cycle
        progress = phase%progress_after(output%fields_value(i))
        exit
      end do
    case default
      ! None within the phase.
    end select
    if (progress > 1.0_wp) progress = huge(1.0_wp)
  end function next_output_progress

end module dd3_process_phase_end
