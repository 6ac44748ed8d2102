!> Conjugate gradients squared (Sonneveld 1989), preconditioned from the right, so that the residual
!> is the true one.
!>
!> A near breakdown (rho or sigma vanish), divergence, a stall, or a residual that the recurrence
!> holds for small but the solution does not bear out end a cycle; the next one starts from the best
!> solution known with a new shadow residual, from the second restart on with a random part. After
!> five restarts the iteration gives up and says why.
module dd3_linalg_cgs
  use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
  use dd3_base_kinds, only : wp, i8
  use dd3_linalg_matrix, only : block_matrix_t, multiply
  use dd3_linalg_preconditioner, only : preconditioner_t
  implicit none
  private
  public :: cgs_t, dot, true_residual

  !> Products of vectors this small against their lengths are breakdowns.
  real(wp), parameter :: breakdown = 1.0e-30_wp
  !> A residual this many times larger than the best of the cycle is divergence.
  real(wp), parameter :: divergence = 1.0e8_wp
  !> The true residual may be this many times the tolerance.
  real(wp), parameter :: slack = 10.0_wp
  !> Iterations without a better residual that end a cycle.
  integer, parameter :: stall_limit = 60
  !> Restarts allowed.
  integer, parameter :: restart_limit = 5
  !> How a cycle ended.
  integer, parameter :: ended_converged = 0, ended_rho = 1, ended_sigma = 2, ended_diverged = 3, &
      ended_stalled = 4, ended_drifted = 5, ended_spent = 6
  !> The same in words.
  character(len=48), parameter :: ended_text(6) = [character(len=48) :: &
    "CGS broke down (rho)", "CGS broke down (sigma)", "CGS diverged", "CGS stalled", &
    "CGS residual not borne out by the solution", "CGS used up its iterations"]

  !> The iteration: its limits, its vectors, and how it went.
  type :: cgs_t
    !> Residual wanted, relative to the right-hand side.
    real(wp) :: tolerance = 1.0e-10_wp
    !> Iterations allowed, restarts included.
    integer :: max_iterations = 200
    !> Iterations and restarts made.
    integer :: iterations = 0, restarts = 0
    !> True relative residual of the solution.
    real(wp) :: residual = huge(1.0_wp)
    !> Whether it is small enough.
    logical :: converged = .false.
    !> Why not.
    character(len=48) :: reason = ""
    !> Vectors of the iteration, `(3n)`.
    real(wp), allocatable :: r(:), shadow(:), p(:), q(:), u(:), v(:), hat(:)
    !> Solution of the cycle, the cycle's best, `(3n)`.
    real(wp), allocatable :: x(:), best(:)
  contains
    procedure :: setup => cgs_setup
    procedure :: solve => cgs_solve
  end type cgs_t

contains

  !> Makes room for systems of a size.
  subroutine cgs_setup(self, n, tolerance, max_iterations)
    !> The iteration.
    class(cgs_t), intent(inout) :: self
    !> Number of unknowns.
    integer, intent(in) :: n
    !> Residual wanted, relative to the right-hand side.
    real(wp), intent(in) :: tolerance
    !> Iterations allowed.
    integer, intent(in) :: max_iterations

    self%tolerance = tolerance
    self%max_iterations = max_iterations
    if (allocated(self%r)) deallocate (self%r, self%shadow, self%p, self%q, self%u, self%v, &
      self%hat, self%x, self%best)
    allocate (self%r(n), self%shadow(n), self%p(n), self%q(n), self%u(n), self%v(n), self%hat(n), &
      self%x(n), self%best(n))
  end subroutine cgs_setup

  !> Solves A x = b for a right-hand side of length one.
  subroutine cgs_solve(self, matrix, preconditioner, b, x)
    !> The iteration.
    class(cgs_t), intent(inout) :: self
    !> The matrix, rows scaled.
    type(block_matrix_t), intent(in) :: matrix
    !> Its approximate inverse.
    class(preconditioner_t), intent(in) :: preconditioner
    !> Right-hand side.
    real(wp), intent(in) :: b(:)
    !> The best solution found.
    real(wp), intent(out) :: x(:)
    real(wp) :: residual
    integer :: ended

    call start(self, matrix, preconditioner, b, x)
    self%iterations = 0
    self%restarts = 0
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
      if (ended == ended_converged .or. ended == ended_spent &
        .or. self%restarts == restart_limit) exit
      self%restarts = self%restarts + 1
    end do
    self%converged = self%residual <= slack*self%tolerance
    self%reason = ""
    if (.not. self%converged) self%reason = ended_text(ended)
  end subroutine cgs_solve

  !> First solution: M^-1 b where that is better than nothing.
  subroutine start(self, matrix, preconditioner, b, x)
    !> The iteration; its `r` becomes the residual.
    class(cgs_t), intent(inout) :: self
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Its approximate inverse.
    class(preconditioner_t), intent(in) :: preconditioner
    !> Right-hand side.
    real(wp), intent(in) :: b(:)
    !> The solution.
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

  !> One cycle from `x` with residual `r` and the shadow residual given; leaves its best solution in
  !> `best`.
  subroutine run_cycle(self, matrix, preconditioner, ended)
    !> The iteration.
    class(cgs_t), intent(inout) :: self
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Its approximate inverse.
    class(preconditioner_t), intent(in) :: preconditioner
    !> How it ended.
    integer, intent(out) :: ended
    real(wp) :: rho, rho_before, sigma, alpha, beta, length, length_shadow, best_length
    integer :: since_best

    length = sqrt(dot(self%r, self%r))
    length_shadow = sqrt(dot(self%shadow, self%shadow))
    best_length = length
    self%best = self%x
    rho_before = 1.0_wp
    since_best = 0
    self%p = 0.0_wp
    self%q = 0.0_wp
    do
      ended = ended_spent
      if (self%iterations >= self%max_iterations) return
      rho = dot(self%shadow, self%r)
      ended = ended_rho
      if (abs(rho) <= breakdown*length_shadow*length) return
      beta = rho/rho_before
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
      rho_before = rho
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

  !> Residual b - A x, and its length.
  subroutine true_residual(matrix, b, x, r, length)
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    !> Right-hand side.
    real(wp), intent(in) :: b(:)
    !> Solution.
    real(wp), intent(in) :: x(:)
    !> Residual.
    real(wp), intent(out) :: r(:)
    !> Its length.
    real(wp), intent(out) :: length

    call multiply(matrix, x, r)
    r = b - r
    length = sqrt(dot(r, r))
  end subroutine true_residual

  !> Adds a random part of half its length to a shadow residual; the same one in every run.
  pure subroutine disturb(seed, length, shadow)
    !> Number of the disturbance.
    integer, intent(in) :: seed
    !> Length of the vector.
    real(wp), intent(in) :: length
    !> The vector.
    real(wp), intent(inout) :: shadow(:)
    !> Multiplicative generator of Park and Miller (1988).
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

  !> Dot product with four partial sums, in an order that never changes.
  pure real(wp) function dot(a, b)
    !> The vectors, of one size.
    real(wp), intent(in) :: a(:), b(:)
    real(wp) :: s(4)
    integer :: i, whole

    s = 0.0_wp
    whole = size(a) - modulo(size(a), 4)
    do i = 1, whole, 4
      s = s + a(i:i + 3)*b(i:i + 3)
    end do
    dot = (s(1) + s(2)) + (s(3) + s(4))
    do i = whole + 1, size(a)
      dot = dot + a(i)*b(i)
    end do
  end function dot

end module dd3_linalg_cgs
