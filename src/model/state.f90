!> What changes in a run. Two copies exist: the committed state (configuration N-1, equilibrated)
!> and the trial state (configuration N); acceptance and cut-back are one `state_copy` each.
module dd3_model_state
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : hint_t
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  implicit none
  private
  public :: state_t, new_state, state_copy, status_gap, status_stick, status_slip

  !> The state of a job at one configuration.
  type :: state_t
    !> Number of accepted increments so far.
    integer :: increment = 0
    !> Running phase, from 1.
    integer :: phase = 1
    !> Progress within the phase, 0 to 1.
    real(wp) :: progress = 0.0_wp
    !> Path of the controlling tools since the job's start, mm.
    real(wp) :: travel = 0.0_wp
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Internal forces, `(3, n_node)`, N.
    real(wp), allocatable :: internal_force(:, :)
    !> External forces, `(3, n_node)`, N: the loads, and what has not faded of released contacts.
    real(wp), allocatable :: external_force(:, :)
    !> Total forces on the sets with loads, `(3, n_load)`, N.
    real(wp), allocatable :: load(:, :)
    !> Push of the candidate nodes on released tools that has not faded yet, `(3, n_contact)`, N.
    real(wp), allocatable :: fading(:, :)
    !> The tool each candidate was released by last, `(n_contact)`; 0 for none.
    integer, allocatable :: fading_tool(:)
    !> Cauchy stress in the material frame, Kelvin, `(6, n_point, n_element)`, MPa.
    real(wp), allocatable :: stress(:, :, :)
    !> Internal variables of the material, `(n_internal, n_point, n_element)`; the first is the
    !> equivalent plastic strain.
    real(wp), allocatable :: internal(:, :, :)
    !> Orthotropy axes as columns in the global frame, `(3, 3, n_point, n_element)`.
    real(wp), allocatable :: orientation(:, :, :, :)
    !> Whether the last increment was plastic, `(n_point, n_element)`.
    logical, allocatable :: plastic(:, :)
    !> Contact forces of the candidate nodes (the sheet's push on the tool), `(3, n_contact)`, N.
    real(wp), allocatable :: lambda(:, :)
    !> Contact status, `(n_contact)`: one of the `status_*` values.
    integer, allocatable :: status(:)
    !> Tool each candidate belongs to at present, `(n_contact)`; 0 for none.
    integer, allocatable :: contact_tool(:)
    !> Where the closest point of each tool was found last, `(n_tool, n_contact)`.
    type(hint_t), allocatable :: hint(:, :)
    !> Displacement of the tools from where their files put them, `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_displacement(:, :)
    !> Force pressed on the tools from outside, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_load(:, :)
    !> Force of the sheet on the tools, that which fades included, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_force(:, :)
  end type state_t

contains

  !> Allocates a state and sets all to zero; no point is plastic, no node in contact.
  subroutine new_state(self, n_node, n_point, n_element, n_internal, n_contact, n_tool, n_load)
    !> The state made.
    type(state_t), intent(out) :: self
    !> Its sizes.
    integer, intent(in) :: n_node, n_point, n_element, n_internal, n_contact, n_tool, n_load

    allocate (self%x(3, n_node), self%internal_force(3, n_node), self%external_force(3, n_node))
    allocate (self%stress(6, n_point, n_element), self%internal(n_internal, n_point, n_element))
    allocate (self%orientation(3, 3, n_point, n_element), self%plastic(n_point, n_element))
    allocate (self%lambda(3, n_contact), self%status(n_contact), self%contact_tool(n_contact))
    allocate (self%hint(n_tool, n_contact))
    allocate (self%load(3, n_load), self%fading(3, n_contact), self%fading_tool(n_contact))
    allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), self%tool_force(3, &
        n_tool))
    self%x = 0.0_wp
    self%internal_force = 0.0_wp
    self%external_force = 0.0_wp
    self%load = 0.0_wp
    self%fading = 0.0_wp
    self%fading_tool = 0
    self%stress = 0.0_wp
    self%internal = 0.0_wp
    self%orientation = 0.0_wp
    self%plastic = .false.
    self%lambda = 0.0_wp
    self%status = 0
    self%contact_tool = 0
    self%tool_displacement = 0.0_wp
    self%tool_load = 0.0_wp
    self%tool_force = 0.0_wp
  end subroutine new_state

  !> Copies one state into another of the same sizes, without allocating.
  subroutine state_copy(from, to)
    !> The state copied.
    type(state_t), intent(in) :: from
    !> The copy.
    type(state_t), intent(inout) :: to

    to%increment = from%increment
    to%phase = from%phase
    to%progress = from%progress
    to%travel = from%travel
    to%x(:, :) = from%x
    to%internal_force(:, :) = from%internal_force
    to%external_force(:, :) = from%external_force
    to%load(:, :) = from%load
    to%fading(:, :) = from%fading
    to%fading_tool(:) = from%fading_tool
    to%stress(:, :, :) = from%stress
    to%internal(:, :, :) = from%internal
    to%orientation(:, :, :, :) = from%orientation
    to%plastic(:, :) = from%plastic
    to%lambda(:, :) = from%lambda
    to%status(:) = from%status
    to%contact_tool(:) = from%contact_tool
    to%hint(:, :) = from%hint
    to%tool_displacement(:, :) = from%tool_displacement
    to%tool_load(:, :) = from%tool_load
    to%tool_force(:, :) = from%tool_force
  end subroutine state_copy

end module dd3_model_state
