!> Compares the linear solvers on the matrices of a run: CGS with ILU(k), k = 0 ... 3, on every numbering, the
!> complete factorisation that `auto` may take in its place, and UMFPACK.
!>
!>     benchmark_run_matrices <input file> [name=value ...]
!>
!> runs the job and takes the reduced matrix and right-hand side of the predictor and of the corrector's last iteration
!> from ten increments spread over its last phase and from one in the middle of each phase before. Two tables in
!> Markdown go to the standard output: the matrices, and what each solver did with them. There iterations are the median
!> (least - most) over the matrices it did not fail on, times are medians over the matrices of medians of several
!> repeats, the residual is the largest of all, and so is the difference from UMFPACK's solution, relative to that
!> solution's largest member; iterations and difference once more for the sharpest residual that makes sense.
program benchmark_run_matrices
  use dd3_base_clock, only : wall_time
  use dd3_base_error, only : error_t, error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : text_t, to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  use dd3_input_case, only : case_t
  use dd3_input_reader, only : read_case
  use dd3_linalg_ilu, only : level_of_fill
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_ordering, only : find_ordering, ordering_names
  use dd3_linalg_scaled_system, only : scaled_system_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_solver_registry, only : new_linear_solver
  use dd3_model_build, only : new_model
  use dd3_model_initial, only : new_initial_state
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_increment, only : accept_increment, new_stepper, prepare_increment, shrink_increment, stepper_t, &
                                    try_increment
  use dd3_process_stage, only : begin_phase, next_output_progress, phase_is_over
  use dd3_system_system, only : new_system
  implicit none

  !> Increments looked at in the last phase, and repeats of a measurement.
  integer, parameter :: places = 10, repeats = 9
  !> Relative residual asked for where solutions are compared; the table's other numbers are those at a job's default.
  real(wp), parameter :: sharp_tolerance = 1.0e-14_wp

  !> One linear system of the run.
  type :: sample_t
    !> Where it comes from.
    character(len=120) :: origin = ""
    !> The matrix.
    type(block_matrix_t) :: matrix
    !> Its right-hand side, and the direct solution.
    real(wp), allocatable :: b(:), reference(:)
  end type sample_t

  !> What a solver did with a system.
  type :: outcome_t
    !> Whether it converged, and without the direct solver.
    logical :: converged = .false.
    !> Iterations.
    integer :: iterations = 0
    !> Times of the factorisation and of the solution, ms.
    real(wp) :: factor = 0.0_wp, solve = 0.0_wp
    !> Residual, and difference from the direct solution relative to its largest member.
    real(wp) :: residual = 0.0_wp, difference = 0.0_wp
  end type outcome_t

  type(case_t) :: case
  type(model_t) :: model
  type(error_list_t) :: errors
  type(text_t), allocatable :: override(:)
  type(sample_t), allocatable :: sample(:)
  integer :: i

  if (command_argument_count() == 0) error stop "benchmark_run_matrices <input file> [name=value ...]"
  allocate (override(command_argument_count() - 1))
  do i = 1, size(override)
    override(i)%s = argument(i + 1)
  end do
  call read_case(case, argument(1), override, errors)
  if (errors%count == 0) call new_model(model, case, errors)
  if (errors%count > 0) then
    do i = 1, errors%count
      print '(a)', errors%item(i)%message
    end do
    error stop 1
  end if
  allocate (sample(0))
  call collect(model, sample)
  call print_samples(sample)
  call compare(sample)

