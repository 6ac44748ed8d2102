! SPDX-License-Identifier: GPL-3.0-or-later
!> Order of magnitude of the time of a run, known before it begins: increments by the lengths of the
!> phases over their trial increments, iterations and time of an element as in the runs of the
!> input_files on a processor of 2020.
module dd3_report_expected_time
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : newline, to_text
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: time_report, expected_increments, rounded_time

  !> Increments over the trial increments of a motion: 1.6 to 2.5 in the cups, the hat and the rail;
  !> those of a phase without motion besides its trial increments.
  real(wp), parameter :: per_trial = 2.0_wp, besides = 3.0_wp
  !> The same factor in the mixed formulation, where the contact limits the increments.
  real(wp), parameter :: mixed_per_trial = 10.0_wp
  !> Iterations of an increment: 4 to 6.
  real(wp), parameter :: iterations = 5.0_wp
  !> Time of an element in an iteration, s, and of each of its integration points.
  real(wp), parameter :: of_element = 1.0e-4_wp, of_point = 5.0e-6_wp

contains

  !> Return the time as text for the user.
  function time_report(model, state, elements) result(text)
    type(model_t), intent(in) :: model
    !> Initial state, or that of a restart.
    type(state_t), intent(in) :: state
    !> Mean number in the run.
    real(wp), intent(in) :: elements
    character(len=:), allocatable :: text

    real(wp) :: increments, seconds
    integer :: i

    increments = sum([(expected_increments(model%phase(i)), i=state%phase, size(model%phase))])
    if (state%begun) increments = increments &
        - state%progress*expected_increments(model%phase(state%phase))
    seconds = increments*iterations*elements &
        *(of_element + of_point*real(model%element%n_point, wp))
    text = "time: about "//rounded_time(seconds)//" on one thread, as an order of magnitude: "// &
        to_text(max(1, nint(increments)))//" increments of "//to_text(nint(iterations))// &
        " iterations"//newline
  end function time_report

  !> Return the number of increments of a phase.
  pure real(wp) function expected_increments(phase)
    type(phase_t), intent(in) :: phase

    expected_increments = max(1.0_wp, 1.0_wp/max(phase%trial, tiny(1.0_wp)))
    if (phase%length > 0.0_wp) then
      expected_increments = merge(mixed_per_trial, per_trial, phase%mixed)*expected_increments
    else
      expected_increments = besides + expected_increments
    end if
  end function expected_increments

  !> Return a time with one digit in seconds, minutes or hours.
  pure function rounded_time(seconds) result(text)
    real(wp), intent(in) :: seconds
    character(len=:), allocatable :: text

    if (seconds < 60.0_wp) then
      text = to_text(one_digit(max(1.0_wp, seconds)))//" s"
    else if (seconds < 3600.0_wp) then
      text = to_text(one_digit(seconds/60.0_wp))//" min"
    else
      text = to_text(one_digit(min(seconds/3600.0_wp, 1.0e6_wp)))//" h"
    end if
  end function rounded_time

  !> Return a number from 1 on, rounded to one digit.
  pure integer function one_digit(value)
    real(wp), intent(in) :: value

    real(wp) :: unit

    unit = 10.0_wp**floor(log10(value))
    one_digit = nint(unit*anint(value/unit))
  end function one_digit

end module dd3_report_expected_time
