! SPDX-License-Identifier: GPL-3.0-or-later
!> Data lines of a mesh file: nodes, elements and members of sets.
module dd3_mesh_inp_data
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text, upper_case
  use dd3_input_number, only : parse_real
  use dd3_input_number_check, only : not_a_number
  use dd3_mesh_inp, only : add_constraint, add_member, inp_source_t, inp_t, &
      make_room_for_elements, make_room_for_nodes
  use dd3_mesh_inp_line, only : field_integer, fields_t, split_fields
  implicit none
  private
  public :: reading_t, outside, skipped, heading, node, element, set, constraint, keywords
  public :: read_data, end_element, add_source, is_name

  !> What the data lines below a keyword are.
  integer, parameter :: outside = 0, skipped = 1, heading = 2, node = 3, element = 4, set = 5, &
      constraint = 6
  !> Largest coordinate, mm.
  real(wp), parameter :: largest_coordinate = 1.0e7_wp
  !> Keywords that are read.
  character(len=*), parameter :: keywords = "*HEADING, *NODE, *ELEMENT, *NSET, *ELSET, *MPC"

  !> State of the reader.
  type :: reading_t
    !> One of the sections above.
    integer :: section = outside
    !> Line being read.
    integer :: number = 0
    !> Set that gets the nodes or elements of the section; 0 for none.
    integer :: set = 0
    !> Whether the lines of a set give first, last, increment.
    logical :: generate = .false.
    !> Number of nodes read of an element that goes on in the next line; 0 between elements.
    integer :: n_read = 0
  end type reading_t

