! SPDX-License-Identifier: GPL-3.0-or-later
!> Configuration of a run: sheet, contact, tools and the place in the process, but for what the terms
!> that act on the sheet own (terms/). Arrays of elements and of contact points have those of the
!> rank's part.
module dd3_model_configuration
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_contact_operator, only : status_gap
  use dd3_tools_closest, only : hint_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: configuration_t, phase_start_t

  !> Values set at the start of a phase: initial values, and final forces on the tools.
  type :: phase_start_t
    !> Displacement of the tools, `(3, n_tool)`, mm, their rotation, `(3, 3, n_tool)`, and angle,
    !> `(n_tool)`, rad.
    real(wp), allocatable :: tool_displacement(:, :), tool_rotation(:, :, :), tool_angle(:)
    !> Force pressed on the tools at the start and at the end of the phase, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_load(:, :), tool_load_end(:, :)
    !> Distance by which the contact layer of each tool lies behind its place, `(n_tool)`, mm, and
    !> by which it does at points that are held along the normal, `(n_contact)`, negative for
    !> others.
    real(wp), allocatable :: layer_offset(:), held_offset(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Equivalent plastic strain, `(n_point, n_element)`.
    real(wp), allocatable :: plastic_strain(:, :)
    !> mJ.
    real(wp) :: elastic_energy = 0.0_wp
    !> Whether the force of `until` is approached from below; true for a displacement.
    logical :: until_from_below = .true.
  end type phase_start_t

  !> Sheet, contact and tools at one configuration.
  type :: configuration_t
    !> Accepted increments.
    integer :: increment = 0
    !> Running phase, from 1.
    integer :: phase = 1
    !> Whether the running phase has begun; false only before the first one.
    logical :: begun = .false.
    !> Progress within the phase, 0 to 1.
    real(wp) :: progress = 0.0_wp
    !> Path of the controlling tools since the start of the job, mm.
    real(wp) :: travel = 0.0_wp
    !> Upper bound of r after a cut-back.
    real(wp) :: r_cap = huge(1.0_wp)
    !> Last increments with a row in history.csv and with a step in fields.vtkhdf; -1 for none.
    integer :: history_increment = -1, fields_increment = -1
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Internal forces, `(3, n_node)`, N.
    real(wp), allocatable :: internal_force(:, :)
    !> External forces, the sum over the terms, `(3, n_node)`, N.
    real(wp), allocatable :: external_force(:, :)
    !> Cauchy stress in the material frame, Kelvin, `(6, n_point, n_element)`, MPa.
    real(wp), allocatable :: stress(:, :, :)
    !> Internal variables of the material, `(n_internal, n_point, n_element)`; the first is the
    !> equivalent plastic strain.
    real(wp), allocatable :: internal_variables(:, :, :)
    !> Orthotropy axes as columns in the global frame, `(3, 3, n_point, n_element)`.
    real(wp), allocatable :: orientation(:, :, :, :)
    !> Parameters of the elements' enhanced strains in the increment, `(n_enhanced, n_element)`;
    !> zero in the committed state.
    real(wp), allocatable :: enhanced(:, :)
    !> Whether the last increment was plastic, `(n_point, n_element)`.
    logical, allocatable :: plastic(:, :)
    !> Contact forces of the candidates, sheet on tool, `(3, n_contact)`, N.
    real(wp), allocatable :: lambda(:, :)
    !> Contact status, `(n_contact)`: one of the `status_*` values of dd3_contact_operator.
    integer, allocatable :: status(:)
    !> Nearest tool of each candidate, `(n_contact)`; 0 for none.
    integer, allocatable :: contact_tool(:)
    !> Place of each candidate on its edge of the mesh, if that moves, `(n_contact)`.
    real(wp), allocatable :: place(:)
    !> Last closest point on each tool, `(n_tool, n_contact)`.
    type(hint_t), allocatable :: hint(:, :)
    !> Displacement of the tools from the coordinates of their files, `(3, n_tool)`, mm; of those
    !> that turn, of the point `tool_centre` on the axis, `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_displacement(:, :), tool_centre(:, :)
    !> Rotation of the tools, `(3, 3, n_tool)`, and their angle since the start of the job,
    !> `(n_tool)`, rad.
    real(wp), allocatable :: tool_rotation(:, :, :), tool_angle(:)
    !> Force pressed on the tools, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_load(:, :)
    !> Force of the sheet on the tools, forces of its draw-beads and fading ones included, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_force(:, :)
    !> Distance by which the contact layer of each tool lies behind its place, `(n_tool)`, mm.
    real(wp), allocatable :: layer_offset(:)
    !> Whether each tool has been in contact since the start of the job, `(n_tool)`.
    logical, allocatable :: touched(:)
    !> Depth of each tool in the faces of the sheet between the nodes, its largest value in the
    !> running phase, `(n_tool)`, mm, and the face of that value, 0 for none.
    real(wp), allocatable :: tool_depth(:), largest_depth(:)
    integer, allocatable :: deepest_face(:)
    !> Smallest convex radius of each tool near that place, mm; huge for an edge without radius.
    real(wp), allocatable :: deepest_radius(:)
    !> Patch, edge and node where a point under pressure first left each tool over an open edge in
    !> the running phase, `(3, n_tool)`, 0 for none, and the displacement of the tool in the phase
    !> until then, `(n_tool)`, mm.
    integer, allocatable :: open_edge(:, :)
    real(wp), allocatable :: open_edge_displacement(:)
    !> Whether the tools that the phase withdraws have all left the sheet.
    logical :: open = .false.
    !> Path of each candidate on the tools while it slips, `(n_contact)`, mm.
    real(wp), allocatable :: slip_path(:)
    !> Work since the start of the job, mJ: of the contact forces on the sheet by the motion of the
    !> tools, of loads and supports, of the internal forces, of the equivalent stress, of friction.
    real(wp) :: tool_work = 0.0_wp, external_work = 0.0_wp, internal_work = 0.0_wp
    real(wp) :: plastic_work = 0.0_wp, friction_work = 0.0_wp
    !> Values fixed at the start of the running phase.
    type(phase_start_t) :: start
  contains
    procedure :: placement
    procedure :: touches
  end type configuration_t

contains

  !> Return the placement of a tool.
  pure type(placement_t) function placement(self, tool)
    class(configuration_t), intent(in) :: self
    integer, intent(in) :: tool

    placement%rotation = self%tool_rotation(:, :, tool)
    associate (centre => self%tool_centre(:, tool))
      placement%translation = self%tool_displacement(:, tool) &
          + (centre - placement%vector_to_global(centre))
    end associate
  end function placement

  !> Whether a tool is in contact with the sheet, on any rank.
  logical function touches(self, tool)
    class(configuration_t), intent(in) :: self
    integer, intent(in) :: tool

    touches = any_rank(any(self%contact_tool == tool .and. self%status /= status_gap))
  end function touches

end module dd3_model_configuration
