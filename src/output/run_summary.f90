! SPDX-License-Identifier: GPL-3.0-or-later
!> Totals of a run and of its phases: how far each came, how it ended and what it cost.
module dd3_output_run_summary
  use dd3_base_clock, only : profile_t
  use dd3_base_error, only : error_t
  use dd3_base_interrupt, only : interruption_code
  use dd3_base_kinds, only : wp
  use dd3_model_state, only : state_t
  use dd3_output_closing, only : closing_t
  use dd3_output_status, only : status_row_t
  implicit none
  private
  public :: phase_summary_t, run_summary_t

  !> Number of accepted increments that a limiter set.
  type :: limiter_count_t
    character(len=16) :: limiter = ""
    integer :: count = 0
  end type limiter_count_t

  !> Totals of a phase in this run.
  type :: phase_summary_t
    !> `pending`; `earlier` if it ended before a restart; `running`; `ended`; `stopped`;
    !> `interrupted`.
    character(len=11) :: state = "pending"
    !> Progress, 0 to 1, travel since the start of the job, mm, and last accepted increment.
    real(wp) :: progress = 0.0_wp, travel = 0.0_wp
    integer :: last_increment = 0
    !> Accepted increments, attempts, cut-backs, iterations of the corrector and of the linear
    !> solver.
    integer :: increments = 0, attempts = 0, retries = 0, iterations = 0, solver_iterations = 0
    !> Wall-clock time of the attempts, s.
    real(wp) :: seconds = 0.0_wp
    !> Limiters of the accepted increments.
    type(limiter_count_t), allocatable :: limited(:)
    !> How far the sheet was formed at its end.
    type(closing_t) :: closing
  contains
    procedure :: add => phase_add
    procedure :: finish => phase_finish
    procedure :: is_early
  end type phase_summary_t

  !> Totals of a run.
  type :: run_summary_t
    !> Accepted increments since the start of the job, or steps of material points.
    integer :: increments = 0
    type(phase_summary_t), allocatable :: phase(:)
    !> Wall-clock time, s.
    real(wp) :: seconds = 0.0_wp
    type(profile_t) :: profile
  contains
    procedure :: start => run_start
    procedure :: total
  end type run_summary_t

  !> Progress that counts as the end of a phase.
  real(wp), parameter :: whole = 1.0_wp - 1.0e-9_wp

contains

  !> Begin a run from a state.
  subroutine run_start(self, n_phase, state)
    class(run_summary_t), intent(inout) :: self
    integer, intent(in) :: n_phase
    !> Initial state, or that of a restart.
    type(state_t), intent(in) :: state

    integer :: i

    if (allocated(self%phase)) deallocate (self%phase)
    allocate (self%phase(n_phase))
    do i = 1, n_phase
      allocate (self%phase(i)%limited(0))
    end do
    self%phase(:state%phase - 1)%state = "earlier"
  end subroutine run_start

  !> Return the sums over the phases; those of a single phase have a meaning for a sum only.
  pure type(phase_summary_t) function total(self)
    class(run_summary_t), intent(in) :: self

    if (.not. allocated(self%phase)) return
    total%increments = sum(self%phase%increments)
    total%attempts = sum(self%phase%attempts)
    total%retries = sum(self%phase%retries)
    total%iterations = sum(self%phase%iterations)
    total%solver_iterations = sum(self%phase%solver_iterations)
  end function total

  !> Add an attempt.
  subroutine phase_add(self, row)
    class(phase_summary_t), intent(inout) :: self
    !> Its row of status.csv.
    type(status_row_t), intent(in) :: row

    integer :: i

    self%attempts = self%attempts + 1
    self%iterations = self%iterations + row%iterations
    self%solver_iterations = self%solver_iterations + row%solver_iterations
    self%seconds = self%seconds + row%seconds
    if (row%outcome /= "accepted") return
    self%increments = self%increments + 1
    do i = 1, size(self%limited)
      if (self%limited(i)%limiter == row%limiter) exit
    end do
    if (i > size(self%limited)) self%limited = [self%limited, limiter_count_t(row%limiter)]
    self%limited(i)%count = self%limited(i)%count + 1
  end subroutine phase_add

  !> Set where the phase ended, and how.
  subroutine phase_finish(self, state, error)
    class(phase_summary_t), intent(inout) :: self
    !> Last accepted state.
    type(state_t), intent(in) :: state
    !> Allocated if the run stopped in the phase.
    type(error_t), allocatable, intent(in) :: error

    self%state = "ended"
    if (allocated(error)) then
      self%state = "stopped"
      if (error%code == interruption_code) self%state = "interrupted"
    end if
    self%progress = state%progress
    self%travel = state%travel
    self%last_increment = state%increment
  end subroutine phase_finish

  !> Whether the phase ended before its whole progress, by `until`.
  pure logical function is_early(self)
    class(phase_summary_t), intent(in) :: self

    is_early = self%state == "ended" .and. self%progress < whole
  end function is_early

end module dd3_output_run_summary
