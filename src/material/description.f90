! SPDX-License-Identifier: GPL-3.0-or-later
!> Description of a law and of its internal variables, and the problems found in the values given to
!> it. The look-up by name, the checks, `--help`, the manual and the generic tests derive from the
!> description.
module dd3_material_description
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, pair_name, parameter_t
  use dd3_base_text, only : same_name, to_text
  implicit none
  private
  public :: description_t, internal_variable_t, problem_t, law_choice_t
  public :: position_of, value_of, is_given, add_problem, check_table, check_strains

  !> Largest plastic strain of a table, to detect strains given in per cent.
  real(wp), parameter :: largest_strain = 10.0_wp

  !> Description of a law in help and messages.
  type :: description_t
    !> Name as written in the input.
    character(len=24) :: name = ""
    !> Summary in one line.
    character(len=80) :: title = ""
    !> Publication: author, year, place.
    character(len=160) :: source = ""
    !> Parameters; the default `-` marks optional ones.
    type(parameter_t), allocatable :: rows(:)
    !> Parameters of examples and generic tests: for a criterion those that reduce it to von Mises,
    !> for other laws those of a typical sheet.
    type(law_value_t), allocatable :: example(:)
  end type description_t

  !> Description of an internal variable of a material point, scalar or tensor.
  type :: internal_variable_t
    character(len=32) :: name = ""
    !> Empty if dimensionless.
    character(len=16) :: unit = ""
    !> Meaning in one line.
    character(len=80) :: meaning = ""
    !> Number of components; 6 for a Kelvin vector in the orthotropy axes.
    integer :: n_component = 1
    !> Index of the first component among the point's internal variables; set for a whole material.
    integer :: first = 0
    !> Value at a stored zero.
    real(wp) :: offset = 0.0_wp
  end type internal_variable_t

  !> An error in the values of a law.
  type :: problem_t
    !> Position of the erroneous value among those given; 0 for the law as a whole.
    integer :: index = 0
    character(len=160) :: message = "", expected = ""
  end type problem_t

  !> A law chosen by its name in the registry, with its parameters.
  type :: law_choice_t
    character(len=24) :: name = ""
    type(law_value_t), allocatable :: values(:)
  end type law_choice_t

contains

  !> Return the position of a name among the values; 0 if not given.
  pure integer function position_of(values, name)
    type(law_value_t), intent(in) :: values(:)
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

  !> Return whether a value was given.
  pure logical function is_given(values, name)
    type(law_value_t), intent(in) :: values(:)
    character(len=*), intent(in) :: name

    is_given = position_of(values, name) > 0
  end function is_given

  !> Return a value by its name.
  pure real(wp) function value_of(values, name, default)
    type(law_value_t), intent(in) :: values(:)
    character(len=*), intent(in) :: name
    !> Result if the value was not given; zero by default.
    real(wp), intent(in), optional :: default

    integer :: i

    value_of = 0.0_wp
    if (present(default)) value_of = default
    i = position_of(values, name)
    if (i > 0) value_of = values(i)%value
  end function value_of

  !> Append a problem to the list; see the components of `problem_t`.
  pure subroutine add_problem(problems, index, message, expected)
    type(problem_t), allocatable, intent(inout) :: problems(:)
    integer, intent(in) :: index
    character(len=*), intent(in) :: message, expected

    type(problem_t), allocatable :: longer(:)

    if (.not. allocated(problems)) allocate (problems(0))
    allocate (longer(size(problems) + 1))
    longer(:size(problems)) = problems
    longer(size(longer)) = problem_t(index, message, expected)
    call move_alloc(longer, problems)
  end subroutine add_problem

  !> Require two points or more of a table, at places that rise.
  pure subroutine check_table(values, place, places, form, problems)
    type(law_value_t), intent(in) :: values(:)
    !> What the places are, singular and plural, and the form of a table.
    character(len=*), intent(in) :: place, places, form
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer, allocatable :: point(:)
    integer :: i

    point = pack([(i, i=1, size(values))], values%name == pair_name)
    if (size(point) < 2) then
      call add_problem(problems, 0, "a table needs two points at least", form)
    end if
    do i = 2, size(point)
      associate (now => values(point(i))%abscissa)
        if (.not. now > values(point(i - 1))%abscissa) call add_problem(problems, point(i), &
            "the "//place//" "//to_text(now)//" is not larger than the one before", &
            places//" that rise")
      end associate
    end do
  end subroutine check_table

  !> Require two points or more of a table, and plastic strains that increase from zero to at most
  !> `largest_strain`.
  pure subroutine check_strains(values, initial, form, problems)
    type(law_value_t), intent(in) :: values(:)
    !> What the first point is to be, and the form of a table.
    character(len=*), intent(in) :: initial, form
    type(problem_t), allocatable, intent(inout) :: problems(:)

    integer :: first, last

    first = position_of(values, pair_name)
    if (first > 0) then
      if (abs(values(first)%abscissa) > 0.0_wp) call add_problem(problems, first, &
          "the first point has a plastic strain of "//to_text(values(first)%abscissa), initial)
    end if
    last = findloc(values%name, pair_name, dim=1, back=.true.)
    if (last > 0) then
      if (values(last)%abscissa > largest_strain) call add_problem(problems, last, &
          "the plastic strain "//to_text(values(last)%abscissa)//" is larger than "// &
          to_text(largest_strain), "plastic strains: 0.1 is about 10 %")
    end if
    call check_table(values, "plastic strain", "plastic strains", form, problems)
  end subroutine check_strains

end module dd3_material_description
