!> The elements the program knows, by name.
module dd3_element_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_element_hex8, only : new_hex8
  use dd3_element_table, only : element_t
  implicit none
  private
  public :: element_count, element_name, new_element, known_elements

  abstract interface
    !> Fills an element's table.
    subroutine constructor_i(self)
      import :: element_t
      !> The table.
      type(element_t), intent(out) :: self
    end subroutine constructor_i
  end interface

  !> One row: name and constructor together.
  type :: entry_t
    !> Name as written in the input.
    character(len=16) :: name = ""
    !> Fills the table.
    procedure(constructor_i), pointer, nopass :: make => null()
  end type entry_t

  !> Number of elements.
  integer, parameter :: element_count = 1

contains

  !> The registry: one row per element.
  subroutine fill_registry(entries)
    !> The rows.
    type(entry_t), intent(out) :: entries(element_count)

    entries(1) = entry_t("hex8", new_hex8)
  end subroutine fill_registry

  !> Name of the i-th element.
  function element_name(i) result(name)
    !> Its number in the registry.
    integer, intent(in) :: i
    character(len=16) :: name

    type(entry_t) :: entries(element_count)

    call fill_registry(entries)
    name = entries(i)%name
  end function element_name

  !> All names, separated by blanks.
  function known_elements() result(names)
    character(len=:), allocatable :: names

    integer :: i

    names = ""
    do i = 1, element_count
      names = trim(names//" "//element_name(i))
    end do
    names = adjustl(names)
  end function known_elements

  !> Makes an element by its name.
  subroutine new_element(self, name, error)
    !> The table.
    type(element_t), intent(out) :: self
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Set where the name is unknown.
    type(error_t), allocatable, intent(out) :: error

    type(entry_t) :: entries(element_count)
    integer :: i

    call fill_registry(entries)
    do i = 1, element_count
      if (entries(i)%name == name) then
        call entries(i)%make(self)
        return
      end if
    end do
    call fatal_error(error, "unknown element "//trim(name)//"; known: "//known_elements())
  end subroutine new_element

end module dd3_element_registry
