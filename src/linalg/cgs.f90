! SPDX-License-Identifier: GPL-3.0-or-later
!> Conjugate gradients squared (Sonneveld 1989), right-preconditioned, so that the residual is the
!> true one.
!>
!> A cycle ends with convergence, a near breakdown (rho or sigma vanishes), divergence, stagnation,
!> or a recursive residual that the true one does not confirm. The next cycle starts from the best
!> solution with a new shadow residual, which has a random part from the second restart on. A
!> solution that a cycle could not improve counts as converged if its residual is round-off.
module dd3_linalg_cgs
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : wp, i8
  use dd3_linalg_matrix, only : block_matrix_t, multiply
  use dd3_linalg_preconditioner, only : preconditioner_t
  use dd3_linalg_residual, only : round_off_residual, dot, true_residual
  use dd3_linalg_solver, only : solver_report_t
  implicit none
  private
  public :: cgs_t

  !> Largest scalar product, relative to the lengths of its vectors, that counts as breakdown.
  real(wp), parameter :: breakdown = 1.0e-30_wp
  !> Ratio of the residual to the least of the cycle that counts as divergence.
  real(wp), parameter :: divergence = 1.0e8_wp
  !> Largest ratio of the true residual to the tolerance that counts as convergence.
  real(wp), parameter :: slack = 10.0_wp
  !> Number of iterations without a smaller residual after which a cycle ends.
  integer, parameter :: stall_limit = 60
  !> Maximum number of restarts.
  integer, parameter :: restart_limit = 5
  !> How a cycle ended.
  integer, parameter :: ended_converged = 0, ended_rho = 1, ended_sigma = 2, ended_diverged = 3, &
      ended_stalled = 4, ended_drifted = 5, ended_spent = 6
  !> Text for each way of ending but convergence.
  character(len=48), parameter :: ended_text(6) = [character(len=48) :: &
      "CGS broke down (rho)", "CGS broke down (sigma)", "CGS diverged", "CGS stalled", &
      "CGS residual not confirmed by the solution", "CGS used up its iterations"]

  !> Settings, work vectors and outcome of the iteration.
  type :: cgs_t
    !> Target residual, relative to the right-hand side.
    real(wp) :: tolerance = 0.0_wp
    !> Maximum number of iterations, restarts included.
    integer :: max_iterations = 0
    !> Number of iterations and restarts made.
    integer :: iterations = 0, restarts = 0
    !> True relative residual of the solution.
    real(wp) :: residual = huge(1.0_wp)
    !> Whether it is small enough.
    logical :: converged = .false.
    !> Reason if not.
    character(len=48) :: reason = ""
    !> Residual, shadow residual, directions and preconditioned vector, `(3n)`.
    real(wp), allocatable :: r(:), shadow(:), p(:), q(:), u(:), v(:), hat(:)
    !> Solution of the cycle, and the best one of the cycle, `(3n)`.
    real(wp), allocatable :: x(:), best(:)
  contains
    procedure :: setup => cgs_setup
    procedure :: solve => cgs_solve
    procedure :: add_to => cgs_add_to
  end type cgs_t

