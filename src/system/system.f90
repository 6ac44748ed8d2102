! SPDX-License-Identifier: GPL-3.0-or-later
!> System of equations of a job: matrices on fixed patterns, work arrays, linear solver and profile.
module dd3_system_system
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : profile_t
  use dd3_base_error, only : error_t
  use dd3_base_ranks, only : n_ranks
  use dd3_base_threads, only : most_threads
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern, find_positions, keep_rows
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_solver_registry, only : new_linear_solver
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_model_model, only : model_t
  use dd3_system_contact_work, only : contact_work_t, new_contact_work
  use dd3_system_enhanced, only : enhanced_t, new_enhanced
  use dd3_system_formulation, only : formulation_t
  use dd3_system_partition, only : new_partition, partition_t, rows_held
  use dd3_system_linear_problem, only : linear_problem_t, new_linear_problem
  implicit none
  private
  public :: system_t, new_system, new_stiffness_pattern, set_elements

  !> Elements in a batch.
  integer, parameter :: batch_size = 8

  !> Elements of the system, in batches for the threads, coloured such that batches of one colour
  !> share no node.
  type :: batches_t
    !> Numbers in the part, batch by batch.
    integer, allocatable :: element(:)
    !> Position of the first element of each batch, and the end of the last one, `(n_batch + 1)`.
    integer, allocatable :: start(:)
    !> Batches sorted by colour, `(n_batch)`.
    integer, allocatable :: coloured(:)
    !> Position of the first batch of each colour, and the end of the last one, `(n_colour + 1)`.
    integer, allocatable :: colour_start(:)
  end type batches_t

  !> Data of assembly and solution.
  type :: system_t
    !> Matrix of the linear system, with the rows that this rank holds: sheet and terms add to it,
    !> the contact, the pressed tools and the supports complete it (`reduce`).
    type(block_matrix_t) :: matrix
    !> Sums of the squares in the columns of nodes of the last stiffness, over the rows of this
    !> rank, with those of the enhanced parameters, `(3, n_node)`, (N/mm)2.
    real(wp), allocatable :: column_square(:, :)
    type(partition_t) :: partition
    !> Position of the blocks of an element of the part in the matrix, `(n_element_node,
    !> n_element_node, n_element)`: row node, column node; 0 for elements that are not in the
    !> system.
    integer, allocatable :: position(:, :, :)
    !> Tangent of the material at the points, MPa, Kelvin, material frame, `(6, 6, n_point,
    !> n_element)`.
    real(wp), allocatable :: tangent(:, :, :, :)
    !> Workspaces of the element kernels, one per thread.
    type(element_work_t), allocatable :: element(:)
    type(batches_t) :: batches
    !> Condensation of the enhanced strains.
    type(enhanced_t), allocatable :: enhanced
    type(contact_work_t), allocatable :: contact
    !> That of the phase, once its contact is evaluated.
    class(formulation_t), allocatable :: formulation
    type(linear_problem_t) :: problem
    class(linear_solver_t), allocatable :: solver
    !> Time by section.
    type(profile_t) :: profile
  end type system_t

