! SPDX-License-Identifier: GPL-3.0-or-later
!> Phase of the process as in the input, with all names resolved: tools moved and pressed, nodes
!> displaced and loaded, early end. It never changes in a run.
module dd3_model_phase
  use dd3_base_kinds, only : wp
  use dd3_model_motions, only : motion_t
  use dd3_model_tolerances, only : tangential
  use dd3_model_tilt, only : tilt_t
  use dd3_model_turn, only : turn_t
  use dd3_settings_limits, only : limits_spec_t
  use dd3_settings_newton, only : newton_spec_t
  use dd3_settings_until, only : until_spec_t
  implicit none
  private
  public :: phase_t, is_normal_held, is_slip_prescribed

  !> Progress by which two places in a phase differ.
  real(wp), parameter :: step = 1.0e-9_wp

  !> Phase in which all displacements and loads are linear in the progress, 0 to 1, but for those
  !> with a table.
  type :: phase_t
    character(len=:), allocatable :: name
    !> Controlling tool; 0 if loads control.
    integer :: control = 0
    !> Trial increment as a fraction of the phase.
    real(wp) :: trial = 0.0_wp
    !> Path of the controlling tool over the phase, mm; 0 if loads control.
    real(wp) :: length = 0.0_wp
    !> Displacement of the tools over the phase, `(3, n_tool)`, mm.
    real(wp), allocatable :: move(:, :)
    !> Turns of the tools, `(n_tool)`.
    type(turn_t), allocatable :: turn(:)
    !> Other tool, from which a tool has a gap at the end of the phase, 0 for none, and z of their
    !> relative displacement there, mm, `(n_tool)`.
    integer, allocatable :: gap_other(:)
    real(wp), allocatable :: gap_offset(:)
    !> Tools under a prescribed force, which move freely along their lines, `(n_tool)`.
    logical, allocatable :: pressed(:)
    !> Tilt of the tools, of those that are pressed, `(n_tool)`.
    type(tilt_t), allocatable :: tilt(:)
    !> Force on the pressed tools at the end of the phase, `(3, n_tool)`, N; without meaning for
    !> those whose force the phase leaves unchanged, `(n_tool)`.
    real(wp), allocatable :: tool_load_end(:, :)
    logical, allocatable :: keeps_tool_load(:)
    !> Unit vector along the line of motion of a pressed or moved tool, `(3, n_tool)`.
    real(wp), allocatable :: direction(:, :)
    !> Tools with contact, `(n_tool)`, and those among them that the phase withdraws: their contact is
    !> kept while they move away, and they have none afterwards.
    logical, allocatable :: active(:), withdrawn(:)
    !> Whether a withdrawn tool goes back to its place after the phase, as the input gives no path.
    logical, allocatable :: goes_back(:)
    !> Progress at which withdrawn tools begin to move; up to then loads and lost constraints reach
    !> their final values between closed tools. 0: all change over the whole phase.
    real(wp) :: opening = 0.0_wp
    !> Whether the phase sets gravity.
    logical :: has_gravity = .false.
    !> Whether this phase or an earlier one unloads the sheet, and no tool acts.
    logical :: unloaded = .false.
    !> Degrees of freedom with prescribed displacement, supports included, `(3, n_node)`.
    logical, allocatable :: prescribed(:, :)
    !> Supports chosen against free rigid motions of an unloaded sheet, in columns of node and axis,
    !> `(2, n)`. They are prescribed too, or springs while tools are withdrawn, between which the
    !> sheet floats.
    integer, allocatable :: support(:, :)
    logical :: floats = .false.
    !> Prescribed displacement over the phase, `(3, n_node)`, mm.
    real(wp), allocatable :: displacement(:, :)
    !> Directions that an earlier phase displaced and this one holds, as text: `x of 'tip', ...`.
    character(len=:), allocatable :: kept_displacements
    !> Total forces on the sets with loads at the end of the phase, `(3, n_load)`, N; without
    !> meaning for those whose load the phase leaves unchanged, `(n_load)`.
    real(wp), allocatable :: load_end(:, :)
    logical, allocatable :: keeps_load(:)
    !> Rotations and bends of node sets.
    type(motion_t), allocatable :: motion(:)
    !> Pressures at the end of the phase, `(n_pressure)`, MPa; without meaning for those that the
    !> phase leaves unchanged, `(n_pressure)`.
    real(wp), allocatable :: pressure_end(:)
    logical, allocatable :: keeps_pressure(:)
    !> Draw-beads that act, those that did not in the phase before, and those that leave with the
    !> withdrawn tools, `(n_bead)`.
    logical, allocatable :: bead_active(:), bead_new(:), bead_leaves(:)
    !> Progress and the factor on displacements, motions, loads and pressures there, `(2, n)`; not
    !> allocated if the factor is the progress.
    real(wp), allocatable :: table(:, :)
    !> The same for the factors on the displacements and on the angles of the tools.
    real(wp), allocatable :: move_table(:, :), turn_table(:, :)
    !> Progress, and the factors on the forces of the start and of `press` there, for the tools that
    !> this phase presses, `(3, n)`; not allocated if the forces vary linearly.
    real(wp), allocatable :: press_table(:, :)
    !> Early end.
    type(until_spec_t) :: until
    type(limits_spec_t) :: limits
    type(newton_spec_t) :: newton
    !> Whether the formulation of the contact is the mixed one.
    logical :: mixed = .false.
    !> Height of the contact layer over the thickness; 0 in the mixed formulation.
    real(wp) :: layer = 0.0_wp
    !> Penalty of the mixed formulation, N/mm; 0 for the automatic one.
    real(wp) :: penalty = 0.0_wp
    !> Distance up to which a tool's surface is looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  contains
    procedure :: factor
    procedure :: slope
    procedure :: move_slope
    procedure :: turns
    procedure :: tilts
    procedure :: turn_factor
    procedure :: turn_slope
    procedure :: tool_motion
    procedure :: tool_rate
    procedure :: acts
    procedure :: held
    procedure :: fading
    procedure :: fading_rate
    procedure :: opened
    procedure :: most_opened
    procedure :: tool_load
    procedure :: tool_load_rate
    procedure :: next_kink
  end type phase_t

