! SPDX-License-Identifier: GPL-3.0-or-later
!> Complete LU factorisation by the multifrontal method (Duff and Reid, ACM Trans. Math. Softw. 9,
!> 1983), on dense fronts by BLAS and LAPACK. Rows are interchanged among the pivots of a front
!> only, so that the pattern is fixed; a nearly singular block of pivots is shifted, and the
!> iteration that uses the factors as preconditioner makes up for it.
module dd3_linalg_multifrontal
  use dd3_base_kinds, only : wp, i8
  use dd3_base_threads, only : most_threads
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_solver
  use dd3_external_blas, only : use_one_blas_thread
  use dd3_linalg_dense, only : dgemv, dlaswp, dtrsv
  use dd3_linalg_front_assembly, only : add_border, add_part, put_blocks
  use dd3_linalg_front_branches, only : find_branches, front_products, front_work_t
  use dd3_linalg_front_factor, only : factor_front
  use dd3_linalg_front_tree, only : front_tree_t, new_front_tree, rows_of
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_preconditioner, only : perturbed_pivots_t, preconditioner_t
  implicit none
  private
  public :: multifrontal_t

  !> Block columns of a front that are assembled together.
  integer, parameter :: chunk = 8

  !> Factors P A11 = L11 U11 of the pivots of each front, A21 A11^-1, and A12.
  type, extends(preconditioner_t) :: multifrontal_t
    type(front_tree_t) :: tree
    !> Number of threads; the results do not depend on it.
    integer :: threads = 1
    !> Number of block rows, and of block products of a factorisation.
    integer :: n = 0
    real(wp) :: products = 0.0_wp
    !> Where the factors of a front begin in `left` and `upper`, `(n_front + 1)`.
    integer(i8), allocatable :: left_start(:), upper_start(:)
    !> Columns of the pivots, `(3 rows, 3 pivots)` for each front, and the rows of the border,
    !> `(3 pivots, 3 border)`.
    real(wp), allocatable :: left(:), upper(:)
    !> Row interchanges of the pivots, `(3n)`.
    integer, allocatable :: pivot(:)
    !> Where the blocks of the two parts of each front begin in `block`, `(2*n_front + 1)`; the
    !> block's number in the matrix and the place of its first entry in the part.
    integer, allocatable :: block_start(:), block(:), entry(:)
    !> Branch of each front, and where its border begins in the workspace of the branch,
    !> `(n_front)`.
    integer, allocatable :: branch_of(:)
    integer(i8), allocatable :: border_at(:)
    !> Workspaces of the trunk, 0, and of the branches.
    type(front_work_t), allocatable :: work(:)
    !> Vector of a solution, `(3n)`, and its part of the border of each front, beside one another.
    real(wp), allocatable :: y(:), part(:)
  contains
    procedure :: analyse => multifrontal_analyse
    procedure :: prepare => multifrontal_prepare
    procedure :: setup => multifrontal_setup
    procedure :: build => multifrontal_build
    procedure :: apply => multifrontal_apply
    procedure :: bytes => multifrontal_bytes
  end type multifrontal_t

