! SPDX-License-Identifier: GPL-3.0-or-later
!> Constant data of a run: mesh, element table, materials, tools, contact candidates, supports and
!> phases.
module dd3_model_model
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_threads, only : least_points, threads_for
  use dd3_element_table, only : element_t
  use dd3_material_material, only : material_t
  use dd3_model_contact_point, only : contact_point_t
  use dd3_model_drawbead, only : drawbead_t
  use dd3_model_internal_variables, only : variable_t
  use dd3_model_load_sets, only : load_set_t, pressure_set_t
  use dd3_model_part, only : part_t
  use dd3_model_phase, only : phase_t
  use dd3_model_sheet_faces, only : sheet_faces_t
  use dd3_model_tolerances, only : tolerances_t
  use dd3_settings_output, only : history_quantities_t, output_spec_t
  use dd3_tools_tool, only : tool_t
  implicit none
  private
  public :: model_t, history_set_t, node_set_t

  !> Node set by its name.
  type :: node_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
  end type node_set_t

  !> Node set with quantities in history.csv; its name is the prefix of their columns.
  type, extends(history_quantities_t) :: history_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
  end type history_set_t

  !> Model of a job.
  type :: model_t
    character(len=:), allocatable :: title
    integer :: n_node = 0, n_element = 0, n_contact = 0, n_tool = 0, n_internal = 0
    !> Initial positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x0(:, :)
    !> Positions in which another run has left the sheet, `(3, n_node)`, mm; not allocated if the
    !> job starts from the initial ones.
    real(wp), allocatable :: x_start(:, :)
    !> Nodes of the elements, `(element%n_node, n_element)`.
    integer, allocatable :: connectivity(:, :)
    !> Elements of this rank.
    type(part_t) :: part
    !> Node sets of the sheet itself, of which there are `n_sheet_set`, then those of the input.
    type(node_set_t), allocatable :: set(:)
    integer :: n_sheet_set = 0
    !> Element type of the sheet.
    type(element_t) :: element
    !> Faces on the boundary of the sheet.
    type(sheet_faces_t) :: face
    type(material_t), allocatable :: material(:)
    character(len=24), allocatable :: material_name(:)
    !> Internal variables of the materials, for output.
    type(variable_t), allocatable :: internal_variable(:)
    !> Material of each element, `(n_element)`.
    integer, allocatable :: material_of(:)
    !> Check sums of their parameters.
    integer, allocatable :: material_digest(:)
    !> Orthotropy axes of each material at the start, columns RD, TD, ND, `(3, 3, n_material)`.
    real(wp), allocatable :: axes(:, :, :)
    !> Thickness of the sheet at the start, mm; the smallest if it varies.
    real(wp) :: thickness = 0.0_wp
    !> Thickness at each node, `(n_node)`, mm; not allocated if it does not vary.
    real(wp), allocatable :: node_thickness(:)
    !> Bottom and top node of the column of each node, `(2, n_node)`; a node that is in no column is
    !> its own bottom and top.
    integer, allocatable :: column(:, :)
    !> Other end of a fibre through the thickness of an element at each node, `(n_node)`; 0 for a
    !> node in the middle of an edge.
    integer, allocatable :: fibre_end(:)
    !> Initial inward unit normals of the rim, `(3, n_node)`; zero for a node elsewhere.
    real(wp), allocatable :: rim_normal(:, :)
    type(tolerances_t) :: tolerance
    type(tool_t), allocatable :: tool(:)
    !> Check sums of the tools with their candidates.
    integer, allocatable :: tool_digest(:)
    !> Contact points of this rank, `(n_contact)`, those at nodes first; the node of each, or one
    !> beside it.
    type(contact_point_t), allocatable :: contact_point(:)
    integer, allocatable :: contact_node(:)
    !> Number of contact points at nodes.
    integer :: n_contact_node = 0
    !> Number of those that do not move on edges of the mesh, which come first.
    integer :: n_contact_fixed = 0
    !> Contact point at each node, `(n_node)`; 0 for none on this rank.
    integer, allocatable :: candidate_of(:)
    !> Nodes that can touch each tool, `(n_tool, n_node)`, and the number of contact points that
    !> can, of all ranks, `(n_tool)`.
    logical, allocatable :: member(:, :)
    integer, allocatable :: n_candidate(:)
    !> Tools that a contact point can touch, `(n_tool, n_contact)`.
    logical, allocatable :: candidate(:, :)
    !> Stiffness of the sheet through its thickness under each contact point, `(n_contact)`, N/mm.
    real(wp), allocatable :: contact_stiffness(:)
    !> Node across the element from a node of a contact face, `(n_node)`; 0 for others.
    integer, allocatable :: opposite(:)
    !> Faces on which a tool can touch the sheet: positions in `face`.
    integer, allocatable :: contact_face(:)
    !> Contact points on each of these faces, `(:, size(contact_face))`: the corners of its parts,
    !> row by row, or all its nodes if it has more than four; 0 for one of another rank.
    integer, allocatable :: face_point(:, :)
    !> Block row of each tool in the reduced system, after those of the nodes, `(n_tool)`; 0 if the
    !> tool is never pressed.
    integer, allocatable :: tool_row(:)
    !> Degrees of freedom held in every phase, `(3, n_node)`.
    logical, allocatable :: fixed(:, :)
    !> Sets that carry a load in some phase.
    type(load_set_t), allocatable :: load_set(:)
    !> Sets that carry a pressure in some phase.
    type(pressure_set_t), allocatable :: pressure_set(:)
    type(drawbead_t), allocatable :: drawbead(:)
    !> Quadrilaterals on the lower and upper faces of the sheet, on which draw-beads act: nodes of
    !> an element, `(4, n)`.
    integer, allocatable :: bead_face(:, :)
    type(phase_t), allocatable :: phase(:)
    !> Node sets recorded in history.csv.
    type(history_set_t), allocatable :: history(:)
    !> What is written, and when.
    type(output_spec_t) :: output
  contains
    procedure :: start_positions
    procedure :: thickness_at
    procedure :: nodal_contact_forces
    procedure :: own_contact_forces
    procedure :: turns
    procedure :: tilts
    procedure :: largest_thickness
    procedure :: least_shear
    procedure :: element_threads
  end type model_t

