! SPDX-License-Identifier: GPL-3.0-or-later
!> Control of the steps: the attempts at an increment, from the first r to the last cut-back, and
!> the bound that an accepted increment sets for the next one.
module dd3_process_step_control
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_model_state, only : state_t
  use dd3_model_terms_viscous, only : goes_on, stronger
  use dd3_process_newton, only : newton_course_t
  use dd3_process_norm, only : residual_t
  use dd3_process_open_edges, only : passage_t
  use dd3_process_predictor, only : prediction_t
  use dd3_system_solve, only : solve_info_t
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: attempt_t, limit_t, stepper_t, cut_back, return_to_until, set_next_r_cap, makes_progress

  !> Upper bound of the factor r and its origin; numbers that do not apply are 0.
  type :: limit_t
    real(wp) :: r = huge(1.0_wp)
    !> Name of the limiter in the records.
    character(len=16) :: limiter = ""
    integer :: element = 0, point = 0, node = 0, tool = 0
    !> Size B of the contact force, eq. (16), of the limiter of contact forces, N.
    real(wp) :: force_size = 0.0_wp
  end type limit_t

  !> Limit, course and outcome of an attempt at an increment.
  type :: attempt_t
    !> Number of the attempt at this increment, from 1, and whether the one before failed.
    integer :: number = 1
    logical :: after_failure = .false.
    !> Whether the phase releases the sheet, with steps from a contact layer to a size of the sheet.
    logical :: releases = .false.
    !> Strength of the viscous forces of a release, and its range, N/mm.
    real(wp) :: viscosity = 0.0_wp, viscous_range(2) = 0.0_wp
    !> Whether the phase ends with the increment.
    logical :: ends_phase = .false.
    !> Factor r with its limiter.
    type(limit_t) :: limit = limit_t()
    !> Bound by the limiter of contact forces alone; its r is huge if it sets none.
    type(limit_t) :: force_limit = limit_t()
    !> Course of the corrector, and the residual in its last iteration.
    type(newton_course_t) :: course = newton_course_t()
    type(residual_t) :: residual = residual_t()
    type(solve_info_t) :: solver = solve_info_t()
    type(verdict_t) :: verdict = verdict_t()
    !> Whether a tool touched the node of the verdict in the last iterations.
    logical :: touched = .false.
    !> Where the prediction of a failed attempt leads a point in contact over an open edge.
    type(passage_t) :: passage = passage_t()
  end type attempt_t

  !> Work data of the increments; nothing in them changes the result of the next one.
  type :: stepper_t
    type(system_t) :: system
    type(prediction_t) :: prediction
    type(attempt_t) :: attempt
  end type stepper_t

  !> Factor on r after a failed attempt, and the smallest r of another one.
  real(wp), parameter :: cutback_factor = 0.5_wp, cutback_min = 1.0e-5_wp
  !> The latter in a release.
  real(wp), parameter :: release_min = 1.0e-8_wp
  !> Factor on the bound after an accepted increment.
  real(wp), parameter :: growth = 1.5_wp
  !> The former in a release, whose increments fail at a snap, not for their size.
  real(wp), parameter :: release_growth = 4.0_wp
  !> Failures of an increment of a release up to which stronger viscous forces keep r.
  integer, parameter :: most_stronger = 8
  !> Largest number of attempts up to which one beyond the early end of the phase is repeated.
  integer, parameter :: most_returns = 10
  !> Smallest increment of the progress of a phase.
  real(wp), parameter :: least_progress = 1.0e-12_wp

contains

  !> Reduce r for another attempt after one that failed. In a release the viscous forces get
  !> stronger, and those that would go on in the next increment keep r, unless the phase would end
  !> with them.
  pure subroutine cut_back(attempt, again)
    type(attempt_t), intent(inout) :: attempt
    !> False if r would fall below its minimum.
    logical, intent(out) :: again

    real(wp) :: factor

    factor = cutback_factor
    if (attempt%releases) then
      if (goes_on(attempt%viscosity, attempt%viscous_range) .and. .not. attempt%ends_phase &
          .and. attempt%number <= most_stronger) factor = 1.0_wp
      attempt%viscosity = stronger(attempt%viscosity, attempt%viscous_range)
    end if
    again = attempt%limit%r*factor >= merge(release_min, cutback_min, attempt%releases)
    if (.not. again) return
    call try_again(attempt, factor, merge("cutback", "viscous", factor < 1.0_wp))
    attempt%after_failure = .true.
  end subroutine cut_back

  !> Reduce r for another attempt if a converged one has gone beyond the early end of the phase: the
  !> prediction extrapolates linearly, and knows nothing of nodes that meet a tool.
  pure subroutine return_to_until(attempt, fraction, again)
    type(attempt_t), intent(inout) :: attempt
    !> Of the increment, at which the phase ends.
    real(wp), intent(in) :: fraction
    logical, intent(out) :: again

    again = fraction < 1.0_wp .and. fraction > 0.0_wp .and. attempt%number < most_returns
    if (.not. again) return
    call try_again(attempt, fraction, "until")
    attempt%after_failure = .false.
  end subroutine return_to_until

  !> Make the next attempt, with a factor on r.
  pure subroutine try_again(attempt, factor, limiter)
    type(attempt_t), intent(inout) :: attempt
    real(wp), intent(in) :: factor
    character(len=*), intent(in) :: limiter

    attempt%limit%r = factor*attempt%limit%r
    attempt%limit%limiter = limiter
    attempt%solver = solve_info_t()
    attempt%number = attempt%number + 1
  end subroutine try_again

  !> Set the bound of r after an accepted increment: a cut-back sets it to its r, raised at once but
  !> in a release, where it rises faster; every other increment raises it. A failed increment leaves
  !> none, so that a restart repeats its attempts.
  pure subroutine set_next_r_cap(state, attempt)
    !> With the bound of the increment.
    type(state_t), intent(inout) :: state
    !> Accepted.
    type(attempt_t), intent(in) :: attempt

    if (attempt%after_failure) state%r_cap = attempt%limit%r
    if (attempt%after_failure .and. attempt%releases) return
    if (state%r_cap < huge(1.0_wp)/release_growth) then
      state%r_cap = merge(release_growth, growth, attempt%releases)*state%r_cap
    end if
  end subroutine set_next_r_cap

  !> Whether an increment with the present r is large enough for the phase to end.
  pure logical function makes_progress(attempt, progress)
    type(attempt_t), intent(in) :: attempt
    !> Progress of the phase in the trial increment.
    real(wp), intent(in) :: progress

    makes_progress = attempt%limit%r*progress > least_progress
  end function makes_progress

end module dd3_process_step_control
