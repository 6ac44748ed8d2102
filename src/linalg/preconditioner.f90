! SPDX-License-Identifier: GPL-3.0-or-later
!> Abstract preconditioner: set up once per sparsity pattern, built once per matrix, then applied.
module dd3_linalg_preconditioner
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_linalg_matrix, only : block_matrix_t
  implicit none
  private
  public :: perturbed_pivots_t, preconditioner_t

  !> Pivots that vanished in a factorisation, and whose blocks were shifted.
  type :: perturbed_pivots_t
    !> Number of these blocks.
    integer :: blocks = 0
    !> Block row of the first such pivot, and its component there, 1 to 3; 0 if there is none, or if
    !> the library does not tell.
    integer :: row = 0, component = 0
  end type perturbed_pivots_t

  !> Approximate inverse of a matrix.
  type, abstract :: preconditioner_t
    !> Name for the log, known after `setup`.
    character(len=80) :: description = ""
    !> Of the last `build`.
    type(perturbed_pivots_t) :: perturbed = perturbed_pivots_t()
  contains
    procedure(setup_interface), deferred :: setup
    procedure(build_interface), deferred :: build
    procedure(apply_interface), deferred :: apply
  end type preconditioner_t

  abstract interface
    !> Prepare for matrices of one pattern.
    subroutine setup_interface(self, matrix)
      import :: preconditioner_t, block_matrix_t
      class(preconditioner_t), intent(inout) :: self
      !> Matrix of the pattern; its values are not used.
      type(block_matrix_t), intent(in) :: matrix
    end subroutine setup_interface

    !> Build the approximate inverse of a matrix of the pattern.
    subroutine build_interface(self, matrix, verdict)
      import :: preconditioner_t, block_matrix_t, verdict_t
      class(preconditioner_t), intent(inout) :: self
      !> Row-scaled matrix.
      type(block_matrix_t), intent(in) :: matrix
      !> Retry if there is none; `row` is set if a block row is to blame.
      type(verdict_t), intent(out) :: verdict
    end subroutine build_interface

    !> Apply the approximate inverse: z = M^-1 r.
    subroutine apply_interface(self, r, z)
      import :: preconditioner_t, wp
      class(preconditioner_t), intent(inout) :: self
      !> Vectors, `(3n)`.
      real(wp), intent(in) :: r(:)
      real(wp), intent(out) :: z(:)
    end subroutine apply_interface
  end interface

end module dd3_linalg_preconditioner