contains

  !> Build the patterns, allocate the work arrays and set up the solver, if it is not yet.
  subroutine new_system(self, model, options, error, solver)
    type(system_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(solver_options_t), intent(in) :: options
    !> Set if the solver is unknown.
    type(error_t), allocatable, intent(out) :: error
    !> Solver of these options, set up for the pattern of the stiffness; moved to the system.
    class(linear_solver_t), allocatable, intent(inout), optional :: solver

    integer :: i

    call new_stiffness_pattern(self%matrix, model)
    call new_partition(self%partition, model)
    call set_elements(self, model, [(i, i=1, size(model%part%element))])
    allocate (self%tangent(6, 6, model%element%n_point, size(model%part%element)), source=0.0_wp)
    ! The choice of threads may take fewer at present than later on.
    allocate (self%element(max(options%threads, most_threads())))
    do i = 1, size(self%element)
      associate (element => model%element)
        call new_element_work(self%element(i), element%n_node, element%n_point, element%n_group, &
            element%n_enhanced)
      end associate
    end do
    allocate (self%enhanced, self%contact)
    call new_enhanced(self%enhanced, model)
    call new_contact_work(self%contact, model%n_contact)
    allocate (self%column_square(3, model%n_node), source=0.0_wp)
    call new_linear_problem(self%problem, model, self%matrix%n)
    if (present(solver)) call move_alloc(solver, self%solver)
    if (allocated(self%solver)) return
    call new_linear_solver(self%solver, options, error)
    if (.not. allocated(error)) call self%solver%setup(self%matrix)
  end subroutine new_system

  !> Set the elements of a system, of which it has the matrix.
  subroutine set_elements(self, model, elements)
    type(system_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Numbers in the part.
    integer, intent(in) :: elements(:)

    integer, allocatable :: position(:, :, :)

    associate (m => model%element%n_node)
      allocate (self%position(m, m, size(model%part%element)), source=0)
    end associate
    call find_positions(self%matrix, model%connectivity(:, model%part%element(elements)), position)
    self%position(:, :, elements) = position
    call new_batches(self%batches, model, elements)
  end subroutine set_elements

  !> Colour the batches greedily in their order: two colours for a mesh numbered section by section.
  subroutine new_batches(self, model, elements)
    type(batches_t), intent(out) :: self
    type(model_t), intent(in) :: model
    integer, intent(in) :: elements(:)

    logical, allocatable :: left(:), taken(:)
    integer :: i, n, n_batch, n_element

    self%element = elements
    n_element = size(elements)
    n_batch = (n_element + batch_size - 1)/batch_size
    self%start = [(min(1 + i*batch_size, n_element + 1), i=0, n_batch)]
    allocate (self%coloured(n_batch), left(n_batch), taken(model%n_node))
    left = .true.
    self%colour_start = [1]
    n = 0
    do while (any(left))
      taken = .false.
      do i = 1, n_batch
        if (.not. left(i)) cycle
        associate (nodes => model%connectivity(:, &
            model%part%element(elements(self%start(i):self%start(i + 1) - 1))))
          if (any(taken(reshape(nodes, [size(nodes)])))) cycle
          taken(reshape(nodes, [size(nodes)])) = .true.
        end associate
        left(i) = .false.
        n = n + 1
        self%coloured(n) = i
      end do
      self%colour_start = [self%colour_start, n + 1]
    end do
  end subroutine new_batches

  !> Build the pattern of the stiffness, with the rows of the pressed tools: each couples with its
  !> candidates and their neighbours. Of several ranks each has the rows that it holds; the rows of
  !> the tools belong to the last rank, so that they come last: nearly all nodes are coupled with
  !> them, and an incomplete factorisation that began with them would be full.
  subroutine new_stiffness_pattern(stiffness, model, elements)
    type(block_matrix_t), intent(out) :: stiffness
    type(model_t), intent(in) :: model
    !> Elements of all ranks whose stiffness is in the matrix, which has the rows of all ranks then;
    !> all elements if not present.
    integer, intent(in), optional :: elements(:)

    logical, allocatable :: near(:)
    !> Coupled nodes, ascending within a tool, and the first of each tool among them.
    integer, allocatable :: coupled(:), first(:), connectivity(:, :)
    integer :: tool, e, i, last

    connectivity = model%coupling
    if (present(elements)) connectivity = model%coupling(:, elements)
    allocate (near(model%n_node))
    first = [1]
    coupled = [integer ::]
    do tool = 1, model%n_tool
      if (model%tool_row(tool) == 0) cycle
      near = .false.
      do e = 1, size(connectivity, 2)
        if (any(model%member(tool, connectivity(:, e)))) near(connectivity(:, e)) = .true.
      end do
      coupled = [coupled, pack([(i, i=1, model%n_node)], near)]
      first = [first, size(coupled) + 1]
    end do
    call new_pattern(stiffness, model%n_node, connectivity, first, coupled)
    if (present(elements) .or. .not. model%part%divided) return
    call keep_rows(stiffness, rows_held(model, stiffness%n))
    last = n_ranks() - 1
    stiffness%owner = [model%part%node_owner, (last, i=1, size(first) - 1)]
  end subroutine new_stiffness_pattern

end module dd3_system_system
