! SPDX-License-Identifier: GPL-3.0-or-later
!> Newton-Raphson iterations on an abstract problem. The step du is that of the linearised problem,
!> with a line search: at the fraction s of the step the residual R does the work
!>     g(s) = du . R(u + s du),
!> the derivative of the potential along the step, if there is one. The full step is taken if it
!> ends short of the minimum or g there is small against g(0), if g(0) says nothing, or near the
!> solution; otherwise it is shortened to where g is small, or where it is in the domain of the
!> problem. Full steps are too long where points return from plastic to elastic behaviour: the
!> tangent is that of plastic flow.
!>
!> A few unknowns may be far more nonlinear than the rest; a step that suits them would be short for
!> all. A problem may therefore solve for them alone after a full step, the rest held: nonlinear
!> elimination. Where that reduces the norm, the step is not shortened; another step follows, which
!> takes the residual that is left to the rest, and converges quadratically.
!> Source: H. Matthies, G. Strang, Int. J. Numer. Methods Eng. 14 (1979) 1613-1626 (line search);
!> P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2011 (contraction); P. J. Lanzkron,
!> D. J. Rose, J. T. Wilkes, SIAM J. Sci. Comput. 17 (1996) 538-559, X.-C. Cai, X. Li, SIAM J. Sci.
!> Comput. 33 (2011) 746-762 (nonlinear elimination).
module dd3_process_newton
  use dd3_base_interrupt, only : interrupted
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_converged, verdict_t
  implicit none
  private
  public :: newton_problem_t, newton_course_t, solve, contraction

  !> Outcomes of the iterations: converged; no contraction; iterations used up; the problem is not
  !> defined at the step, or has no linearisation, as the verdict says; interrupted.
  enum, bind(c)
    enumerator :: newton_converged = 0
    enumerator :: newton_diverging, newton_slow, newton_invalid, newton_interrupted
  end enum
  public :: newton_converged, newton_diverging, newton_slow, newton_invalid, newton_interrupted

  !> Problem F(u) = 0 with its trial solution u and the last step.
  type, abstract :: newton_problem_t
    !> Norm over its scale at the trial solution, which tells convergence.
    real(wp) :: scaled_norm = 0.0_wp
    !> Scaled norm above which, and number of iterations after which, iterations without contraction
    !> are ended.
    real(wp) :: far = 0.5_wp
    integer :: patience = 10
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure(is_admissible_interface), deferred :: is_admissible
    procedure(linearise_interface), deferred :: linearise
    procedure(apply_interface), deferred :: apply
    procedure(slope_interface), deferred :: slope
    procedure :: eliminate => eliminate_nothing
  end type newton_problem_t

  abstract interface
    !> Evaluate the residual at the trial solution.
    subroutine evaluate_interface(self, first, verdict)
      import :: newton_problem_t, verdict_t
      class(newton_problem_t), intent(inout) :: self
      !> Of the solution: a linearisation follows in any case.
      logical, intent(in) :: first
      !> Failed if the problem is not defined there.
      type(verdict_t), intent(out) :: verdict
    end subroutine evaluate_interface

    !> Return the work of the residual in the last step.
    function slope_interface(self) result(work)
      import :: newton_problem_t, wp
      class(newton_problem_t), intent(in) :: self
      real(wp) :: work
    end function slope_interface

    !> Whether the trial solution satisfies the conditions that are not in the norm.
    function is_admissible_interface(self) result(admissible)
      import :: newton_problem_t
      class(newton_problem_t), intent(in) :: self
      logical :: admissible
    end function is_admissible_interface

    !> Linearise at the trial solution and solve for the step.
    subroutine linearise_interface(self, verdict)
      import :: newton_problem_t, verdict_t
      class(newton_problem_t), intent(inout) :: self
      !> Failed if there is no step.
      type(verdict_t), intent(out) :: verdict
    end subroutine linearise_interface

    !> Set the trial solution to that of the linearisation and a fraction of the step.
    subroutine apply_interface(self, fraction)
      import :: newton_problem_t, wp
      class(newton_problem_t), intent(inout) :: self
      real(wp), intent(in) :: fraction
    end subroutine apply_interface
  end interface

  !> Course of the iterations.
  type :: newton_course_t
    !> One of the `newton_*` values.
    integer :: outcome = newton_slow
    integer :: iterations = 0
    !> Scaled norm in each iteration that had one.
    real(wp), allocatable :: norm(:)
    !> Number of times that a step was shortened.
    integer :: shortened = 0
    !> Number of nonlinear eliminations that reduced the norm.
    integer :: eliminations = 0
    !> Of the last evaluation or linearisation.
    type(verdict_t) :: verdict = verdict_t()
  end type newton_course_t

  !> Ratio |g(s)/g(0)| up to which a step is not shortened. Smaller: more evaluations for hardly
  !> fewer iterations; larger: more iterations where sheets bend and unbend over radii.
  real(wp), parameter :: largest_ratio = 0.3_wp
  !> Scaled norm below which steps are not shortened, with smaller tolerances too. Near the solution
  !> residual and step may be nearly orthogonal: with friction and exact contact |g(1)/g(0)| was
  !> 4e4, the full step raised the norm by 6 %, and a search shortened every step to 0.003 of it.
  !> With 1e-4 the draw of tests/cases/springback stops there at a tolerance of 1e-5, with 1e-3 it
  !> takes 3 % more iterations.
  real(wp), parameter :: near = 1.0e-2_wp
  !> Ratio |g(1)/g(0)| above which the residual was nearly orthogonal to the step, so that g says
  !> nothing. The full step is taken then if it reduces the norm. Where points stick to a tool that
  !> leads them, searches on g shorten every step to a twentieth.
  real(wp), parameter :: orthogonal = 10.0_wp
  !> Distance of the next fraction from the ends of its interval, over the interval, and the largest
  !> number of times that a step is shortened.
  real(wp), parameter :: margin = 0.1_wp
  integer, parameter :: most_times = 4
  !> Iterations over which the contraction is measured.
  integer, parameter :: span = 5

