! SPDX-License-Identifier: GPL-3.0-or-later
!> Automatic choice of the solver.
!>
!> The set-up counts operations. If a complete factorisation on blocks costs no more than an
!> incomplete one with a few iterations, as on all sheets of some thousand elements, it is taken.
!> Otherwise the complete factorisation and CGS are tried in turn and the one that takes less time
!> is kept: CGS, whose cost grows as contact and plasticity spread, is skipped for a number of
!> factorisations when it was slower or failed, tried again, and skipped for twice that number if
!> that repeats; where it was faster before it may fail several times in a row. UMFPACK, which
!> interchanges rows freely, is the last resort. MUMPS is not considered: it takes longer than the
!> complete factorisation, see docs/reports/solvers.md, and results would depend on whether the
!> program was built with it.
module dd3_linalg_auto_solver
  use dd3_base_clock, only : processor_time
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_block_lu_solver, only : block_lu_solver_t, new_block_lu_solver
  use dd3_linalg_cgs_solver, only : cgs_solver_t, new_cgs_solver
  use dd3_linalg_fill_pattern, only : fill_pattern_t, new_fill_pattern, elimination_cost
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_umfpack_solver, only : umfpack_solver_t, new_umfpack_solver
  implicit none
  private
  public :: auto_solver_t, make_auto_solver, memory_failures, memory_rest, memory_next_rest, &
      memory_time

  !> Entries of `memory`: consecutive failures of CGS, factorisations for which it is still skipped,
  !> length of the next such rest, 0 while CGS is faster or alone, and the time of the complete
  !> factorisation with its solution, us.
  integer, parameter :: memory_failures = 1, memory_rest = 2, memory_next_rest = 3, memory_time = 4
  !> Number of these entries.
  integer, parameter :: memory_size = 4
  !> Consecutive failures that start a rest while CGS is faster or alone.
  integer, parameter :: failures_allowed = 3
  !> Shortest and longest rest, in factorisations.
  integer, parameter :: first_rest = 20, longest_rest = 320
  !> Iterations with which an incomplete factorisation is compared with a complete one.
  real(wp), parameter :: assumed_iterations = 8.0_wp
  !> Block products of an elimination in the time of an iteration, for each block of matrix and
  !> factors: there are two of each, which are read from memory.
  real(wp), parameter :: products_per_block = 4.0_wp
  !> Time of a block product, s, if the choice must not depend on the clock.
  real(wp), parameter :: product_time = 9.0e-9_wp
  !> Largest time in `memory`, also that of a complete factorisation that has always failed, us.
  integer, parameter :: longest_time = 1000000000
  !> Largest cost of CGS, divided by that of the complete factorisation, and fewest iterations.
  real(wp), parameter :: largest_cost = 1.5_wp
  integer, parameter :: least_iterations = 20
  !> What solves with the present matrix.
  integer, parameter :: by_none = 0, by_cgs = 1, by_block = 2, by_direct = 3

  !> CGS, the complete factorisation, and UMFPACK.
  type, extends(linear_solver_t) :: auto_solver_t
    type(cgs_solver_t) :: cgs
    type(block_lu_solver_t) :: block
    type(umfpack_solver_t) :: direct
    !> Whether CGS, with its complete factorisation by rows on a narrow strip, is used; whether the
    !> complete factorisation by fronts is.
    logical :: may_iterate = .false., may_factorise = .false.
    !> Whether `direct` is set up; done on first use.
    logical :: direct_set_up = .false.
    !> One of the `by_*` values.
    integer :: ready = by_none
    !> Whether a failure of CGS with the present matrix has been recorded, and whether the time of a
    !> factorisation with its first solution has.
    logical :: failure_recorded = .false., time_recorded = .false.
    !> Why the present matrix is not solved by the first choice; empty if another one is faster.
    character(len=160) :: reason = ""
    !> Block products of the set-up of CGS, and of one iteration.
    real(wp) :: setup_products = 0.0_wp, iteration_products = 0.0_wp
    !> Time of the present factorisation, s.
    real(wp) :: seconds = 0.0_wp
  contains
    procedure :: setup_scaled => auto_solver_setup
    procedure :: factor_scaled => auto_solver_factor
    procedure :: solve_scaled => auto_solver_solve
    procedure :: release => auto_solver_release
    procedure :: factor_bytes => auto_solver_factor_bytes
  end type auto_solver_t

