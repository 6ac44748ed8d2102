! SPDX-License-Identifier: GPL-3.0-or-later
!> Entry of the list of messages: code, title, cause, remedy.
module dd3_message_row
  implicit none
  private
  public :: message_row_t, row

  !> A kind of message.
  type :: message_row_t
    !> Severity and number: W warning, N note, E1 error in the input, E2 stop of a run. It never
    !> changes its meaning, and is not used again.
    character(len=4) :: code = ""
    !> What happened, in a few words.
    character(len=80) :: title = ""
    !> Why, and what to do; sentences.
    character(len=320) :: cause = "", remedy = ""
  end type message_row_t

contains

  !> Return an entry.
  pure function row(code, title, cause, remedy)
    character(len=*), intent(in) :: code, title, cause, remedy
    type(message_row_t) :: row

    row%code = code
    row%title = title
    row%cause = cause
    row%remedy = remedy
  end function row

end module dd3_message_row