contains

  !> Read a line of data.
  subroutine read_data(self, at, text)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text

    type(fields_t) :: fields

    if (at%section == heading .or. at%section == skipped) return
    if (at%section == outside) then
      at%section = skipped
      call self%report(at%number, "data without a keyword above", keywords)
      return
    end if
    call split_fields(text, fields)
    if (fields%overflow) then
      call self%report(at%number, "more than 64 values in a line", "at most 16 values")
      return
    end if
    select case (at%section)
    case (node)
      call read_node(self, at, text, fields)
    case (element)
      call read_element(self, at, text, fields)
    case (constraint)
      call read_constraint(self, at, text, fields)
    case default
      call read_members(self, at, text, fields)
    end select
  end subroutine read_data

  !> Read a node: label, x, y, z.
  subroutine read_node(self, at, text, fields)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: text
    type(fields_t), intent(in) :: fields

    character(len=*), parameter :: form = "label, x, y, z of a node"
    real(wp) :: x(3)
    integer :: label, i
    logical :: ok

    if (fields%n /= 4) then
      call self%report(at%number, "expected 4 values, got "//to_text(fields%n), form)
      return
    end if
    call read_label(self, at, text, fields, 1, form, label)
    do i = 1, 3
      associate (word => text(fields%first(i + 1):fields%last(i + 1)))
        call parse_real(word, x(i), ok)
        if (.not. ok) then
          call self%report(at%number, not_a_number(word), form, fields%first(i + 1), &
              fields%last(i + 1))
        else if (abs(x(i)) > largest_coordinate) then
          call self%report(at%number, "'"//word//"' is out of range", "at most 1e7 mm", &
              fields%first(i + 1), fields%last(i + 1))
        end if
      end associate
    end do
    if (self%n_node == size(self%node_label)) call make_room_for_nodes(self)
    self%n_node = self%n_node + 1
    self%x(:, self%n_node) = x
    self%node_label(self%n_node) = label
    self%node_line(self%n_node) = at%number
    if (at%set > 0) call add_member(self%set(at%set), label, at%number)
  end subroutine read_node

  !> Read an element, or the rest of one: label, then the labels of its nodes; a line that ends with
  !> a comma goes on in the next one.
  subroutine read_element(self, at, text, fields)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text
    type(fields_t), intent(in) :: fields

    character(len=:), allocatable :: form
    integer :: i, label

    form = "label and "//to_text(self%n_element_node)//" nodes of an element"
    if (at%n_read == 0) then
      if (self%n_element == size(self%element_label)) call make_room_for_elements(self)
      self%n_element = self%n_element + 1
      self%corner(:, self%n_element) = 0
      self%element_line(self%n_element) = at%number
    end if
    do i = 1, fields%n
      call read_label(self, at, text, fields, i, form, label)
      if (at%n_read == 0) self%element_label(self%n_element) = label
      if (at%n_read > 0 .and. at%n_read <= self%n_element_node) then
        self%corner(at%n_read, self%n_element) = label
      end if
      at%n_read = at%n_read + 1
    end do
    if (fields%open .and. at%n_read <= self%n_element_node) return
    call end_element(self, at)
  end subroutine read_element

  !> End an element: check its number of nodes, and add it to the set of the section.
  subroutine end_element(self, at)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at

    if (at%n_read == 0) return
    associate (label => self%element_label(self%n_element))
      if (at%n_read /= self%n_element_node + 1) then
        call self%report(self%element_line(self%n_element), "element "//to_text(label)//" has "// &
            to_text(at%n_read - 1)//" nodes", to_text(self%n_element_node)//" for type "// &
            trim(self%element_type)//"; a line that ends with a comma goes on in the next one")
      end if
      if (at%set > 0) call add_member(self%set(at%set), label, self%element_line(self%n_element))
    end associate
    at%n_read = 0
  end subroutine end_element

  !> Read members of a set: labels, or first, last and increment.
  subroutine read_members(self, at, text, fields)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: text
    type(fields_t), intent(in) :: fields

    character(len=*), parameter :: form = "labels, names of sets, or with GENERATE: first, "// &
        "last, increment"
    integer :: i, value(3), label, before

    before = self%errors%count
    value = 1
    if (at%generate .and. (fields%n < 2 .or. fields%n > 3)) then
      call self%report(at%number, "expected 2 or 3 values, got "//to_text(fields%n), form)
      return
    end if
    do i = 1, fields%n
      if (.not. at%generate .and. is_name(text(fields%first(i):fields%last(i)))) then
        call add_source(self, at, text(fields%first(i):fields%last(i)), &
            self%set(at%set)%of_elements)
        cycle
      end if
      call read_label(self, at, text, fields, i, form, label)
      if (at%generate) value(i) = label
      if (.not. at%generate) call add_member(self%set(at%set), label, at%number)
    end do
    if (.not. at%generate .or. self%errors%count > before) return
    if (value(2) < value(1)) then
      call self%report(at%number, "the last label is smaller than the first", form)
      return
    end if
    do label = value(1), value(2), value(3)
      if (self%set(at%set)%n > 20000000) exit
      call add_member(self%set(at%set), label, at%number)
    end do
  end subroutine read_members

  !> Read a constraint: its type, a bound node, and the ends of the edge in whose middle it lies.
  subroutine read_constraint(self, at, text, fields)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: text
    type(fields_t), intent(in) :: fields

    character(len=*), parameter :: form = "LINEAR, a node, the two ends of the edge in whose "// &
        "middle it lies"
    integer :: label(3), i, before

    before = self%errors%count
    associate (word => text(fields%first(1):fields%last(1)))
      if (upper_case(word) /= "LINEAR") then
        call self%report(at%number, "constraints of type '"//word//"' are not read", form, &
            fields%first(1), fields%last(1))
      else if (fields%n /= 4) then
        call self%report(at%number, "expected 4 values, got "//to_text(fields%n), form)
      end if
    end associate
    if (self%errors%count > before) return
    do i = 1, 3
      call read_label(self, at, text, fields, i + 1, form, label(i))
    end do
    if (self%errors%count == before) call add_constraint(self, label, at%number)
  end subroutine read_constraint

  !> Add a set whose members the set of the section has too.
  subroutine add_source(self, at, name, of_elements)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: name
    logical, intent(in) :: of_elements

    type(inp_source_t) :: source

    source%name = name
    source%of_elements = of_elements
    source%line_number = at%number
    self%set(at%set)%source = [self%set(at%set)%source, source]
  end subroutine add_source

  !> Whether a word is the name of a set: it begins with a letter.
  pure logical function is_name(word)
    character(len=*), intent(in) :: word

    is_name = len(word) > 0
    if (is_name) is_name = scan(upper_case(word(1:1)), "ABCDEFGHIJKLMNOPQRSTUVWXYZ") > 0
  end function is_name

  !> Read a label; 0 if it is not one.
  subroutine read_label(self, at, text, fields, i, form, label)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: text
    type(fields_t), intent(in) :: fields
    !> Number of the field.
    integer, intent(in) :: i
    !> Expected form of the line.
    character(len=*), intent(in) :: form
    integer, intent(out) :: label

    logical :: ok

    associate (word => text(fields%first(i):fields%last(i)))
      call field_integer(word, label, ok)
      if (ok) return
      label = 0
      call self%report(at%number, "'"//word//"' is not a label: expected an integer from 1 to "// &
          "999999999", form, fields%first(i), fields%last(i))
    end associate
  end subroutine read_label

end module dd3_mesh_inp_data
