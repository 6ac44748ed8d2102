! SPDX-License-Identifier: GPL-3.0-or-later
!> A law as written in the input, checked against the registries, with the location of every
!> problem.
module dd3_laws_choice
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_parameter, only : parameter_t
  use dd3_input_case, only : law_spec_t
  use dd3_input_law, only : check_law_name, check_law_values
  use dd3_material_check, only : check_together, known_laws, law_backstress, law_fracture, &
      law_modulus, law_rate, law_rows, law_temperature
  use dd3_material_description, only : law_choice_t, problem_t
  implicit none
  private
  public :: choose_checked, choose_law

  !> Names of the kinds of laws in messages.
  character(len=22), parameter :: kind_name(7) = [character(len=22) :: "yield criterion", &
      "hardening law", "back-stress law", "law of the modulus", "law of the strain rate", &
      "law of the temperature", "law of fracture"]
  !> Kinds of laws that a material may lack, and the input word for that.
  integer, parameter :: optional_kind(5) = [law_backstress, law_modulus, law_rate, &
      law_temperature, law_fracture]
  character(len=24), parameter :: no_law = "none"

contains

  !> Check a law as written, also the relations between its values, and set its values.
  subroutine choose_checked(kind, spec, choice, errors)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    type(law_spec_t), intent(in) :: spec
    !> The law with its values.
    type(law_choice_t), intent(out) :: choice
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(problem_t), allocatable :: problems(:)
    type(location_t) :: place
    !> Position of each value among the parameters as written; 0 for a default.
    integer, allocatable :: origin(:)
    integer :: found, i

    found = errors%count
    call choose_law(kind, spec, choice, errors, origin)
    if (choice%name == "" .or. choice%name == no_law) return
    call check_together(kind, choice%name, choice%values, problems, errors%count > found)
    do i = 1, size(problems)
      ! A problem of the whole law, or of a default, belongs to the name of the law.
      place = spec%at
      if (problems(i)%index > 0) then
        if (origin(problems(i)%index) > 0) place = spec%parameter(origin(problems(i)%index))%at
      end if
      call errors%push_input(place, trim(problems(i)%message), trim(problems(i)%expected), &
          code="E149")
    end do
  end subroutine choose_checked

  !> Check the name and each parameter of a law as written, and set its values.
  subroutine choose_law(kind, spec, choice, errors, origin)
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    type(law_spec_t), intent(in) :: spec
    !> The law with its values; without a name if the name is unknown.
    type(law_choice_t), intent(out) :: choice
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors
    !> Position of each value among the parameters as written; 0 for a default. Not allocated if the
    !> name is unknown.
    integer, allocatable, intent(out) :: origin(:)

    character(len=24), allocatable :: names(:)
    type(parameter_t), allocatable :: rows(:)
    integer :: position

    call known_laws(kind, names)
    if (any(kind == optional_kind)) names = [names, no_law]
    call check_law_name(spec, trim(kind_name(kind)), names, position, errors)
    if (position == 0) return
    choice%name = names(position)
    call law_rows(kind, names(position), rows)
    call check_law_values(spec, rows, choice%values, errors, origin)
  end subroutine choose_law

end module dd3_laws_choice