contains

  !> Symbolic factorisation and allocation.
  subroutine multifrontal_setup(self, matrix)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call self%analyse(matrix)
    call self%prepare(matrix)
  end subroutine multifrontal_setup

  !> Find the tree of the fronts and count the block products.
  subroutine multifrontal_analyse(self, matrix)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer :: f

    self%description = "multifrontal LU"
    self%n = matrix%n
    call new_front_tree(self%tree, matrix)
    self%products = 0.0_wp
    do f = 1, self%tree%n_front
      self%products = self%products + front_products(self%tree, f)
    end do
  end subroutine multifrontal_analyse

  !> Allocate the factors and the workspaces.
  subroutine multifrontal_prepare(self, matrix)
    !> Analysed.
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    call use_one_blas_thread()
    if (allocated(self%left)) deallocate (self%left, self%upper, self%left_start, &
        self%upper_start, self%pivot, self%y, self%part)
    call find_sizes(self)
    call find_branches(self%tree, self%threads, self%branch_of, self%border_at, self%work)
    call place_blocks(self, matrix)
  end subroutine multifrontal_prepare

  !> Find the sizes of the factors and allocate them.
  subroutine find_sizes(self)
    class(multifrontal_t), intent(inout) :: self

    integer(i8) :: p, m
    integer :: f

    associate (tree => self%tree)
      allocate (self%left_start(tree%n_front + 1), self%upper_start(tree%n_front + 1))
      self%left_start(1) = 1
      self%upper_start(1) = 1
      do f = 1, tree%n_front
        p = 3*int(tree%first(f + 1) - tree%first(f), i8)
        m = 3*int(rows_of(tree, f), i8)
        self%left_start(f + 1) = self%left_start(f) + m*p
        self%upper_start(f + 1) = self%upper_start(f) + p*(m - p)
      end do
      allocate (self%left(self%left_start(tree%n_front + 1) - 1))
      ! One more, so that the empty part of the last front has an address.
      allocate (self%upper(self%upper_start(tree%n_front + 1)))
    end associate
    allocate (self%pivot(3*self%n), self%y(3*self%n), self%part(3*size(self%tree%border) + 1))
  end subroutine find_sizes

  !> Assign the blocks of the matrix to the fronts, each to the front of its earlier pivot.
  subroutine place_blocks(self, matrix)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer, allocatable :: new_number(:), place(:)
    integer :: f, i, j, k, n, p, last, part

    associate (tree => self%tree)
      if (allocated(self%block)) deallocate (self%block, self%entry, self%block_start)
      allocate (self%block(size(matrix%column)), self%entry(size(matrix%column)))
      allocate (self%block_start(2*tree%n_front + 1), new_number(matrix%n), place(matrix%n))
      new_number(tree%order) = [(i, i=1, matrix%n)]
      n = 0
      do f = 1, tree%n_front
        last = tree%first(f + 1) - 1
        p = last - tree%first(f) + 1
        place(tree%first(f):last) = [(i, i=1, p)]
        do k = tree%border_start(f), tree%border_start(f + 1) - 1
          place(tree%border(k)) = p + k - tree%border_start(f) + 1
        end do
        do part = 1, 2
          self%block_start(2*f - 2 + part) = n + 1
          do i = tree%first(f), last
            do k = matrix%row_start(tree%order(i)), matrix%row_start(tree%order(i) + 1) - 1
              j = new_number(matrix%column(k))
              if (j < tree%first(f)) cycle
              if (part == 1 .and. j <= last) call add(k, place(i), place(j), rows_of(tree, f))
              if (part == 1 .and. j > last) call add(position_of(matrix, tree%order(j), &
                  tree%order(i)), place(j), place(i), rows_of(tree, f))
              if (part == 2 .and. j > last) call add(k, place(i), place(j) - p, p)
            end do
          end do
        end do
      end do
      self%block_start(2*tree%n_front + 1) = n + 1
    end associate

  contains

    !> Add a block to the part.
    subroutine add(block, row, column, rows)
      integer, intent(in) :: block, row, column
      !> Block rows of the part.
      integer, intent(in) :: rows

      n = n + 1
      self%block(n) = block
      self%entry(n) = 9*rows*(column - 1) + 3*row - 2
    end subroutine add

  end subroutine place_blocks

  !> Numeric factorisation.
  subroutine multifrontal_build(self, matrix, verdict)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Retry if a block of pivots is not finite; `row` is the first of them.
    type(verdict_t), intent(out) :: verdict

    integer :: b, threads

    threads = min(self%threads, most_threads())
    !$omp parallel do if (size(self%work) > 1) schedule(dynamic) num_threads(threads)
    do b = 1, size(self%work) - 1
      call build_branch(self, matrix, b, 1)
    end do
    !$omp end parallel do
    verdict%outcome = verdict_converged
    if (all(self%work(1:)%failed == 0)) call build_branch(self, matrix, 0, threads)
    call find_perturbed(self)
    if (all(self%work%failed == 0)) return
    verdict%outcome = verdict_retry
    verdict%cause = cause_solver
    verdict%row = self%tree%order(self%tree%first(maxval(self%work%failed)))
    verdict%detail = "the factorisation grows without bound"
  end subroutine multifrontal_build

  !> Find the pivots that were perturbed in any branch; the first of them does not depend on the
  !> number of branches.
  subroutine find_perturbed(self)
    class(multifrontal_t), intent(inout) :: self

    integer :: b, row

    self%perturbed = perturbed_pivots_t(blocks=sum(self%work%shifted))
    if (self%perturbed%blocks == 0) return
    b = minloc(self%work%weak_front, 1, mask=self%work%weak_front > 0) - 1
    row = self%tree%first(self%work(b)%weak_front) + (self%work(b)%weak_pivot - 1)/3
    self%perturbed%row = self%tree%order(row)
    self%perturbed%component = 1 + modulo(self%work(b)%weak_pivot - 1, 3)
  end subroutine find_perturbed

  !> Factorise the fronts of a branch, or those of the trunk when all branches are finished.
  subroutine build_branch(self, matrix, branch, threads)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Branch, and number of threads that process a front.
    integer, intent(in) :: branch, threads

    integer :: f
    logical :: good

    self%work(branch)%shifted = 0
    self%work(branch)%weak_front = 0
    self%work(branch)%failed = 0
    do f = self%work(branch)%first, self%work(branch)%last
      if (self%branch_of(f) /= branch) cycle
      call build_front(self, matrix, f, threads, good)
      if (good) cycle
      self%work(branch)%failed = f
      return
    end do
  end subroutine build_branch

  !> Assemble and factorise a front.
  subroutine build_front(self, matrix, f, threads, good)
    class(multifrontal_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    integer, intent(in) :: f, threads
    !> Whether the pivots are finite.
    logical, intent(out) :: good

    integer :: p, u, k, perturbed

    associate (tree => self%tree, work => self%work(self%branch_of(f)), &
        left => self%left_start(f), upper => self%upper_start(f), rest => self%border_at(f), &
        from => self%block_start(2*f - 1), middle => self%block_start(2*f), &
        after => self%block_start(2*f + 1))
      p = 3*(tree%first(f + 1) - tree%first(f))
      u = 3*rows_of(tree, f) - p
      !$omp parallel do num_threads(threads) if (threads > 1) schedule(dynamic)
      do k = 1, (p + u)/3, chunk
        call add_children(self, f, [k, min(k + chunk - 1, (p + u)/3)], p, u, &
            self%left(left), self%upper(upper), work%border(rest))
      end do
      !$omp end parallel do
      call put_blocks(p + u, middle - from, self%block(from:), self%entry(from:), matrix%value, &
          self%left(left))
      call put_blocks(p, after - middle, self%block(middle:), self%entry(middle:), matrix%value, &
          self%upper(upper))
      call factor_front(p, u, tree%last_child(f) == 0, threads, self%left(left), &
          self%upper(upper), work%border(rest), self%pivot(3*tree%first(f) - 2), &
          perturbed, good)
      if (perturbed == 0) return
      if (work%shifted == 0) then
        work%weak_front = f
        work%weak_pivot = perturbed
      end if
      work%shifted = work%shifted + 1
    end associate
  end subroutine build_front

  !> Set some block columns of a front to the sum of the borders of its children.
  subroutine add_children(self, f, columns, p, u, left, upper, rest)
    class(multifrontal_t), intent(in) :: self
    integer, intent(in) :: f
    !> First and last block column.
    integer, intent(in) :: columns(2)
    !> Pivots, rows of the border, and parts of the front; see `factor_front`.
    integer, intent(in) :: p, u
    real(wp), intent(inout) :: left(p + u, p), upper(p, u), rest(u, u)

    integer :: child, n

    associate (tree => self%tree, first => 3*columns(1) - 2, last => 3*columns(2))
      left(:, first:min(last, p)) = 0.0_wp
      upper(:, max(first - p, 1):last - p) = 0.0_wp
      child = tree%last_child(f)
      if (child > 0) rest(:, max(first - p, 1):last - p) = 0.0_wp
      do while (child > 0)
        n = tree%border_start(child + 1) - tree%border_start(child)
        call add_border(n, tree%place(tree%border_start(child):), &
            self%work(self%branch_of(child))%border(self%border_at(child)), columns, p, u, left, &
            upper, rest)
        child = tree%previous(child)
      end do
    end associate
  end subroutine add_children

  !> Solve L U z = r.
  subroutine multifrontal_apply(self, r, z)
    class(multifrontal_t), intent(inout) :: self
    real(wp), intent(in) :: r(:)
    real(wp), intent(out) :: z(:)

    integer :: i, b, threads

    threads = min(self%threads, most_threads())
    do i = 1, self%n
      self%y(3*i - 2:3*i) = r(3*self%tree%order(i) - 2:3*self%tree%order(i))
    end do
    !$omp parallel do if (size(self%work) > 1) schedule(dynamic) num_threads(threads)
    do b = 1, size(self%work) - 1
      call forward(self, b)
    end do
    !$omp end parallel do
    call forward(self, 0)
    call backward(self, 0)
    !$omp parallel do if (size(self%work) > 1) schedule(dynamic) num_threads(threads)
    do b = 1, size(self%work) - 1
      call backward(self, b)
    end do
    !$omp end parallel do
    do i = 1, self%n
      z(3*self%tree%order(i) - 2:3*self%tree%order(i)) = self%y(3*i - 2:3*i)
    end do
  end subroutine multifrontal_apply

  !> Eliminate the pivots of a branch, or of the trunk, from the vector `y`.
  subroutine forward(self, branch)
    class(multifrontal_t), intent(inout) :: self
    integer, intent(in) :: branch

    integer :: f, child, p, m, at, from

    associate (tree => self%tree)
      do f = self%work(branch)%first, self%work(branch)%last
        if (self%branch_of(f) /= branch) cycle
        at = 3*tree%first(f) - 2
        from = 3*tree%border_start(f) - 2
        p = 3*(tree%first(f + 1) - tree%first(f))
        m = 3*rows_of(tree, f)
        self%part(from:from + m - p - 1) = 0.0_wp
        child = tree%last_child(f)
        do while (child > 0)
          associate (first => tree%border_start(child), last => tree%border_start(child + 1) - 1)
            call add_part(last - first + 1, tree%place(first:last), self%part(3*first - 2:3*last), &
                p, self%y(at:at + p - 1), self%part(from:from + m - p - 1))
          end associate
          child = tree%previous(child)
        end do
        if (m > p) call dgemv("N", m - p, p, -1.0_wp, self%left(self%left_start(f) + int(p, i8)), &
            m, self%y(at), 1, 1.0_wp, self%part(from), 1)
      end do
    end associate
  end subroutine forward

  !> Find the pivots of a branch, or of the trunk, from those of later fronts.
  subroutine backward(self, branch)
    class(multifrontal_t), intent(inout) :: self
    integer, intent(in) :: branch

    integer :: f, i, k, p, u, at, from

    associate (tree => self%tree)
      do f = self%work(branch)%last, self%work(branch)%first, -1
        if (self%branch_of(f) /= branch) cycle
        at = 3*tree%first(f) - 2
        from = 3*tree%border_start(f) - 2
        p = 3*(tree%first(f + 1) - tree%first(f))
        u = 3*rows_of(tree, f) - p
        if (u > 0) then
          do k = 1, u/3
            i = 3*tree%border(tree%border_start(f) + k - 1)
            self%part(from + 3*k - 3:from + 3*k - 1) = self%y(i - 2:i)
          end do
          call dgemv("N", p, u, -1.0_wp, self%upper(self%upper_start(f)), p, self%part(from), 1, &
              1.0_wp, self%y(at), 1)
        end if
        call dlaswp(1, self%y(at), p, 1, p, self%pivot(at), 1)
        call dtrsv("L", "N", "U", p, self%left(self%left_start(f)), p + u, self%y(at), 1)
        call dtrsv("U", "N", "N", p, self%left(self%left_start(f)), p + u, self%y(at), 1)
      end do
    end associate
  end subroutine backward

  !> Return the memory of the factors and the workspace, bytes.
  pure real(wp) function multifrontal_bytes(self) result(bytes)
    class(multifrontal_t), intent(in) :: self

    integer :: b

    bytes = 8.0_wp*(real(size(self%left, kind=i8), wp) + real(size(self%upper, kind=i8), wp)) &
        + 8.0_wp*(real(size(self%block), wp) + real(size(self%tree%border), wp))
    do b = 0, size(self%work) - 1
      bytes = bytes + 8.0_wp*real(size(self%work(b)%border, kind=i8), wp)
    end do
  end function multifrontal_bytes

end module dd3_linalg_multifrontal
