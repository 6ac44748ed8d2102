!> What a law says of itself, and what is found wrong with the values given to it. The look-up by
!> name, the checks, `--help`, the manual and the generic tests all derive from the description.
module dd3_material_description
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : parameter_t, law_value_t
  use dd3_base_text, only : same_name
  implicit none
  private
  public :: description_t, problem_t, law_choice_t, position_of, value_of, is_given, add_problem

  !> A law as the user sees it.
  type :: description_t
    !> Name as written in the input.
    character(len=24) :: name = ""
    !> One line on what it is.
    character(len=80) :: title = ""
    !> Author, year, where published.
    character(len=160) :: source = ""
    !> Its parameters; the default `-` marks those that may be left out.
    type(parameter_t), allocatable :: rows(:)
    !> Values that reduce a criterion to von Mises, those of a usual sheet for the other laws: the
    !> starting point of examples and generic tests.
    type(law_value_t), allocatable :: example(:)
  end type description_t

  !> Something wrong with the values of a law.
  type :: problem_t
    !> Position of the offending value among those given; 0 for the law as a whole.
    integer :: index = 0
    !> What is wrong.
    character(len=160) :: message = ""
    !> What was expected.
    character(len=160) :: expected = ""
  end type problem_t

  !> A law chosen by name, with its parameters.
  type :: law_choice_t
    !> Name as in the registry.
    character(len=24) :: name = ""
    !> Its parameters.
    type(law_value_t), allocatable :: values(:)
  end type law_choice_t

contains

  !> Position of a name among the values; 0 where it was not given.
  pure integer function position_of(values, name)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> The name.
    character(len=*), intent(in) :: name
    integer :: i

    position_of = 0
    do i = 1, size(values)
      if (same_name(values(i)%name, name)) then
        position_of = i
        return
      end if
    end do
  end function position_of

  !> Whether a value was given.
  pure logical function is_given(values, name)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> The name.
    character(len=*), intent(in) :: name

    is_given = position_of(values, name) > 0
  end function is_given

  !> A value by its name.
  pure real(wp) function value_of(values, name, default)
    !> The values given.
    type(law_value_t), intent(in) :: values(:)
    !> The name.
    character(len=*), intent(in) :: name
    !> Taken where the value was not given; zero without it.
    real(wp), intent(in), optional :: default
    integer :: i

    value_of = 0.0_wp
    if (present(default)) value_of = default
    i = position_of(values, name)
    if (i > 0) value_of = values(i)%value
  end function value_of

  !> Adds a problem to the list.
  pure subroutine add_problem(problems, index, message, expected)
    !> The list.
    type(problem_t), allocatable, intent(inout) :: problems(:)
    !> See `problem_t`.
    integer, intent(in) :: index
    !> See `problem_t`.
    character(len=*), intent(in) :: message, expected
    type(problem_t), allocatable :: longer(:)

    if (.not. allocated(problems)) allocate (problems(0))
    allocate (longer(size(problems) + 1))
    longer(:size(problems)) = problems
    longer(size(longer)) = problem_t(index, message, expected)
    call move_alloc(longer, problems)
  end subroutine add_problem

end module dd3_material_description
