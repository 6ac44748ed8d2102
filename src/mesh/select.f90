! SPDX-License-Identifier: GPL-3.0-or-later
!> Selection of nodes: in a plane, in a box, by number, nearest to a point.
module dd3_mesh_select
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_case, only : node_set_spec_t, set_plane, set_box, set_nodes
  use dd3_mesh_mesh, only : mesh_t, mesh_set_t
  implicit none
  private
  public :: add_set

  !> Default tolerance as a fraction of the model's size.
  real(wp), parameter :: relative_tolerance = 1.0e-6_wp

contains

  !> Add a set to the mesh.
  subroutine add_set(mesh, wanted, errors)
    type(mesh_t), intent(inout) :: mesh
    type(node_set_spec_t), intent(in) :: wanted
    type(error_list_t), intent(inout) :: errors

    type(mesh_set_t) :: set
    logical, allocatable :: member(:)
    real(wp) :: tolerance
    integer :: i, before

    before = errors%count
    allocate (member(mesh%n_node), source=.true.)
    if (wanted%of /= "") then
      member = .false.
      member(mesh%nodes_of(wanted%of)) = .true.
    end if
    tolerance = wanted%tolerance
    if (tolerance < 0.0_wp) tolerance = relative_tolerance*mesh%model_size()
    select case (wanted%kind)
    case (set_plane)
      member = member .and. abs(mesh%x(wanted%axis, :) - wanted%value(1)) <= tolerance
    case (set_box)
      do i = 1, 3
        member = member .and. mesh%x(i, :) >= wanted%value(2*i - 1) - tolerance &
                 .and. mesh%x(i, :) <= wanted%value(2*i) + tolerance
      end do
    case (set_nodes)
      call keep_numbers(member, mesh, wanted, errors)
    case default
      call keep_nearest(member, mesh%x, wanted%value, tolerance)
    end select
    set%name = wanted%name
    set%node = pack([(i, i=1, mesh%n_node)], member)
    if (size(set%node) == 0 .and. errors%count == before) then
      call errors%push_input(wanted%source%opened, "set '"//wanted%source%called()// &
          "' contains no node", "at least one node", code="E146")
    end if
    call mesh%append_set(set)
  end subroutine add_set

  !> Keep the members with the numbers of the set; of a mesh file these are its labels.
  subroutine keep_numbers(member, mesh, wanted, errors)
    !> Whether each node is a member.
    logical, intent(inout) :: member(:)
    type(mesh_t), intent(in) :: mesh
    type(node_set_spec_t), intent(in) :: wanted
    type(error_list_t), intent(inout) :: errors

    integer :: label(size(member))
    logical :: named(size(member)), inside(size(member))
    integer :: i

    label = [(i, i=1, size(member))]
    if (allocated(mesh%node_label)) label = mesh%node_label
    named = .false.
    do i = 1, size(wanted%range, 2)
      inside = label >= wanted%range(1, i) .and. label <= wanted%range(2, i)
      if (wanted%range(2, i) > maxval(label) .or. .not. any(inside)) then
        call errors%push_input(wanted%source%entry(wanted%source%find("nodes"))%value(i)%at, &
            "there is no node "//to_text(wanted%range(2, i)), "numbers from "// &
            to_text(minval(label, mask=label > 0))//" to "//to_text(maxval(label)), code="E113")
        cycle
      end if
      named = named .or. inside
    end do
    member = member .and. named
  end subroutine keep_numbers

  !> Keep the member nearest to a point; among equals, the one with the lowest number.
  pure subroutine keep_nearest(member, x, point, tolerance)
    !> Whether each node is a member.
    logical, intent(inout) :: member(:)
    !> Coordinates, `(3, n)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), intent(in) :: point(:)
    !> Largest difference of distances considered equal, mm.
    real(wp), intent(in) :: tolerance

    real(wp) :: distance(size(member)), least
    integer :: i

    if (.not. any(member)) return
    distance = [(norm2(x(:, i) - point), i=1, size(member))]
    least = minval(distance, mask=member)
    do i = 1, size(member)
      if (member(i) .and. distance(i) <= least + tolerance) exit
    end do
    member = .false.
    member(i) = .true.
  end subroutine keep_nearest

end module dd3_mesh_select
