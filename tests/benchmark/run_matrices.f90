! SPDX-License-Identifier: GPL-3.0-or-later
!> Compare the linear solvers on the matrices of a run: UMFPACK, the automatic choice, the complete
!> factorisation on blocks, and CGS with ILU(k), k = 0 ... 3, for every ordering.
!>
!>     benchmark_run_matrices <input file> [name=value ...]
!>
!> Runs the job and keeps the reduced matrix and right-hand side of the predictor and of the
!> corrector's last iteration, from ten increments of the last phase and from one in the middle of
!> each earlier phase. Prints two Markdown tables: the matrices, and the results of each solver.
!> Iterations are the median (least - most) over the matrices without failure, times the medians
!> over the matrices of the medians of several repeats, residual and difference from UMFPACK's
!> solution (relative to its largest component) the largest values. Iterations and difference are
!> repeated for a tolerance near round-off ("sharp").
program benchmark_run_matrices
  use dd3_base_clock, only : processor_time
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_linalg_fill_pattern, only : fill_pattern_t, new_fill_pattern
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_ordering, only : find_ordering, ordering_names
  use dd3_linalg_scaled_system, only : scaled_system_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t, solver_report_t
  use dd3_linalg_solver_registry, only : missing_package, new_linear_solver
  use dd3_model_model, only : model_t
  use run_samples, only : collect, read_model, sample_t, usual_options
  implicit none

  !> Repeats of a measurement.
  integer, parameter :: repeats = 9
  !> Tolerance near round-off, with which solutions are compared.
  real(wp), parameter :: sharp_tolerance = 1.0e-14_wp

  !> Result of a solver for one system.
  type :: outcome_t
    !> Whether it converged without fallback.
    logical :: converged = .false.
    integer :: iterations = 0
    !> Times of factorisation and solution, ms.
    real(wp) :: factor = 0.0_wp, solve = 0.0_wp
    !> Residual, and difference from the direct solution relative to its largest component.
    real(wp) :: residual = 0.0_wp, difference = 0.0_wp
  end type outcome_t

  type(model_t) :: model
  type(sample_t), allocatable :: sample(:)

  if (command_argument_count() == 0) then
    error stop "benchmark_run_matrices <input file> [name=value ...]"
  end if
  call read_model(model, 1)
  call collect(model, sample)
  call print_samples(sample)
  call compare(sample)

