! SPDX-License-Identifier: GPL-3.0-or-later
!> A material of the library: its laws, its axes and the names of its internal variables.
module dd3_library_law_material
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, error_t, fatal_error
  use dd3_base_text, only : newline, to_text
  use dd3_input_case, only : material_spec_t
  use dd3_input_material_file, only : read_material
  use dd3_laws_material, only : make_material
  use dd3_material_description, only : internal_variable_t
  use dd3_material_material, only : material_t
  implicit none
  private
  public :: law_material_t, new_law_material, variable_name

  !> Number of errors in a message.
  integer, parameter :: most_shown = 20
  !> Components of a Kelvin vector.
  character(len=2), parameter :: tensor_component(6) = ["11", "22", "33", "23", "13", "12"]

  type :: law_material_t
    type(material_t) :: laws
    !> Rolling, transverse and normal direction in the initial sheet, in columns.
    real(wp) :: axes(3, 3) = 0.0_wp
    type(internal_variable_t), allocatable :: variable(:)
  end type law_material_t

contains

  !> Read a material from the input language.
  subroutine new_law_material(self, file_name, name, error, content)
    type(law_material_t), intent(out) :: self
    character(len=*), intent(in) :: file_name
    !> Name of the material; empty for the only one.
    character(len=*), intent(in) :: name
    !> All errors found, one after the other.
    type(error_t), allocatable, intent(out) :: error
    !> Text in place of the file.
    character(len=*), intent(in), optional :: content

    type(material_spec_t) :: spec
    type(error_list_t) :: errors
    integer :: ignored

    call read_material(spec, file_name, name, errors, content)
    if (errors%count == 0) call make_material(self%laws, spec, ignored, errors)
    if (errors%count > 0) then
      call errors%sort()
      call fatal_error(error, all_messages(errors))
      return
    end if
    self%axes = spec%frame
    call self%laws%describe_internal_variables(self%variable)
  end subroutine new_law_material

  !> Return the messages of a list of errors.
  pure function all_messages(errors) result(text)
    type(error_list_t), intent(in) :: errors
    character(len=:), allocatable :: text

    integer :: i

    text = errors%item(1)%message
    do i = 2, min(errors%count, most_shown)
      text = text//newline//errors%item(i)%message
    end do
    if (errors%count > most_shown) text = text//newline//to_text(errors%count - most_shown)// &
        " more errors"
  end function all_messages

  !> Return the name of a component of the internal variables: `back_stress_12`, for a scalar the
  !> name of the variable.
  pure function variable_name(self, i) result(name)
    type(law_material_t), intent(in) :: self
    !> From 1 to the number of components.
    integer, intent(in) :: i
    character(len=:), allocatable :: name

    integer :: k, component

    do k = size(self%variable), 1, -1
      if (self%variable(k)%first <= i) exit
    end do
    component = i - self%variable(k)%first + 1
    name = trim(self%variable(k)%name)
    if (self%variable(k)%n_component == 6) then
      name = name//"_"//tensor_component(component)
    else if (self%variable(k)%n_component > 1) then
      name = name//"_"//to_text(component)
    end if
  end function variable_name

end module dd3_library_law_material
