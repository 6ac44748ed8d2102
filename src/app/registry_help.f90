! SPDX-License-Identifier: GPL-3.0-or-later
!> Help on the elements and the linear solvers, printed from their registries.
module dd3_app_registry_help
  use dd3_base_error, only : error_t
  use dd3_base_text, only : join, newline, same_name
  use dd3_element_registry, only : element_names, new_element
  use dd3_element_table, only : element_t
  use dd3_linalg_solver_registry, only : missing_package, solver_names
  implicit none
  private
  public :: help_elements, help_registry

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

  !> Return the names of the linear solvers, and the packages of those that this build lacks.
  function help_solvers() result(text)
    character(len=:), allocatable :: text

    character(len=16), allocatable :: name(:)
    integer :: i

    name = solver_names()
    text = "linear solvers: "//join(name, " ")//newline
    do i = 1, size(name)
      if (missing_package(name(i)) /= "") text = text//"not in this build: "//trim(name(i))// &
          " (package "//missing_package(name(i))//")"//newline
    end do
  end function help_solvers

  !> Return name and title of an element in one line.
  function line(name)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: line

    type(element_t) :: element
    type(error_t), allocatable :: error
    character(len=name_width) :: column

    call new_element(element, name, error)
    column = name
    line = "  "//column//trim(element%title)//newline
  end function line

end module dd3_app_registry_help
