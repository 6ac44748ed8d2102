! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh data of a run: the sheet, and all that is numbered by its nodes, elements and faces, but for
!> its contact points and for what single phases prescribe at nodes.
module dd3_model_mesh_data
  use dd3_base_kinds, only : wp
  use dd3_base_threads, only : least_points, threads_for
  use dd3_element_table, only : element_t
  use dd3_mesh_mesh, only : placed, unmoved
  use dd3_model_part, only : part_t
  use dd3_model_sheet_faces, only : sheet_faces_t
  use dd3_model_terms_load_sets, only : load_set_t, pressure_set_t
  use dd3_model_tolerances, only : tolerances_t
  use dd3_sheet_surface_point, only : surface_point_t
  implicit none
  private
  public :: mesh_data_t, node_set_t

  !> Node set by its name.
  type :: node_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
  end type node_set_t

  !> Mesh data.
  type :: mesh_data_t
    integer :: n_node = 0, n_element = 0, n_bound = 0
    !> Initial positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x0(:, :)
    !> Positions in which another run has left the sheet, `(3, n_node)`, mm; not allocated if the
    !> job starts from the initial ones.
    real(wp), allocatable :: x_start(:, :)
    !> Nodes of the elements, `(element%n_node, n_element)`.
    integer, allocatable :: connectivity(:, :)
    !> Labels of the nodes in the mesh file, `(n_node)`; see `mesh_t`.
    integer, allocatable :: node_label(:)
    !> Number of refinements that have made the mesh.
    integer :: mesh_number = 0
    !> Number of nodes before the first of them; those that divisions have made come after.
    integer :: n_first_node = 0
    !> Times that each element has been divided, `(n_element)`; not allocated if none has.
    integer, allocatable :: level(:)
    !> Bound nodes and the nodes at the ends of their edges, `(3, n_bound)`, and their points on
    !> the edges; not allocated if there are none.
    integer, allocatable :: bound(:, :)
    type(surface_point_t), allocatable :: bound_point(:)
    !> Nodes that the forces of each element act on, `(:, n_element)`: its own, and the parents of
    !> its bound nodes; a node may be repeated.
    integer, allocatable :: coupling(:, :)
    !> Elements of this rank.
    type(part_t) :: part
    !> Node sets of the sheet itself, of which there are `n_sheet_set`, then those of the input.
    type(node_set_t), allocatable :: set(:)
    integer :: n_sheet_set = 0
    !> Element type of the sheet.
    type(element_t) :: element
    !> Faces on the boundary of the sheet.
    type(sheet_faces_t) :: face
    !> Material of each element, `(n_element)`.
    integer, allocatable :: material_of(:)
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
    !> Rotation and displacement (mm) that brought the initial sheet to its place, see `mesh_t`.
    real(wp) :: placement(3, 4) = unmoved
    !> Inward unit normals of the rim of the initial sheet in its place, `(3, n_node)`; zero for a
    !> node elsewhere.
    real(wp), allocatable :: rim_normal(:, :)
    type(tolerances_t) :: tolerance
    !> Degrees of freedom held in every phase, `(3, n_node)`.
    logical, allocatable :: fixed(:, :)
    !> Sets that carry a load in some phase.
    type(load_set_t), allocatable :: load_set(:)
    !> Sets that carry a pressure in some phase.
    type(pressure_set_t), allocatable :: pressure_set(:)
    !> Quadrilaterals on the lower and upper faces of the sheet, on which draw-beads act: nodes of
    !> an element, `(4, n)`.
    integer, allocatable :: bead_face(:, :)
  contains
    procedure :: bound_nodes
    procedure :: first_nodes
    procedure :: start_positions
    procedure :: undeformed_positions
    procedure :: thickness_at
    procedure :: largest_thickness
    procedure :: element_threads
  end type mesh_data_t

contains

  !> Return the numbers of the bound nodes.
  pure function bound_nodes(self) result(node)
    class(mesh_data_t), intent(in) :: self
    integer :: node(self%n_bound)

    if (self%n_bound > 0) node = self%bound(1, :)
  end function bound_nodes

  !> Return those of some nodes that were there before the first refinement; all if none was. A mean
  !> over them keeps its meaning where a part of the sheet is refined.
  pure function first_nodes(self, node) result(first)
    class(mesh_data_t), intent(in) :: self
    integer, intent(in) :: node(:)
    integer, allocatable :: first(:)

    first = pack(node, node <= self%n_first_node)
    if (size(first) == 0) first = node
  end function first_nodes

  !> Return the positions of the nodes at the start of the job, `(3, n_node)`, mm.
  pure function start_positions(self) result(x)
    class(mesh_data_t), intent(in) :: self
    real(wp) :: x(3, size(self%x0, 2))

    x = self%x0
    if (allocated(self%x_start)) x = self%x_start
  end function start_positions

  !> Return the positions that the nodes would have without deformation, `(3, n_node)`, mm.
  pure function undeformed_positions(self) result(x)
    class(mesh_data_t), intent(in) :: self
    real(wp) :: x(3, size(self%x0, 2))

    x = placed(self%placement, self%x0)
  end function undeformed_positions

  !> Return the thickness of the sheet at a node at the start, mm.
  pure real(wp) function thickness_at(self, node)
    class(mesh_data_t), intent(in) :: self
    integer, intent(in) :: node

    thickness_at = self%thickness
    if (allocated(self%node_thickness)) thickness_at = self%node_thickness(node)
  end function thickness_at

  !> Return the largest thickness of the sheet at the start, mm.
  pure real(wp) function largest_thickness(self)
    class(mesh_data_t), intent(in) :: self

    largest_thickness = self%thickness
    if (allocated(self%node_thickness)) largest_thickness = maxval(self%node_thickness)
  end function largest_thickness

  !> Return the number of threads of a loop over the elements of this rank.
  integer function element_threads(self)
    class(mesh_data_t), intent(in) :: self

    element_threads = threads_for(size(self%part%element)*self%element%n_point, least_points)
  end function element_threads

end module dd3_model_mesh_data
