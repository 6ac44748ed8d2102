! SPDX-License-Identifier: GPL-3.0-or-later
!> The mesh: nodes, elements, node sets.
module dd3_mesh_mesh
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : same_name
  implicit none
  private
  public :: mark_directions, mesh_t, mesh_set_t, element_set_t, placed, unmoved

  !> Placement of a sheet that lies where it was made.
  real(wp), parameter :: unmoved(3, 4) = reshape([real(wp) :: 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], &
      [3, 4])

  !> A named list of nodes.
  type :: mesh_set_t
    !> In lower case.
    character(len=:), allocatable :: name
    !> Node numbers, ascending.
    integer, allocatable :: node(:)
  end type mesh_set_t

  !> A named list of elements.
  type :: element_set_t
    !> In lower case.
    character(len=:), allocatable :: name
    !> Element numbers, ascending.
    integer, allocatable :: element(:)
  end type element_set_t

  !> The mesh of the sheet.
  type :: mesh_t
    !> Number of nodes, of elements, of nodes per element.
    integer :: n_node = 0, n_element = 0, n_element_node = 0
    !> Initial coordinates, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Nodes of each element in the element's order, `(n_element_node, n_element)`.
    integer, allocatable :: connectivity(:, :)
    !> Position in `case%material`, `(n_element)`.
    integer, allocatable :: material(:)
    !> Thickness of a structured blank, mm; 0 for a mesh from a file, which may vary.
    real(wp) :: thickness = 0.0_wp
    !> Rotation and displacement (mm) that have brought the initial sheet to its place, without its
    !> deformation.
    real(wp) :: placement(3, 4) = unmoved
    !> Number of refinements that have made the mesh.
    integer :: mesh_number = 0
    !> Number of nodes before the first of them, which come first; not used without.
    integer :: n_first_node = 0
    !> Times that each element has been divided, `(n_element)`; not allocated if none has.
    integer, allocatable :: level(:)
    !> Bound nodes, each in the middle of an edge of a larger element, and the nodes at the ends of
    !> that edge, `(3, n)`; not allocated if there are none.
    integer, allocatable :: bound(:, :)
    !> Labels of the nodes in the mesh file, 0 of nodes that a cut or a refinement has made; not
    !> allocated for a structured blank.
    integer, allocatable :: node_label(:)
    !> Node sets of the blank, then those of the input file in its order.
    type(mesh_set_t), allocatable :: set(:)
    !> Element sets of the mesh file.
    type(element_set_t), allocatable :: element_set(:)
    !> Of the regions of a blank, for the log, a line each; not allocated without.
    character(len=:), allocatable :: report
  contains
    procedure :: find_set
    procedure :: find_element_set
    procedure :: append_set
    procedure :: nodes_of
    procedure :: model_size
  end type mesh_t

contains

  !> Return positions of the initial sheet in its place, without deformation, `(3, :)`, mm.
  pure function placed(placement, x)
    !> Rotation and displacement, mm.
    real(wp), intent(in) :: placement(3, 4)
    !> mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: placed(3, size(x, 2))

    placed = matmul(placement(:, :3), x) + spread(placement(:, 4), 2, size(x, 2))
  end function placed

  !> Return the position of a set; 0 if not found.
  pure integer function find_set(self, name)
    class(mesh_t), intent(in) :: self
    character(len=*), intent(in) :: name

    if (allocated(self%set)) then
      do find_set = 1, size(self%set)
        if (same_name(self%set(find_set)%name, name)) return
      end do
    end if
    find_set = 0
  end function find_set

  !> Return the position of an element set; 0 if not found.
  pure integer function find_element_set(self, name) result(position)
    class(mesh_t), intent(in) :: self
    character(len=*), intent(in) :: name

    if (allocated(self%element_set)) then
      do position = 1, size(self%element_set)
        if (same_name(self%element_set(position)%name, name)) return
      end do
    end if
    position = 0
  end function find_element_set

  !> Append a node set without copying the nodes of the others.
  subroutine append_set(self, set)
    class(mesh_t), intent(inout) :: self
    type(mesh_set_t), intent(in) :: set

    type(mesh_set_t), allocatable :: larger(:)
    integer :: i

    allocate (larger(size(self%set) + 1))
    do i = 1, size(self%set)
      call move_alloc(self%set(i)%name, larger(i)%name)
      call move_alloc(self%set(i)%node, larger(i)%node)
    end do
    larger(size(larger)) = set
    call move_alloc(larger, self%set)
  end subroutine append_set

  !> Return the nodes of a set; size 0 if not found.
  pure function nodes_of(self, name) result(node)
    class(mesh_t), intent(in) :: self
    character(len=*), intent(in) :: name
    integer, allocatable :: node(:)

    integer :: i

    i = self%find_set(name)
    if (i > 0) then
      node = self%set(i)%node
    else
      allocate (node(0))
    end if
  end function nodes_of

  !> Return the diagonal of the bounding box of all nodes, mm.
  pure real(wp) function model_size(self)
    class(mesh_t), intent(in) :: self

    model_size = norm2(maxval(self%x, dim=2) - minval(self%x, dim=2))
  end function model_size

  !> Mark the directions of some nodes.
  pure subroutine mark_directions(marked, node, direction)
    !> `(3, n_node)`.
    logical, intent(inout) :: marked(:, :)
    integer, intent(in) :: node(:)
    logical, intent(in) :: direction(3)

    integer :: i

    do i = 1, size(node)
      marked(:, node(i)) = marked(:, node(i)) .or. direction
    end do
  end subroutine mark_directions

end module dd3_mesh_mesh
