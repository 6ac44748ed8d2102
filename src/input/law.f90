!> Checks a law as written in the input against a registry's table of laws and parameters.
module dd3_input_law
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : as_written, error_list_t, error_t
  use dd3_base_parameter, only : parameter_t, law_value_t, range_text, kind_text, pair_name
  use dd3_base_text, only : text_t, same_name, suggestion, join, to_text
  use dd3_input_case, only : law_spec_t
  use dd3_input_number, only : parse_pair, parse_real
  use dd3_input_table, only : find_key
  use dd3_input_text_file, only : read_lines, resolve_path
  use dd3_input_value, only : check_range, no_number
  implicit none
  private
  public :: check_law_name, check_law_values

contains

  !> Position of the law's name among the known ones; 0, and an error with the nearest one, if it
  !> is not there.
  subroutine check_law_name(spec, what, known, position, errors)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> What it is: "yield criterion", "hardening law", "back-stress law".
    character(len=*), intent(in) :: what
    !> Names of the laws there are.
    character(len=*), intent(in) :: known(:)
    !> Position in `known`.
    integer, intent(out) :: position
    !> Receives the error.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: meant

    do position = 1, size(known)
      if (same_name(known(position), spec%name)) return
    end do
    position = 0
    meant = suggestion(spec%name, known)
    if (meant == "") meant = names_holding(spec%name, known)
    call errors%push_input(spec%at, "there is no "//what//" '"// &
        as_written(spec%name, spec%at)//"'"//meant, &
        "one of: "//join(known, " "))
  end subroutine check_law_name

  !> The known names that hold a name, as a question; empty where there is none.
  pure function names_holding(name, known) result(text)
    !> What was written.
    character(len=*), intent(in) :: name
    !> The names there are.
    character(len=*), intent(in) :: known(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, size(known)
      if (len(name) < 3 .or. index(known(i), name) == 0) cycle
      if (text /= "") text = text//" or"
      text = text//" '"//trim(known(i))//"'"
    end do
    if (text /= "") text = "; did you mean"//text//"?"
  end function names_holding

  !> The law's parameters checked against the rows: unknown, doubled, missing, no number, out of
  !> range. Rows with the
  !> default `-` may be left out and are then not among the values; other defaults are filled in.
  !> Points, and those of a file, are values each.
  subroutine check_law_values(spec, rows, values, errors, origin)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> Its parameters.
    type(parameter_t), intent(in) :: rows(:)
    !> The values, in the order of the rows.
    type(law_value_t), allocatable, intent(out) :: values(:)
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors
    !> Which parameter as written each value comes from; 0 for a default.
    integer, allocatable, intent(out), optional :: origin(:)

    type(law_value_t) :: value
    integer, allocatable :: from(:)
    logical :: ok
    integer :: i, k

    do i = 1, size(spec%parameter)
      call check_law_parameter(spec, i, rows, errors)
    end do
    allocate (values(0), from(0))
    do k = 1, size(rows)
      value = law_value_t(rows(k)%name)
      i = find_parameter(spec, trim(rows(k)%name))
      if (rows(k)%repeatable) then
        call take_points(spec, values, from)
      else if (i > 0 .and. rows(k)%kind == kind_text) then
        call read_points(spec, i, rows, values, from, errors)
      else if (i > 0) then
        value%value = spec%parameter(i)%value
        values = [values, value]
        from = [from, i]
      else if (rows(k)%default == "") then
        call errors%push_input(spec%at, "'"//trim(rows(k)%name)//"' is missing for "//spec%name, &
            trim(rows(k)%name)//"=value: "//trim(rows(k)%help))
      else if (rows(k)%default /= "-") then
        call parse_real(trim(rows(k)%default), value%value, ok)
        values = [values, value]
        from = [from, 0]
      end if
    end do
    if (present(origin)) call move_alloc(from, origin)
  end subroutine check_law_values

  !> Adds the points written in the input.
  subroutine take_points(spec, values, from)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> Receives the points.
    type(law_value_t), allocatable, intent(inout) :: values(:)
    !> Receives where they come from.
    integer, allocatable, intent(inout) :: from(:)

    integer :: i

    do i = 1, size(spec%parameter)
      associate (given => spec%parameter(i))
        if (given%key /= pair_name) cycle
        values = [values, law_value_t(pair_name, given%value, given%abscissa)]
        from = [from, i]
      end associate
    end do
  end subroutine take_points

  !> Adds the points of a file: two numbers in each line, blanks, a comma or a semicolon between
  !> them, comments after a `#`.
  subroutine read_points(spec, i, rows, values, from, errors)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> Position of the parameter that names the file.
    integer, intent(in) :: i
    !> The law's parameters.
    type(parameter_t), intent(in) :: rows(:)
    !> Receives the points.
    type(law_value_t), allocatable, intent(inout) :: values(:)
    !> Receives where they come from.
    integer, allocatable, intent(inout) :: from(:)
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    type(text_t), allocatable :: line(:)
    type(error_t), allocatable :: error
    character(len=:), allocatable :: path
    type(law_value_t) :: value
    logical :: ok
    integer :: n, row

    if (spec%parameter(i)%text == "") return
    if (size(from) > 0) then
      call errors%push_input(spec%parameter(i)%key_at, "points are given beside a file of them", &
          "one of them")
      return
    end if
    row = find_key(rows, pair_name)
    path = resolve_path(spec%folder, spec%parameter(i)%text)
    call read_lines(path, line, error)
    if (allocated(error)) then
      call errors%push_input(spec%parameter(i)%at, "'"//path//"' cannot be read: "//error%message)
      return
    end if
    value%name = pair_name
    do n = 1, size(line)
      line(n)%s = pair_of(line(n)%s)
      if (line(n)%s == "") cycle
      call parse_pair(line(n)%s, value%abscissa, value%value, ok)
      if (.not. ok) then
        call errors%push_input(spec%parameter(i)%at, "'"//path//"', line "//to_text(n)// &
            " does not hold two numbers", &
            "p and Y in each line, decimals with a point; # before a heading")
        return
      end if
      call check_range(value%value, rows(row), spec%parameter(i)%at, &
          "Y"//range_text(rows(row))//", in line "//to_text(n)//" of '"//path//"'", errors)
      values = [values, value]
      from = [from, i]
    end do
  end subroutine read_points

  !> The numbers of a line with a colon between them, without its comment.
  pure function pair_of(line) result(pair)
    !> The line.
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

  !> Checks one parameter as written.
  subroutine check_law_parameter(spec, i, rows, errors)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> Position of the parameter.
    integer, intent(in) :: i
    !> The law's parameters.
    type(parameter_t), intent(in) :: rows(:)
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: known
    integer :: k

    associate (given => spec%parameter(i))
      k = find_key(rows, given%key)
      if (k == 0) then
        known = "no parameters"
        if (size(rows) > 0) known = "one of: "//join(rows%name, " ")
        call errors%push_input(given%key_at, "unknown parameter '"//given%key//"' of "// &
            spec%name//suggestion(given%key, rows%name), known)
      else if (find_parameter(spec, given%key) < i .and. .not. rows(k)%repeatable) then
        call errors%push_input(given%key_at, "'"//given%key//"' is given twice")
      else if (given%text == "") then
        call errors%push_input(given%at, "no value is given for '"//given%key//"'", &
            trim(rows(k)%name)//"="//trim(merge("path  ", "number", rows(k)%kind == kind_text))// &
            range_text(rows(k)))
      else if (rows(k)%kind == kind_text) then
        return  ! any text will do until the file is read
      else if (.not. given%numeric .and. rows(k)%repeatable) then
        call errors%push_input(given%at, "'"//given%text//"' is not two numbers", &
            trim(rows(k)%name)//": "//trim(rows(k)%help))
      else if (.not. given%numeric) then
        call errors%push_input(given%at, no_number(given%text), &
            trim(rows(k)%name)//"=number"//range_text(rows(k)))
      else
        call check_range(given%value, rows(k), given%at, trim(rows(k)%name)//"=number"// &
            range_text(rows(k)), errors)
      end if
    end associate
  end subroutine check_law_parameter

  !> Position of the first parameter of a name; 0 if there is none.
  pure integer function find_parameter(spec, name)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> The name.
    character(len=*), intent(in) :: name

    do find_parameter = 1, size(spec%parameter)
      if (same_name(spec%parameter(find_parameter)%key, name)) return
    end do
    find_parameter = 0
  end function find_parameter

end module dd3_input_law