contains

  !> An argument of the command line.
  function argument(number) result(text)
    !> Its number.
    integer, intent(in) :: number
    character(len=:), allocatable :: text

    integer :: length

    call get_command_argument(number, length=length)
    allocate (character(len=length) :: text)
    call get_command_argument(number, text)
  end function argument

  !> Runs the job and keeps linear systems of it.
  subroutine collect(model, sample)
    !> The model.
    type(model_t), intent(in) :: model
    !> The systems.
    type(sample_t), allocatable, intent(inout) :: sample(:)

    type(stepper_t) :: stepper
    type(state_t) :: committed, trial
    type(phase_t) :: phase
    type(error_t), allocatable :: error
    real(wp) :: step, next
    logical :: chosen
    integer :: number

    call new_initial_state(committed, model)
    call new_initial_state(trial, model)
    call new_system(stepper%system, model, solver_options_t(), 1, error)
    if (allocated(error)) error stop 1
    call new_stepper(stepper, model)
    do number = 1, size(model%phase)
      call begin_phase(model, number, phase, committed)
      step = 1.0_wp
      if (number == size(model%phase)) step = 1.0_wp/real(places, wp)
      next = 0.5_wp*step
      do while (.not. phase_is_over(phase, committed))
        chosen = committed%progress >= next
        call take_increment(model, phase, stepper, committed, trial, chosen, sample)
        if (committed%increment /= trial%increment) return
        if (chosen) next = next + step
      end do
    end do
  end subroutine collect

  !> One increment of the run; keeps its systems where it is one of those chosen. The trial state's number tells that
  !> it failed.
  subroutine take_increment(model, phase, stepper, committed, trial, chosen, sample)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The maker of increments.
    type(stepper_t), intent(inout) :: stepper
    !> The states.
    type(state_t), intent(inout) :: committed, trial
    !> Whether the systems are kept.
    logical, intent(in) :: chosen
    !> Gets them.
    type(sample_t), allocatable, intent(inout) :: sample(:)

    type(verdict_t) :: verdict
    logical :: again

    trial%increment = -1
    call prepare_increment(stepper, model, phase, committed, next_output_progress(model, phase, committed), verdict)
    if (verdict%outcome /= verdict_converged) return
    if (chosen) call keep("predictor", phase, committed, stepper, sample)
    do
      call try_increment(stepper, model, phase, committed, trial, verdict)
      if (verdict%outcome == verdict_converged) exit
      call shrink_increment(stepper, phase, again)
      if (again) cycle
      trial%increment = -1
      return
    end do
    if (chosen) call keep("corrector", phase, trial, stepper, sample)
    call accept_increment(stepper, trial, committed)
  end subroutine take_increment

  !> Keeps the linear system of this moment.
  subroutine keep(part, phase, state, stepper, sample)
    !> Predictor or corrector.
    character(len=*), intent(in) :: part
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The state it belongs to.
    type(state_t), intent(in) :: state
    !> Holds the system.
    type(stepper_t), intent(in) :: stepper
    !> Gets it.
    type(sample_t), allocatable, intent(inout) :: sample(:)

    type(sample_t), allocatable :: longer(:)
    integer :: n

    n = size(sample)
    allocate (longer(n + 1))
    longer(:n) = sample
    call move_alloc(longer, sample)
    associate (this => sample(n + 1), status => stepper%system%contact%status)
      this%matrix = stepper%system%reduced
      this%b = stepper%system%problem%rhs
      write (this%origin, '("| ",i0," | ",a," | ",f5.2," | ",i0," | ",a," | ",4(i0," | "))') n + 1, phase%name, &
        state%travel, state%increment, part, count(state%plastic), count(status == status_gap), &
        count(status == status_stick), count(status == status_slip)
    end associate
  end subroutine keep

  !> Prints where the systems come from.
  subroutine print_samples(sample)
    !> The systems.
    type(sample_t), intent(in) :: sample(:)

    integer :: k

    print '(i0," unknowns, ",i0," blocks of 3 x 3",/)', size(sample(1)%b), size(sample(1)%matrix%column)
    print '(a)', "| | phase | travel, mm | increment | from | plastic points | gap | stick | slip |"
    print '(a)', "|---|---|---|---|---|---|---|---|---|"
    do k = 1, size(sample)
      print '(a)', trim(sample(k)%origin)
    end do
  end subroutine print_samples

  !> Runs all solvers over all systems.
  subroutine compare(sample)
    !> The systems.
    type(sample_t), intent(inout) :: sample(:)

    type(solver_options_t) :: options
    integer :: i, level

    print '(/,a)', "| solver | numbering | fill | failed | iterations | set-up, ms | factorisation, ms "// &
      "| solution, ms | residual | difference | sharp: iterations | difference |"
    print '(a)', "|---|---|---|---|---|---|---|---|---|---|---|---|"
    options%method = "umfpack"
    call measure(options, "UMFPACK", sample)
    options%method = "auto"
    call measure(options, "auto", sample)
    options%method = "cgs"
    do i = 1, size(ordering_names)
      options%ordering = ordering_names(i)
      do level = 0, 3
        options%ilu_level = level
        call measure(options, "CGS + ILU("//achar(iachar("0") + level)//")", sample)
      end do
    end do
  end subroutine compare

  !> One solver over all systems, a line of the table; systems it failed on count among the failures only.
  subroutine measure(options, name, sample)
    !> The solver's options.
    type(solver_options_t), intent(in) :: options
    !> What it is called.
    character(len=*), intent(in) :: name
    !> The systems; UMFPACK's solutions are kept.
    type(sample_t), intent(inout) :: sample(:)

    type(outcome_t) :: usual(size(sample)), sharp(size(sample))
    type(solver_options_t) :: sharper
    real(wp) :: setup, no_matter

    sharper = options
    sharper%tolerance = sharp_tolerance
    call solve_all(sharper, 1, sample, sharp, no_matter)
    call solve_all(options, repeats, sample, usual, setup)
    associate (good => usual%converged, fit => sharp%converged)
      write (*, '("| ",a," | ",a," | ",a," | ",i0," of ",i0," | ")', advance="no") name, trim(options%ordering), &
        trim(fill_text(options, sample(1)%matrix)), count(.not. good), size(sample)
      if (count(good) == 0) then
        print '(a,f8.3,a)', "| ", setup, " | | | | | | |"
        return
      end if
      write (*, '(a," | ",3(f8.3," | "),2(es7.1," | "))', advance="no") range_text(pack(usual%iterations, good)), &
        setup, median(usual%factor), median(pack(usual%solve, good)), maxval(usual%residual, good), &
        maxval(usual%difference, good)
      if (count(fit) == 0) then
        print '(a)', "| |"
      else
        print '(a," | ",es7.1," |")', range_text(pack(sharp%iterations, fit)), maxval(sharp%difference, fit)
      end if
    end associate
  end subroutine measure

  !> Median, least and largest of numbers, as text.
  function range_text(number) result(text)
    !> The numbers.
    integer, intent(in) :: number(:)
    character(len=:), allocatable :: text

    text = to_text(nint(median(real(number, wp))))//" ("//to_text(minval(number))//" - "//to_text(maxval(number))//")"
  end function range_text

  !> One solver over all systems.
  subroutine solve_all(options, rounds, sample, outcome, setup)
    !> The solver's options.
    type(solver_options_t), intent(in) :: options
    !> How often each system is solved.
    integer, intent(in) :: rounds
    !> The systems; gets the direct solutions where they have none.
    type(sample_t), intent(inout) :: sample(:)
    !> What came of it.
    type(outcome_t), intent(out) :: outcome(:)
    !> Time of the set-up, ms.
    real(wp), intent(out) :: setup

    class(linear_solver_t), allocatable :: solver
    type(error_t), allocatable :: error
    real(wp) :: began
    integer :: k

    call new_linear_solver(solver, options, error)
    if (allocated(error)) error stop 1
    began = wall_time()
    call solver%setup(sample(1)%matrix)
    setup = 1.0e3_wp*(wall_time() - began)
    do k = 1, size(sample)
      call solve(solver, rounds, sample(k), outcome(k))
    end do
    call solver%release()
  end subroutine solve_all

  !> Solves one system several times.
  subroutine solve(solver, rounds, sample, outcome)
    !> The solver, set up.
    class(linear_solver_t), intent(inout) :: solver
    !> How often.
    integer, intent(in) :: rounds
    !> The system; gets the direct solution where it has none.
    type(sample_t), intent(inout) :: sample
    !> What came of it.
    type(outcome_t), intent(out) :: outcome

    type(solver_report_t) :: report
    type(verdict_t) :: verdict
    real(wp) :: x(size(sample%b)), factor(rounds), solution(rounds), began
    integer :: i

    do i = 1, rounds
      began = wall_time()
      call solver%factor(sample%matrix, verdict)
      factor(i) = 1.0e3_wp*(wall_time() - began)
      if (verdict%outcome /= verdict_converged) return
      began = wall_time()
      call solver%solve(sample%b, x, report)
      solution(i) = 1.0e3_wp*(wall_time() - began)
    end do
    if (.not. allocated(sample%reference)) sample%reference = x
    outcome%converged = report%converged .and. .not. report%fallback
    outcome%iterations = report%iterations
    outcome%factor = median(factor)
    outcome%solve = median(solution)
    outcome%residual = report%residual
    outcome%difference = maxval(abs(x - sample%reference))/maxval(abs(sample%reference))
  end subroutine solve

  !> Median of a list.
  pure real(wp) function median(list)
    !> The list; not empty.
    real(wp), intent(in) :: list(:)

    real(wp) :: sorted(size(list)), least
    integer :: i, at

    sorted = list
    do i = 1, size(list)
      at = i - 1 + minloc(sorted(i:), dim=1)
      least = sorted(at)
      sorted(at) = sorted(i)
      sorted(i) = least
    end do
    median = 0.5_wp*(sorted((size(list) + 1)/2) + sorted(size(list)/2 + 1))
  end function median

  !> Blocks of an incomplete factorisation against those in the matrix, as text; nothing for other solvers.
  character(len=8) function fill_text(options, matrix)
    !> The solver's options.
    type(solver_options_t), intent(in) :: options
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix

    fill_text = ""
    if (options%method == "cgs") write (fill_text, '(f8.2)') fill_of(options, matrix)
    fill_text = adjustl(fill_text)
  end function fill_text

  !> Blocks of an incomplete factorisation against those in the matrix.
  real(wp) function fill_of(options, matrix)
    !> The solver's options.
    type(solver_options_t), intent(in) :: options
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix

    type(scaled_system_t) :: system
    type(error_t), allocatable :: error
    integer, allocatable :: order(:), fill_start(:), fill_column(:), fill_diagonal(:)

    call find_ordering(trim(options%ordering), matrix, order, error)
    if (allocated(error)) error stop 1
    call system%setup(matrix, order)
    call level_of_fill(matrix%n, system%matrix%row_start, system%matrix%column, options%ilu_level, fill_start, &
                       fill_column, fill_diagonal)
    fill_of = real(size(fill_column), wp)/real(size(matrix%column), wp)
  end function fill_of

end program benchmark_run_matrices
