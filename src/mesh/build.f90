!> Builds the mesh of a case: nodes, elements and node sets; checks the prescribed displacements.
module dd3_mesh_build
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_input_case, only : case_t, phase_spec_t
  use dd3_mesh_blank, only : new_blank_mesh
  use dd3_mesh_mesh, only : mesh_t
  use dd3_mesh_select, only : add_set
  implicit none
  private
  public :: new_mesh

contains

  !> Build the mesh. It is complete only if no error was added.
  subroutine new_mesh(mesh, case, natural, errors)
    type(mesh_t), intent(out) :: mesh
    !> Without errors.
    type(case_t), intent(in) :: case
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    integer :: i, before

    before = errors%count
    call new_blank_mesh(mesh, case%blank(1), natural)
    do i = 1, size(case%set)
      call add_set(mesh, case%set(i), errors)
    end do
    if (errors%count > before) return
    do i = 1, size(case%phase)
      call check_displacements(mesh, case, case%phase(i), errors)
    end do
  end subroutine new_mesh

  !> Report displacements of nodes that are fixed by a boundary condition, or displaced twice.
  subroutine check_displacements(mesh, case, phase, errors)
    type(mesh_t), intent(in) :: mesh
    type(case_t), intent(in) :: case
    type(phase_spec_t), intent(in) :: phase
    type(error_list_t), intent(inout) :: errors

    logical :: held(3, mesh%n_node), moved(3, mesh%n_node)
    integer, allocatable :: node(:)
    integer :: i

    if (size(phase%displace) == 0) return
    held = .false.
    moved = .false.
    do i = 1, size(case%boundary)
      call mark(held, mesh%nodes_of(case%boundary(i)%set), case%boundary(i)%fix)
    end do
    do i = 1, size(phase%displace)
      node = mesh%nodes_of(phase%displace(i)%set)
      if (any(held(phase%displace(i)%axis, node)) .and. abs(phase%displace(i)%value) > 0.0_wp) then
        call errors%push_input(phase%displace(i)%at, "a node of '"//phase%displace(i)%set// &
            "' is fixed along this axis by *BOUNDARY", "nodes that are free along this axis")
      else if (any(moved(phase%displace(i)%axis, node))) then
        call errors%push_input(phase%displace(i)%at, "a node of '"//phase%displace(i)%set// &
            "' is displaced twice along this axis in this phase", "one displace for each node")
      end if
      moved(phase%displace(i)%axis, node) = .true.
    end do
  end subroutine check_displacements

  !> Mark the directions of some nodes.
  pure subroutine mark(marked, node, direction)
    !> `(3, n_node)`.
    logical, intent(inout) :: marked(:, :)
    integer, intent(in) :: node(:)
    logical, intent(in) :: direction(3)

    integer :: i

    do i = 1, size(node)
      marked(:, node(i)) = marked(:, node(i)) .or. direction
    end do
  end subroutine mark

end module dd3_mesh_build
