!> The three registries behind one door: which laws there are, what they say of themselves, what is
!> wrong with the values given to one.
module dd3_material_check
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : parameter_t, law_value_t
  use dd3_base_text, only : join, nearest_name, same_name, to_text
  use dd3_material_backstress_law, only : backstress_slot_t
  use dd3_material_backstress_registry, only : describe_backstresses, find_backstress
  use dd3_material_description, only : description_t, problem_t, add_problem, is_given
  use dd3_material_hardening_law, only : hardening_slot_t
  use dd3_material_hardening_registry, only : describe_hardenings, find_hardening
  use dd3_material_yield_criterion, only : yield_slot_t
  use dd3_material_yield_convexity, only : check_convexity
  use dd3_material_yield_registry, only : describe_criteria, find_criterion
  implicit none
  private
  public :: law_yield, law_hardening, law_backstress
  public :: describe_laws, known_laws, law_rows, check_law

  !> The kinds of laws.
  integer, parameter :: law_yield = 1, law_hardening = 2, law_backstress = 3

contains

  !> What each law of a kind says of itself.
  subroutine describe_laws(kind, descriptions)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> The descriptions, in the order of the registry.
    type(description_t), allocatable, intent(out) :: descriptions(:)

    select case (kind)
    case (law_yield)
      call describe_criteria(descriptions)
    case (law_hardening)
      call describe_hardenings(descriptions)
    case default
      call describe_backstresses(descriptions)
    end select
  end subroutine describe_laws

  !> Names of the laws of a kind.
  subroutine known_laws(kind, names)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> The names, in the order of the registry.
    character(len=24), allocatable, intent(out) :: names(:)
    type(description_t), allocatable :: descriptions(:)
    integer :: i

    call describe_laws(kind, descriptions)
    allocate (names(size(descriptions)))
    do i = 1, size(names)
      names(i) = descriptions(i)%name
    end do
  end subroutine known_laws

  !> The parameters of a law; none where the name is unknown.
  subroutine law_rows(kind, name, rows)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> Name of the law.
    character(len=*), intent(in) :: name
    !> Its parameters.
    type(parameter_t), allocatable, intent(out) :: rows(:)
    type(description_t), allocatable :: descriptions(:)
    integer :: i

    call describe_laws(kind, descriptions)
    do i = 1, size(descriptions)
      if (descriptions(i)%name == name) then
        call move_alloc(descriptions(i)%rows, rows)
        return
      end if
    end do
    allocate (rows(0))
  end subroutine law_rows

  !> Finds all that is wrong with a law's name and values.
  subroutine check_law(kind, name, values, problems)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> Name of the law.
    character(len=*), intent(in) :: name
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> What is wrong; of size zero where nothing is.
    type(problem_t), allocatable, intent(out) :: problems(:)
    type(parameter_t), allocatable :: rows(:)
    character(len=24), allocatable :: names(:)

    allocate (problems(0))
    call known_laws(kind, names)
    if (.not. any(names == name)) then
      call unknown_law(name, names, problems)
      return
    end if
    call law_rows(kind, name, rows)
    call check_rows(rows, values, problems)
    call check_together(kind, name, values, problems)
  end subroutine check_law

  !> Says that a law is unknown, and which one may be meant.
  subroutine unknown_law(name, names, problems)
    !> Name as given.
    character(len=*), intent(in) :: name
    !> Names there are.
    character(len=*), intent(in) :: names(:)
    !> Receives the problem.
    type(problem_t), allocatable, intent(inout) :: problems(:)
    character(len=:), allocatable :: near, expected

    expected = "one of "//join(names, ", ")
    near = nearest_name(name, names)
    if (len(near) > 0) expected = near//"? ("//expected//")"
    call add_problem(problems, 0, "unknown law "//trim(name), expected)
  end subroutine unknown_law

  !> Unknown, doubled and missing parameters, and those out of range.
  subroutine check_rows(rows, values, problems)
    !> The parameters of the law.
    type(parameter_t), intent(in) :: rows(:)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> Receives what is wrong.
    type(problem_t), allocatable, intent(inout) :: problems(:)
    integer :: i, j

    do i = 1, size(values)
      do j = 1, size(rows)
        if (same_name(rows(j)%name, values(i)%name)) exit
      end do
      if (j > size(rows)) then
        call unknown_parameter(rows, values(i)%name, i, problems)
      else if (.not. rows(j)%repeatable .and. is_given(values(:i - 1), values(i)%name)) then
        call add_problem(problems, i, trim(values(i)%name)//" is given twice", "once")
      else if (.not. in_range(rows(j), values(i)%value)) then
        call add_problem(problems, i, trim(values(i)%name)//" = "//to_text(values(i)%value)// &
                         " is out of range", range_text(rows(j)))
      end if
    end do
    do j = 1, size(rows)
      if (rows(j)%default /= "" .or. is_given(values, rows(j)%name)) cycle
      call add_problem(problems, 0, trim(rows(j)%name)//" is missing", rows(j)%help)
    end do
  end subroutine check_rows

  !> Says that a parameter is unknown.
  subroutine unknown_parameter(rows, name, i, problems)
    !> The parameters of the law.
    type(parameter_t), intent(in) :: rows(:)
    !> Name as given.
    character(len=*), intent(in) :: name
    !> Its position among the values.
    integer, intent(in) :: i
    !> Receives the problem.
    type(problem_t), allocatable, intent(inout) :: problems(:)
    character(len=:), allocatable :: expected

    expected = "no parameter"
    if (size(rows) > 0) expected = "one of "//join(rows%name, ", ")
    call add_problem(problems, i, "unknown parameter "//trim(name), expected)
  end subroutine unknown_parameter

  !> Whether a value is within the bounds of a parameter.
  pure logical function in_range(row, value)
    !> The parameter.
    type(parameter_t), intent(in) :: row
    !> The value.
    real(wp), intent(in) :: value

    in_range = value >= row%lower .and. value <= row%upper
    if (row%lower_open .and. .not. value > row%lower) in_range = .false.
    if (row%upper_open .and. .not. value < row%upper) in_range = .false.
  end function in_range

  !> The bounds of a parameter in words.
  pure function range_text(row) result(text)
    !> The parameter.
    type(parameter_t), intent(in) :: row
    character(len=:), allocatable :: text

    text = ""
    if (row%lower > -huge(1.0_wp)) then
      text = merge("above   ", "at least", row%lower_open)
      text = trim(text)//" "//to_text(row%lower)
    end if
    if (row%upper < huge(1.0_wp)) then
      if (text /= "") text = text//" and "
      text = text//trim(merge("below  ", "at most", row%upper_open))//" "//to_text(row%upper)
    end if
  end function range_text

  !> What the law itself finds wrong with its values taken together.
  subroutine check_together(kind, name, values, problems)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> Name of the law.
    character(len=*), intent(in) :: name
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> Receives what is wrong.
    type(problem_t), allocatable, intent(inout) :: problems(:)
    type(yield_slot_t) :: criterion
    type(hardening_slot_t) :: hardening
    type(backstress_slot_t) :: backstress

    select case (kind)
    case (law_yield)
      call find_criterion(name, criterion)
      call criterion%law%check(values, problems)
      if (size(problems) > 0) return
      call criterion%law%set(values)
      call check_convexity(criterion%law, problems)
    case (law_hardening)
      call find_hardening(name, hardening)
      call hardening%law%check(values, problems)
    case default
      call find_backstress(name, backstress)
      call backstress%law%check(values, problems)
    end select
  end subroutine check_together

end module dd3_material_check
