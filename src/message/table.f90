! SPDX-License-Identifier: GPL-3.0-or-later
!> The list of all messages with a code, for `--help` and docs/messages.md.
module dd3_message_table
  use dd3_base_text, only : newline, same_name
  use dd3_message_input_errors, only : input_errors
  use dd3_message_row, only : message_row_t
  use dd3_message_stops, only : stops
  use dd3_message_warnings, only : input_warnings, notes, run_warnings
  implicit none
  private
  public :: help_message, message_markdown

contains

  !> Return the help on a code; empty if there is no such code.
  function help_message(code) result(text)
    !> In any case.
    character(len=*), intent(in) :: code
    character(len=:), allocatable :: text

    type(message_row_t), allocatable :: list(:)
    integer :: i

    text = ""
    list = [input_warnings(), run_warnings(), notes(), input_errors(), stops()]
    do i = 1, size(list)
      if (.not. same_name(list(i)%code, code)) cycle
      text = list(i)%code//": "//trim(list(i)%title)//newline//"  cause: "//trim(list(i)%cause)// &
          newline//"  remedy: "//trim(list(i)%remedy)//newline
    end do
  end function help_message

  !> Return the page of all messages.
  function message_markdown() result(text)
    character(len=:), allocatable :: text

    text = "# Messages"//newline//newline// &
        "Made by `dd3imp --help messages`; `dd3imp --help W009` prints one entry. A code never "// &
        "changes"//newline//"its meaning. Messages stand on the screen, in job.log and in "// &
        "[run.json](manual.md#runjson)."//newline// &
        section("Warnings of unusual input", input_warnings())// &
        section("Warnings during a run", run_warnings())//section("Notes", notes())// &
        section("Errors in the input", input_errors())//section("Stops of a run", stops())
  end function message_markdown

  !> Return a section with its table.
  function section(title, list) result(text)
    character(len=*), intent(in) :: title
    type(message_row_t), intent(in) :: list(:)
    character(len=:), allocatable :: text

    integer :: i

    text = newline//"## "//title//newline//newline//"| code | message | cause | remedy |"// &
        newline//"|---|---|---|---|"//newline
    do i = 1, size(list)
      text = text//"| "//list(i)%code//" | "//trim(list(i)%title)//" | "//trim(list(i)%cause)// &
          " | "//trim(list(i)%remedy)//" |"//newline
    end do
  end function section

end module dd3_message_table
