! SPDX-License-Identifier: GPL-3.0-or-later
!> Help on the laws and their reference in the manual, from the registries.
module dd3_app_law_help
  use dd3_base_text, only : newline, same_name
  use dd3_contact_friction, only : friction_laws
  use dd3_input_help, only : describe_key, escaped
  use dd3_material_check, only : describe_laws, law_backstress, law_fracture, law_hardening, &
      law_modulus, law_rate, law_temperature, law_yield
  use dd3_material_description, only : description_t
  implicit none
  private
  public :: friction_markdown, help_friction, help_laws, help_law, law_reference_markdown

  !> Kinds of laws, and their keys in the input.
  integer, parameter :: kinds(7) = [law_yield, law_hardening, law_backstress, law_modulus, &
      law_rate, law_temperature, law_fracture]
  character(len=11), parameter :: keys(7) = [character(len=11) :: "yield", "hardening", &
      "backstress", "modulus", "rate", "temperature", "fracture"]
  !> Key of the laws of friction.
  character(len=*), parameter :: friction_key = "friction_law"
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
    integer :: k, i

    text = ""
    do k = 1, size(kinds)
      call describe_laws(kinds(k), law)
      do i = 1, size(law)
        if (same_name(law(i)%name, name)) text = text//entry_of(keys(k), law(i))
      end do
    end do
  end function help_law

  !> Return the help on the laws of friction by their key `friction_law`; empty otherwise.
  function help_friction(topic) result(text)
    character(len=*), intent(in) :: topic
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: i

    text = ""
    if (.not. same_name(topic, friction_key)) return
    law = friction_laws()
    do i = 1, size(law)
      text = text//entry_of(friction_key, law(i))
    end do
  end function help_friction

  !> Return the help on a law of a key.
  function entry_of(key, law) result(text)
    character(len=*), intent(in) :: key
    type(description_t), intent(in) :: law
    character(len=:), allocatable :: text

    integer :: p

    text = trim(key)//" = "//trim(law%name)//newline//"  "//trim(law%title)//newline// &
        "  source: "//trim(law%source)//newline
    do p = 1, size(law%rows)
      text = text//"  "//describe_key(law%rows(p))//newline//repeat(" ", 6)// &
          trim(law%rows(p)%help)//newline
    end do
  end function entry_of

  !> Return the manual's reference of the laws of friction in Markdown.
  function friction_markdown() result(text)
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: i, p

    law = friction_laws()
    text = newline//"## Friction laws"//newline//heading(friction_key)// &
        "| law | meaning | parameters |"//newline//"|---|---|---|"//newline
    do i = 1, size(law)
      text = text//"| `"//trim(law(i)%name)//"` | "//escaped(trim(law(i)%title))//" | "
      do p = 1, size(law(i)%rows)
        if (p > 1) text = text//"; "
        text = text//"`"//trim(law(i)%rows(p)%name)//"` "//escaped(trim(law(i)%rows(p)%help))
      end do
      text = text//" |"//newline
    end do
  end function friction_markdown

  !> Return the manual's reference of all laws in Markdown.
  function law_reference_markdown() result(text)
    character(len=:), allocatable :: text

    type(description_t), allocatable :: law(:)
    integer :: k

    text = newline//"## Laws"//newline//newline//"`dd3imp --help law` and the pages of the "// &
        "[criteria](yield_criteria.md) and the [other laws](hardening_laws.md)"//newline// &
        "have the parameters with meaning, unit, bounds and default."//newline
    do k = 1, size(kinds)
      call describe_laws(kinds(k), law)
      text = text//table_of(keys(k), law)
    end do
  end function law_reference_markdown

  !> Return the heading of the laws of a key in Markdown.
  function heading(key)
    character(len=*), intent(in) :: key
    character(len=:), allocatable :: heading

    heading = newline//"### `"//trim(key)//" = law key=value ...`"//newline//newline
  end function heading

  !> Return the laws of a key in Markdown.
  function table_of(key, law) result(text)
    character(len=*), intent(in) :: key
    type(description_t), intent(in) :: law(:)
    character(len=:), allocatable :: text

    integer :: i

    text = heading(key)//"| law | meaning |"//newline//"|---|---|"//newline
    do i = 1, size(law)
      text = text//"| `"//trim(law(i)%name)//"` | "//escaped(trim(law(i)%title))//" |"//newline
    end do
  end function table_of

end module dd3_app_law_help
