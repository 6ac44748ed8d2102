! SPDX-License-Identifier: GPL-3.0-or-later
!> The content of an `.inp` file as plain data: nodes and elements by label, sets, and the line of
!> each part for the messages.
module dd3_mesh_inp
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : same_name, text_t
  use dd3_input_token, only : line_t, place
  implicit none
  private
  public :: inp_t, inp_set_t, inp_source_t, new_inp, find_set, position_of_set, add_member, &
      make_room_for_nodes, &
      make_room_for_elements, add_constraint

  !> A set that another one names.
  type :: inp_source_t
    character(len=:), allocatable :: name
    !> Whether it holds elements, whose nodes are meant in a set of nodes.
    logical :: of_elements = .false.
    !> Line that names it.
    integer :: line_number = 0
  end type inp_source_t

  !> A set as written in the file.
  type :: inp_set_t
    character(len=:), allocatable :: name
    !> Whether it holds elements.
    logical :: of_elements = .false.
    !> Line that begins it.
    integer :: opened = 0
    !> Labels, `label(1:n)`, and the lines that name them.
    integer :: n = 0
    integer, allocatable :: label(:), line_number(:)
    !> Sets whose members it has too.
    type(inp_source_t), allocatable :: source(:)
  end type inp_set_t

  !> The content of a file, with the line of each part for the messages.
  type :: inp_t
    character(len=:), allocatable :: file
    type(text_t), allocatable :: line(:)
    integer :: n_node = 0, n_element = 0, n_set = 0, n_constraint = 0
    !> Coordinates, mm, `x(:, 1:n_node)`.
    real(wp), allocatable :: x(:, :)
    integer, allocatable :: node_label(:), node_line(:)
    !> Type of the elements, and its number of nodes; 0 before the first element.
    character(len=5) :: element_type = ""
    integer :: n_element_node = 0
    !> Labels of the nodes of the elements in the file's order, `corner(:, 1:n_element)`.
    integer, allocatable :: corner(:, :)
    integer, allocatable :: element_label(:), element_line(:)
    !> Labels of the bound nodes and of the ends of their edges, `constraint(:, 1:n_constraint)`.
    integer, allocatable :: constraint(:, :), constraint_line(:)
    !> `set(1:n_set)`.
    type(inp_set_t), allocatable :: set(:)
    type(error_list_t) :: errors
  contains
    procedure :: report
  end type inp_t

