!> What every preconditioner provides: a set-up once per pattern, a build per matrix, and its
!> application.
module dd3_linalg_preconditioner
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: preconditioner_t

  !> An approximate inverse of a matrix.
  type, abstract :: preconditioner_t
    !> What it is, for the log; known after the set-up.
    character(len=80) :: description = ""
  contains
    !> Once per pattern.
    procedure(setup_interface), deferred :: setup
    !> Once per matrix.
    procedure(build_interface), deferred :: build
    !> Once per use.
    procedure(apply_interface), deferred :: apply
  end type preconditioner_t

  abstract interface
    !> Prepares for matrices of one pattern.
    subroutine setup_interface(self, matrix)
      import :: preconditioner_t, block_matrix_t
      !> The preconditioner.
      class(preconditioner_t), intent(inout) :: self
      !> A matrix of the pattern; its values are not read.
      type(block_matrix_t), intent(in) :: matrix
    end subroutine setup_interface

    !> Builds the approximate inverse of a matrix of the pattern.
    subroutine build_interface(self, matrix, verdict)
      import :: preconditioner_t, block_matrix_t, verdict_t
      !> The preconditioner.
      class(preconditioner_t), intent(inout) :: self
      !> The matrix, rows scaled to one.
      type(block_matrix_t), intent(in) :: matrix
      !> Retry where none could be built.
      type(verdict_t), intent(out) :: verdict
    end subroutine build_interface

    !> Applies the approximate inverse: z = M^-1 r.
    subroutine apply_interface(self, r, z)
      import :: preconditioner_t, wp
      !> The preconditioner.
      class(preconditioner_t), intent(in) :: self
      !> The vector, `(3n)`.
      real(wp), intent(in) :: r(:)
      !> The result, `(3n)`.
      real(wp), intent(out) :: z(:)
    end subroutine apply_interface
  end interface

end module dd3_linalg_preconditioner