contains

  !> Solve for a few unknowns alone, unless that leaves the norm above a bound: then the trial
  !> solution is as before. A problem that does not override this has no such unknowns.
  recursive subroutine eliminate_nothing(self, bound, eliminated)
    class(newton_problem_t), intent(inout) :: self
    real(wp), intent(in) :: bound
    !> Whether the trial solution has changed.
    logical, intent(out) :: eliminated

    eliminated = .false.
  end subroutine eliminate_nothing

  !> Iterate from the present trial solution.
  recursive subroutine solve(problem, tolerance, iterations, line_search, course)
    class(newton_problem_t), intent(inout) :: problem
    !> Of the scaled norm.
    real(wp), intent(in) :: tolerance
    !> Largest number of iterations.
    integer, intent(in) :: iterations
    !> Whether steps are shortened, and iterations without contraction are ended.
    logical, intent(in) :: line_search
    type(newton_course_t), intent(out) :: course

    real(wp) :: start
    integer :: j, eliminations

    start = 0.0_wp
    course%norm = [real(wp) ::]
    do j = 1, iterations
      course%outcome = newton_interrupted
      if (interrupted()) return
      course%iterations = j
      course%outcome = newton_invalid
      eliminations = course%eliminations
      call evaluate(problem, tolerance, line_search, start, course)
      if (course%verdict%outcome /= verdict_converged) return
      course%norm = [course%norm, problem%scaled_norm]
      course%outcome = newton_converged
      if (j > 1 .and. course%norm(j) < tolerance .and. course%eliminations == eliminations) then
        if (problem%is_admissible()) return
      end if
      course%outcome = newton_diverging
      if (line_search .and. is_lost(course%norm, problem%far, problem%patience)) return
      course%outcome = newton_invalid
      call problem%linearise(course%verdict)
      if (course%verdict%outcome /= verdict_converged) return
      start = problem%slope()
      call problem%apply(1.0_wp)
    end do
    course%outcome = newton_slow
  end subroutine solve

  !> Evaluate the problem after a step, which is shortened if need be: regula falsi between a
  !> fraction short of the minimum and one beyond it. The step to the first iteration, that of the
  !> prediction, is only kept in the domain of the problem.
  recursive subroutine evaluate(problem, tolerance, line_search, start, course)
    class(newton_problem_t), intent(inout) :: problem
    !> Of the scaled norm.
    real(wp), intent(in) :: tolerance
    logical, intent(in) :: line_search
    !> Slope at the start of the step.
    real(wp), intent(in) :: start
    !> Holds the number of the iteration.
    type(newton_course_t), intent(inout) :: course

    !> Fractions of the step, and the slopes there.
    real(wp) :: fraction, short, beyond, slope, slope_short, slope_beyond
    logical :: too_far, eliminated
    integer :: k

    fraction = 1.0_wp
    short = 0.0_wp
    beyond = 1.0_wp
    slope_short = start
    slope_beyond = -start
    do k = 0, most_times
      call problem%evaluate(course%iterations == 1, course%verdict)
      if (.not. line_search .or. k == most_times) return
      slope = -slope_short
      too_far = .true.
      if (course%verdict%outcome == verdict_converged) then
        if (course%iterations == 1) return
        if (k == 0) then
          if (problem%scaled_norm < max(near, tolerance)) return
          call problem%eliminate(course%norm(course%iterations - 1), eliminated)
          if (eliminated) course%eliminations = course%eliminations + 1
          if (eliminated) return
        end if
        slope = problem%slope()
        too_far = slope*start < 0.0_wp
        if (is_small(slope, start)) return
        if (k == 0 .and. (.not. too_far .or. (abs(slope) > orthogonal*abs(start) .and. &
            problem%scaled_norm < course%norm(course%iterations - 1)))) return
      end if
      if (too_far) then
        beyond = fraction
        slope_beyond = slope
      else
        short = fraction
        slope_short = slope
      end if
      fraction = between(short, beyond, slope_short, slope_beyond)
      course%shortened = course%shortened + 1
      call problem%apply(fraction)
    end do
  end subroutine evaluate

  !> Whether a slope is small enough against that at the start of the step.
  pure logical function is_small(slope, start)
    real(wp), intent(in) :: slope, start

    is_small = abs(slope) <= largest_ratio*abs(start)
  end function is_small

  !> Return the fraction at which the secant vanishes, not too near to the ends.
  pure real(wp) function between(short, beyond, slope_short, slope_beyond) result(fraction)
    real(wp), intent(in) :: short, beyond, slope_short, slope_beyond

    real(wp) :: part

    part = 0.5_wp
    if (abs(slope_short - slope_beyond) > 0.0_wp) part = slope_short/(slope_short - slope_beyond)
    fraction = short + min(max(part, margin), 1.0_wp - margin)*(beyond - short)
  end function between

  !> Whether the iterations do not approach a solution: far from it for long, without contraction.
  pure logical function is_lost(norm, far, patience)
    real(wp), intent(in) :: norm(:)
    !> Norm above which they are far.
    real(wp), intent(in) :: far
    !> Least number of iterations.
    integer, intent(in) :: patience

    is_lost = .false.
    if (size(norm) < patience) return
    is_lost = all(norm(size(norm) - patience + 1:) > far) .and. contraction(norm) >= 1.0_wp
  end function is_lost

  !> Return the mean ratio of successive norms: from the smallest norm before the last iterations to
  !> the smallest in them; 0 if there are too few.
  pure real(wp) function contraction(norm)
    real(wp), intent(in) :: norm(:)

    contraction = 0.0_wp
    if (size(norm) <= span) return
    associate (last => size(norm) - span)
      contraction = (minval(norm(last + 1:))/minval(norm(:last)))**(1.0_wp/real(span, wp))
    end associate
  end function contraction

end module dd3_process_newton
