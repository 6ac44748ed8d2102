!> Newton-Raphson iterations on an abstract problem. The step is that of the linearised problem;
!> one that leaves the domain of the problem or overshoots is halved.
!>
!> A step overshoots if the residual has grown and the same matrix assigns a correction to the
!> residual left behind that is not small against the step. The growth alone is no reason to shorten
!> a step: where the sheet rotates, the linear rotation stretches it, and the next iteration removes
!> that residual at once. In a problem that is linear but for contact the correction vanishes.
!> Source: P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2011 (natural monotonicity
!> test, simplified Newton correction, contraction).
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
    !> Norm of residual and step over their scale, which tells convergence, and norm of the residual
    !> alone, at the trial solution.
    real(wp) :: scaled_norm = 0.0_wp, residual_norm = 0.0_wp
  contains
    procedure(evaluate_interface), deferred :: evaluate
    procedure(is_admissible_interface), deferred :: is_admissible
    procedure(linearise_interface), deferred :: linearise
    procedure(apply_interface), deferred :: apply
    procedure(correction_left_interface), deferred :: correction_left
  end type newton_problem_t

  abstract interface
    !> Evaluate the residual at the trial solution, and set the norms.
    subroutine evaluate_interface(self, with_stiffness, verdict)
      import :: newton_problem_t, verdict_t
      class(newton_problem_t), intent(inout) :: self
      !> A linearisation follows in any case.
      logical, intent(in) :: with_stiffness
      !> Failed if the problem is not defined there.
      type(verdict_t), intent(out) :: verdict
    end subroutine evaluate_interface

    !> Return the norm of the step that the last matrix assigns to the residual, over that of the
    !> last step.
    function correction_left_interface(self) result(norm)
      import :: newton_problem_t, wp
      class(newton_problem_t), intent(inout) :: self
      real(wp) :: norm
    end function correction_left_interface

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
    !> Number of times that a step was halved.
    integer :: halved = 0
    !> Of the last evaluation or linearisation.
    type(verdict_t) :: verdict
  end type newton_course_t

  !> Ratio of the correction left to the step above which a step overshoots, and the largest number
  !> of times that one is halved.
  real(wp), parameter :: largest_ratio = 0.25_wp
  integer, parameter :: most_halvings = 4
  !> Iterations over which the contraction is measured; those with a norm above `far`, after which a
  !> contraction of 1 or more ends them.
  integer, parameter :: span = 5, patience = 10
  real(wp), parameter :: far = 0.5_wp

contains

  !> Iterate from the present trial solution.
  subroutine solve(problem, tolerance, iterations, damping, course)
    class(newton_problem_t), intent(inout) :: problem
    !> Of the scaled norm.
    real(wp), intent(in) :: tolerance
    !> Largest number of iterations.
    integer, intent(in) :: iterations
    !> Whether steps are halved, and iterations without contraction are ended.
    logical, intent(in) :: damping
    type(newton_course_t), intent(out) :: course

    real(wp) :: before
    integer :: j

    before = huge(1.0_wp)
    course%norm = [real(wp) ::]
    do j = 1, iterations
      course%outcome = newton_interrupted
      if (interrupted()) return
      course%iterations = j
      course%outcome = newton_invalid
      call evaluate(problem, damping, before, course)
      if (course%verdict%outcome /= verdict_converged) return
      course%norm = [course%norm, problem%scaled_norm]
      before = problem%residual_norm
      course%outcome = newton_converged
      if (j > 1 .and. course%norm(j) < tolerance) then
        if (problem%is_admissible()) return
      end if
      course%outcome = newton_diverging
      if (damping .and. is_lost(course%norm)) return
      course%outcome = newton_invalid
      call problem%linearise(course%verdict)
      if (course%verdict%outcome /= verdict_converged) return
      call problem%apply(1.0_wp)
    end do
    course%outcome = newton_slow
  end subroutine solve

  !> Evaluate the problem after a step, which is halved if need be.
  subroutine evaluate(problem, damping, before, course)
    class(newton_problem_t), intent(inout) :: problem
    logical, intent(in) :: damping
    !> Norm of the residual before the step.
    real(wp), intent(in) :: before
    !> Holds the number of the iteration.
    type(newton_course_t), intent(inout) :: course

    integer :: k

    do k = 0, most_halvings
      call problem%evaluate(course%iterations == 1, course%verdict)
      if (.not. damping .or. k == most_halvings) return
      if (course%verdict%outcome == verdict_converged) then
        ! The step to the first iteration has no matrix.
        if (course%iterations == 1 .or. problem%residual_norm <= before) return
        if (problem%correction_left() <= largest_ratio) return
      end if
      course%halved = course%halved + 1
      call problem%apply(0.5_wp**(k + 1))
    end do
  end subroutine evaluate

  !> Whether the iterations do not approach a solution: far from it for long, without contraction.
  pure logical function is_lost(norm)
    real(wp), intent(in) :: norm(:)

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
