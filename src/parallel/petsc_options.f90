! SPDX-License-Identifier: GPL-3.0-or-later
!> Options of the solvers of PETSc: what its database holds beside the user's own options.
module dd3_parallel_petsc_options
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_external_petsc, only : replace_option, set_option
  use dd3_linalg_mumps, only : cntl_null_pivot, icntl_null_pivots, icntl_out_of_core, &
      icntl_permutation, icntl_scaling, icntl_workspace, null_pivot
  use dd3_linalg_solver, only : solver_options_t
  implicit none
  private
  public :: set_solver_options

  !> Tolerance of the iterations, whose own residual drifts, as a fraction of the one asked for.
  real(wp), parameter :: margin = 0.1_wp
  !> Vectors that GMRES keeps before it restarts, and its iterations as a smoother. With four the
  !> number of iterations grows with the sheet, with two there is no convergence at 20,164 elements.
  integer, parameter :: krylov_vectors = 100, smoothing_steps = 8

contains

  !> Set the options of a solver.
  subroutine set_solver_options(prefix_of_solver, iterative, options, workspace)
    !> Prefix of the solver's options in the database.
    character(len=*), intent(in) :: prefix_of_solver
    logical, intent(in) :: iterative
    type(solver_options_t), intent(in) :: options
    !> MUMPS's additional workspace, per cent.
    integer, intent(in) :: workspace

    character(len=:), allocatable :: prefix
    logical :: on_disk

    prefix = "-"//prefix_of_solver
    if (.not. iterative) then
      call set_option(prefix//"ksp_type", "preonly")
      call set_option(prefix//"pc_type", "lu")
      call set_option(prefix//"pc_factor_mat_solver_type", "mumps")
      prefix = prefix//"mat_mumps_"
      call set_option(prefix//"icntl_"//to_text(icntl_permutation), "0")
      call set_option(prefix//"icntl_"//to_text(icntl_scaling), "0")
      call set_option(prefix//"icntl_"//to_text(icntl_workspace), to_text(workspace))
      call set_option(prefix//"icntl_"//to_text(icntl_null_pivots), "1")
      on_disk = options%factor_folder /= ""
      ! The input decides, and not the options of the user or of a solver before.
      call replace_option(prefix//"icntl_"//to_text(icntl_out_of_core), merge("1", "0", on_disk))
      if (on_disk) call replace_option(prefix//"ooc_tmpdir", trim(options%factor_folder))
      call set_option(prefix//"cntl_"//to_text(cntl_null_pivot), to_text(null_pivot))
      return
    end if
    call set_option(prefix//"ksp_type", "fgmres")
    call set_option(prefix//"ksp_gmres_restart", to_text(krylov_vectors))
    call set_option(prefix//"ksp_rtol", to_text(margin*options%tolerance))
    call set_option(prefix//"ksp_max_it", to_text(options%iterations))
    call set_option(prefix//"pc_type", "gamg")
    call set_option(prefix//"pc_gamg_reuse_interpolation", "false")
    prefix = prefix//"mg_levels_"
    call set_option(prefix//"ksp_type", "gmres")
    call set_option(prefix//"ksp_max_it", to_text(smoothing_steps))
    call set_option(prefix//"pc_type", "asm")
    call set_option(prefix//"sub_pc_type", "ilu")
    call set_option(prefix//"sub_pc_factor_levels", to_text(options%ilu_level))
  end subroutine set_solver_options

end module dd3_parallel_petsc_options
