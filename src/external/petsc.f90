! SPDX-License-Identifier: GPL-3.0-or-later
!> Procedures of the library PETSc (C interface, integers of 4 bytes). Objects are pointers; all
!> indices are 0-based; the functions return an error code, 0 for none.
module dd3_external_petsc
  use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int, c_intptr_t, c_null_char, &
      c_null_ptr, c_ptr
  implicit none
  private
  public :: petsc_comm_world, insert_values, norm_2, set_option, replace_option
  public :: mat_create, mat_set_sizes, mat_set_block_size, mat_set_type, mat_set_preallocation, &
      mat_set_values_blocked, mat_assemble, mat_create_vecs, mat_residual, mat_destroy
  public :: mat_null_space_create_rigid_body, mat_set_near_null_space, mat_null_space_destroy
  public :: vec_duplicate, vec_set_values, vec_get_values, vec_assemble, vec_axpy, vec_norm, &
      vec_destroy
  public :: ksp_create, ksp_set_options_prefix, ksp_set_from_options, ksp_set_operators, &
      ksp_set_initial_guess_nonzero, ksp_set_up, ksp_solve, ksp_get_converged_reason, &
      ksp_get_iteration_number, ksp_get_pc, ksp_reset, ksp_destroy
  public :: pc_factor_get_matrix, mat_mumps_get_infog

  !> Communicator of all ranks; a pointer in Open MPI, which the configuration checks.
  integer(c_intptr_t), bind(c, name="PETSC_COMM_WORLD") :: petsc_comm_world

  !> INSERT_VALUES, NORM_2, MAT_FINAL_ASSEMBLY.
  integer(c_int), parameter :: insert_values = 1, norm_2 = 1, final_assembly = 0

  interface
    integer(c_int) function mat_create(comm, matrix) bind(c, name="MatCreate")
      import :: c_int, c_intptr_t, c_ptr
      integer(c_intptr_t), value :: comm
      type(c_ptr), intent(out) :: matrix
    end function mat_create

    !> Set the numbers of scalar rows and columns of this rank, and in all.
    integer(c_int) function mat_set_sizes(matrix, rows, columns, all_rows, all_columns) &
        bind(c, name="MatSetSizes")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: rows, columns, all_rows, all_columns
    end function mat_set_sizes

    integer(c_int) function mat_set_block_size(matrix, size) bind(c, name="MatSetBlockSize")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: size
    end function mat_set_block_size

    integer(c_int) function mat_set_type(matrix, name) bind(c, name="MatSetType")
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: matrix
      !> Ended by a null character.
      character(kind=c_char), intent(in) :: name(*)
    end function mat_set_type

    integer(c_int) function mat_set_preallocation(matrix, block_size, own, other, own_upper, &
        other_upper) bind(c, name="MatXAIJSetPreallocation")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: block_size
      !> Numbers of blocks of each block row in columns of this rank and of the others.
      integer(c_int), intent(in) :: own(*), other(*)
      !> Those of symmetric matrices; null.
      type(c_ptr), value :: own_upper, other_upper
    end function mat_set_preallocation

    !> Create the rigid motions of nodes with given coordinates.
    integer(c_int) function mat_null_space_create_rigid_body(coordinates, space) &
        bind(c, name="MatNullSpaceCreateRigidBody")
      import :: c_int, c_ptr
      type(c_ptr), value :: coordinates
      type(c_ptr), intent(out) :: space
    end function mat_null_space_create_rigid_body

    !> Set the vectors that a matrix nearly maps to zero.
    integer(c_int) function mat_set_near_null_space(matrix, space) &
        bind(c, name="MatSetNearNullSpace")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix, space
    end function mat_set_near_null_space

    integer(c_int) function mat_null_space_destroy(space) bind(c, name="MatNullSpaceDestroy")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: space
    end function mat_null_space_destroy

    integer(c_int) function mat_set_values_blocked(matrix, n_row, row, n_column, column, value, &
        mode) bind(c, name="MatSetValuesBlocked")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: n_row, n_column, mode
      integer(c_int), intent(in) :: row(*), column(*)
      !> By scalar rows.
      real(c_double), intent(in) :: value(*)
    end function mat_set_values_blocked

    integer(c_int) function mat_assembly_begin(matrix, kind) bind(c, name="MatAssemblyBegin")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: kind
    end function mat_assembly_begin

    integer(c_int) function mat_assembly_end(matrix, kind) bind(c, name="MatAssemblyEnd")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      integer(c_int), value :: kind
    end function mat_assembly_end

    integer(c_int) function mat_create_vecs(matrix, right, left) bind(c, name="MatCreateVecs")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix
      type(c_ptr), intent(out) :: right, left
    end function mat_create_vecs

    !> Evaluate r = b - A x.
    integer(c_int) function mat_residual(matrix, b, x, r) bind(c, name="MatResidual")
      import :: c_int, c_ptr
      type(c_ptr), value :: matrix, b, x, r
    end function mat_residual

    integer(c_int) function mat_destroy(matrix) bind(c, name="MatDestroy")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: matrix
    end function mat_destroy

    integer(c_int) function vec_duplicate(vector, copy) bind(c, name="VecDuplicate")
      import :: c_int, c_ptr
      type(c_ptr), value :: vector
      type(c_ptr), intent(out) :: copy
    end function vec_duplicate

    integer(c_int) function vec_set_values(vector, n, index, value, mode) &
        bind(c, name="VecSetValues")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: vector
      integer(c_int), value :: n, mode
      integer(c_int), intent(in) :: index(*)
      real(c_double), intent(in) :: value(*)
    end function vec_set_values

    !> Get values of this rank.
    integer(c_int) function vec_get_values(vector, n, index, value) bind(c, name="VecGetValues")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: vector
      integer(c_int), value :: n
      integer(c_int), intent(in) :: index(*)
      real(c_double), intent(out) :: value(*)
    end function vec_get_values

    integer(c_int) function vec_assembly_begin(vector) bind(c, name="VecAssemblyBegin")
      import :: c_int, c_ptr
      type(c_ptr), value :: vector
    end function vec_assembly_begin

    integer(c_int) function vec_assembly_end(vector) bind(c, name="VecAssemblyEnd")
      import :: c_int, c_ptr
      type(c_ptr), value :: vector
    end function vec_assembly_end

    !> Add a multiple of the other vector to a vector.
    integer(c_int) function vec_axpy(vector, factor, other) bind(c, name="VecAXPY")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: vector, other
      real(c_double), value :: factor
    end function vec_axpy

    integer(c_int) function vec_norm(vector, kind, norm) bind(c, name="VecNorm")
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: vector
      integer(c_int), value :: kind
      real(c_double), intent(out) :: norm
    end function vec_norm

    integer(c_int) function vec_destroy(vector) bind(c, name="VecDestroy")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: vector
    end function vec_destroy

    integer(c_int) function ksp_create(comm, solver) bind(c, name="KSPCreate")
      import :: c_int, c_intptr_t, c_ptr
      integer(c_intptr_t), value :: comm
      type(c_ptr), intent(out) :: solver
    end function ksp_create

    integer(c_int) function ksp_set_options_prefix(solver, prefix) &
        bind(c, name="KSPSetOptionsPrefix")
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: solver
      !> Null-terminated.
      character(kind=c_char), intent(in) :: prefix(*)
    end function ksp_set_options_prefix

    integer(c_int) function ksp_set_from_options(solver) bind(c, name="KSPSetFromOptions")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
    end function ksp_set_from_options

    !> Set the matrix, and the one that the preconditioner is made from.
    integer(c_int) function ksp_set_operators(solver, matrix, source) &
        bind(c, name="KSPSetOperators")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver, matrix, source
    end function ksp_set_operators

    !> Set whether the vector of the solution holds a first guess.
    integer(c_int) function ksp_set_initial_guess_nonzero(solver, guess) &
        bind(c, name="KSPSetInitialGuessNonzero")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), value :: guess
    end function ksp_set_initial_guess_nonzero

    !> Factorise.
    integer(c_int) function ksp_set_up(solver) bind(c, name="KSPSetUp")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
    end function ksp_set_up

    integer(c_int) function ksp_solve(solver, b, x) bind(c, name="KSPSolve")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver, b, x
    end function ksp_solve

    !> Get the reason of the end: positive if converged.
    integer(c_int) function ksp_get_converged_reason(solver, reason) &
        bind(c, name="KSPGetConvergedReason")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(out) :: reason
    end function ksp_get_converged_reason

    integer(c_int) function ksp_get_iteration_number(solver, iterations) &
        bind(c, name="KSPGetIterationNumber")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      integer(c_int), intent(out) :: iterations
    end function ksp_get_iteration_number

    !> Drop the factors.
    integer(c_int) function ksp_reset(solver) bind(c, name="KSPReset")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
    end function ksp_reset

    integer(c_int) function ksp_get_pc(solver, preconditioner) bind(c, name="KSPGetPC")
      import :: c_int, c_ptr
      type(c_ptr), value :: solver
      type(c_ptr), intent(out) :: preconditioner
    end function ksp_get_pc

    !> Get the factors.
    integer(c_int) function pc_factor_get_matrix(preconditioner, factors) &
        bind(c, name="PCFactorGetMatrix")
      import :: c_int, c_ptr
      type(c_ptr), value :: preconditioner
      type(c_ptr), intent(out) :: factors
    end function pc_factor_get_matrix

    integer(c_int) function mat_mumps_get_infog(factors, position, value) &
        bind(c, name="MatMumpsGetInfog")
      import :: c_int, c_ptr
      type(c_ptr), value :: factors
      integer(c_int), value :: position
      integer(c_int), intent(out) :: value
    end function mat_mumps_get_infog

    integer(c_int) function ksp_destroy(solver) bind(c, name="KSPDestroy")
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: solver
    end function ksp_destroy

    integer(c_int) function options_has_name(options, prefix, name, found) &
        bind(c, name="PetscOptionsHasName")
      import :: c_char, c_int, c_ptr
      !> Database and prefix; null for the global one and for none.
      type(c_ptr), value :: options, prefix
      !> Null-terminated, with its minus sign.
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), intent(out) :: found
    end function options_has_name

    integer(c_int) function options_set_value(options, name, value) &
        bind(c, name="PetscOptionsSetValue")
      import :: c_char, c_int, c_ptr
      type(c_ptr), value :: options
      character(kind=c_char), intent(in) :: name(*), value(*)
    end function options_set_value
  end interface

