! SPDX-License-Identifier: GPL-3.0-or-later
!> What a phase does with the tools: moved, turned, pressed, withdrawn.
module dd3_model_phase_tools
  use dd3_base_kinds, only : wp
  use dd3_model_cushion, only : cushion_t, spacer_t
  use dd3_model_nodal_conditions, only : nodal_conditions_t
  use dd3_model_progress_table, only : interval, step, table_slope, table_value
  use dd3_model_tilt, only : tilt_t
  use dd3_model_turn, only : turn_t
  implicit none
  private
  public :: phase_tools_t

  !> Process of the tools in a phase. The conditions at nodes are inherited, as Fortran has one
  !> parent for a type.
  type, extends(nodal_conditions_t) :: phase_tools_t
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
    !> Cushions of the tools, `(n_tool)`, and spacers between them.
    type(cushion_t), allocatable :: cushion(:)
    type(spacer_t), allocatable :: spacer(:)
    !> Force on the pressed tools at the end of the phase, `(3, n_tool)`, N; without meaning for
    !> those whose force the phase leaves unchanged, `(n_tool)`.
    real(wp), allocatable :: tool_load_end(:, :)
    logical, allocatable :: keeps_tool_load(:)
    !> Unit vector along the line of motion of a pressed or moved tool, `(3, n_tool)`.
    real(wp), allocatable :: direction(:, :)
    !> Tools with contact, `(n_tool)`, and those among them that the phase withdraws: their contact
    !> is kept while they move away, and they have none afterwards.
    logical, allocatable :: active(:), withdrawn(:)
    !> Whether a withdrawn tool goes back to its place after the phase, as the input gives no path.
    logical, allocatable :: goes_back(:)
    !> Progress at which withdrawn tools begin to move; up to then loads and lost constraints reach
    !> their final values between closed tools. 0: all change over the whole phase.
    real(wp) :: opening = 0.0_wp
    !> Progress and the factors on the displacements and on the angles of the tools there, `(2, n)`;
    !> not allocated if the factor is the progress.
    real(wp), allocatable :: move_table(:, :), turn_table(:, :)
    !> Progress, and the factors on the forces of the start and of `press` there, for the tools that
    !> this phase presses, `(3, n)`; not allocated if the forces vary linearly.
    real(wp), allocatable :: press_table(:, :)
  contains
    procedure :: moves
    procedure :: turns
    procedure :: tilts
    procedure :: turn_factor
    procedure :: turn_slope
    procedure :: move_slope
    procedure :: tool_motion
    procedure :: tool_rate
    procedure :: acts
    procedure :: opened
    procedure :: most_opened
    procedure :: tool_load
    procedure :: tool_load_rate
  end type phase_tools_t

contains

  !> Whether a tool that is not pressed has a path: a displacement, a gap to another tool, an angle.
  pure logical function moves(self, tool)
    class(phase_tools_t), intent(in) :: self
    integer, intent(in) :: tool

    moves = norm2(self%move(:, tool)) > 0.0_wp .or. self%gap_other(tool) > 0 .or. self%turns(tool)
  end function moves

  !> Whether a tool turns.
  pure logical function turns(self, tool)
    class(phase_tools_t), intent(in) :: self
    integer, intent(in) :: tool

    turns = abs(self%turn(tool)%angle) > 0.0_wp
  end function turns

  !> Whether a tool is pressed and tilts.
  pure logical function tilts(self, tool)
    class(phase_tools_t), intent(in) :: self
    integer, intent(in) :: tool

    tilts = self%pressed(tool) .and. self%tilt(tool)%free
  end function tilts

  !> Return the factor on the angles of the tools at a progress.
  pure real(wp) function turn_factor(self, progress)
    class(phase_tools_t), intent(in) :: self
    real(wp), intent(in) :: progress

    turn_factor = table_value(self%turn_table, progress)
  end function turn_factor

  !> Return the derivative of the factor on the angles of the tools behind a progress.
  pure real(wp) function turn_slope(self, progress)
    class(phase_tools_t), intent(in) :: self
    real(wp), intent(in) :: progress

    turn_slope = table_slope(self%turn_table, progress)
  end function turn_slope

  !> Return the derivative of the factor on the displacements of the tools behind a progress.
  pure real(wp) function move_slope(self, progress)
    class(phase_tools_t), intent(in) :: self
    real(wp), intent(in) :: progress

    move_slope = table_slope(self%move_table, progress)
  end function move_slope

  !> Return the displacement of a tool that is not pressed over the phase, mm.
  pure function tool_motion(self, tool, start) result(motion)
    class(phase_tools_t), intent(in) :: self
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
    class(phase_tools_t), intent(in) :: self
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

  !> Whether a tool has contact in the phase and after it.
  elemental logical function acts(self, tool)
    class(phase_tools_t), intent(in) :: self
    integer, intent(in) :: tool

    acts = self%active(tool) .and. .not. self%withdrawn(tool)
  end function acts

  !> Return the distance by which a withdrawn tool has moved at a progress, mm; 0 for others.
  elemental real(wp) function opened(self, tool, progress)
    class(phase_tools_t), intent(in) :: self
    integer, intent(in) :: tool
    real(wp), intent(in) :: progress

    opened = 0.0_wp
    if (self%withdrawn(tool)) opened = max(0.0_wp, progress - self%opening) &
        /(1.0_wp - self%opening)*norm2(self%move(:, tool))
  end function opened

  !> Return the largest of the distances by which withdrawn tools have moved at a progress, mm.
  pure real(wp) function most_opened(self, progress)
    class(phase_tools_t), intent(in) :: self
    real(wp), intent(in) :: progress

    integer :: t

    most_opened = maxval([0.0_wp, (self%opened(t, progress), t=1, size(self%withdrawn))])
  end function most_opened

  !> Return the force pressed on a tool at a progress, N.
  pure function tool_load(self, tool, progress, start, end) result(load)
    class(phase_tools_t), intent(in) :: self
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
    class(phase_tools_t), intent(in) :: self
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

end module dd3_model_phase_tools
