! SPDX-License-Identifier: GPL-3.0-or-later
!> Help on the elements, the linear solvers and the output fields, printed from their registries.
module dd3_app_registry_help
  use dd3_base_error, only : error_t
  use dd3_base_text, only : newline, same_name
  use dd3_element_registry, only : element_names, new_element
  use dd3_element_table, only : element_t
  use dd3_linalg_solver_registry, only : missing_package, solver_meaning, solver_names
  use dd3_output_field_table, only : at_nodes_and_cells, at_points, common_fields, field_t
  implicit none
  private
  public :: field_markdown, help_elements, help_registry, solver_markdown

  !> Width of the column of names.
  integer, parameter :: name_width = 18

contains

  !> Return the list of all elements.
  function help_elements() result(text)
    character(len=:), allocatable :: text

    character(len=16), allocatable :: name(:)
    integer :: i

    name = element_names()
    text = ""
    do i = 1, size(name)
      text = text//line(name(i))
    end do
  end function help_elements

  !> Return the help on a topic: one element by its name, all elements by the key `element`, all
  !> linear solvers by the key `method`; otherwise empty.
  function help_registry(topic) result(text)
    character(len=*), intent(in) :: topic
    character(len=:), allocatable :: text

    character(len=16), allocatable :: name(:)
    integer :: i

    text = ""
    if (same_name(topic, "element")) text = "elements:"//newline//help_elements()
    if (same_name(topic, "method")) text = help_solvers()
    name = element_names()
    do i = 1, size(name)
      if (same_name(name(i), topic)) text = line(name(i))
    end do
  end function help_registry

  !> Return names and meanings of the linear solvers, and the packages of those that this build
  !> lacks.
  function help_solvers() result(text)
    character(len=:), allocatable :: text

    character(len=16), allocatable :: name(:)
    integer :: i

    name = solver_names()
    text = "linear solvers:"//newline
    do i = 1, size(name)
      text = text//column(name(i))//solver_meaning(name(i))
      if (missing_package(name(i)) /= "") text = text//"; not in this build (package "// &
          missing_package(name(i))//")"
      text = text//newline
    end do
  end function help_solvers

  !> Return the reference of the linear solvers in Markdown.
  function solver_markdown() result(text)
    character(len=:), allocatable :: text

    character(len=16), allocatable :: name(:)
    integer :: i

    name = solver_names()
    text = newline//"## Linear solvers"//newline//newline//"| `method` | meaning |"//newline// &
        "|---|---|"//newline
    do i = 1, size(name)
      text = text//"| `"//trim(name(i))//"` | "//solver_meaning(name(i))//" |"//newline
    end do
  end function solver_markdown

  !> Return the reference of the output fields in Markdown.
  function field_markdown() result(text)
    character(len=:), allocatable :: text

    type(field_t), allocatable :: field(:)
    character(len=:), allocatable :: place
    integer :: i

    text = newline//"## Output fields"//newline//newline//"| field | where | unit | meaning |"// &
        newline//"|---|---|---|---|"//newline
    field = common_fields()
    do i = 1, size(field)
      place = "nodes"
      if (any(field(i)%location == [at_nodes_and_cells, at_points])) place = "cells, nodes"
      text = text//"| `"//trim(field(i)%name)//"` | "//place//" | "//trim(field(i)%unit)//" | "// &
          trim(field(i)%description)//" |"//newline
    end do
  end function field_markdown

  !> Return name and title of an element in one line.
  function line(name)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: line

    type(element_t) :: element
    type(error_t), allocatable :: error

    call new_element(element, name, error)
    line = column(name)//trim(element%title)//newline
  end function line

  !> Return a name, indented and padded to the width of the column of names.
  pure function column(name)
    character(len=*), intent(in) :: name
    character(len=name_width + 2) :: column

    column = "  "//name
  end function column

end module dd3_app_registry_help
