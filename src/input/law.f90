!> Checks a law as written in the input against a registry's table of laws and parameters.
module dd3_input_law
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t
  use dd3_base_parameter, only : parameter_t, law_value_t
  use dd3_base_text, only : same_name, nearest_name, join
  use dd3_input_case, only : law_spec_t, law_parameter_t
  use dd3_input_number, only : parse_real
  use dd3_input_table, only : find_key
  use dd3_input_value, only : check_range, range_text
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

    character(len=:), allocatable :: nearest

    do position = 1, size(known)
      if (same_name(known(position), spec%name)) return
    end do
    position = 0
    nearest = nearest_name(spec%name, known)
    if (nearest /= "") nearest = "; did you mean '"//nearest//"'?"
    call errors%push_input(spec%at, "there is no "//what//" '"//spec%name//"'"//nearest, &
        "one of: "//join(known, " "))
  end subroutine check_law_name

  !> The law's parameters checked against the rows: unknown, doubled, missing, no number, out of
  !> range. Rows with the
  !> default `-` may be left out and are then not among the values; other defaults are filled in.
  subroutine check_law_values(spec, rows, values, errors)
    !> The law as written.
    type(law_spec_t), intent(in) :: spec
    !> Its parameters.
    type(parameter_t), intent(in) :: rows(:)
    !> The values, in the order of the rows.
    type(law_value_t), allocatable, intent(out) :: values(:)
    !> Receives the errors.
    type(error_list_t), intent(inout) :: errors

    type(law_value_t) :: value
    logical :: ok
    integer :: i, k

    do i = 1, size(spec%parameter)
      call check_law_parameter(spec, i, rows, errors)
    end do
    allocate (values(0))
    do k = 1, size(rows)
      value%name = rows(k)%name
      i = find_parameter(spec, trim(rows(k)%name))
      if (i > 0) then
        value%value = spec%parameter(i)%value
        values = [values, value]
      else if (rows(k)%default == "") then
        call errors%push_input(spec%at, "'"//trim(rows(k)%name)//"' is missing for "//spec%name, &
                               trim(rows(k)%name)//"=value: "//trim(rows(k)%help))
      else if (rows(k)%default /= "-") then
        call parse_real(trim(rows(k)%default), value%value, ok)
        values = [values, value]
      end if
    end do
  end subroutine check_law_values

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

    character(len=:), allocatable :: nearest, known
    integer :: k

    associate (given => spec%parameter(i))
      k = find_key(rows, given%key)
      if (k == 0) then
        nearest = nearest_name(given%key, rows%name)
        if (nearest /= "") nearest = "; did you mean '"//nearest//"'?"
        known = "no parameters"
        if (size(rows) > 0) known = "one of: "//join(rows%name, " ")
        call errors%push_input(given%key_at, "unknown parameter '"//given%key//"' of "// &
            spec%name//nearest, known)
      else if (find_parameter(spec, given%key) < i) then
        call errors%push_input(given%key_at, "'"//given%key//"' is given twice")
      else if (.not. given%numeric) then
        call errors%push_input(given%at, "'"//given%text//"' is not a number", &
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
