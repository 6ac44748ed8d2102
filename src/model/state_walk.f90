! SPDX-License-Identifier: GPL-3.0-or-later
!> Walk over the components of a state: `visit_state` passes every component with its name to a
!> visitor. Restart (output/restart.f90) and the tests are visitors, so that a component is named in
!> one place only.
module dd3_model_state_walk
  use dd3_base_kinds, only : wp
  use dd3_model_part, only : of_elements, of_points
  use dd3_model_state, only : phase_start_t, state_t
  use dd3_tools_closest, only : hint_t
  implicit none
  private
  public :: state_visitor_t, visit_state

  !> Operation on the components of a state; it can change them.
  type, abstract :: state_visitor_t
  contains
    procedure(visit_reals_interface), deferred :: reals
    procedure(visit_integers_interface), deferred :: integers
    !> Components that hold values of the elements, or of the contact points, of this rank; these
    !> are consecutive.
    procedure :: reals_of_items
    procedure :: integers_of_items
    procedure, private :: logicals
    procedure, private :: logicals_of_items
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
      call visitor%reals_of_items(of_elements, "stress", 6*n_point, n, state%stress)
      call visitor%reals_of_items(of_elements, "internal_variables", n_variable*n_point, n, &
          state%internal_variables)
      call visitor%reals_of_items(of_elements, "orientation", 9*n_point, n, state%orientation)
      call visitor%reals_of_items(of_elements, "enhanced", size(state%enhanced, 1), n, &
          state%enhanced)
      call visitor%logicals_of_items(of_elements, "plastic", n_point, n, state%plastic)
    end associate
    associate (n => size(state%status))
      call visitor%reals_of_items(of_points, "lambda", 3, n, state%lambda)
      call visitor%integers_of_items(of_points, "status", 1, n, state%status)
      call visitor%integers_of_items(of_points, "contact_tool", 1, n, state%contact_tool)
      call visitor%reals_of_items(of_points, "place", 1, n, state%place)
      call visit_hints("hint", size(state%hint, 1), n, state%hint, visitor)
      call visitor%reals_of_items(of_points, "slip_path", 1, n, state%slip_path)
    end associate
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
    call visitor%one_logical("open", state%open)
    call visitor%reals("largest_depth", size(state%largest_depth), state%largest_depth)
    call visitor%integers("deepest_face", size(state%deepest_face), state%deepest_face)
    call visitor%reals("deepest_radius", size(state%deepest_radius), state%deepest_radius)
    call visitor%integers("open_edge", size(state%open_edge), state%open_edge)
    call visitor%reals("open_edge_displacement", size(state%open_edge_displacement), &
        state%open_edge_displacement)
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
    call visitor%one_real("damping_work", state%damping_work)
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
    call visitor%reals_of_items(of_points, "start_held_offset", 1, size(start%held_offset), &
        start%held_offset)
    call visitor%reals("start_load", size(start%load), start%load)
    call visitor%reals("start_load_end", size(start%load_end), start%load_end)
    call visitor%reals("start_pressure", size(start%pressure), start%pressure)
    call visitor%reals("start_pressure_end", size(start%pressure_end), start%pressure_end)
    call visitor%reals("start_x", size(start%x), start%x)
    call visitor%reals("start_fading", size(start%fading), start%fading)
    call visitor%reals("start_laying", size(start%laying), start%laying)
    call visitor%reals_of_items(of_elements, "start_plastic_strain", &
        size(start%plastic_strain, 1), size(start%plastic_strain, 2), start%plastic_strain)
    call visitor%one_real("start_elastic_energy", start%elastic_energy)
    call visitor%one_real("start_damping_work", start%damping_work)
    call visitor%one_logical("start_fading_turns", start%fading_turns)
    call visitor%one_logical("start_until_from_below", start%until_from_below)
  end subroutine visit_phase_start

  !> Pass every component of the closest points to a visitor.
  subroutine visit_hints(name, n_tool, n, hint, visitor)
    character(len=*), intent(in) :: name
    integer, intent(in) :: n_tool, n
    type(hint_t), intent(inout) :: hint(n_tool, n)
    class(state_visitor_t), intent(inout) :: visitor

    real(wp), allocatable :: anchor(:, :, :), u(:, :), v(:, :), clearance(:, :)
    integer, allocatable :: patch(:, :)
    logical, allocatable :: due(:, :)
    integer :: i, t

    patch = hint%patch
    u = hint%u
    v = hint%v
    due = hint%due
    clearance = hint%clearance
    allocate (anchor(3, n_tool, n))
    do i = 1, n
      do t = 1, n_tool
        anchor(:, t, i) = hint(t, i)%anchor
      end do
    end do
    call visitor%integers_of_items(of_points, name//"_patch", n_tool, n, patch)
    call visitor%reals_of_items(of_points, name//"_u", n_tool, n, u)
    call visitor%reals_of_items(of_points, name//"_v", n_tool, n, v)
    call visitor%logicals_of_items(of_points, name//"_due", n_tool, n, due)
    call visitor%reals_of_items(of_points, name//"_anchor", 3*n_tool, n, anchor)
    call visitor%reals_of_items(of_points, name//"_clearance", n_tool, n, clearance)
    do i = 1, n
      do t = 1, n_tool
        hint(t, i) = hint_t(patch=patch(t, i), u=u(t, i), v=v(t, i), due=due(t, i), &
            anchor=anchor(:, t, i), clearance=clearance(t, i))
      end do
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

  !> Visit real numbers of elements or contact points as any others.
  subroutine reals_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    real(wp), intent(inout) :: values(n, n_item)

    if (item > 0) call self%reals(name, size(values), values)
  end subroutine reals_of_items

  !> Visit integers of elements or contact points as any others.
  subroutine integers_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    integer, intent(inout) :: values(n, n_item)

    if (item > 0) call self%integers(name, size(values), values)
  end subroutine integers_of_items

  !> Visit logical values of elements or contact points as integers 0 and 1.
  subroutine logicals_of_items(self, item, name, n, n_item, values)
    class(state_visitor_t), intent(inout) :: self
    !> `of_elements` or `of_points`.
    integer, intent(in) :: item
    character(len=*), intent(in) :: name
    !> Number of values of an item, and of the items.
    integer, intent(in) :: n, n_item
    logical, intent(inout) :: values(n, n_item)

    integer, allocatable :: number(:, :)

    number = merge(1, 0, values)
    call self%integers_of_items(item, name, n, n_item, number)
    values = number /= 0
  end subroutine logicals_of_items

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
