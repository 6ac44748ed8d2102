! SPDX-License-Identifier: GPL-3.0-or-later
!> Complete LU factorisation by the library MUMPS (Amestoy, Duff, L'Excellent and Koster, SIAM J.
!> Matrix Anal. Appl. 23, 2001): multifrontal, with partial pivoting in the fronts. It is analysed
!> once for a pattern, in the ordering of the program's own factorisation by fronts.
module dd3_linalg_mumps
  use dd3_base_kinds, only : i8, wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, cause_factor_files, &
      cause_singular, cause_solver, cause_solver_memory
  use dd3_external_blas, only : use_one_blas_thread
  use dd3_external_mumps_library, only : dmumps, dmumps_struc
  use dd3_linalg_front_tree, only : choose_ordering
  use dd3_linalg_matrix, only : block_matrix_t, copy_values
  use dd3_linalg_preconditioner, only : perturbed_pivots_t, preconditioner_t
  implicit none
  private
  public :: mumps_t, mumps_verdict, needs_workspace
  public :: icntl_permutation, icntl_scaling, icntl_workspace, icntl_out_of_core, &
      icntl_null_pivots, &
      cntl_null_pivot, null_pivot, infog_status, infog_argument, infog_null_pivots, &
      first_workspace, more_workspace, most_workspace

  !> MUMPS's jobs.
  integer, parameter :: job_begin = -1, job_end = -2, job_analyse = 1, job_factorise = 2, &
      job_solve = 3
  !> Positions in `icntl`: units and amount of its messages, column permutation, ordering, scaling,
  !> additional workspace in percent of the estimate, whether the factors are on the disk, and
  !> whether it looks for null pivots.
  integer, parameter :: icntl_units(3) = [1, 2, 3], icntl_messages = 4, icntl_permutation = 6, &
      icntl_ordering = 7, icntl_scaling = 8, icntl_workspace = 14, icntl_out_of_core = 22, &
      icntl_null_pivots = 24
  !> Position in `cntl`, and its value: largest null pivot (the rows of the matrix add up to one);
  !> negative as it is not a fraction of the matrix's norm.
  integer, parameter :: cntl_null_pivot = 3
  real(wp), parameter :: null_pivot = -1.0e-13_wp
  !> Value of `icntl_ordering`: that of `perm_in`.
  integer, parameter :: ordering_given = 1
  !> Positions in `infog`: status and its argument, the memory estimated by the analysis, MB, with
  !> the factors and without them, and the number of null pivots.
  integer, parameter :: infog_status = 1, infog_argument = 2, infog_megabytes = 16, &
      infog_megabytes_out_of_core = 26, infog_null_pivots = 28
  !> MUMPS's errors: no memory, workspace too small, singular pattern or matrix, files of factors.
  integer, parameter :: error_memory(3) = [-5, -7, -13], error_workspace(2) = [-8, -9], &
      error_singular(2) = [-6, -10], error_files = -90
  !> Additional workspace: percent at first, factor after `error_workspace`, and limit.
  integer, parameter :: first_workspace = 5, more_workspace = 3, most_workspace = 1000
  real(wp), parameter :: megabyte = 1.0e6_wp

  !> Factors of a matrix.
  type, extends(preconditioner_t) :: mumps_t
    !> Whether `library` is in use.
    logical :: begun = .false.
    !> Folder of the factors; empty for the memory.
    character(len=255) :: folder = ""
    !> Outcome of the analysis.
    type(verdict_t) :: analysis
    !> MUMPS's data: the matrix by entries, right-hand side and factors.
    type(dmumps_struc) :: library
  contains
    procedure :: setup => mumps_setup
    procedure :: build => mumps_build
    procedure :: apply => mumps_apply
    procedure :: bytes => mumps_bytes
    procedure :: release => mumps_release
  end type mumps_t

