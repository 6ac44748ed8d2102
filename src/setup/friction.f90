! SPDX-License-Identifier: GPL-3.0-or-later
!> Friction of a tool from its coefficient and laws as written.
module dd3_setup_friction
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_parameter, only : law_value_t
  use dd3_contact_friction, only : check_friction_law, coulomb, friction_laws, friction_t
  use dd3_input_case, only : law_spec_t, tool_spec_t
  use dd3_input_law, only : check_law_name, check_law_values
  use dd3_material_description, only : description_t, problem_t
  implicit none
  private
  public :: set_friction

contains

  !> Set the friction of a tool.
  subroutine set_friction(friction, spec, errors)
    type(friction_t), intent(out) :: friction
    type(tool_spec_t), intent(in) :: spec
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    integer :: i

    friction = coulomb(spec%friction)
    do i = 1, size(spec%friction_law)
      call add_checked(friction, spec%friction_law(i), errors)
    end do
    if (size(spec%friction_law) == 0 .or. spec%friction > 0.0_wp) return
    call errors%push_input(spec%friction_law(1)%at, "the law is a factor on friction, which "// &
        "is 0", "friction = coefficient; 1 if the factors are coefficients", code="E156")
  end subroutine set_friction

  !> Check a law and add it.
  subroutine add_checked(friction, spec, errors)
    type(friction_t), intent(inout) :: friction
    type(law_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    type(description_t), allocatable :: known(:)
    type(law_value_t), allocatable :: values(:)
    type(problem_t), allocatable :: problems(:)
    type(location_t) :: place
    !> Position of each value among the parameters as written; 0 for a default.
    integer, allocatable :: origin(:)
    integer :: position, found, i

    known = friction_laws()
    call check_law_name(spec, "law of friction", known%name, position, errors)
    if (position == 0) return
    found = errors%count
    call check_law_values(spec, known(position)%rows, values, errors, origin)
    if (errors%count > found) return
    call check_friction_law(known(position)%name, values, problems)
    do i = 1, size(problems)
      place = spec%at
      if (problems(i)%index > 0) place = spec%parameter(origin(problems(i)%index))%at
      call errors%push_input(place, trim(problems(i)%message), trim(problems(i)%expected), &
          code="E157")
    end do
    if (size(problems) == 0) call friction%add_law(known(position)%name, values)
  end subroutine add_checked

end module dd3_setup_friction
