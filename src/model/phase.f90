!> One stage of the process with all names resolved: which tools move or press, which nodes are
!> driven, when it ends.
module dd3_model_phase
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : limits_spec_t, newton_spec_t, until_spec_t
  implicit none
  private
  public :: phase_t

  !> A phase. All moves and loads are linear in its progress, 0 to 1.
  type :: phase_t
    !> Name.
    character(len=:), allocatable :: name
    !> Controlling tool; 0 where loads control.
    integer :: control = 0
    !> Trial increment as a fraction of the whole phase.
    real(wp) :: trial = 0.0_wp
    !> Path of the controlling tool over the whole phase, mm; 0 where loads control.
    real(wp) :: length = 0.0_wp
    !> Displacement of the tools over the phase, `(3, n_tool)`, mm.
    real(wp), allocatable :: move(:, :)
    !> Whether a force acts on the tool, which then follows it, `(n_tool)`.
    logical, allocatable :: pressed(:)
    !> The force on the pressed tools at the start and at the end of the phase, `(3, n_tool)`, N;
    !> the start is set when the phase begins.
    real(wp), allocatable :: press_start(:, :), press_end(:, :)
    !> Displacement of the tools at the start of the phase, `(3, n_tool)`, mm; set when the phase
    !> begins.
    real(wp), allocatable :: tool_start(:, :)
    !> Whether this phase leaves the force on each tool as it finds it, `(n_tool)`.
    logical, allocatable :: keeps_press(:)
    !> Unit vector of the pressed tools' line of motion, or of a moved tool's motion, `(3, n_tool)`.
    real(wp), allocatable :: direction(:, :)
    !> Whether contact with the tool is on, `(n_tool)`.
    logical, allocatable :: active(:)
    !> Degrees of freedom whose displacement is prescribed, supports included, `(3, n_node)`.
    logical, allocatable :: prescribed(:, :)
    !> Their displacement over the phase, `(3, n_node)`, mm.
    real(wp), allocatable :: displacement(:, :)
    !> Total forces on the sets with loads at the start and at the end of the phase, `(3,
    !> size(load_set))`, N; the start is set when the phase begins.
    real(wp), allocatable :: load_start(:, :), load_end(:, :)
    !> Whether this phase leaves the load of a set as it finds it, `(size(load_set))`.
    logical, allocatable :: keeps_load(:)
    !> Push of the sheet on released tools that fades to nothing over the phase, `(3, n_contact)`,
    !> N; set when the phase begins.
    real(wp), allocatable :: fading(:, :)
    !> What ends it early.
    type(until_spec_t) :: until
    !> Whether the force that ends it is met from below; set when the phase begins.
    logical :: until_from_below = .true.
    !> Limits of the predictor.
    type(limits_spec_t) :: limits
    !> Settings of the corrector.
    type(newton_spec_t) :: newton
    !> Penalty coefficient, N/mm.
    real(wp) :: penalty = 0.0_wp
    !> Distance up to which a tool's surface is looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  end type phase_t

end module dd3_model_phase
