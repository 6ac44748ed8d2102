! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of a law as written in the input against the registry's names and parameters.
module dd3_input_law
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, error_t
  use dd3_base_parameter, only : parameter_t, law_value_t, range_text, kind_text, pair_name
  use dd3_base_text, only : text_t, same_name, suggestion, join, to_text
  use dd3_input_case, only : law_spec_t
  use dd3_input_known_name, only : check_known_name
  use dd3_input_number, only : parse_pair, parse_real
  use dd3_input_number_check, only : check_range, not_a_number
  use dd3_input_table, only : find_key
  use dd3_input_text_file, only : read_lines, resolve_path
  implicit none
  private
  public :: check_law_name, check_law_values

  !> Largest size of a parameter: beyond any unit, and its powers in a law are numbers.
  real(wp), parameter :: largest_size = 1.0e30_wp

  !> Values of a law while they are collected: the first `count` of each array.
  type :: collection_t
    integer :: count = 0
    type(law_value_t), allocatable :: value(:)
    !> Position of each value among the parameters as written; 0 for a default.
    integer, allocatable :: from(:)
  contains
    procedure :: add => collection_add
  end type collection_t

contains

  !> Return the position of the law's name among the known ones; 0, with an error, if not found.
  subroutine check_law_name(spec, what, known, position, errors)
    type(law_spec_t), intent(in) :: spec
    !> Kind of law: "yield criterion", "hardening law", "back-stress law".
    character(len=*), intent(in) :: what
    character(len=*), intent(in) :: known(:)
    integer, intent(out) :: position
    type(error_list_t), intent(inout) :: errors

    call check_known_name(spec%name, spec%at, what, known, position, errors)
  end subroutine check_law_name

  !> Check the law's parameters against the rows and return the values in the order of the rows.
  !> Parameters with the default `-` that are left out have no value; other defaults are filled in.
  !> Each pair, written or from a file, is one value.
  subroutine check_law_values(spec, rows, values, errors, origin)
    type(law_spec_t), intent(in) :: spec
    type(parameter_t), intent(in) :: rows(:)
    type(law_value_t), allocatable, intent(out) :: values(:)
    type(error_list_t), intent(inout) :: errors
    !> Position in `spec%parameter` of each value; 0 for a default.
    integer, allocatable, intent(out), optional :: origin(:)

    type(law_value_t) :: value
    type(collection_t) :: all
    logical :: ok
    integer :: i, k

    do i = 1, size(spec%parameter)
      call check_law_parameter(spec, i, rows, errors)
    end do
    allocate (all%value(8), all%from(8))
    do k = 1, size(rows)
      value = law_value_t(rows(k)%name)
      i = find_parameter(spec, trim(rows(k)%name))
      if (rows(k)%repeatable) then
        call add_pairs(spec, all)
      else if (i > 0 .and. rows(k)%kind == kind_text) then
        call read_pairs(spec, i, rows, all, errors)
      else if (i > 0) then
        value%value = spec%parameter(i)%value
        call all%add(value, i)
      else if (rows(k)%default == "") then
        call errors%push_input(spec%at, "'"//trim(rows(k)%name)//"' is missing for "//spec%name, &
            trim(rows(k)%name)//"=value: "//trim(rows(k)%help), code="E121")
      else if (rows(k)%default /= "-") then
        call parse_real(trim(rows(k)%default), value%value, ok)
        call all%add(value, 0)
      end if
    end do
    values = all%value(:all%count)
    if (present(origin)) origin = all%from(:all%count)
  end subroutine check_law_values

  !> Append a value.
  subroutine collection_add(self, value, from)
    class(collection_t), intent(inout) :: self
    type(law_value_t), intent(in) :: value
    integer, intent(in) :: from

    type(law_value_t), allocatable :: larger(:)
    integer, allocatable :: larger_from(:)

    if (self%count == size(self%from)) then
      allocate (larger(2*self%count), larger_from(2*self%count))
      larger(:self%count) = self%value
      larger_from(:self%count) = self%from
      call move_alloc(larger, self%value)
      call move_alloc(larger_from, self%from)
    end if
    self%count = self%count + 1
    self%value(self%count) = value
    self%from(self%count) = from
  end subroutine collection_add

  !> Append the pairs written in the input.
  subroutine add_pairs(spec, all)
    type(law_spec_t), intent(in) :: spec
    type(collection_t), intent(inout) :: all

    integer :: i

    do i = 1, size(spec%parameter)
      associate (given => spec%parameter(i))
        if (given%key /= pair_name) cycle
        call all%add(law_value_t(pair_name, given%value, given%abscissa), i)
      end associate
    end do
  end subroutine add_pairs

  !> Append the pairs of a file: two numbers in each line, separated by blanks, a comma or a
  !> semicolon; `#` begins a comment.
  subroutine read_pairs(spec, i, rows, all, errors)
    type(law_spec_t), intent(in) :: spec
    !> Position in `spec%parameter` of the file's name.
    integer, intent(in) :: i
    type(parameter_t), intent(in) :: rows(:)
    type(collection_t), intent(inout) :: all
    type(error_list_t), intent(inout) :: errors

    type(text_t), allocatable :: line(:)
    type(error_t), allocatable :: error
    character(len=:), allocatable :: path
    type(law_value_t) :: value
    logical :: ok
    integer :: n, row

    if (spec%parameter(i)%text == "") return
    if (any(all%value(:all%count)%name == pair_name)) then
      call errors%push_input(spec%parameter(i)%key_at, &
          "pairs p:Y and a file of pairs cannot be combined", "one of the two", code="E124")
      return
    end if
    row = find_key(rows, pair_name)
    path = resolve_path(spec%folder, spec%parameter(i)%text)
    call read_lines(path, line, error)
    if (allocated(error)) then
      call errors%push_input(spec%parameter(i)%at, "cannot read '"//path//"': "//error%message, &
          code="E101")
      return
    end if
    value%name = pair_name
    do n = 1, size(line)
      line(n)%s = pair_of(line(n)%s)
      if (line(n)%s == "") cycle
      call parse_pair(line(n)%s, value%abscissa, value%value, ok)
      if (.not. ok) then
        call errors%push_input(spec%parameter(i)%at, "expected 2 numbers in line "// &
            to_text(n)//" of '"//path//"'", &
            "p and Y in each line, with decimal points; # begins a comment", code="E132")
        return
      end if
      call check_range(value%value, rows(row), spec%parameter(i)%at, &
          "Y"//range_text(rows(row))//", in line "//to_text(n)//" of '"//path//"'", errors)
      call all%add(value, i)
    end do
  end subroutine read_pairs

  !> Return the words of a line as a pair with a colon, without the comment.
  pure function pair_of(line) result(pair)
    character(len=*), intent(in) :: line
    character(len=:), allocatable :: pair

    integer :: last, gap, i

    last = index(line//"#", "#") - 1
    pair = line(:last)
    do i = 1, last
      if (scan(pair(i:i), ",;"//achar(9)) > 0) pair(i:i) = " "
    end do
    pair = trim(adjustl(pair))
    gap = index(pair, " ")
    if (gap > 0) pair = pair(:gap - 1)//":"//trim(adjustl(pair(gap:)))
  end function pair_of

  !> Check parameter i as written.
  subroutine check_law_parameter(spec, i, rows, errors)
    type(law_spec_t), intent(in) :: spec
    integer, intent(in) :: i
    type(parameter_t), intent(in) :: rows(:)
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: known
    integer :: k

    associate (given => spec%parameter(i))
      k = find_key(rows, given%key)
      if (k == 0) then
        known = "no parameters"
        if (size(rows) > 0) known = "one of: "//join(rows%name, " ")
        call errors%push_input(given%key_at, "unknown parameter '"//given%key//"' of "// &
            spec%name//suggestion(given%key, rows%name), known, code="E112")
      else if (find_parameter(spec, given%key) < i .and. .not. rows(k)%repeatable) then
        call errors%push_input(given%key_at, "'"//given%key//"' is given twice", &
            "one of: "//join(rows%name, " ")//", each once, in upper or lower case", code="E122")
      else if (given%text == "") then
        call errors%push_input(given%at, "no value is given for '"//given%key//"'", &
            trim(rows(k)%name)//"="//trim(merge("path  ", "number", rows(k)%kind == kind_text))// &
            range_text(rows(k)), code="E121")
      else if (rows(k)%kind == kind_text) then
        return  ! checked when the file is read
      else if (.not. given%numeric .and. rows(k)%repeatable) then
        call errors%push_input(given%at, "'"//given%text//"' is not a pair of numbers", &
            trim(rows(k)%name)//": "//trim(rows(k)%help), code="E131")
      else if (.not. given%numeric) then
        call errors%push_input(given%at, not_a_number(given%text), &
            trim(rows(k)%name)//"=number"//range_text(rows(k)), code="E131")
      else if (abs(given%value) > largest_size) then
        call errors%push_input(given%at, trim(rows(k)%name)//" = "//to_text(given%value)// &
            " is out of range", "at most 1e30 in size", code="E133")
      else
        call check_range(given%value, rows(k), given%at, trim(rows(k)%name)//"=number"// &
            range_text(rows(k)), errors)
      end if
    end associate
  end subroutine check_law_parameter

  !> Return the position of the first parameter with a name; 0 if not found.
  pure integer function find_parameter(spec, name)
    type(law_spec_t), intent(in) :: spec
    character(len=*), intent(in) :: name

    do find_parameter = 1, size(spec%parameter)
      if (same_name(spec%parameter(find_parameter)%key, name)) return
    end do
    find_parameter = 0
  end function find_parameter

end module dd3_input_law
