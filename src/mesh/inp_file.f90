! SPDX-License-Identifier: GPL-3.0-or-later
!> Reader of a strict subset of the `.inp` files of Abaqus and CalculiX: *HEADING, *NODE, *ELEMENT
!> of one type, *NSET, *ELSET and *MPC. Anything else is refused by name and line. The result is the
!> file as plain data, with nodes and elements by label; all errors of a file are reported.
module dd3_mesh_inp_file
  use dd3_base_error, only : error_t, error_list_t, location_t
  use dd3_base_text, only : join, upper_case
  use dd3_input_text_file, only : read_lines
  use dd3_mesh_inp, only : find_set, inp_t, new_inp
  use dd3_mesh_inp_data, only : add_source, constraint, element, end_element, heading, is_name, &
      keywords, node, read_data, reading_t, set, skipped
  use dd3_mesh_inp_element, only : inp_type_names, nodes_of_type
  use dd3_mesh_inp_line, only : is_comment, parameter_list_t, split_keyword
  implicit none
  private
  public :: read_inp

  !> Errors after which the reader gives up.
  integer, parameter :: most_errors = 25

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
    case ("*mpc")
      at%section = constraint
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

  !> Read the type of the elements of a section; all sections have the same.
  subroutine set_type(self, at, text, word)
    type(inp_t), intent(inout) :: self
    type(reading_t), intent(inout) :: at
    character(len=*), intent(in) :: text
    type(parameter_list_t), intent(inout) :: word

    character(len=:), allocatable :: name
    integer :: i

    call take_name(self, at, word, "type", i)
    if (i == 0 .and. all(word%name(2:word%n) /= "type")) then
      call self%report(at%number, "the type of the elements is missing", &
        "*ELEMENT, TYPE="//join(inp_type_names, " or "))
    end if
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

end module dd3_mesh_inp_file