contains

  !> Set the limits and allocate the vectors.
  subroutine cgs_setup(self, n, tolerance, max_iterations)
    class(cgs_t), intent(inout) :: self
    !> Number of unknowns.
    integer, intent(in) :: n
    !> See `cgs_t`.
    real(wp), intent(in) :: tolerance
    !> See `cgs_t`.
    integer, intent(in) :: max_iterations

    self%tolerance = tolerance
    self%max_iterations = max_iterations
    if (allocated(self%r)) then
      deallocate (self%r, self%shadow, self%p, self%q, self%u, self%v, self%hat, self%x, self%best)
    end if
    allocate (self%r(n), self%shadow(n), self%p(n), self%q(n), self%u(n), self%v(n), self%hat(n), &
        self%x(n), self%best(n))
  end subroutine cgs_setup

  !> Solve A x = b for a right-hand side of unit length.
  subroutine cgs_solve(self, matrix, preconditioner, b, x)
    class(cgs_t), intent(inout) :: self
    !> Row-scaled matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Preconditioner, built for the matrix.
    class(preconditioner_t), intent(inout) :: preconditioner
    real(wp), intent(in) :: b(:)
    !> Best solution found.
    real(wp), intent(out) :: x(:)

    real(wp) :: residual
    integer :: ended

    call start(self, matrix, preconditioner, b, x)
    self%iterations = 0
    self%restarts = 0
    self%converged = .false.
    ended = ended_converged
    do while (self%residual > self%tolerance)
      self%shadow = self%r
      if (self%restarts > 1) call disturb(self%restarts, self%residual, self%shadow)
      self%x = x
      call run_cycle(self, matrix, preconditioner, ended)
      call true_residual(matrix, b, self%best, self%r, residual)
      if (ieee_is_finite(residual) .and. residual < self%residual) then
        self%residual = residual
        x = self%best
      else
        call true_residual(matrix, b, x, self%r, self%residual)
      end if
      if (ended == ended_converged .and. self%residual > slack*self%tolerance) ended = ended_drifted
      if (ended == ended_converged .or. ended == ended_spent) exit
      self%converged = self%residual <= round_off_residual(matrix, b, x)
      if (self%converged) exit
      if (self%restarts == restart_limit) exit
      self%restarts = self%restarts + 1
    end do
    self%converged = self%converged .or. self%residual <= slack*self%tolerance
    self%reason = ""
    if (.not. self%converged) self%reason = ended_text(ended)
  end subroutine cgs_solve

  !> Find the initial solution, M^-1 b or zero, whichever has the smaller residual, and set `r`.
  subroutine start(self, matrix, preconditioner, b, x)
    class(cgs_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    class(preconditioner_t), intent(inout) :: preconditioner
    real(wp), intent(in) :: b(:)
    real(wp), intent(out) :: x(:)

    call preconditioner%apply(b, x)
    call true_residual(matrix, b, x, self%r, self%residual)
    if (ieee_is_finite(self%residual)) then
      if (self%residual < 1.0_wp) return
    end if
    x = 0.0_wp
    self%r = b
    self%residual = 1.0_wp
  end subroutine start

  !> Run one cycle from the components `x`, `r` and `shadow`; set `best`.
  subroutine run_cycle(self, matrix, preconditioner, ended)
    class(cgs_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    class(preconditioner_t), intent(inout) :: preconditioner
    !> How the cycle ended.
    integer, intent(out) :: ended

    real(wp) :: rho, rho_previous, sigma, alpha, beta, length, length_shadow, best_length
    integer :: since_best

    length = sqrt(dot(self%r, self%r))
    length_shadow = sqrt(dot(self%shadow, self%shadow))
    best_length = length
    self%best = self%x
    rho_previous = 1.0_wp
    since_best = 0
    self%p = 0.0_wp
    self%q = 0.0_wp
    do
      ended = ended_spent
      if (self%iterations >= self%max_iterations) return
      rho = dot(self%shadow, self%r)
      ended = ended_rho
      if (abs(rho) <= breakdown*length_shadow*length) return
      beta = rho/rho_previous
      self%u = self%r + beta*self%q
      self%p = self%u + beta*(self%q + beta*self%p)
      call preconditioner%apply(self%p, self%hat)
      call multiply(matrix, self%hat, self%v)
      sigma = dot(self%shadow, self%v)
      ended = ended_diverged
      if (.not. ieee_is_finite(sigma)) return
      ended = ended_sigma
      if (abs(sigma) <= breakdown*length_shadow*sqrt(dot(self%v, self%v))) return
      alpha = rho/sigma
      self%q = self%u - alpha*self%v
      self%u = self%u + self%q
      call preconditioner%apply(self%u, self%hat)
      self%x = self%x + alpha*self%hat
      call multiply(matrix, self%hat, self%v)
      self%r = self%r - alpha*self%v
      length = sqrt(dot(self%r, self%r))
      rho_previous = rho
      self%iterations = self%iterations + 1
      ended = ended_diverged
      if (.not. ieee_is_finite(length)) return
      if (length > divergence*best_length) return
      since_best = since_best + 1
      if (length < best_length) then
        best_length = length
        self%best = self%x
        since_best = 0
      end if
      ended = ended_converged
      if (length <= self%tolerance) return
      ended = ended_stalled
      if (since_best >= stall_limit) return
    end do
  end subroutine run_cycle

  !> Add a reproducible random vector of half its length to a shadow residual.
  pure subroutine disturb(seed, length, shadow)
    integer, intent(in) :: seed
    !> Length of `shadow`.
    real(wp), intent(in) :: length
    real(wp), intent(inout) :: shadow(:)

    ! Multiplicative generator of Park and Miller (1988).
    integer(i8), parameter :: factor = 16807_i8, modulus = 2147483647_i8
    real(wp) :: size_of_part
    integer(i8) :: state
    integer :: i

    state = 4711_i8*int(seed, i8)
    size_of_part = length*sqrt(3.0_wp/(4.0_wp*real(size(shadow), wp)))
    do i = 1, size(shadow)
      state = modulo(factor*state, modulus)
      shadow(i) = shadow(i) + size_of_part*(2.0_wp*real(state, wp)/real(modulus, wp) - 1.0_wp)
    end do
  end subroutine disturb

  !> Add the result to the report of a solver; the iterations of one that failed before count too.
  pure subroutine cgs_add_to(self, report)
    class(cgs_t), intent(in) :: self
    type(solver_report_t), intent(inout) :: report

    report%converged = self%converged
    report%iterations = report%iterations + self%iterations
    report%restarts = self%restarts
    report%residual = self%residual
    report%reason = self%reason
  end subroutine cgs_add_to

end module dd3_linalg_cgs