contains

  !> Print the table of the systems.
  subroutine print_samples(sample)
    type(sample_t), intent(in) :: sample(:)

    integer :: k

    print '(i0," unknowns, ",i0," blocks of 3 x 3",/)', size(sample(1)%b), &
        size(sample(1)%matrix%column)
    print '(a)', "| | phase | travel, mm | increment | from | plastic points | gap | stick | slip |"
    print '(a)', "|---|---|---|---|---|---|---|---|---|"
    do k = 1, size(sample)
      print '(a)', trim(sample(k)%origin)
    end do
  end subroutine print_samples

  !> Measure all solvers on all systems.
  subroutine compare(sample)
    type(sample_t), intent(inout) :: sample(:)

    type(solver_options_t) :: options
    integer :: i, level

    print '(/,a)', "| solver | numbering | fill | failed | iterations | set-up, ms "// &
        "| factorisation, ms | solution, ms | residual | difference | sharp: iterations "// &
        "| difference |"
    print '(a)', "|---|---|---|---|---|---|---|---|---|---|---|---|"
    call measure(usual_options("umfpack"), "UMFPACK", sample)
    call measure(usual_options("auto"), "auto", sample)
    call measure(usual_options("block_lu"), "block LU", sample)
    if (missing_package("mumps") == "") call measure(usual_options("mumps"), "MUMPS", sample)
    options = usual_options("cgs")
    do i = 1, size(ordering_names)
      options%ordering = ordering_names(i)
      do level = 0, 3
        options%ilu_level = level
        call measure(options, "CGS + ILU("//achar(iachar("0") + level)//")", sample)
      end do
    end do
  end subroutine compare

  !> Measure one solver on all systems and print its row of the table; systems on which it failed
  !> enter the number of failures only.
  subroutine measure(options, name, sample)
    type(solver_options_t), intent(in) :: options
    !> Name for the table.
    character(len=*), intent(in) :: name
    !> Systems; the first solver sets their direct solutions.
    type(sample_t), intent(inout) :: sample(:)

    type(outcome_t) :: usual(size(sample)), sharp(size(sample))
    type(solver_options_t) :: sharper
    real(wp) :: setup

    sharper = options
    sharper%tolerance = sharp_tolerance
    call solve_all(sharper, 1, sample, sharp, setup)
    call solve_all(options, repeats, sample, usual, setup)
    associate (good => usual%converged, fit => sharp%converged)
      write (*, '("| ",a," | ",a," | ",a," | ",i0," of ",i0," | ")', advance="no") name, &
          trim(options%ordering), trim(fill_text(options, sample(1)%matrix)), count(.not. good), &
          size(sample)
      if (count(good) == 0) then
        print '(a,f8.3,a)', "| ", setup, " | | | | | | |"
        return
      end if
      write (*, '(a," | ",3(f8.3," | "),2(es7.1," | "))', advance="no") &
          range_text(pack(usual%iterations, good)), setup, median(usual%factor), &
          median(pack(usual%solve, good)), maxval(usual%residual, good), &
          maxval(usual%difference, good)
      if (count(fit) == 0) then
        print '(a)', "| |"
      else
        print '(a," | ",es7.1," |")', range_text(pack(sharp%iterations, fit)), &
            maxval(sharp%difference, fit)
      end if
    end associate
  end subroutine measure

  !> Return median, least and largest of some numbers as text.
  function range_text(number) result(text)
    integer, intent(in) :: number(:)
    character(len=:), allocatable :: text

    text = to_text(nint(median(real(number, wp))))//" ("//to_text(minval(number))//" - " &
        //to_text(maxval(number))//")"
  end function range_text

  !> Solve all systems by one solver.
  subroutine solve_all(options, rounds, sample, outcome, setup)
    type(solver_options_t), intent(in) :: options
    !> Number of repeats.
    integer, intent(in) :: rounds
    !> Systems; direct solutions are set where there are none.
    type(sample_t), intent(inout) :: sample(:)
    type(outcome_t), intent(out) :: outcome(:)
    !> Time of the set-up, ms.
    real(wp), intent(out) :: setup

    class(linear_solver_t), allocatable :: solver
    type(error_t), allocatable :: error
    real(wp) :: began
    integer :: k

    call new_linear_solver(solver, options, error)
    if (allocated(error)) error stop 1
    began = processor_time()
    call solver%setup(sample(1)%matrix)
    setup = 1.0e3_wp*(processor_time() - began)
    do k = 1, size(sample)
      call solve(solver, rounds, sample(k), outcome(k))
    end do
    call solver%release()
  end subroutine solve_all

  !> Solve one system several times.
  subroutine solve(solver, rounds, sample, outcome)
    !> Solver, set up for the pattern.
    class(linear_solver_t), intent(inout) :: solver
    !> Number of repeats.
    integer, intent(in) :: rounds
    !> System; its direct solution is set if there is none.
    type(sample_t), intent(inout) :: sample
    type(outcome_t), intent(out) :: outcome

    type(solver_report_t) :: report
    type(verdict_t) :: verdict
    real(wp) :: x(size(sample%b)), factor(rounds), solution(rounds), began
    integer :: i

    do i = 1, rounds
      began = processor_time()
      call solver%factor(sample%matrix, verdict)
      factor(i) = 1.0e3_wp*(processor_time() - began)
      if (verdict%outcome /= verdict_converged) return
      began = processor_time()
      call solver%solve(sample%b, x, report)
      solution(i) = 1.0e3_wp*(processor_time() - began)
    end do
    if (.not. allocated(sample%reference)) sample%reference = x
    outcome%converged = report%converged .and. .not. report%fallback
    outcome%iterations = report%iterations
    outcome%factor = median(factor)
    outcome%solve = median(solution)
    outcome%residual = report%residual
    outcome%difference = maxval(abs(x - sample%reference))/maxval(abs(sample%reference))
  end subroutine solve

  !> Return the median of a list.
  pure real(wp) function median(list)
    !> List with at least one number.
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

  !> Return the fill as text, empty for solvers without incomplete factorisation.
  character(len=8) function fill_text(options, matrix)
    type(solver_options_t), intent(in) :: options
    type(block_matrix_t), intent(in) :: matrix

    fill_text = ""
    if (options%method == "cgs") write (fill_text, '(f8.2)') fill_of(options, matrix)
    fill_text = adjustl(fill_text)
  end function fill_text

  !> Return the ratio of the blocks of an incomplete factorisation to those in the matrix.
  real(wp) function fill_of(options, matrix)
    type(solver_options_t), intent(in) :: options
    type(block_matrix_t), intent(in) :: matrix

    type(scaled_system_t) :: system
    type(error_t), allocatable :: error
    type(fill_pattern_t) :: pattern
    integer, allocatable :: order(:)

    call find_ordering(trim(options%ordering), matrix, order, error)
    if (allocated(error)) error stop 1
    call system%setup(matrix, order)
    call new_fill_pattern(pattern, system%matrix, options%ilu_level)
    fill_of = real(size(pattern%column), wp)/real(size(matrix%column), wp)
  end function fill_of

end program benchmark_run_matrices
