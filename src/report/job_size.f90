! SPDX-License-Identifier: GPL-3.0-or-later
!> Size of a job, known before it runs: unknowns, matrix, factors of the linear solver, and memory.
module dd3_report_job_size
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : i8, wp
  use dd3_base_machine_memory, only : available_memory, resident_memory
  use dd3_base_text, only : newline, to_text
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_solver_registry, only : new_linear_solver
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_system_system, only : new_stiffness_pattern
  implicit none
  private
  public :: job_size_t, find_job_size, size_report, memory_warning

  !> Bytes of a real and of an integer.
  real(wp), parameter :: real_bytes = 8.0_wp, integer_bytes = 4.0_wp
  real(wp), parameter :: megabyte = 1.0e6_wp
  !> Blocks in a row of the matrix: at least as many on average on every sheet.
  integer, parameter :: least_blocks = 8
  !> Memory that BLAS and HDF5 take in a run, bytes.
  real(wp), parameter :: libraries = 10.0e6_wp

  !> Size of a job.
  type :: job_size_t
    integer :: elements = 0, unknowns = 0
    !> Blocks of the matrix; 0 if there is no memory for it.
    integer :: blocks = 0
    !> Memory of the factors and of the whole program in the run, bytes; the factors are 0 if only
    !> the factorisation tells. Without a matrix the total is a lower bound.
    real(wp) :: factors = 0.0_wp, total = 0.0_wp
    !> Part of the total that does not grow with the number of elements, bytes.
    real(wp) :: fixed = 0.0_wp
  end type job_size_t