contains

  !> Analyse the pattern.
  subroutine mumps_setup(self, matrix)
    class(mumps_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer, allocatable :: order(:)
    character(len=8) :: ordering
    integer :: i

    call self%release()
    call use_one_blas_thread()
    call begin(self)
    associate (library => self%library)
      if (self%begun) then
        call choose_ordering(matrix, order, ordering)
        self%description = "MUMPS ("//trim(ordering)//")"
        call set_pattern(self, matrix)
        do i = 1, matrix%n
          library%perm_in(3*order(i) - 2:3*order(i)) = [3*i - 2, 3*i - 1, 3*i]
        end do
        library%job = job_analyse
        call dmumps(library)
      end if
      self%analysis = mumps_verdict(library%infog(infog_status), library%infog(infog_argument))
    end associate
  end subroutine mumps_setup

  !> Begin to use the library.
  subroutine begin(self)
    type(mumps_t), intent(inout) :: self

    associate (library => self%library)
      ! The sequential library needs no communicator.
      library%comm = 0
      library%sym = 0
      library%par = 1
      library%job = job_begin
      call dmumps(library)
      self%begun = library%infog(infog_status) >= 0
      library%icntl(icntl_units) = 0
      library%icntl(icntl_messages) = 0
      library%icntl(icntl_permutation) = 0
      library%icntl(icntl_ordering) = ordering_given
      library%icntl(icntl_scaling) = 0
      library%icntl(icntl_workspace) = first_workspace
      library%icntl(icntl_null_pivots) = 1
      if (self%folder /= "") library%icntl(icntl_out_of_core) = 1
      if (self%folder /= "") library%ooc_tmpdir = self%folder
      library%cntl(cntl_null_pivot) = null_pivot
    end associate
  end subroutine begin

  !> Allocate the matrix, with rows and columns of its entries, and the vectors.
  subroutine set_pattern(self, matrix)
    type(mumps_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix

    integer :: i, k, c, at

    associate (library => self%library)
      library%n = 3*matrix%n
      library%nnz = 9_i8*size(matrix%column, kind=i8)
      allocate (library%irn(library%nnz), library%jcn(library%nnz), library%a(library%nnz))
      allocate (library%perm_in(library%n), library%rhs(library%n))
      at = 0
      do i = 1, matrix%n
        do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
          do c = 1, 3
            library%irn(at + 1:at + 3) = [3*i - 2, 3*i - 1, 3*i]
            library%jcn(at + 1:at + 3) = 3*matrix%column(k) - 3 + c
            at = at + 3
          end do
        end do
      end do
    end associate
  end subroutine set_pattern

  !> Factorise, with more workspace if interchanges of rows need it.
  subroutine mumps_build(self, matrix, verdict)
    class(mumps_t), intent(inout) :: self
    type(block_matrix_t), intent(in) :: matrix
    !> Retry if the matrix is singular, memory is short, or MUMPS fails otherwise.
    type(verdict_t), intent(out) :: verdict

    verdict = self%analysis
    if (verdict%outcome /= verdict_converged) return
    associate (library => self%library)
      do
        call copy_values(size(matrix%value), matrix%value, library%a)
        library%job = job_factorise
        call dmumps(library)
        if (.not. needs_workspace(library%infog(infog_status), library%icntl(icntl_workspace))) exit
        library%icntl(icntl_workspace) = more_workspace*library%icntl(icntl_workspace)
      end do
      verdict = mumps_verdict(library%infog(infog_status), library%infog(infog_argument))
      self%perturbed = perturbed_pivots_t()
      if (verdict%outcome /= verdict_converged .or. library%infog(infog_null_pivots) == 0) return
      associate (row => library%pivnul_list(1) - 1)
        self%perturbed = perturbed_pivots_t(library%infog(infog_null_pivots), 1 + row/3, &
            1 + modulo(row, 3))
      end associate
    end associate
  end subroutine mumps_build

  !> Whether a factorisation failed as its workspace was too small, and can have more.
  pure logical function needs_workspace(status, workspace)
    !> Of `infog` and `icntl`.
    integer, intent(in) :: status, workspace

    needs_workspace = any(status == error_workspace) .and. workspace < most_workspace
  end function needs_workspace

  !> Translate MUMPS's status.
  type(verdict_t) function mumps_verdict(status, argument) result(verdict)
    !> Of `infog`.
    integer, intent(in) :: status, argument

    verdict%outcome = verdict_converged
    if (status >= 0) return
    verdict%outcome = verdict_retry
    if (any(status == error_singular)) then
      verdict%cause = cause_singular
      verdict%detail = "the matrix is singular"
    else if (any(status == error_memory) .or. any(status == error_workspace)) then
      verdict%cause = cause_solver_memory
      verdict%detail = "not enough memory for MUMPS"
    else if (status == error_files) then
      verdict%cause = cause_factor_files
      verdict%detail = "MUMPS cannot write its factors to the disk"
    else
      verdict%cause = cause_solver
      verdict%detail = "MUMPS failed with INFOG(1) = "//to_text(status)//", INFOG(2) = "// &
          to_text(argument)
    end if
  end function mumps_verdict

  !> Solve L U z = r; z is zero without factors.
  subroutine mumps_apply(self, r, z)
    class(mumps_t), intent(inout) :: self
    real(wp), intent(in) :: r(:)
    real(wp), intent(out) :: z(:)

    z = 0.0_wp
    if (.not. self%begun) return
    associate (library => self%library)
      library%rhs = r
      library%job = job_solve
      call dmumps(library)
      if (library%infog(infog_status) >= 0) z = library%rhs
    end associate
  end subroutine mumps_apply

  !> Return the memory of the library, as it is estimated by the analysis, and of the matrix, bytes.
  real(wp) function mumps_bytes(self) result(bytes)
    class(mumps_t), intent(in) :: self

    !> Bytes of an entry with its row and column.
    real(wp), parameter :: per_entry = 16.0_wp
    integer :: position

    bytes = 0.0_wp
    position = merge(infog_megabytes, infog_megabytes_out_of_core, self%folder == "")
    if (self%begun) bytes = megabyte*real(self%library%infog(position), wp) &
        + per_entry*real(self%library%nnz, wp)
  end function mumps_bytes

  !> Free everything.
  subroutine mumps_release(self)
    class(mumps_t), intent(inout) :: self

    if (.not. self%begun) return
    self%begun = .false.
    associate (library => self%library)
      if (associated(library%irn)) deallocate (library%irn, library%jcn, library%a, &
          library%perm_in, library%rhs)
      library%job = job_end
      call dmumps(library)
    end associate
  end subroutine mumps_release

end module dd3_linalg_mumps