contains

  !> Return the positions of the nodes at the start of the job, `(3, n_node)`, mm.
  pure function start_positions(self) result(x)
    class(model_t), intent(in) :: self
    real(wp) :: x(3, size(self%x0, 2))

    x = self%x0
    if (allocated(self%x_start)) x = self%x_start
  end function start_positions

  !> Return the thickness of the sheet at a node at the start, mm.
  pure real(wp) function thickness_at(self, node)
    class(model_t), intent(in) :: self
    integer, intent(in) :: node

    thickness_at = self%thickness
    if (allocated(self%node_thickness)) thickness_at = self%node_thickness(node)
  end function thickness_at

  !> Return the forces on the nodes, `(3, n_node)`, N, that have the same work as those at the
  !> contact points of all ranks.
  function nodal_contact_forces(self, x, point_force, place) result(force)
    class(model_t), intent(in) :: self
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    !> Of the points that move, `(n_contact)`.
    real(wp), intent(in) :: place(:)
    real(wp) :: force(3, self%n_node)

    force = self%own_contact_forces(x, point_force, place)
    call sum_over_ranks(size(force), force)
  end function nodal_contact_forces

  !> Return what the contact points of this rank contribute to the forces on the nodes.
  pure function own_contact_forces(self, x, point_force, place) result(force)
    class(model_t), intent(in) :: self
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    !> Of the points that move, `(n_contact)`.
    real(wp), intent(in) :: place(:)
    real(wp) :: force(3, self%n_node)

    type(contact_point_t) :: point
    integer :: c

    force = 0.0_wp
    do c = 1, self%n_contact
      if (all(abs(point_force(:, c)) <= 0.0_wp)) cycle
      point = self%contact_point(c)%at_place(place(c))
      call point%add_nodal_forces(x, point_force(:, c), force)
    end do
  end function own_contact_forces

  !> Whether a tool turns in some phase.
  pure logical function turns(self, tool)
    class(model_t), intent(in) :: self
    integer, intent(in) :: tool

    integer :: i

    turns = any([(self%phase(i)%turns(tool), i=1, size(self%phase))])
  end function turns

  !> Whether a tool tilts in some phase.
  pure logical function tilts(self, tool)
    class(model_t), intent(in) :: self
    integer, intent(in) :: tool

    integer :: i

    tilts = any([(self%phase(i)%tilts(tool), i=1, size(self%phase))])
  end function tilts

  !> Return the largest thickness of the sheet at the start, mm.
  pure real(wp) function largest_thickness(self)
    class(model_t), intent(in) :: self

    largest_thickness = self%thickness
    if (allocated(self%node_thickness)) largest_thickness = maxval(self%node_thickness)
  end function largest_thickness

  !> Return the smallest shear modulus of the elements, MPa.
  pure real(wp) function least_shear(self)
    class(model_t), intent(in) :: self

    integer :: m

    least_shear = huge(1.0_wp)
    do m = 1, size(self%material)
      if (any(self%material_of == m)) &
          least_shear = min(least_shear, self%material(m)%laws%elasticity%shear)
    end do
  end function least_shear

  !> Return the number of threads of a loop over the elements of this rank.
  integer function element_threads(self)
    class(model_t), intent(in) :: self

    element_threads = threads_for(size(self%part%element)*self%element%n_point, least_points)
  end function element_threads

end module dd3_model_model