contains

  !> Find the size of a job by its symbolic factorisation, which is not made if there is too little
  !> memory for the rest. The memory of UMFPACK, where it stands in for a solver that fails, comes
  !> on top.
  subroutine find_job_size(self, model, state, options, solver, error)
    type(job_size_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> Initial state.
    type(state_t), intent(in) :: state
    type(solver_options_t), intent(in) :: options
    !> The solver, set up for the run; not allocated if there is too little memory for the rest.
    class(linear_solver_t), allocatable, intent(out) :: solver
    !> Set if the solver is unknown.
    type(error_t), allocatable, intent(out) :: error

    type(block_matrix_t) :: matrix
    real(wp) :: without_solver

    self%elements = model%n_element
    self%unknowns = 3*model%n_node
    self%fixed = resident_memory() + libraries
    without_solver = self%fixed + states_bytes(model, state) + element_bytes(model)
    self%total = without_solver + matrix_bytes(model, least_blocks*size(model%part%element))
    if (is_too_large(self)) return
    call new_stiffness_pattern(matrix, model)
    call new_linear_solver(solver, options, error)
    if (allocated(error)) return
    call solver%setup(matrix)
    self%unknowns = 3*matrix%n
    self%blocks = size(matrix%column)
    self%factors = solver%factor_bytes()
    self%total = without_solver + matrix_bytes(model, self%blocks) + solver%bytes()
  end subroutine find_job_size

  !> Return the memory of the matrix, and in the mixed formulation of the stiffness, bytes.
  pure real(wp) function matrix_bytes(model, blocks) result(bytes)
    type(model_t), intent(in) :: model
    integer, intent(in) :: blocks

    bytes = real(blocks, wp)*(9.0_wp*real_bytes + integer_bytes)
    if (any(model%phase%mixed)) bytes = 2.0_wp*bytes
  end function matrix_bytes

  !> Return the memory of the states of a run beside the initial one, which becomes the committed
  !> one, bytes: trial, and that in which the work at the start of a phase is evaluated.
  pure real(wp) function states_bytes(model, state) result(bytes)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    !> Reals of a point besides the internal variables, of a node and of a candidate.
    real(wp), parameter :: per_point = 6.0_wp + 9.0_wp + 1.5_wp, per_node = 15.0_wp, &
        per_candidate = 12.0_wp

    bytes = real_bytes*((per_point + real(model%n_internal, wp))*points(model) &
        + per_node*real(model%n_node, wp) + per_candidate*real(model%n_contact, wp)) &
        + real(storage_size(state%contact%hint)/8, wp)*real(size(state%contact%hint, kind=i8), wp)
    bytes = 2.0_wp*bytes
  end function states_bytes

  !> Return the memory of what the elements hold for the linear system and the prediction, bytes.
  pure real(wp) function element_bytes(model) result(bytes)
    type(model_t), intent(in) :: model

    !> Reals of a point: tangent; strain, rotation and plastic flag of the prediction; a field.
    real(wp), parameter :: per_point = 36.0_wp + 7.5_wp + 6.0_wp

    associate (n => real(model%element%n_node, wp), m => real(model%element%n_enhanced, wp))
      bytes = real_bytes*per_point*points(model) &
          + real(size(model%part%element), wp) &
          *(integer_bytes*n**2 + real_bytes*m*(3.0_wp*n + 4.0_wp))
    end associate
  end function element_bytes

  !> Return the number of integration points of this rank.
  pure real(wp) function points(model)
    type(model_t), intent(in) :: model

    points = real(model%element%n_point, wp)*real(size(model%part%element), wp)
  end function points

  !> Return the memory of a run whose mesh is refined, bytes: while it is, the sheet before and
  !> after are held with their states. Runs of 600 to 2,500 elements took 0.8 to 1.0 of it.
  pure real(wp) function refined_bytes(self, elements) result(bytes)
    type(job_size_t), intent(in) :: self
    !> Largest number of elements.
    integer, intent(in) :: elements

    bytes = self%total
    if (elements > self%elements) bytes = self%fixed &
        + 2.0_wp*(self%total - self%fixed)*real(elements, wp)/real(self%elements, wp)
  end function refined_bytes

  !> Return the size as text for the user.
  function size_report(self, most_elements) result(text)
    type(job_size_t), intent(in) :: self
    !> Number of elements of a mesh that is refined, at the end of the forming; 0 for another one.
    integer, intent(in), optional :: most_elements
    character(len=:), allocatable :: text

    text = "size: "//to_text(self%elements)//" elements, "//to_text(self%unknowns)//" unknowns"
    if (self%blocks == 0) then
      text = text//newline//"memory: more than "//to_text(nint(self%total/megabyte))//" MB"//newline
      return
    end if
    text = text//"; matrix of "//to_text(9.0_wp*real(self%blocks, wp)/1.0e6_wp, 3)// &
        " million entries, "
    if (self%factors > 0.0_wp) then
      text = text//"factors "// &
          to_text(self%factors/real_bytes/(9.0_wp*real(self%blocks, wp)), 3)//" times as many"
    else
      text = text//"factors not known before the factorisation"
    end if
    text = text//newline//"memory: about "//to_text(nint(self%total/megabyte))//" MB"
    if (self%factors > 0.0_wp) then
      text = text//", of which factors "//to_text(nint(self%factors/megabyte))//" MB"
    else
      text = text//" without factors"
    end if
    if (present(most_elements)) then
      if (most_elements > self%elements) text = text//"; at the end of the forming about "// &
          to_text(nint(refined_bytes(self, most_elements)/megabyte))//" MB"
    end if
    text = text//newline
  end function size_report

  !> Return a warning if the job needs more memory than the machine has left; empty otherwise.
  function memory_warning(self, most_elements) result(text)
    type(job_size_t), intent(in) :: self
    !> As above.
    integer, intent(in), optional :: most_elements
    character(len=:), allocatable :: text

    type(job_size_t) :: largest

    text = ""
    largest = self
    if (present(most_elements)) largest%total = refined_bytes(self, most_elements)
    if (.not. is_too_large(largest)) return
    text = "the job needs about "//to_text(nint(largest%total/megabyte))//" MB of memory, "// &
        "the machine has "//to_text(nint(available_memory()/megabyte))//" MB left: it would be "// &
        "slow or be ended by the system; a mesh with fewer elements needs less"
  end function memory_warning

  !> Whether the job needs more memory than the machine has left.
  logical function is_too_large(self)
    type(job_size_t), intent(in) :: self

    real(wp) :: available

    available = available_memory()
    is_too_large = available > 0.0_wp
    if (is_too_large) is_too_large = self%total > available + resident_memory()
  end function is_too_large

end module dd3_report_job_size
