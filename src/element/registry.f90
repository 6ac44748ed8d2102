!> The registry of elements: one row per element, with its name and constructor.
module dd3_element_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_element_hex8, only : new_hex8
  use dd3_element_table, only : element_t
  implicit none
  private
  public :: element_names, known_elements, new_element

  abstract interface
    !> Fill an element's table.
    subroutine constructor_interface(self)
      import :: element_t
      type(element_t), intent(out) :: self
    end subroutine constructor_interface
  end interface

  !> A row of the registry.
  type :: row_t
    !> Name as written in the input.
    character(len=16) :: name = ""
    !> Constructor.
    procedure(constructor_interface), pointer, nopass :: make => null()
  end type row_t

contains

  !> Return the registry: one row per element.
  function registry() result(row)
    type(row_t), allocatable :: row(:)

    row = [row_t("hex8", new_hex8)]
  end function registry

  !> Return the names of all elements.
  function element_names() result(name)
    character(len=16), allocatable :: name(:)

    type(row_t), allocatable :: row(:)

    row = registry()
    name = row%name
  end function element_names

  !> Return the names of all elements in one line, separated by blanks.
  function known_elements() result(line)
    character(len=:), allocatable :: line

    character(len=16), allocatable :: name(:)
    integer :: i

    name = element_names()
    line = trim(name(1))
    do i = 2, size(name)
      line = line//" "//trim(name(i))
    end do
  end function known_elements

  !> Make the table of an element.
  subroutine new_element(self, name, error)
    type(element_t), intent(out) :: self
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Set if the name is unknown.
    type(error_t), allocatable, intent(out) :: error

    type(row_t), allocatable :: row(:)
    integer :: i

    row = registry()
    do i = 1, size(row)
      if (row(i)%name == name) then
        call row(i)%make(self)
        return
      end if
    end do
    call fatal_error(error, "unknown element "//trim(name)//"; known: "//known_elements())
  end subroutine new_element

end module dd3_element_registry
