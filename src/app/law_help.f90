! SPDX-License-Identifier: GPL-3.0-or-later
!> Help on the laws and their reference in the manual, from the registries.
module dd3_app_law_help
  use dd3_base_text, only : newline, same_name
  use dd3_input_help, only : describe_key, escaped
  use dd3_material_check, only : describe_laws, law_backstress, law_hardening, law_modulus, &
      law_rate, law_temperature, law_yield
  use dd3_material_description, only : description_t
  implicit none
  private
  public :: help_laws, help_law, law_reference_markdown

  !> Kinds of laws, and their keys in the input.
  integer, parameter :: kinds(6) = [law_yield, law_hardening, law_backstress, law_modulus, &
      law_rate, law_temperature]
  character(len=11), parameter :: keys(6) = [character(len=11) :: "yield", "hardening", &
      "backstress", "modulus", "rate", "temperature"]
  !> Width of the column of names, in characters.
  integer, parameter :: name_width = 18

contains

  !> Return the list of all laws.
  function help_laws() result(text)
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: k, i

    text = ""
    do k = 1, size(kinds)
      call describe_laws(kinds(k), law)
      do i = 1, size(law)
        text = text//"  "//law(i)%name(:name_width)//trim(keys(k))//": "//trim(law(i)%title)
        text = text//newline
      end do
    end do
  end function help_laws

  !> Return the help on a law; empty if its name is unknown.
  function help_law(name) result(text)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: k, i, p

    text = ""
    do k = 1, size(kinds)
      call describe_laws(kinds(k), law)
      do i = 1, size(law)
        if (.not. same_name(law(i)%name, name)) cycle
        text = text//trim(keys(k))//" = "//trim(law(i)%name)//newline//"  "//trim(law(i)%title)// &
            newline//"  source: "//trim(law(i)%source)//newline
        do p = 1, size(law(i)%rows)
          text = text//"  "//describe_key(law(i)%rows(p))//newline//repeat(" ", 6)// &
              trim(law(i)%rows(p)%help)//newline
        end do
      end do
    end do
  end function help_law

  !> Return the manual's reference of all laws in Markdown.
  function law_reference_markdown() result(text)
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: k, i, p

    text = newline//"# Laws"//newline
    do k = 1, size(kinds)
      call describe_laws(kinds(k), law)
      text = text//newline//"## `"//trim(keys(k))//" = law key=value ...`"//newline//newline// &
          "| law | meaning | parameters | source |"//newline//"|---|---|---|---|"//newline
      do i = 1, size(law)
        text = text//"| `"//trim(law(i)%name)//"` | "//escaped(trim(law(i)%title))//" | "
        do p = 1, size(law(i)%rows)
          if (p > 1) text = text//"; "
          text = text//"`"//trim(law(i)%rows(p)%name)//"` "//escaped(trim(law(i)%rows(p)%help))
        end do
        text = text//" | "//escaped(trim(law(i)%source))//" |"//newline
      end do
    end do
  end function law_reference_markdown

end module dd3_app_law_help
