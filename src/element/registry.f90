! SPDX-License-Identifier: GPL-3.0-or-later
!> The registry of elements: one row per element, with its name and constructor. An element without
!> kernels of its own gets those of the mean dilatation.
module dd3_element_registry
  use dd3_base_error, only : error_t, fatal_error
  use dd3_element_hex20, only : new_hex20
  use dd3_element_hex27, only : new_hex27
  use dd3_element_hex8, only : new_hex8
  use dd3_element_mean_dilatation, only : use_mean_dilatation
  use dd3_element_solid_shell, only : new_solid_shell
  use dd3_element_table, only : element_t
  implicit none
  private
  public :: element_names, known_elements, new_element

  !> Points through the thickness of an element with a choice of them, for a caller that makes none.
  integer, parameter :: default_thickness_points = 7

  abstract interface
    !> Fill an element's table.
    subroutine constructor_interface(self)
      import :: element_t
      type(element_t), intent(out) :: self
    end subroutine constructor_interface

    !> Fill the table of an element with a number of integration points through the thickness.
    subroutine layered_interface(self, n)
      import :: element_t
      type(element_t), intent(out) :: self
      integer, intent(in) :: n
    end subroutine layered_interface
  end interface

  !> A row of the registry.
  type :: row_t
    !> Name as written in the input.
    character(len=16) :: name = ""
    !> Constructor: the first, or the second for an element with `thickness_points`.
    procedure(constructor_interface), pointer, nopass :: make => null()
    procedure(layered_interface), pointer, nopass :: make_layered => null()
  end type row_t

contains

  !> Return the registry: one row per element.
  function registry() result(row)
    type(row_t), allocatable :: row(:)

    row = [row_t("hex8", new_hex8), &
        row_t("solid_shell", make_layered=new_solid_shell), &
        row_t("hex20", new_hex20), &
        row_t("hex27", new_hex27)]
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
  subroutine new_element(self, name, error, thickness_points)
    type(element_t), intent(out) :: self
    !> Name as written in the input.
    character(len=*), intent(in) :: name
    !> Set if the name is unknown.
    type(error_t), allocatable, intent(out) :: error
    !> Integration points through the thickness of an element with a choice of them.
    integer, intent(in), optional :: thickness_points

    type(row_t), allocatable :: row(:)
    integer :: i, n

    n = default_thickness_points
    if (present(thickness_points)) n = thickness_points
    row = registry()
    do i = 1, size(row)
      if (row(i)%name /= name) cycle
      if (associated(row(i)%make_layered)) then
        call row(i)%make_layered(self, n)
      else
        call row(i)%make(self)
      end if
      if (.not. associated(self%deform)) call use_mean_dilatation(self)
      return
    end do
    call fatal_error(error, "unknown element "//trim(name)//"; known: "//known_elements())
  end subroutine new_element

end module dd3_element_registry
