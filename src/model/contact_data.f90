! SPDX-License-Identifier: GPL-3.0-or-later
!> Mesh data with the contact points of the sheet: their nodes, and the tools that they can touch.
module dd3_model_contact_data
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_mesh_data, only : mesh_data_t
  implicit none
  private
  public :: contact_data_t, side_faces, rim_faces, all_faces

  !> Faces that a tool touches: those of the upper and lower side of the sheet, those of its rim, or
  !> both.
  integer, parameter :: side_faces = 1, rim_faces = 2, all_faces = 3

  !> Mesh data with contact points.
  type, extends(mesh_data_t) :: contact_data_t
    integer :: n_contact = 0
    !> Contact points of this rank, `(n_contact)`, those at nodes first; the node of each, or one
    !> beside it.
    type(surface_point_t), allocatable :: contact_point(:)
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
    !> Faces that each tool touches, `(n_tool)`: `side_faces`, `rim_faces` or `all_faces`.
    integer, allocatable :: touched_faces(:)
    !> Stiffness of the sheet through its thickness under each contact point for the tools that
    !> touch each kind of faces, `(n_contact, all_faces)`, N/mm.
    real(wp), allocatable :: contact_stiffness(:, :)
    !> Area of each contact point on the sheet without strain, likewise, mm2.
    real(wp), allocatable :: contact_area(:, :)
    !> Node across the element from a node of a contact face, `(n_node)`; 0 for others.
    integer, allocatable :: opposite(:)
    !> Faces on which a tool can touch the sheet: positions in `face`; whether they are of its rim.
    integer, allocatable :: contact_face(:)
    logical, allocatable :: is_rim_face(:)
    !> Contact points on each of these faces, `(:, size(contact_face))`: the corners of its parts,
    !> row by row, or all its nodes if it has more than four; 0 for one of another rank.
    integer, allocatable :: face_point(:, :)
    !> Block row of each tool in the reduced system, after those of the nodes, `(n_tool)`; 0 if the
    !> tool is never pressed.
    integer, allocatable :: tool_row(:)
  contains
    procedure :: faces_of_kind
    procedure :: nodal_contact_forces
    procedure :: own_contact_forces
  end type contact_data_t

contains

  !> Return which contact faces are of a kind, `(size(contact_face))`.
  pure function faces_of_kind(self, kind) result(chosen)
    class(contact_data_t), intent(in) :: self
    integer, intent(in) :: kind
    logical :: chosen(size(self%contact_face))

    chosen = kind == all_faces .or. (self%is_rim_face .eqv. kind == rim_faces)
  end function faces_of_kind

  !> Return the forces on the nodes, `(3, n_node)`, N, that have the same work as those at the
  !> contact points of all ranks.
  function nodal_contact_forces(self, x, point_force, place) result(force)
    class(contact_data_t), intent(in) :: self
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
    class(contact_data_t), intent(in) :: self
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    !> Of the points that move, `(n_contact)`.
    real(wp), intent(in) :: place(:)
    real(wp) :: force(3, self%n_node)

    type(surface_point_t) :: point
    integer :: c

    force = 0.0_wp
    do c = 1, self%n_contact
      if (all(abs(point_force(:, c)) <= 0.0_wp)) cycle
      point = self%contact_point(c)%at_place(place(c))
      call point%add_nodal_forces(x, point_force(:, c), force)
    end do
  end function own_contact_forces

end module dd3_model_contact_data
