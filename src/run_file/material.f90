! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: materials with their laws, and single points.
module dd3_run_file_material
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_json, only : json_t
  use dd3_base_parameter, only : pair_name, parameter_t
  use dd3_base_text, only : same_name
  use dd3_input_case, only : case_t, law_spec_t, point_spec_t
  use dd3_input_table, only : find_key
  use dd3_laws_choice, only : choose_law
  use dd3_material_check, only : describe_laws, law_backstress, law_fracture, law_hardening, &
      law_modulus, law_rate, law_temperature, law_yield
  use dd3_material_description, only : description_t, law_choice_t
  use dd3_model_model, only : model_t
  use dd3_run_file_input, only : add_location
  implicit none
  private
  public :: add_materials, add_points

contains

  !> Add the materials.
  subroutine add_materials(json, case, model)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model

    integer :: m, i, n

    call json%begin_array("materials")
    do m = 1, size(case%material)
      associate (material => case%material(m))
        call json%begin_object("")
        call json%add("name", material%name)
        call json%add("young", material%young)
        call json%add("poisson", material%poisson)
        call add_law(json, "yield", law_yield, material%yield)
        call add_law(json, "hardening", law_hardening, material%hardening)
        call json%begin_array("backstress")
        do i = 1, size(material%backstress)
          if (.not. same_name(material%backstress(i)%name, "none")) then
            call add_law(json, "", law_backstress, material%backstress(i))
          end if
        end do
        call json%end_array()
        call add_optional(json, "modulus", law_modulus, material%modulus)
        call add_optional(json, "rate", law_rate, material%rate)
        call add_optional(json, "temperature", law_temperature, material%temperature)
        call add_optional(json, "fracture", law_fracture, material%fracture)
        call json%add("rolling_direction", model%axes(:, 1, m))
        call json%add("normal_direction", model%axes(:, 3, m))
        n = 0
        if (allocated(model%material_of)) n = count(model%material_of == m)
        call json%add("elements", n)
        call add_location(json, "at", material%source%opened)
        call json%end_object()
      end associate
    end do
    call json%end_array()
  end subroutine add_materials

  !> Add a law that the material may lack: null then.
  subroutine add_optional(json, name, kind, spec)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> Without errors.
    type(law_spec_t), intent(in) :: spec

    if (same_name(spec%name, "none")) then
      call json%add_null(name)
    else
      call add_law(json, name, kind, spec)
    end if
  end subroutine add_optional

  !> Add a law with the values of its parameters.
  subroutine add_law(json, name, kind, spec)
    type(json_t), intent(inout) :: json
    character(len=*), intent(in) :: name
    !> One of the `law_*` values.
    integer, intent(in) :: kind
    !> Without errors.
    type(law_spec_t), intent(in) :: spec

    type(description_t), allocatable :: known(:)
    type(law_choice_t) :: choice
    type(error_list_t) :: ignored
    integer, allocatable :: origin(:)
    integer :: i, k

    call choose_law(kind, spec, choice, ignored, origin)
    call describe_laws(kind, known)
    call json%begin_object(name)
    do k = 1, size(known)
      if (.not. same_name(known(k)%name, choice%name)) cycle
      call json%add("name", trim(known(k)%name))
      call json%add("title", trim(known(k)%title))
      call json%add("source", trim(known(k)%source))
      call json%begin_array("parameters")
      do i = 1, size(choice%values)
        call add_parameter(json, choice, i, known(k)%rows, spec, origin(i))
      end do
      call json%end_array()
    end do
    call add_location(json, "at", spec%at)
    call json%end_object()
  end subroutine add_law

  !> Add a parameter.
  subroutine add_parameter(json, choice, i, rows, spec, origin)
    type(json_t), intent(inout) :: json
    type(law_choice_t), intent(in) :: choice
    !> Position among its values.
    integer, intent(in) :: i
    !> Rows of the law.
    type(parameter_t), intent(in) :: rows(:)
    type(law_spec_t), intent(in) :: spec
    !> Position among the parameters as written; 0 for a default.
    integer, intent(in) :: origin

    type(location_t) :: at
    integer :: row

    row = find_key(rows, trim(choice%values(i)%name))
    call json%begin_object("", flat=.true.)
    call json%add("name", trim(choice%values(i)%name))
    if (row > 0) call json%add("unit", trim(rows(row)%unit))
    if (row == 0) call json%add("unit", "")
    if (choice%values(i)%name == pair_name) then
      call json%add("abscissa", choice%values(i)%abscissa)
    else
      call json%add_null("abscissa")
    end if
    call json%add("value", choice%values(i)%value)
    call json%add("default", origin == 0)
    if (origin > 0) at = spec%parameter(origin)%at
    call add_location(json, "at", at)
    call json%end_object()
  end subroutine add_parameter

  !> Add the single points.
  subroutine add_points(json, case)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case

    integer :: i

    call json%begin_array("points")
    do i = 1, size(case%point)
      call add_point(json, case, case%point(i))
    end do
    call json%end_array()
  end subroutine add_points

  !> Add a single point with its path.
  subroutine add_point(json, case, point)
    type(json_t), intent(inout) :: json
    type(case_t), intent(in) :: case
    type(point_spec_t), intent(in) :: point

    integer :: i

    call json%begin_object("")
    call json%add("name", point%name)
    call json%add("material", case%material(point%material)%name)
    call json%add("by", trim(merge("gradient  ", "components", point%by_gradient)))
    call json%begin_array("control", flat=.true.)
    do i = 1, size(point%by_stress)
      call json%add("", merge("stress", "strain", point%by_stress(i)))
    end do
    call json%end_array()
    call json%begin_object("axes", flat=.true.)
    call json%add("rolling", point%frame(:, 1))
    call json%add("normal", point%frame(:, 3))
    call json%end_object()
    call json%begin_array("targets")
    do i = 1, size(point%goal)
      call json%begin_object("", flat=.true.)
      call json%add("values", point%goal(i)%value)
      call json%add("steps", point%goal(i)%steps)
      call json%end_object()
    end do
    call json%end_array()
    call add_location(json, "at", point%source%opened)
    call json%end_object()
  end subroutine add_point

end module dd3_run_file_material