contains

  !> Set an option of PETSc's database unless the user has set it (PETSC_OPTIONS).
  subroutine set_option(name, value)
    !> With its minus sign and prefix.
    character(len=*), intent(in) :: name, value

    integer(c_int) :: found, ignored

    ignored = options_has_name(c_null_ptr, c_null_ptr, name//c_null_char, found)
    if (found == 0) ignored = options_set_value(c_null_ptr, name//c_null_char, value//c_null_char)
  end subroutine set_option

  !> Set an option of PETSc's database, also if the user has set it.
  subroutine replace_option(name, value)
    !> With its minus sign and prefix.
    character(len=*), intent(in) :: name, value

    integer(c_int) :: ignored

    ignored = options_set_value(c_null_ptr, name//c_null_char, value//c_null_char)
  end subroutine replace_option

  !> Assemble a matrix whose values are set.
  subroutine mat_assemble(matrix)
    type(c_ptr), intent(in) :: matrix

    integer(c_int) :: ignored

    ignored = mat_assembly_begin(matrix, final_assembly)
    ignored = mat_assembly_end(matrix, final_assembly)
  end subroutine mat_assemble

  !> Assemble a vector whose values are set.
  subroutine vec_assemble(vector)
    type(c_ptr), intent(in) :: vector

    integer(c_int) :: ignored

    ignored = vec_assembly_begin(vector)
    ignored = vec_assembly_end(vector)
  end subroutine vec_assemble

end module dd3_external_petsc
