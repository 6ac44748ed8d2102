!> One attempt at an increment: what limited it, how the corrector and the linear solver proceeded,
!> how it ended. Records and messages are made from it.
module dd3_process_attempt
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_process_limit, only : limit_t
  use dd3_process_status_memory, only : new_status_memory
  use dd3_system_solve, only : solve_info_t
  implicit none
  private
  public :: attempt_t, correction_t, new_attempt, clear_correction

  !> Course of the corrector.
  type :: correction_t
    !> Criterion of convergence, eq. (19), after each iteration.
    real(wp), allocatable :: criterion(:)
    !> Contact status in the last iterations, see `dd3_process_status_memory`.
    integer, allocatable :: status(:, :)
    !> Number of iterations damped.
    integer :: damped = 0
    !> Fraction of the last solution in the trial state, and the reductions that led to it.
    real(wp) :: step = 1.0_wp
    integer :: reductions = 0
    !> Norm of the residuals in the last iteration, N.
    real(wp) :: residual = 0.0_wp
    !> Node with the largest residual, and that residual, N.
    integer :: worst_node = 0
    real(wp) :: worst_residual = 0.0_wp
    !> Increment of the contact forces in the last iteration, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda_increment(:, :)
    !> Increment of the parameters of the enhanced strains, `(n_enhanced, n_element)`.
    real(wp), allocatable :: enhanced_increment(:, :)
  end type correction_t

  !> Limit, course and outcome of an attempt.
  type :: attempt_t
    !> Number of the attempt at this increment, from 1.
    integer :: number = 1
    !> Factor r with its limiter.
    type(limit_t) :: limit
    !> Bound by the limiter of contact forces alone; its r is huge if it sets none.
    type(limit_t) :: force_limit
    type(correction_t) :: correction
    type(solve_info_t) :: solver
    type(verdict_t) :: verdict
  end type attempt_t

contains

  !> Make the first attempt at an increment.
  subroutine new_attempt(self, n_contact)
    type(attempt_t), intent(inout) :: self
    !> Number of contact candidates.
    integer, intent(in) :: n_contact

    self%number = 1
    self%limit = limit_t()
    self%force_limit = limit_t()
    self%solver = solve_info_t()
    self%verdict = verdict_t()
    call clear_correction(self%correction, n_contact)
  end subroutine new_attempt

  !> Reset the course of the corrector before its first iteration.
  subroutine clear_correction(self, n_contact)
    type(correction_t), intent(inout) :: self
    integer, intent(in) :: n_contact

    self%criterion = [real(wp) ::]
    call new_status_memory(self%status, n_contact)
    if (.not. allocated(self%lambda_increment)) allocate (self%lambda_increment(3, n_contact))
    self%damped = 0
    self%step = 1.0_wp
    self%reductions = 0
    self%lambda_increment = 0.0_wp
    self%residual = 0.0_wp
    self%worst_node = 0
    self%worst_residual = 0.0_wp
  end subroutine clear_correction

end module dd3_process_attempt