contains

  !> Whether the prescribed displacements of a node hold it along a normal.
  pure logical function is_normal_held(phase, node, normal)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: node
    real(wp), intent(in) :: normal(3)

    is_normal_held = norm2(merge(0.0_wp, normal, phase%prescribed(:, node))) <= tangential
  end function is_normal_held

  !> Whether the prescribed displacements of a node make it slip over a tool. A smaller slip is
  !> round-off of positions and turns.
  pure logical function is_slip_prescribed(phase, node, normal, slip)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: node
    !> Of the tool, and displacement of the node relative to it, mm.
    real(wp), intent(in) :: normal(3), slip(3)

    real(wp), parameter :: least_slip = 1.0e-9_wp
    real(wp) :: prescribed(3)

    prescribed = merge(slip, 0.0_wp, phase%prescribed(:, node))
    is_slip_prescribed = norm2(prescribed - dot_product(normal, prescribed)*normal) > least_slip
  end function is_slip_prescribed

  !> Return the factor on displacements and loads at a progress.
  pure real(wp) function factor(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    factor = table_value(self%table, progress)
    if (self%opening > 0.0_wp) factor = min(1.0_wp, progress/self%opening)
  end function factor

  !> Return the derivative of the factor behind a progress.
  pure real(wp) function slope(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    slope = table_slope(self%table, progress)
    if (self%opening > 0.0_wp) slope = self%fading_rate(progress)
  end function slope

  !> Return the fraction of the forces of lost constraints that is left at a progress.
  pure real(wp) function fading(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    fading = 1.0_wp - progress
    if (self%opening > 0.0_wp) fading = max(0.0_wp, 1.0_wp - progress/self%opening)
  end function fading

  !> Return the negative derivative of `fading` behind a progress.
  pure real(wp) function fading_rate(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    fading_rate = 1.0_wp
    if (self%opening > 0.0_wp) &
        fading_rate = merge(1.0_wp/self%opening, 0.0_wp, progress < self%opening - step)
  end function fading_rate

  !> Return the distance by which a withdrawn tool has moved at a progress, mm; 0 for others.
  elemental real(wp) function opened(self, tool, progress)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool
    real(wp), intent(in) :: progress

    opened = 0.0_wp
    if (self%withdrawn(tool)) opened = max(0.0_wp, progress - self%opening) &
        /(1.0_wp - self%opening)*norm2(self%move(:, tool))
  end function opened

  !> Return the largest of the distances by which withdrawn tools have moved at a progress, mm.
  pure real(wp) function most_opened(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    integer :: t

    most_opened = maxval([0.0_wp, (self%opened(t, progress), t=1, size(self%withdrawn))])
  end function most_opened

  !> Return the directions that prescribed displacements and chosen supports hold, `(3, n_node)`.
  pure function held(self)
    class(phase_t), intent(in) :: self
    logical, allocatable :: held(:, :)

    integer :: k

    held = self%prescribed
    do k = 1, size(self%support, 2)
      held(self%support(2, k), self%support(1, k)) = .true.
    end do
  end function held

  !> Whether a tool has contact in the phase and after it.
  elemental logical function acts(self, tool)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool

    acts = self%active(tool) .and. .not. self%withdrawn(tool)
  end function acts

  !> Return the derivative of the factor on the displacements of the tools behind a progress.
  pure real(wp) function move_slope(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    move_slope = table_slope(self%move_table, progress)
  end function move_slope

  !> Whether a tool turns.
  pure logical function turns(self, tool)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool

    turns = abs(self%turn(tool)%angle) > 0.0_wp
  end function turns

  !> Whether a tool is pressed and tilts.
  pure logical function tilts(self, tool)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool

    tilts = self%pressed(tool) .and. self%tilt(tool)%free
  end function tilts

  !> Return the factor on the angles of the tools at a progress.
  pure real(wp) function turn_factor(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    turn_factor = table_value(self%turn_table, progress)
  end function turn_factor

  !> Return the derivative of the factor on the angles of the tools behind a progress.
  pure real(wp) function turn_slope(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    turn_slope = table_slope(self%turn_table, progress)
  end function turn_slope

  !> Return the factor of a table at a progress; the progress if there is no table.
  pure real(wp) function table_value(table, progress) result(factor)
    !> Progress and factor, `(2, n)`.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    integer :: i

    factor = progress
    if (.not. allocated(table)) return
    i = interval(table(1, :), progress)
    associate (x => table(1, i:i + 1), y => table(2, i:i + 1))
      factor = y(1) + (y(2) - y(1))*((progress - x(1))/(x(2) - x(1)))
    end associate
  end function table_value

  !> Return the derivative of the factor of a table behind a progress; 1 if there is no table.
  pure real(wp) function table_slope(table, progress) result(slope)
    !> Progress and factor, `(2, n)`.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    integer :: i

    slope = 1.0_wp
    if (.not. allocated(table)) return
    i = interval(table(1, :), progress + step)
    slope = (table(2, i + 1) - table(2, i))/(table(1, i + 1) - table(1, i))
  end function table_slope

  !> Return the displacement of a tool that is not pressed over the phase, mm.
  pure function tool_motion(self, tool, start) result(motion)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool
    !> Displacements of the tools at the start of the phase, `(3, n_tool)`, mm.
    real(wp), intent(in) :: start(:, :)
    real(wp) :: motion(3)

    motion = self%move(:, tool)
    associate (other => self%gap_other(tool))
      if (other > 0) motion(3) = self%gap_offset(tool) + start(3, other) + self%move(3, other) &
          - start(3, tool)
    end associate
  end function tool_motion

  !> Return the displacement of a tool that is not pressed by the progress, behind a progress, mm.
  pure function tool_rate(self, tool, progress, start) result(rate)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool
    real(wp), intent(in) :: progress
    !> Displacements of the tools at the start of the phase, `(3, n_tool)`, mm.
    real(wp), intent(in) :: start(:, :)
    real(wp) :: rate(3)

    if (self%withdrawn(tool)) then
      rate = 0.0_wp
      if (progress >= self%opening - step) rate = self%move(:, tool)/(1.0_wp - self%opening)
    else
      rate = self%move_slope(progress)*self%tool_motion(tool, start)
    end if
  end function tool_rate

  !> Return the force pressed on a tool at a progress, N.
  pure function tool_load(self, tool, progress, start, end) result(load)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool
    real(wp), intent(in) :: progress
    !> Forces at the start of the phase and of `press`, N.
    real(wp), intent(in) :: start(3), end(3)
    real(wp) :: load(3)

    real(wp) :: factor(2)
    integer :: i

    if (.not. allocated(self%press_table) .or. self%keeps_tool_load(tool)) then
      load = start + progress*(end - start)
      return
    end if
    i = interval(self%press_table(1, :), progress)
    associate (from => self%press_table(:, i), to => self%press_table(:, i + 1))
      factor = from(2:) + (to(2:) - from(2:))*((progress - from(1))/(to(1) - from(1)))
    end associate
    load = factor(1)*start + factor(2)*end
  end function tool_load

  !> Return the derivative of the force pressed on a tool behind a progress, N.
  pure function tool_load_rate(self, tool, progress, start, end) result(rate)
    class(phase_t), intent(in) :: self
    integer, intent(in) :: tool
    real(wp), intent(in) :: progress
    !> As for `tool_load`.
    real(wp), intent(in) :: start(3), end(3)
    real(wp) :: rate(3)

    integer :: i

    rate = end - start
    if (.not. allocated(self%press_table) .or. self%keeps_tool_load(tool)) return
    i = interval(self%press_table(1, :), progress + step)
    associate (from => self%press_table(:, i), to => self%press_table(:, i + 1))
      rate = ((to(2) - from(2))*start + (to(3) - from(3))*end)/(to(1) - from(1))
    end associate
  end function tool_load_rate

  !> Return the next place of the tables behind a progress; 1 without a table.
  pure real(wp) function next_kink(self, progress)
    class(phase_t), intent(in) :: self
    real(wp), intent(in) :: progress

    next_kink = min(next_place(self%table, progress), next_place(self%move_table, progress), &
        next_place(self%turn_table, progress), next_place(self%press_table, progress))
    if (progress < self%opening - step) next_kink = min(next_kink, self%opening)
  end function next_kink

  !> Return the next place of a table behind a progress; 1 without a table.
  pure real(wp) function next_place(table, progress)
    !> Progress in the first row.
    real(wp), allocatable, intent(in) :: table(:, :)
    real(wp), intent(in) :: progress

    next_place = 1.0_wp
    if (allocated(table)) next_place = table(1, interval(table(1, :), progress + step) + 1)
  end function next_place

  !> Return the number of the interval that holds a value.
  pure integer function interval(x, value) result(i)
    !> Ascending.
    real(wp), intent(in) :: x(:)
    real(wp), intent(in) :: value

    do i = 1, size(x) - 2
      if (value < x(i + 1)) return
    end do
  end function interval

end module dd3_model_phase
