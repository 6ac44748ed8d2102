! SPDX-License-Identifier: GPL-3.0-or-later
!> State of a run: all that changes in it and decides how it continues. Two copies exist, the
!> committed state (configuration N-1, in equilibrium) and the trial state (configuration N);
!> acceptance and cut-back are assignments. The walk over the components in state_walk.f90 serves
!> the restart; a test checks that it names every component declared here. Arrays of elements and
!> of contact points have those of the rank's part.
module dd3_model_state
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : any_rank
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_sheet_sheet, only : sheet_t
  use dd3_tools_closest, only : hint_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: state_t, phase_start_t, new_state

  !> Values set at the start of a phase: initial values, and final values of the loads.
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
    !> Total forces on the sets with loads at the start and at the end of the phase, `(3, n_load)`,
    !> N.
    real(wp), allocatable :: load(:, :), load_end(:, :)
    !> Pressures at the start and at the end of the phase, `(n_pressure)`, MPa.
    real(wp), allocatable :: pressure(:), pressure_end(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Forces of the nodes on constraints that are lost, supports, draw-beads and those of an earlier
    !> run, which fade over the phase, and those that lay a free sheet down, `(3, n_node)`, N.
    real(wp), allocatable :: fading(:, :), laying(:, :)
    !> Whether the former turn with the sheet. Those of a sheet that is taken over keep their
    !> directions, as the tools did from which most of them come.
    logical :: fading_turns = .true.
    !> Equivalent plastic strain, `(n_point, n_element)`.
    real(wp), allocatable :: plastic_strain(:, :)
    !> Elastic energy, and work of viscous forces until then, mJ.
    real(wp) :: elastic_energy = 0.0_wp, damping_work = 0.0_wp
    !> Whether the force of `until` is approached from below; true for a displacement.
    logical :: until_from_below = .true.
  end type phase_start_t

  !> State at one configuration.
  type :: state_t
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
    !> External forces, `(3, n_node)`, N: loads, and the fading forces of lost constraints.
    real(wp), allocatable :: external_force(:, :)
    !> Total forces on the sets with loads, `(3, n_load)`, N, and pressures, `(n_pressure)`, MPa.
    real(wp), allocatable :: load(:, :), pressure(:)
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
    !> Forces of the nodes on lost constraints that are left, with those that lay a sheet down,
    !> `(3, n_node)`, N.
    real(wp), allocatable :: fading(:, :)
    !> Tool that released each node, while the force fades, `(n_node)`; 0 for none.
    integer, allocatable :: fading_tool(:)
    !> Displacement of the tools from the coordinates of their files, `(3, n_tool)`, mm; of those
    !> that turn, of the point `tool_centre` on the axis, `(3, n_tool)`, mm.
    real(wp), allocatable :: tool_displacement(:, :), tool_centre(:, :)
    !> Rotation of the tools, `(3, 3, n_tool)`, and their angle since the start of the job,
    !> `(n_tool)`, rad.
    real(wp), allocatable :: tool_rotation(:, :, :), tool_angle(:)
    !> Force pressed on the tools, `(3, n_tool)`, N.
    real(wp), allocatable :: tool_load(:, :)
    !> Force of the sheet on the tools, fading forces included, `(3, n_tool)`, N.
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
    !> Restraining force per length of each interval of the draw-beads, N/mm, and its slip path, mm,
    !> `(n_interval)`.
    real(wp), allocatable :: bead_force(:), bead_path(:)
    !> Forces of the draw-beads on the nodes, `(3, n_node)`, N; size 0 without draw-beads.
    real(wp), allocatable :: bead_load(:, :)
    !> Force of each draw-bead on the sheet, `(3, n_bead)`, its restraining force, `(n_bead)`, N,
    !> and its length on the sheet, `(n_bead)`, mm.
    real(wp), allocatable :: bead_total(:, :), bead_restraint(:), bead_length(:)
    !> Fraction of the normal force of each draw-bead at the start of the phase, `(n_bead)`.
    real(wp), allocatable :: bead_normal(:)
    !> Work since the start of the job, mJ: of the contact forces on the sheet by the motion of the
    !> tools, of loads and supports, of the internal forces, of the equivalent stress, of friction.
    real(wp) :: tool_work = 0.0_wp, external_work = 0.0_wp, internal_work = 0.0_wp
    real(wp) :: plastic_work = 0.0_wp, friction_work = 0.0_wp
    !> Work dissipated by the draw-beads since the start of the job, mJ.
    real(wp) :: bead_work = 0.0_wp
    !> Work dissipated by viscous forces since the start of the job, mJ.
    real(wp) :: damping_work = 0.0_wp
    !> Values fixed at the start of the running phase.
    type(phase_start_t) :: start
  contains
    procedure :: placement
    procedure :: touches
  end type state_t

contains

  !> Return the placement of a tool.
  pure type(placement_t) function placement(self, tool)
    class(state_t), intent(in) :: self
    integer, intent(in) :: tool

    placement%rotation = self%tool_rotation(:, :, tool)
    associate (centre => self%tool_centre(:, tool))
      placement%translation = self%tool_displacement(:, tool) &
          + (centre - placement%vector_to_global(centre))
    end associate
  end function placement

  !> Whether a tool is in contact with the sheet, on any rank.
  logical function touches(self, tool)
    class(state_t), intent(in) :: self
    integer, intent(in) :: tool

    touches = any_rank(any(self%contact_tool == tool .and. self%status /= status_gap))
  end function touches

  !> Make the initial state: the sheet as it is at the start of the job, unstressed or with the
  !> state that another run has left in it, and the tools at their initial positions.
  subroutine new_state(self, model, sheet)
    type(state_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> The sheet of the model; unstressed if it is left out.
    type(sheet_t), intent(in), optional :: sheet

    integer :: e, p, t

    call new_sheet(self, model)
    associate (n_contact => model%n_contact, n_tool => model%n_tool)
      allocate (self%lambda(3, n_contact), self%fading(3, model%n_node), source=0.0_wp)
      allocate (self%status(n_contact), self%contact_tool(n_contact), source=0)
      allocate (self%fading_tool(model%n_node), source=0)
      allocate (self%hint(n_tool, n_contact))
      allocate (self%slip_path(n_contact), source=0.0_wp)
      allocate (self%place(n_contact), source=0.5_wp)
      allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), source=0.0_wp)
      allocate (self%tool_centre(3, n_tool), self%tool_angle(n_tool), source=0.0_wp)
      self%tool_rotation = spread(identity, 3, n_tool)
      allocate (self%tool_force(3, n_tool), self%layer_offset(n_tool), source=0.0_wp)
      allocate (self%touched(n_tool), source=.false.)
      allocate (self%tool_depth(n_tool), self%largest_depth(n_tool), source=0.0_wp)
      allocate (self%deepest_face(n_tool), self%open_edge(3, n_tool), source=0)
      allocate (self%open_edge_displacement(n_tool), source=0.0_wp)
      allocate (self%deepest_radius(n_tool), source=huge(1.0_wp))
    end associate
    call new_beads(self, model)
    self%x(:, :) = model%start_positions()
    do e = 1, size(model%part%element)
      do p = 1, model%element%n_point
        self%orientation(:, :, p, e) = model%axes(:, :, model%material_of(model%part%element(e)))
      end do
    end do
    if (present(sheet)) then
      if (sheet%has_state) then
        associate (e => model%part%element, &
            n => min(model%n_internal, size(sheet%internal_variables, 1)))
          self%stress(:, :, :) = sheet%stress(:, :, e)
          self%orientation(:, :, :, :) = sheet%orientation(:, :, :, e)
          self%internal_variables(:n, :, :) = sheet%internal_variables(:n, :, e)
        end associate
      end if
    end if
    do t = 1, model%n_tool
      self%tool_displacement(:, t) = model%tool(t)%position
    end do
    call new_phase_start(self%start, self)
  end subroutine new_state

  !> Allocate what belongs to nodes, sets with loads and integration points, and set it to zero.
  subroutine new_sheet(self, model)
    type(state_t), intent(inout) :: self
    type(model_t), intent(in) :: model

    associate (n_node => model%n_node, n_point => model%element%n_point, &
        n => size(model%part%element))
      allocate (self%x(3, n_node), self%internal_force(3, n_node), source=0.0_wp)
      allocate (self%external_force(3, n_node), self%load(3, size(model%load_set)), source=0.0_wp)
      allocate (self%pressure(size(model%pressure_set)), source=0.0_wp)
      allocate (self%stress(6, n_point, n), source=0.0_wp)
      allocate (self%internal_variables(model%n_internal, n_point, n), source=0.0_wp)
      allocate (self%orientation(3, 3, n_point, n), source=0.0_wp)
      allocate (self%enhanced(model%element%n_enhanced, n), source=0.0_wp)
      allocate (self%plastic(n_point, n), source=.false.)
    end associate
  end subroutine new_sheet

  !> Allocate what belongs to draw-beads and set it to zero.
  subroutine new_beads(self, model)
    type(state_t), intent(inout) :: self
    type(model_t), intent(in) :: model

    integer :: n_bead, n_interval, n_node, b

    n_bead = size(model%drawbead)
    n_node = merge(model%n_node, 0, n_bead > 0)
    n_interval = sum([(size(model%drawbead(b)%line, 3), b=1, n_bead)])
    allocate (self%bead_force(n_interval), self%bead_path(n_interval), source=0.0_wp)
    allocate (self%bead_load(3, n_node), self%bead_total(3, n_bead), source=0.0_wp)
    allocate (self%bead_restraint(n_bead), self%bead_length(n_bead), source=0.0_wp)
    allocate (self%bead_normal(n_bead), source=0.0_wp)
  end subroutine new_beads

  !> Allocate the values at the start of a phase for a state and set them to zero.
  subroutine new_phase_start(self, state)
    type(phase_start_t), intent(out) :: self
    type(state_t), intent(in) :: state

    associate (n_node => size(state%x, 2), n_tool => size(state%layer_offset), &
        n_load => size(state%load, 2), n_pressure => size(state%pressure))
      allocate (self%tool_displacement(3, n_tool), self%tool_load(3, n_tool), &
          self%tool_load_end(3, n_tool), self%load(3, n_load), self%load_end(3, n_load), &
          self%fading(3, n_node), self%laying(3, n_node), source=0.0_wp)
      allocate (self%layer_offset(n_tool), self%pressure(n_pressure), &
          self%pressure_end(n_pressure), source=0.0_wp)
    end associate
    allocate (self%held_offset(size(state%status)), source=-1.0_wp)
    allocate (self%plastic_strain(size(state%stress, 2), size(state%stress, 3)), source=0.0_wp)
    self%tool_rotation = state%tool_rotation
    self%tool_angle = state%tool_angle
    self%x = state%x
  end subroutine new_phase_start

end module dd3_model_state
