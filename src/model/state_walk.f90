! SPDX-License-Identifier: GPL-3.0-or-later
!> Walk over the components of a state: `visit_state` passes every component with its name to a
!> visitor. Restart (output/restart.f90) and the tests are visitors, so that a component is named in
!> one place only.
module dd3_model_state_walk
  use dd3_base_kinds, only : wp
  use dd3_contact_closest, only : hint_t
  use dd3_model_state, only : phase_start_t, state_t
  implicit none
  private
  public :: state_visitor_t, visit_state

  !> Operation on the components of a state; it can change them.
  type, abstract :: state_visitor_t
  contains
    procedure(visit_reals_interface), deferred :: reals
    procedure(visit_integers_interface), deferred :: integers
    !> Components that hold values of the elements of this rank; these are consecutive.
    procedure :: reals_of_elements
    procedure :: integers_of_elements
    procedure, private :: logicals
    procedure, private :: logicals_of_elements
    procedure, private :: one_real
    procedure, private :: one_integer
    procedure, private :: one_logical
  end type state_visitor_t

  abstract interface
    !> Visit a component of real numbers.
    subroutine visit_reals_interface(self, name, n, values)
      import :: state_visitor_t, wp
      class(state_visitor_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      !> The component in array element order.
      real(wp), intent(inout) :: values(n)
    end subroutine visit_reals_interface

    !> Visit a component of integers; logical components are passed as 0 and 1.
    subroutine visit_integers_interface(self, name, n, values)
      import :: state_visitor_t
      class(state_visitor_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: n
      !> The component in array element order.
      integer, intent(inout) :: values(n)
    end subroutine visit_integers_interface
  end interface

contains

  !> Pass every component of a state to a visitor, always in the same order.
  subroutine visit_state(state, visitor)
    type(state_t), intent(inout) :: state
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%one_integer("increment", state%increment)
    call visitor%one_integer("phase", state%phase)
    call visitor%one_logical("begun", state%begun)
    call visitor%one_real("progress", state%progress)
    call visitor%one_real("travel", state%travel)
    call visitor%one_real("r_cap", state%r_cap)
    call visitor%one_integer("history_increment", state%history_increment)
    call visitor%one_integer("fields_increment", state%fields_increment)
    call visitor%reals("x", size(state%x), state%x)
    call visitor%reals("internal_force", size(state%internal_force), state%internal_force)
    call visitor%reals("external_force", size(state%external_force), state%external_force)
    call visitor%reals("load", size(state%load), state%load)
    call visitor%reals("pressure", size(state%pressure), state%pressure)
    associate (n => size(state%plastic, 2), n_point => size(state%plastic, 1), &
        n_variable => size(state%internal_variables, 1))
      call visitor%reals_of_elements("stress", 6*n_point, n, state%stress)
      call visitor%reals_of_elements("internal_variables", n_variable*n_point, n, &
          state%internal_variables)
      call visitor%reals_of_elements("orientation", 9*n_point, n, state%orientation)
      call visitor%reals_of_elements("enhanced", size(state%enhanced, 1), n, state%enhanced)
      call visitor%logicals_of_elements("plastic", n_point, n, state%plastic)
    end associate
    call visitor%reals("lambda", size(state%lambda), state%lambda)
    call visitor%integers("status", size(state%status), state%status)
    call visitor%integers("contact_tool", size(state%contact_tool), state%contact_tool)
    call visit_hints("hint", size(state%hint), state%hint, visitor)
    call visitor%reals("fading", size(state%fading), state%fading)
    call visitor%integers("fading_tool", size(state%fading_tool), state%fading_tool)
    call visitor%reals("tool_displacement", size(state%tool_displacement), state%tool_displacement)
    call visitor%reals("tool_centre", size(state%tool_centre), state%tool_centre)
    call visitor%reals("tool_rotation", size(state%tool_rotation), state%tool_rotation)
    call visitor%reals("tool_angle", size(state%tool_angle), state%tool_angle)
    call visitor%reals("tool_load", size(state%tool_load), state%tool_load)
    call visitor%reals("tool_force", size(state%tool_force), state%tool_force)
    call visitor%reals("layer_offset", size(state%layer_offset), state%layer_offset)
    call visitor%logicals("touched", size(state%touched), state%touched)
    call visitor%reals("tool_depth", size(state%tool_depth), state%tool_depth)
    call visitor%reals("largest_depth", size(state%largest_depth), state%largest_depth)
    call visitor%integers("deepest_face", size(state%deepest_face), state%deepest_face)
    call visitor%reals("deepest_radius", size(state%deepest_radius), state%deepest_radius)
    call visitor%integers("open_edge", size(state%open_edge), state%open_edge)
    call visitor%reals("open_edge_displacement", size(state%open_edge_displacement), &
        state%open_edge_displacement)
    call visitor%reals("slip_path", size(state%slip_path), state%slip_path)
    call visitor%reals("bead_force", size(state%bead_force), state%bead_force)
    call visitor%reals("bead_path", size(state%bead_path), state%bead_path)
    call visitor%reals("bead_load", size(state%bead_load), state%bead_load)
    call visitor%reals("bead_total", size(state%bead_total), state%bead_total)
    call visitor%reals("bead_restraint", size(state%bead_restraint), state%bead_restraint)
    call visitor%reals("bead_length", size(state%bead_length), state%bead_length)
    call visitor%reals("bead_normal", size(state%bead_normal), state%bead_normal)
    call visitor%one_real("tool_work", state%tool_work)
    call visitor%one_real("external_work", state%external_work)
    call visitor%one_real("internal_work", state%internal_work)
    call visitor%one_real("plastic_work", state%plastic_work)
    call visitor%one_real("friction_work", state%friction_work)
    call visitor%one_real("bead_work", state%bead_work)
    call visit_phase_start(state%start, visitor)
  end subroutine visit_state

  !> Pass every component of the values at the start of a phase to a visitor.
  subroutine visit_phase_start(start, visitor)
    type(phase_start_t), intent(inout) :: start
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%reals("start_tool_displacement", size(start%tool_displacement), &
        start%tool_displacement)
    call visitor%reals("start_tool_rotation", size(start%tool_rotation), start%tool_rotation)
    call visitor%reals("start_tool_angle", size(start%tool_angle), start%tool_angle)
    call visitor%reals("start_tool_load", size(start%tool_load), start%tool_load)
    call visitor%reals("start_tool_load_end", size(start%tool_load_end), start%tool_load_end)
    call visitor%reals("start_layer_offset", size(start%layer_offset), start%layer_offset)
    call visitor%reals("start_held_offset", size(start%held_offset), start%held_offset)
    call visitor%reals("start_load", size(start%load), start%load)
    call visitor%reals("start_load_end", size(start%load_end), start%load_end)
    call visitor%reals("start_pressure", size(start%pressure), start%pressure)
    call visitor%reals("start_pressure_end", size(start%pressure_end), start%pressure_end)
    call visitor%reals("start_x", size(start%x), start%x)
    call visitor%reals("start_fading", size(start%fading), start%fading)
    call visitor%reals_of_elements("start_plastic_strain", size(start%plastic_strain, 1), &
        size(start%plastic_strain, 2), start%plastic_strain)
    call visitor%one_logical("start_until_from_below", start%until_from_below)
  end subroutine visit_phase_start

  !> Pass every component of the closest points to a visitor.
  subroutine visit_hints(name, n, hint, visitor)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    type(hint_t), intent(inout) :: hint(n)
    class(state_visitor_t), intent(inout) :: visitor

    real(wp), allocatable :: anchor(:, :), u(:), v(:), clearance(:)
    integer, allocatable :: patch(:)
    logical, allocatable :: due(:)
    integer :: i

    patch = hint%patch
    u = hint%u
    v = hint%v
    due = hint%due
    clearance = hint%clearance
    allocate (anchor(3, n))
    do i = 1, n
      anchor(:, i) = hint(i)%anchor
    end do
    call visitor%integers(name//"_patch", n, patch)
    call visitor%reals(name//"_u", n, u)
    call visitor%reals(name//"_v", n, v)
    call visitor%logicals(name//"_due", n, due)
    call visitor%reals(name//"_anchor", 3*n, anchor)
    call visitor%reals(name//"_clearance", n, clearance)
    do i = 1, n
      hint(i) = hint_t(patch=patch(i), u=u(i), v=v(i), due=due(i), anchor=anchor(:, i), &
          clearance=clearance(i))
    end do
  end subroutine visit_hints

  !> Visit a component of logical values as integers 0 and 1.
  subroutine logicals(self, name, n, values)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: n
    logical, intent(inout) :: values(n)

    integer, allocatable :: number(:)

    number = merge(1, 0, values)
    call self%integers(name, n, number)
    values = number /= 0
  end subroutine logicals

  !> Visit real numbers of the elements as any others.
  subroutine reals_of_elements(self, name, n, n_element, values)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Number of values of an element, and of the elements.
    integer, intent(in) :: n, n_element
    real(wp), intent(inout) :: values(n, n_element)

    call self%reals(name, size(values), values)
  end subroutine reals_of_elements

  !> Visit integers of the elements as any others.
  subroutine integers_of_elements(self, name, n, n_element, values)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Number of values of an element, and of the elements.
    integer, intent(in) :: n, n_element
    integer, intent(inout) :: values(n, n_element)

    call self%integers(name, size(values), values)
  end subroutine integers_of_elements

  !> Visit logical values of the elements as integers 0 and 1.
  subroutine logicals_of_elements(self, name, n, n_element, values)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    !> Number of values of an element, and of the elements.
    integer, intent(in) :: n, n_element
    logical, intent(inout) :: values(n, n_element)

    integer, allocatable :: number(:, :)

    number = merge(1, 0, values)
    call self%integers_of_elements(name, n, n_element, number)
    values = number /= 0
  end subroutine logicals_of_elements

  !> Visit a scalar.
  subroutine one_real(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(inout) :: value

    real(wp) :: values(1)

    values = value
    call self%reals(name, 1, values)
    value = values(1)
  end subroutine one_real

  !> Visit a scalar.
  subroutine one_integer(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(inout) :: value

    integer :: values(1)

    values = value
    call self%integers(name, 1, values)
    value = values(1)
  end subroutine one_integer

  !> Visit a scalar.
  subroutine one_logical(self, name, value)
    class(state_visitor_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(inout) :: value

    integer :: number

    number = merge(1, 0, value)
    call self%one_integer(name, number)
    value = number /= 0
  end subroutine one_logical

end module dd3_model_state_walk
