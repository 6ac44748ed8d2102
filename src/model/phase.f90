!> Phase of the process as in the input, with all names resolved: tools moved and pressed, nodes
!> displaced and loaded, early end. It never changes in a run.
module dd3_model_phase
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : limits_spec_t, newton_spec_t, until_spec_t
  implicit none
  private
  public :: phase_t

  !> Phase in which all displacements and loads are linear in the progress, 0 to 1.
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
    !> Tools under a prescribed force, which move freely along their lines, `(n_tool)`.
    logical, allocatable :: pressed(:)
    !> Force on the pressed tools at the end of the phase, `(3, n_tool)`, N; without meaning for
    !> those whose force the phase leaves unchanged, `(n_tool)`.
    real(wp), allocatable :: tool_load_end(:, :)
    logical, allocatable :: keeps_tool_load(:)
    !> Unit vector along the line of motion of a pressed or moved tool, `(3, n_tool)`.
    real(wp), allocatable :: direction(:, :)
    !> Tools with contact, `(n_tool)`.
    logical, allocatable :: active(:)
    !> Degrees of freedom with prescribed displacement, supports included, `(3, n_node)`.
    logical, allocatable :: prescribed(:, :)
    !> Supports chosen against free rigid motions of an unloaded sheet, in columns of node and axis,
    !> `(2, n)`; they are prescribed too.
    integer, allocatable :: support(:, :)
    !> Prescribed displacement over the phase, `(3, n_node)`, mm.
    real(wp), allocatable :: displacement(:, :)
    !> Directions that an earlier phase displaced and this one holds, as text: `x of 'tip', ...`.
    character(len=:), allocatable :: kept_displacements
    !> Total forces on the sets with loads at the end of the phase, `(3, n_load)`, N; without
    !> meaning for those whose load the phase leaves unchanged, `(n_load)`.
    real(wp), allocatable :: load_end(:, :)
    logical, allocatable :: keeps_load(:)
    !> Early end.
    type(until_spec_t) :: until
    type(limits_spec_t) :: limits
    type(newton_spec_t) :: newton
    !> Penalty coefficient, N/mm.
    real(wp) :: penalty = 0.0_wp
    !> Distance up to which a tool's surface is looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  end type phase_t

end module dd3_model_phase