contains

  !> Create the solver for the registry.
  subroutine make_auto_solver(solver, options)
    class(linear_solver_t), allocatable, intent(out) :: solver
    type(solver_options_t), intent(in) :: options

    type(auto_solver_t), allocatable :: made

    allocate (made)
    made%options = options
    call new_block_lu_solver(made%block, options)
    call new_umfpack_solver(made%direct, options)
    call move_alloc(made, solver)
  end subroutine make_auto_solver

  !> Choose by counting, or prepare for measuring, and forget earlier failures.
  subroutine auto_solver_setup(self, matrix)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    type(solver_options_t) :: options
    character(len=:), allocatable :: level
    logical :: outright

    options = self%options
    level = "ILU("//to_text(options%ilu_level)//")"
    call self%block%analyse(matrix)
    call count_products(self, matrix)
    outright = self%block%products <= self%setup_products &
        + assumed_iterations*self%iteration_products
    self%may_iterate = self%block%by_rows .or. .not. outright
    self%may_factorise = .not. (self%block%by_rows .and. outright)
    if (.not. outright) options%iterations = min(options%iterations, max(least_iterations, &
        int((largest_cost*self%block%products - self%setup_products)/self%iteration_products)))
    if (.not. self%may_factorise) options%ilu_level = matrix%n
    call new_cgs_solver(self%cgs, options)
    if (self%may_iterate) call self%cgs%setup_scaled(matrix)
    if (self%may_factorise) call self%block%prepare(matrix)
    if (.not. outright) then
      self%description = "CGS with "//level//" or "//trim(self%block%description)// &
          ", whichever takes less time"
      if (options%reproducible) self%description = trim(self%description)//" by count"
    else if (self%may_factorise) then
      self%description = trim(self%block%description)//", cheaper than CGS with "//level
    else
      self%description = "CGS with complete LU in place of "//level
    end if
    self%description = trim(self%description)//"; UMFPACK to fall back on"
    allocate (self%memory(memory_size), source=0)
    if (self%may_factorise) self%memory(memory_next_rest) = first_rest
  end subroutine auto_solver_setup

  !> Count the operations of CGS.
  subroutine count_products(self, matrix)
    type(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    type(fill_pattern_t) :: pattern

    call new_fill_pattern(pattern, matrix, self%options%ilu_level)
    self%setup_products = real(elimination_cost(pattern), wp)
    self%iteration_products = products_per_block &
        *real(size(pattern%column) + size(matrix%column), wp)
  end subroutine count_products

  !> Factorise for the solver whose turn it is, or for the next one if that fails.
  subroutine auto_solver_factor(self, matrix, verdict)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    real(wp) :: began

    began = processor_time()
    self%ready = by_none
    self%failure_recorded = .false.
    self%time_recorded = .false.
    self%reason = ""
    if (self%may_iterate .and. self%memory(memory_rest) == 0 .and. is_timed(self)) then
      call self%cgs%factor_scaled(matrix, verdict)
      if (verdict%outcome == verdict_converged) self%ready = by_cgs
      if (self%ready == by_none) call record_failure(self, verdict%detail)
    else if (self%may_iterate .and. self%memory(memory_rest) > 0) then
      self%memory(memory_rest) = self%memory(memory_rest) - 1
      if (self%memory(memory_failures) > 0) self%reason = "CGS skipped; failures "// &
          "in a row: "//to_text(self%memory(memory_failures))
    end if
    if (self%ready == by_none) then
      began = processor_time()
      call factor_completely(self, matrix, verdict)
    end if
    self%seconds = processor_time() - began
    self%method = name_of(self%ready)
  end subroutine auto_solver_factor

  !> Whether the time of the complete factorisation is known, if there is one beside CGS.
  pure logical function is_timed(self)
    class(auto_solver_t), intent(in) :: self

    is_timed = self%memory(memory_time) > 0 .or. .not. self%may_factorise
  end function is_timed

  !> Return the name of a solver in the registry.
  pure function name_of(ready) result(name)
    !> One of the `by_*` values.
    integer, intent(in) :: ready
    character(len=8) :: name

    name = "umfpack"
    if (ready == by_cgs) name = "cgs"
    if (ready == by_block) name = "block_lu"
  end function name_of

  !> Factorise on blocks, or by UMFPACK if that fails.
  subroutine factor_completely(self, matrix, verdict)
    type(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    if (self%may_factorise) then
      if (self%may_iterate .and. self%memory(memory_time) == 0) &
          self%memory(memory_time) = longest_time
      call self%block%factor_scaled(matrix, verdict)
      self%ready = by_block
      if (verdict%outcome == verdict_converged) return
      self%reason = verdict%detail
    end if
    call factor_directly(self, matrix, verdict)
  end subroutine factor_completely

  !> Factorise by UMFPACK.
  subroutine factor_directly(self, matrix, verdict)
    type(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    type(verdict_t), intent(out) :: verdict

    if (.not. self%direct_set_up) call self%direct%setup_scaled(matrix)
    self%direct_set_up = .true.
    call self%direct%factor_scaled(matrix, verdict)
    self%ready = merge(by_direct, by_none, verdict%outcome == verdict_converged)
  end subroutine factor_directly

  !> Count a failure of CGS, once per matrix; too many start a rest.
  subroutine record_failure(self, reason)
    type(auto_solver_t), intent(inout) :: self
    character(len=*), intent(in) :: reason

    self%reason = reason
    if (self%failure_recorded) return
    self%failure_recorded = .true.
    self%memory(memory_failures) = self%memory(memory_failures) + 1
    if (self%memory(memory_failures) < failures_allowed &
        .and. self%memory(memory_next_rest) == 0) return
    call start_rest(self)
    self%news = "linear solver: CGS skipped for "//to_text(self%memory(memory_rest))// &
        " factorisations: "//reason
  end subroutine record_failure

  !> Skip CGS for a while.
  subroutine start_rest(self)
    type(auto_solver_t), intent(inout) :: self

    self%memory(memory_rest) = max(self%memory(memory_next_rest), first_rest)
    self%memory(memory_next_rest) = min(2*self%memory(memory_rest), longest_rest)
  end subroutine start_rest

  !> Solve; a solver that fails is replaced by the next one.
  subroutine auto_solver_solve(self, matrix, b, x, report)
    class(auto_solver_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    real(wp), intent(in) :: b(:)
    real(wp), intent(inout) :: x(:)
    type(solver_report_t), intent(inout) :: report

    type(verdict_t) :: verdict
    real(wp) :: began

    began = processor_time()
    if (self%ready == by_cgs) then
      call self%cgs%solve_scaled(matrix, b, x, report)
      if (report%converged) then
        if (.not. self%time_recorded) call compare_times(self, self%seconds + processor_time() &
            - began, report%iterations)
        self%time_recorded = .true.
        return
      end if
      call record_failure(self, trim(report%reason))
      began = processor_time()
      self%seconds = 0.0_wp
      call factor_completely(self, matrix, verdict)
    end if
    if (self%ready == by_block) then
      call self%block%solve_scaled(matrix, b, x, report)
      if (report%converged) then
        if (.not. self%time_recorded) call keep_time(self, self%seconds + processor_time() - began)
        self%time_recorded = .true.
      else
        self%reason = report%reason
        call factor_directly(self, matrix, verdict)
      end if
    end if
    report%fallback = len_trim(self%reason) > 0
    report%reason = self%reason
    if (self%ready == by_direct) call self%direct%solve_scaled(matrix, b, x, report)
    if (self%ready /= by_none) return
    report%cause = verdict%cause
    report%reason = verdict%detail
  end subroutine auto_solver_solve

  !> Skip CGS for a while if it took longer than the complete factorisation.
  subroutine compare_times(self, measured, iterations)
    type(auto_solver_t), intent(inout) :: self
    !> Time of a solution by CGS, s, and its iterations.
    real(wp), intent(in) :: measured
    integer, intent(in) :: iterations

    real(wp) :: seconds, other

    self%memory(memory_failures) = 0
    seconds = measured
    if (self%options%reproducible) seconds = product_time*(self%setup_products &
        + real(iterations, wp)*self%iteration_products)
    other = 1.0e-6_wp*real(self%memory(memory_time), wp)
    if (.not. self%may_factorise) then
      self%memory(memory_next_rest) = 0
    else if (seconds > other) then
      call start_rest(self)
      self%news = "linear solver: "//trim(self%block%description)//" for "// &
          to_text(self%memory(memory_rest))//" factorisations, "//to_text(other, 3)// &
          " s each; CGS took "//to_text(seconds, 3)//" s with "//to_text(iterations)//" iterations"
    else
      if (self%memory(memory_next_rest) > first_rest) self%news = "linear solver: CGS, "// &
          to_text(seconds, 3)//" s; "//trim(self%block%description)//" took "//to_text(other, 3)// &
          " s"
      self%memory(memory_next_rest) = 0
    end if
  end subroutine compare_times

  !> Remember the time of a solution by the complete factorisation.
  subroutine keep_time(self, measured)
    type(auto_solver_t), intent(inout) :: self
    real(wp), intent(in) :: measured

    real(wp) :: seconds

    if (.not. self%may_iterate) return
    seconds = measured
    if (self%options%reproducible) seconds = product_time*self%block%products
    self%memory(memory_time) = max(1, nint(min(1.0e6_wp*seconds, real(longest_time, wp))))
  end subroutine keep_time

  !> Free UMFPACK's factors.
  subroutine auto_solver_release(self)
    class(auto_solver_t), intent(inout) :: self

    self%method = ""
    call self%direct%release()
    self%direct_set_up = .false.
    self%ready = by_none
  end subroutine auto_solver_release

  !> Return the memory of the factors of CGS and of the complete factorisation, bytes.
  real(wp) function auto_solver_factor_bytes(self) result(bytes)
    class(auto_solver_t), intent(in) :: self

    bytes = 0.0_wp
    if (self%may_iterate) bytes = bytes + self%cgs%factor_bytes()
    if (self%may_factorise) bytes = bytes + self%block%factor_bytes()
  end function auto_solver_factor_bytes

end module dd3_linalg_auto_solver
