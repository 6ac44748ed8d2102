!> The system of equations of a job: matrices on fixed patterns, work arrays, the linear solver and
!> the profile.
module dd3_system_system
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : profile_t
  use dd3_base_error, only : error_t
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern, find_positions
  use dd3_linalg_solver, only : linear_solver_t, solver_options_t
  use dd3_linalg_solver_registry, only : new_linear_solver
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_model_model, only : model_t
  use dd3_system_contact, only : contact_work_t, new_contact_work
  use dd3_system_reduced, only : linear_problem_t, new_linear_problem
  implicit none
  private
  public :: system_t, new_system

  !> Elements for each thread below which the threads wait for one another longer than they work.
  integer, parameter :: least_elements = 128
  !> Elements in a block that one thread takes at a time.
  integer, parameter :: block_size = 32

  !> Everything the assembly and the solution work on.
  type :: system_t
    !> Stiffness of the sheet, and the reduced matrix on the same pattern.
    type(block_matrix_t) :: stiffness, reduced
    !> Where the blocks of an element go, `(n_element_node, n_element_node, n_element)`: row node,
    !> column node.
    integer, allocatable :: position(:, :, :)
    !> Tangent of the material at the points, MPa, Kelvin, material frame, `(6, 6, n_point,
    !> n_element)`.
    real(wp), allocatable :: tangent(:, :, :, :)
    !> Workspaces of the element kernels, one for each thread.
    type(element_work_t), allocatable :: element(:)
    !> Number of threads, and whether the sheet has enough elements for more than one to pay.
    integer :: threads = 1
    !> See above.
    logical :: parallel = .false.
    !> Blocks of consecutive elements, `(n_block + 1)`: where each begins, and the end of the last.
    integer, allocatable :: block_start(:)
    !> Blocks sorted by colour; blocks of one colour share no node, `(n_block)`.
    integer, allocatable :: coloured_block(:)
    !> Where each colour begins among them, `(n_colour + 1)`.
    integer, allocatable :: colour_start(:)
    !> Contact operators of the candidates.
    type(contact_work_t) :: contact
    !> Right-hand sides and solution.
    type(linear_problem_t) :: problem
    !> The linear solver.
    class(linear_solver_t), allocatable :: solver
    !> Where the time goes.
    type(profile_t) :: profile
  end type system_t

contains

  !> Builds the patterns, allocates the work arrays and sets up the solver.
  subroutine new_system(self, model, options, threads, error)
    !> The system made.
    type(system_t), intent(out) :: self
    !> The model.
    type(model_t), intent(in) :: model
    !> Which solver, and its settings.
    type(solver_options_t), intent(in) :: options
    !> Number of threads.
    integer, intent(in) :: threads
    !> Set where the solver is not known.
    type(error_t), allocatable, intent(out) :: error

    integer, allocatable :: first(:), coupled(:)
    integer :: i

    call coupled_nodes(model, first, coupled)
    call new_pattern(self%stiffness, model%n_node, model%connectivity, first, coupled)
    call find_positions(self%stiffness, model%connectivity, self%position)
    self%stiffness%value(:, :, :) = 0.0_wp
    self%reduced = self%stiffness
    allocate (self%tangent(6, 6, model%element%n_point, model%n_element), source=0.0_wp)
    self%threads = threads
    self%parallel = threads > 1 .and. model%n_element >= least_elements*threads
    call colour_blocks(self, model)
    allocate (self%element(threads))
    do i = 1, threads
      call new_element_work(self%element(i), model%element)
    end do
    call new_contact_work(self%contact, model%n_contact)
    call new_linear_problem(self%problem, model, self%stiffness%n)
    call new_linear_solver(self%solver, options, error)
    if (.not. allocated(error)) call self%solver%setup(self%reduced)
  end subroutine new_system

  !> Colours the blocks of elements, greedily in their order, so that blocks of one colour share no
  !> node: two colours for a mesh numbered section by section.
  subroutine colour_blocks(self, model)
    !> Gets the blocks and their colours.
    type(system_t), intent(inout) :: self
    !> The model.
    type(model_t), intent(in) :: model

    logical, allocatable :: left(:), taken(:)
    integer :: i, n, n_block

    n_block = (model%n_element + block_size - 1)/block_size
    self%block_start = [(min(1 + i*block_size, model%n_element + 1), i=0, n_block)]
    allocate (self%coloured_block(n_block), left(n_block), taken(model%n_node))
    left = .true.
    self%colour_start = [1]
    n = 0
    do while (any(left))
      taken = .false.
      do i = 1, n_block
        if (.not. left(i)) cycle
        associate (nodes => model%connectivity(:, self%block_start(i):self%block_start(i + 1) - 1))
          if (any(taken(reshape(nodes, [size(nodes)])))) cycle
          taken(reshape(nodes, [size(nodes)])) = .true.
        end associate
        left(i) = .false.
        n = n + 1
        self%coloured_block(n) = i
      end do
      self%colour_start = [self%colour_start, n + 1]
    end do
  end subroutine colour_blocks

  !> Nodes each pressed tool's row couples with: its candidates and their neighbours.
  subroutine coupled_nodes(model, first, coupled)
    !> The model.
    type(model_t), intent(in) :: model
    !> Start of each tool's nodes in `coupled`, `(n_pressed + 1)`.
    integer, allocatable, intent(out) :: first(:)
    !> The nodes, growing within a tool.
    integer, allocatable, intent(out) :: coupled(:)

    logical, allocatable :: member(:), near(:)
    integer :: tool, e, n, i

    allocate (member(model%n_node), near(model%n_node))
    first = [1]
    coupled = [integer ::]
    do tool = 1, model%n_tool
      if (model%tool_block(tool) == 0) cycle
      member = .false.
      member(pack(model%contact_node, model%candidate(tool, :))) = .true.
      near = .false.
      do e = 1, model%n_element
        if (any(member(model%connectivity(:, e)))) near(model%connectivity(:, e)) = .true.
      end do
      n = size(coupled)
      coupled = [coupled, pack([(i, i=1, model%n_node)], near)]
      first = [first, first(size(first)) + size(coupled) - n]
    end do
  end subroutine coupled_nodes

end module dd3_system_system
