!> Control of the steps: the attempts at an increment, from the first r to the last cut-back, and
!> the bound that an accepted increment sets for the next one.
module dd3_process_step_control
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_process_limit, only : limit_t, limiter_cutback, limiter_until
  use dd3_process_newton, only : newton_course_t
  use dd3_process_open_edges, only : passage_t
  use dd3_process_residual, only : residual_t
  use dd3_system_solve, only : solve_info_t
  implicit none
  private
  public :: attempt_t, r_cap_t, cut_back, return_to_until, next_r_cap, makes_progress

  !> Limit, course and outcome of an attempt at an increment.
  type :: attempt_t
    !> Number of the attempt at this increment, from 1.
    integer :: number = 1
    !> Factor r with its limiter.
    type(limit_t) :: limit
    !> Bound by the limiter of contact forces alone; its r is huge if it sets none.
    type(limit_t) :: force_limit
    !> Course of the corrector, and the residual in its last iteration.
    type(newton_course_t) :: course
    type(residual_t) :: residual
    type(solve_info_t) :: solver
    type(verdict_t) :: verdict
    !> Whether a tool touched the node of the verdict in the last iterations.
    logical :: touched = .false.
    !> Where the prediction of a failed attempt leads a point in contact over an open edge.
    type(passage_t) :: passage
  end type attempt_t

  !> Bound of r by earlier increments.
  type :: r_cap_t
    real(wp) :: r = huge(1.0_wp)
    !> Whether the number of iterations set it, rather than a cut-back.
    logical :: by_iterations = .false.
  end type r_cap_t

  !> Factor on r after a failed attempt, and the smallest r of another one.
  real(wp), parameter :: cutback_factor = 0.5_wp, cutback_min = 1.0e-5_wp
  !> Factor on the bound after an accepted increment, and the value above which it is removed.
  real(wp), parameter :: growth = 1.5_wp, largest_r_cap = 1.0e3_wp
  !> Smallest factor on r after an increment that took more iterations than the target.
  real(wp), parameter :: smallest_factor = 0.5_wp
  !> Largest number of attempts up to which one beyond the early end of the phase is repeated.
  integer, parameter :: most_returns = 10
  !> Smallest increment of the progress of a phase.
  real(wp), parameter :: least_progress = 1.0e-12_wp

contains

  !> Reduce r for another attempt after one that failed.
  pure subroutine cut_back(attempt, again)
    type(attempt_t), intent(inout) :: attempt
    !> False if r would fall below its minimum.
    logical, intent(out) :: again

    again = attempt%limit%r*cutback_factor >= cutback_min
    if (again) call try_again(attempt, cutback_factor, limiter_cutback)
  end subroutine cut_back

  !> Reduce r for another attempt if a converged one has gone beyond the early end of the phase: the
  !> prediction extrapolates linearly, and knows nothing of nodes that meet a tool.
  pure subroutine return_to_until(attempt, fraction, again)
    type(attempt_t), intent(inout) :: attempt
    !> Of the increment, at which the phase ends.
    real(wp), intent(in) :: fraction
    logical, intent(out) :: again

    again = fraction < 1.0_wp .and. fraction > 0.0_wp .and. attempt%number < most_returns
    if (again) call try_again(attempt, fraction, limiter_until)
  end subroutine return_to_until

  !> Make the next attempt, with a factor on r.
  pure subroutine try_again(attempt, factor, limiter)
    type(attempt_t), intent(inout) :: attempt
    real(wp), intent(in) :: factor
    !> One of the `limiter_*` values.
    integer, intent(in) :: limiter

    attempt%limit%r = factor*attempt%limit%r
    attempt%limit%limiter = limiter
    attempt%solver = solve_info_t()
    attempt%number = attempt%number + 1
  end subroutine try_again

  !> Return the bound of r after an accepted increment. A cut-back, or more iterations than the
  !> target, set one, which every other increment raises; a failed increment leaves none, so that a
  !> restart repeats its attempts.
  pure type(r_cap_t) function next_r_cap(cap, attempt, target_iterations) result(next)
    !> Bound of the increment.
    type(r_cap_t), intent(in) :: cap
    !> Accepted.
    type(attempt_t), intent(in) :: attempt
    !> 0 for none.
    integer, intent(in) :: target_iterations

    real(wp) :: factor

    next = cap
    factor = growth
    if (target_iterations > 0 .and. attempt%verdict%iterations > target_iterations) then
      factor = max(smallest_factor, &
          sqrt(real(target_iterations, wp)/real(attempt%verdict%iterations, wp)))
      next = r_cap_t(attempt%limit%r, .true.)
    else if (attempt%number > 1 .and. attempt%limit%limiter /= limiter_until) then
      next = r_cap_t(attempt%limit%r, .false.)
    end if
    if (next%r < huge(1.0_wp)/growth) next%r = next%r*factor
    if (next%r > largest_r_cap) next%r = huge(1.0_wp)
  end function next_r_cap

  !> Whether an increment with the present r is large enough for the phase to end.
  pure logical function makes_progress(attempt, progress)
    type(attempt_t), intent(in) :: attempt
    !> Progress of the phase in the trial increment.
    real(wp), intent(in) :: progress

    makes_progress = attempt%limit%r*progress > least_progress
  end function makes_progress

end module dd3_process_step_control
