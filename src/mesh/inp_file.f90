! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of a strict subset of the `.inp` files of Abaqus and CalculiX: *HEADING, *NODE, *ELEMENT
!> of one type, *NSET and *ELSET. Anything else is refused by name and line. The result is the file
!> as plain data, with nodes and elements by label; all errors of a file are reported.
module dd3_mesh_inp_file
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : join, to_text, upper_case
  use dd3_input_number, only : parse_real
  use dd3_input_number_check, only : not_a_number
  use dd3_input_text_file, only : read_lines
  use dd3_mesh_inp, only : add_member, find_set, inp_source_t, inp_t, make_room_for_elements, &
      make_room_for_nodes, new_inp
  use dd3_mesh_inp_element, only : inp_type_names, nodes_of_type
  use dd3_mesh_inp_line, only : field_integer, fields_t, is_comment, parameter_list_t, &
      split_fields, split_keyword
  implicit none
  private
  public :: read_inp

  !> What the data lines below a keyword are.
  integer, parameter :: outside = 0, skipped = 1, heading = 2, node = 3, element = 4, set = 5
  !> Largest coordinate, mm.
  real(wp), parameter :: largest_coordinate = 1.0e7_wp
  !> Errors after which the reader gives up.
  integer, parameter :: most_errors = 25
  !> Keywords that are read.
  character(len=*), parameter :: keywords = "*HEADING, *NODE, *ELEMENT, *NSET, *ELSET"

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

  !> Read a file. Its errors are in `self%errors`.
  subroutine read_inp(self, file, location, errors)
    type(inp_t), intent(out) :: self
    character(len=*), intent(in) :: file
    !> Where the input names the file.
    type(location_t), intent(in) :: location
    !> Gets an error if the file cannot be read.
    type(error_list_t), intent(inout) :: errors

    type(error_t), allocatable :: error
    type(reading_t) :: at

    call new_inp(self, file)
    call read_lines(file, self%line, error)
    if (allocated(error)) then
      call errors%push_input(location, "cannot read the mesh '"//file//"': "//error%message, &
          "a mesh as an Abaqus or CalculiX .inp file", code="E101")
      return
    end if
    do while (at%number < size(self%line) .and. self%errors%count <= most_errors)
      at%number = at%number + 1
      if (is_comment(self%line(at%number)%s)) cycle
      if (self%line(at%number)%s(1:1) == "*") then
        call end_element(self, at)
        call begin_section(self, at, self%line(at%number)%s)
      else
        call read_data(self, at, self%line(at%number)%s)
      end if
    end do
    call end_element(self, at)
    if (self%errors%count > 0) return
    if (self%n_node == 0) call errors%push_input(location, "the mesh '"//file// &
        "' contains no node", "*NODE, then lines: label, x, y, z", code="E102")
    if (self%n_node > 0 .and. self%n_element == 0) call errors%push_input(location, "the mesh '"// &
        file//"' contains no element", "*ELEMENT, TYPE=C3D8, then lines: label, 8 nodes", &
        code="E102")
  end subroutine read_inp

  !> Begin the section of a keyword.
  subroutine begin_section(self, at, text)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text

    type(parameter_list_t) :: word
    integer :: number

    call split_keyword(text, word)
    number = at%number
    at = reading_t(number=number, section=skipped)
    select case (word%name(1))
    case ("*heading")
      at%section = heading
    case ("*node")
      call take_set(self, at, text, word, "nset")
      at%section = node
    case ("*element")
      call take_set(self, at, text, word, "elset")
      call set_type(self, at, text, word)
    case ("*nset")
      call begin_set(self, at, text, word, "nset")
      call take_elements(self, at, text, word)
    case ("*elset")
      call begin_set(self, at, text, word, "elset")
    case default
      call self%report(number, "the keyword "//upper_case(trim(word%name(1)))//" is not read", &
          keywords//"; a model is turned into such a file by dd3 mesh", 1, &
          len_trim(word%name(1)))
      return
    end select
    call report_untaken(self, at, word)
    call check_end(self, at, word)
  end subroutine begin_section

  !> Report the parameters of a keyword that nobody took.
  subroutine report_untaken(self, at, word)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    type(parameter_list_t), intent(in) :: word

    character(len=:), allocatable :: what
    integer :: i

    do i = 2, word%n
      if (word%taken(i) .or. word%name(i) == "") cycle
      what = " is not read"
      if (any(word%name(2:i - 1) == word%name(i))) what = " is given twice"
      call self%report(at%number, "the parameter "//upper_case(trim(word%name(i)))//" of "// &
          upper_case(trim(word%name(1)))//what, known_parameters(word%name(1)), &
          word%column(i), word%column(i) + len_trim(word%name(i)) - 1)
    end do
  end subroutine report_untaken

  !> Return the parameters of a keyword as an expectation.
  pure function known_parameters(keyword) result(text)
    character(len=*), intent(in) :: keyword
    character(len=:), allocatable :: text

    select case (keyword)
    case ("*node")
      text = "NSET"
    case ("*element")
      text = "TYPE ELSET"
    case ("*nset")
      text = "NSET GENERATE ELSET"
    case ("*elset")
      text = "ELSET GENERATE"
    case default
      text = "no parameters"
    end select
  end function known_parameters

  !> Report a keyword line that goes on in the next line.
  subroutine check_end(self, at, word)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    type(parameter_list_t), intent(in) :: word

    if (.not. word%open .or. at%number == size(self%line)) return
    if (.not. is_name(adjustl(self%line(at%number + 1)%s))) return
    call self%report(at%number + 1, "the keyword line above ends with a comma and goes on here", &
        "all parameters in one line")
  end subroutine check_end

  !> Take a parameter whose value is a name; 0 if it is not given, or has no value.
  subroutine take_name(self, at, word, name, position)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    type(parameter_list_t), intent(inout) :: word
    character(len=*), intent(in) :: name
    integer, intent(out) :: position

    call word%take(name, position)
    if (position == 0) return
    if (word%last(position) >= word%first(position)) return
    call self%report(at%number, upper_case(name)//" has no value", upper_case(name)//"=name", &
        word%column(position), word%column(position) + len(name) - 1)
    position = 0
  end subroutine take_name

  !> Take the name of a set that gets the nodes or elements of a section.
  subroutine take_set(self, at, text, word, name)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(inout) :: word
    !> "nset" or "elset".
    character(len=*), intent(in) :: name

    integer :: i

    call take_name(self, at, word, name, i)
    if (i > 0) call find_set(self, text(word%first(i):word%last(i)), name == "elset", &
        at%number, at%set)
  end subroutine take_set

  !> Begin the members of a set; without a name they are reported.
  subroutine begin_set(self, at, text, word, name)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(inout) :: word
    !> "nset" or "elset".
    character(len=*), intent(in) :: name

    integer :: i

    call word%take("generate", i)
    at%generate = i > 0
    call take_set(self, at, text, word, name)
    if (at%set > 0) then
      at%section = set
    else if (all(word%name(2:word%n) /= name)) then
      call self%report(at%number, "the set has no name", "*"//upper_case(name)//", "// &
          upper_case(name)//"=name")
    end if
  end subroutine begin_set

  !> Take the set of elements whose nodes a set of nodes has.
  subroutine take_elements(self, at, text, word)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(in) :: at
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(inout) :: word

    integer :: i

    call take_name(self, at, word, "elset", i)
    if (i > 0 .and. at%set > 0) call add_source(self, at, text(word%first(i):word%last(i)), .true.)
  end subroutine take_elements

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

  !> Read the type of the elements of a section; all sections have the same.
  subroutine set_type(self, at, text, word)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(inout) :: word

    character(len=:), allocatable :: name
    integer :: i

    call take_name(self, at, word, "type", i)
    if (i == 0 .and. all(word%name(2:word%n) /= "type")) &
        call self%report(at%number, "the type of the elements is missing", &
        "*ELEMENT, TYPE="//join(inp_type_names, " or "))
    if (i == 0) return
    name = upper_case(text(word%first(i):word%last(i)))
    if (nodes_of_type(name) == 0) then
      call self%report(at%number, "elements of type "//name//" are not read", "TYPE="// &
          join(inp_type_names, " or ")//", hexahedra; their integration is chosen by `element` "// &
          "of *MESH", word%first(i), word%last(i))
    else if (self%n_element_node > 0 .and. name /= self%element_type) then
      call self%report(at%number, "elements of type "//name//" after others of type "// &
          trim(self%element_type), "one type for the whole mesh", word%first(i), word%last(i))
    else
      at%section = element
      self%element_type = name
      self%n_element_node = nodes_of_type(name)
    end if
  end subroutine set_type

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
      if (at%n_read > 0 .and. at%n_read <= self%n_element_node) &
          self%corner(at%n_read, self%n_element) = label
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

end module dd3_mesh_inp_file
