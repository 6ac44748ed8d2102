! SPDX-License-Identifier: GPL-3.0-or-later
!> Inputs for the tests: writes them, joins the messages they give.
module input_text
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : text_t
  use dd3_input_case, only : case_t
  use dd3_input_reader, only : read_case
  implicit none
  private
  public :: write_file, remove_file, read_text, messages, newline, good_sheet, good_pull, good_tool

  character(len=1), parameter :: newline = achar(10)
  !> A valid sheet with its material.
  character(len=*), parameter :: good_sheet = "*BLANK sheet"//newline//"size = 20 10 1"//newline// &
      "divisions = 4 2 2"//newline//"material = steel"//newline//"*MATERIAL steel"//newline// &
      "young = 2.1e5"//newline//"poisson = 0.3"//newline//"yield = von_mises"//newline// &
      "hardening = swift K=565 e0=0.007 n = 0.26"//newline
  !> A valid phase without tools.
  character(len=*), parameter :: good_pull = "*PHASE pull"//newline//"control = load"//newline// &
      "trial = 0.1"//newline//"displace = x_max x 0.1"//newline
  !> A valid tool and its contact.
  character(len=*), parameter :: good_tool = "*TOOL punch"//newline//"patches = 'my punch.bez'"// &
      newline//"contact = z_max"//newline//"friction = 0.1"//newline//"*CONTACT"//newline// &
      "penalty = 1d3"//newline

contains

  !> Write a file without conversion of line ends.
  subroutine write_file(name, text)
    character(len=*), intent(in) :: name
    character(len=*), intent(in) :: text

    integer :: unit

    call remove_file(name)
    open (newunit=unit, file=name, access="stream", form="unformatted", status="new", &
        action="write")
    write (unit) text
    close (unit)
  end subroutine write_file

  subroutine remove_file(name)
    character(len=*), intent(in) :: name

    integer :: unit, status

    open (newunit=unit, file=name, status="old", iostat=status)
    if (status == 0) close (unit, status="delete")
  end subroutine remove_file

  !> Read a case from a text, by way of a file.
  subroutine read_text(case, text, errors, overrides)
    type(case_t), intent(out) :: case
    character(len=*), intent(in) :: text
    type(error_list_t), intent(out) :: errors
    !> Texts `name=value`.
    type(text_t), intent(in), optional :: overrides(:)

    type(text_t) :: none(0)

    call write_file("case.dat", text)
    if (present(overrides)) then
      call read_case(case, "case.dat", overrides, errors)
    else
      call read_case(case, "case.dat", none, errors)
    end if
    call remove_file("case.dat")
  end subroutine read_text

  !> Return all messages, one per line.
  function messages(errors) result(text)
    type(error_list_t), intent(in) :: errors
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, errors%count
      text = text//errors%item(i)%message//newline
    end do
  end function messages

end module input_text
