! SPDX-License-Identifier: GPL-3.0-or-later
!> Materials of the library for the tests, from texts of Fortran.
module library_cases
  use, intrinsic :: iso_c_binding, only : c_char, c_loc, c_null_char, c_ptr, c_size_t
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, pair_name
  use dd3_base_text, only : newline
  use dd3_library_interface, only : material_new, material_read, material_state_name
  use dd3_material_description, only : description_t
  implicit none
  private
  public :: make, read_from, state_name, law_text, elastic, steel, aluminium, cyclic

  character(len=*), parameter :: elastic = "*MATERIAL sheet"//newline//"young = 2.1e5"//newline// &
      "poisson = 0.3"//newline
  !> Isotropic; anisotropic; with back-stresses.
  character(len=*), parameter :: steel = elastic//"yield = von_mises"//newline// &
      "hardening = swift K=565 e0=0.007117 n=0.259"//newline
  character(len=*), parameter :: aluminium = elastic// &
      "yield = hill48 F=0.284 G=0.358 H=0.642 L=1.289 M=1.2 N=1.5"//newline// &
      "hardening = voce Y0=200 Rsat=100 CR=10"//newline
  character(len=*), parameter :: cyclic = aluminium// &
      "backstress = lemaitre_chaboche CX=50 Xsat=60"//newline//"backstress = prager k=300"//newline

contains

  !> Make a material from a text.
  subroutine make(text, name, handle, message)
    character(len=*), intent(in) :: text, name
    type(c_ptr), intent(out) :: handle
    !> Errors found, to its length.
    character(len=*), intent(out) :: message

    character(kind=c_char), target :: c_text(len(text) + 1), c_name(len(name) + 1)
    character(kind=c_char), target :: c_message(len(message) + 1)

    call fill(text, c_text)
    call fill(name, c_name)
    handle = material_new(c_loc(c_text), c_loc(c_name), c_loc(c_message), &
        int(size(c_message), c_size_t))
    call empty(c_message, message)
  end subroutine make

  !> Make a material from a file.
  subroutine read_from(file, name, handle, message)
    character(len=*), intent(in) :: file, name
    type(c_ptr), intent(out) :: handle
    character(len=*), intent(out) :: message

    character(kind=c_char), target :: c_file(len(file) + 1), c_name(len(name) + 1)
    character(kind=c_char), target :: c_message(len(message) + 1)

    call fill(file, c_file)
    call fill(name, c_name)
    handle = material_read(c_loc(c_file), c_loc(c_name), c_loc(c_message), &
        int(size(c_message), c_size_t))
    call empty(c_message, message)
  end subroutine read_from

  !> Return the name of an internal variable, from 0.
  function state_name(handle, i) result(name)
    type(c_ptr), intent(in) :: handle
    integer, intent(in) :: i
    character(len=40) :: name

    character(kind=c_char), target :: c_name(41)

    call material_state_name(handle, i, c_loc(c_name), int(size(c_name), c_size_t))
    call empty(c_name, name)
  end function state_name

  !> Copy a text to an array of C.
  subroutine fill(text, bytes)
    character(len=*), intent(in) :: text
    character(kind=c_char), intent(out) :: bytes(:)

    integer :: i

    do i = 1, len(text)
      bytes(i) = text(i:i)
    end do
    bytes(len(text) + 1) = c_null_char
  end subroutine fill

  !> Copy an array of C to a text.
  subroutine empty(bytes, text)
    character(kind=c_char), intent(in) :: bytes(:)
    character(len=*), intent(out) :: text

    integer :: i

    text = ""
    do i = 1, len(text)
      if (bytes(i) == c_null_char) exit
      text(i:i) = bytes(i)
    end do
  end subroutine empty

  !> Return the line of a law with the parameters of its example.
  function law_text(key, description) result(text)
    !> Key of the block: yield, hardening, backstress.
    character(len=*), intent(in) :: key
    type(description_t), intent(in) :: description
    character(len=:), allocatable :: text

    integer :: i

    text = key//" = "//trim(description%name)
    do i = 1, size(description%example)
      text = text//" &"//newline//value_text(description%example(i))
    end do
    text = text//newline
  end function law_text

  !> Return a parameter with its value.
  function value_text(value) result(text)
    type(law_value_t), intent(in) :: value
    character(len=80) :: text

    if (value%name == pair_name) then
      write (text, '(es22.16, ":", es22.16)') value%abscissa, value%value
    else
      write (text, '(a, "=", es23.16)') trim(value%name), value%value
    end if
  end function value_text

end module library_cases
