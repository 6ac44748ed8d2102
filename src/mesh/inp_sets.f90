! SPDX-License-Identifier: GPL-3.0-or-later
!> Sets of an `.inp` file: their members by labels, by the names of other sets, and for nodes by
!> those of sets of elements.
module dd3_mesh_inp_sets
  use dd3_base_number_index, only : number_index_t
  use dd3_base_text, only : lower_case, to_text
  use dd3_mesh_inp, only : inp_set_t, inp_t, position_of_set
  use dd3_mesh_mesh, only : mesh_t
  implicit none
  private
  public :: resolve_sets

  !> Which nodes or elements a set names by their labels.
  type :: members_t
    logical, allocatable :: named(:)
  end type members_t

contains

  !> Make the sets: those of nodes as they are, those of elements with their nodes as well.
  subroutine resolve_sets(mesh, inp, nodes, elements, node)
    type(mesh_t), intent(inout) :: mesh
    type(inp_t), intent(inout) :: inp
    type(number_index_t), intent(in) :: nodes, elements
    !> Nodes of the elements in the file's order.
    integer, intent(in) :: node(:, :)

    type(members_t) :: of(inp%n_set)
    integer, allocatable :: member(:)
    integer :: s, n, k, i

    do s = 1, inp%n_set
      if (inp%set(s)%of_elements) then
        call own_members(inp, inp%set(s), elements, inp%n_element, of(s)%named)
      else
        call own_members(inp, inp%set(s), nodes, inp%n_node, of(s)%named)
      end if
    end do
    call add_sources(inp, node, of)
    n = count(inp%set(:inp%n_set)%of_elements)
    allocate (mesh%set(inp%n_set - n), mesh%element_set(n))
    n = 0
    k = 0
    do s = 1, inp%n_set
      member = pack([(i, i=1, size(of(s)%named))], of(s)%named)
      if (inp%set(s)%of_elements) then
        k = k + 1
        mesh%element_set(k)%name = lower_case(inp%set(s)%name)
        call move_alloc(member, mesh%element_set(k)%element)
      else
        n = n + 1
        mesh%set(n)%name = lower_case(inp%set(s)%name)
        call move_alloc(member, mesh%set(n)%node)
      end if
    end do
  end subroutine resolve_sets

  !> Find the nodes or elements that a set names by their labels; report those that the file does
  !> not have, and an empty set.
  subroutine own_members(inp, set, numbers, n, named)
    type(inp_t), intent(inout) :: inp
    type(inp_set_t), intent(in) :: set
    type(number_index_t), intent(in) :: numbers
    !> Number of all nodes or elements.
    integer, intent(in) :: n
    logical, allocatable, intent(out) :: named(:)

    character(len=:), allocatable :: what
    integer :: i, k, before

    what = trim(merge("element", "node   ", set%of_elements))
    before = inp%errors%count
    allocate (named(n), source=.false.)
    do i = 1, set%n
      k = numbers%find(set%label(i))
      if (k > 0) named(k) = .true.
      if (k == 0 .and. inp%errors%count == before) call inp%report(set%line_number(i), "set '"// &
          set%name//"' names "//what//" "//to_text(set%label(i))// &
          ", which the file does not have", "labels of "//what//"s")
    end do
    if (set%n == 0 .and. size(set%source) == 0) call inp%report(set%opened, "set '"//set%name// &
        "' is empty", "labels of "//what//"s")
  end subroutine own_members

  !> Add the members of the sets that sets name, until nothing changes; report sets that the file
  !> does not have.
  subroutine add_sources(inp, node, of)
    type(inp_t), intent(inout) :: inp
    !> Nodes of the elements.
    integer, intent(in) :: node(:, :)
    !> Members of the sets; get those of others.
    type(members_t), intent(inout) :: of(:)

    logical :: changed
    integer :: s, i, k, before

    do s = 1, size(of)
      do i = 1, size(inp%set(s)%source)
        associate (source => inp%set(s)%source(i))
          if (position_of_set(inp, source%name, source%of_elements) > 0) cycle
          call inp%report(source%line_number, "set '"//inp%set(s)%name//"' names set '"// &
              source%name//"', which the file does not have", "labels, or sets of the file")
        end associate
      end do
    end do
    changed = inp%errors%count == 0
    do while (changed)
      changed = .false.
      do s = 1, size(of)
        before = count(of(s)%named)
        do i = 1, size(inp%set(s)%source)
          associate (source => inp%set(s)%source(i))
            k = position_of_set(inp, source%name, source%of_elements)
            call unite(of(s)%named, of(k)%named, source%of_elements .and. &
                .not. inp%set(s)%of_elements)
          end associate
        end do
        changed = changed .or. count(of(s)%named) > before
      end do
    end do

  contains

    !> Add members, or the nodes of elements.
    subroutine unite(named, other, by_nodes)
      logical, intent(inout) :: named(:)
      logical, intent(in) :: other(:), by_nodes

      integer :: e

      if (.not. by_nodes) then
        named = named .or. other
        return
      end if
      do e = 1, size(other)
        if (other(e)) named(node(:, e)) = .true.
      end do
    end subroutine unite

  end subroutine add_sources

end module dd3_mesh_inp_sets