contains

  !> Allocate the lists.
  pure subroutine new_inp(self, file)
    type(inp_t), intent(inout) :: self
    character(len=*), intent(in) :: file

    integer, parameter :: room = 1024

    self%file = file
    allocate (self%x(3, room), self%node_label(room), self%node_line(room))
    allocate (self%corner(27, room), self%element_label(room), self%element_line(room))
    allocate (self%constraint(3, room), self%constraint_line(room))
    allocate (self%set(8))
  end subroutine new_inp

  !> Add an error at a line, or at some columns of it.
  subroutine report(self, number, message, expected, first, last)
    class(inp_t), intent(inout) :: self
    !> Number of the line.
    integer, intent(in) :: number
    character(len=*), intent(in) :: message, expected
    !> Columns; the whole line if absent.
    integer, intent(in), optional :: first, last

    type(line_t) :: line

    line%file = self%file
    line%number = number
    line%text = self%line(number)%s
    if (present(first)) then
      call self%errors%push_input(place(line, first, max(1, last - first + 1)), message, expected, &
          code="E147")
    else
      call self%errors%push_input(place(line, 1, len_trim(line%text)), message, expected, &
          code="E147")
    end if
  end subroutine report

  !> Find a set by its name; a new name adds one.
  subroutine find_set(self, name, of_elements, line_number, position)
    type(inp_t), intent(inout) :: self
    character(len=*), intent(in) :: name
    logical, intent(in) :: of_elements
    !> Line that names it.
    integer, intent(in) :: line_number
    integer, intent(out) :: position

    type(inp_set_t), allocatable :: larger(:)
    integer :: i

    position = position_of_set(self, name, of_elements)
    if (position > 0) return
    position = self%n_set + 1
    if (self%n_set == size(self%set)) then
      allocate (larger(2*self%n_set))
      do i = 1, self%n_set
        call move_set(self%set(i), larger(i))
      end do
      call move_alloc(larger, self%set)
    end if
    self%n_set = self%n_set + 1
    self%set(position)%name = name
    self%set(position)%of_elements = of_elements
    self%set(position)%opened = line_number
    allocate (self%set(position)%label(64), self%set(position)%line_number(64))
    allocate (self%set(position)%source(0))
  end subroutine find_set

  !> Return the position of a set; 0 if there is none of this name.
  pure integer function position_of_set(self, name, of_elements) result(position)
    type(inp_t), intent(in) :: self
    character(len=*), intent(in) :: name
    logical, intent(in) :: of_elements

    do position = self%n_set, 1, -1
      if (self%set(position)%of_elements .neqv. of_elements) cycle
      if (same_name(self%set(position)%name, name)) return
    end do
  end function position_of_set

  !> Move a set without copying its members.
  pure subroutine move_set(from, to)
    type(inp_set_t), intent(inout) :: from, to

    call move_alloc(from%name, to%name)
    call move_alloc(from%label, to%label)
    call move_alloc(from%line_number, to%line_number)
    call move_alloc(from%source, to%source)
    to%of_elements = from%of_elements
    to%opened = from%opened
    to%n = from%n
  end subroutine move_set

  !> Append a member to a set.
  pure subroutine add_member(set, label, line_number)
    type(inp_set_t), intent(inout) :: set
    integer, intent(in) :: label, line_number

    if (set%n == size(set%label)) then
      call enlarge(set%label)
      call enlarge(set%line_number)
    end if
    set%n = set%n + 1
    set%label(set%n) = label
    set%line_number(set%n) = line_number
  end subroutine add_member

  pure subroutine make_room_for_nodes(self)
    type(inp_t), intent(inout) :: self

    real(wp), allocatable :: larger(:, :)

    allocate (larger(3, 2*self%n_node))
    larger(:, :self%n_node) = self%x
    call move_alloc(larger, self%x)
    call enlarge(self%node_label)
    call enlarge(self%node_line)
  end subroutine make_room_for_nodes

  pure subroutine make_room_for_elements(self)
    type(inp_t), intent(inout) :: self

    integer, allocatable :: larger(:, :)

    allocate (larger(size(self%corner, 1), 2*self%n_element))
    larger(:, :self%n_element) = self%corner
    call move_alloc(larger, self%corner)
    call enlarge(self%element_label)
    call enlarge(self%element_line)
  end subroutine make_room_for_elements

  !> Append a constraint.
  pure subroutine add_constraint(self, label, line_number)
    type(inp_t), intent(inout) :: self
    !> Labels of the bound node and of the ends of its edge.
    integer, intent(in) :: label(3), line_number

    integer, allocatable :: larger(:, :)

    if (self%n_constraint == size(self%constraint_line)) then
      allocate (larger(3, 2*self%n_constraint))
      larger(:, :self%n_constraint) = self%constraint
      call move_alloc(larger, self%constraint)
      call enlarge(self%constraint_line)
    end if
    self%n_constraint = self%n_constraint + 1
    self%constraint(:, self%n_constraint) = label
    self%constraint_line(self%n_constraint) = line_number
  end subroutine add_constraint

  !> Double the size of a list.
  pure subroutine enlarge(list)
    integer, allocatable, intent(inout) :: list(:)

    integer, allocatable :: larger(:)

    allocate (larger(2*size(list)))
    larger(:size(list)) = list
    call move_alloc(larger, list)
  end subroutine enlarge

end module dd3_mesh_inp
