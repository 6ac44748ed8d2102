! SPDX-License-Identifier: GPL-3.0-or-later
!> Lines on the error stream, which may be closed.
module dd3_app_error_stream
  use, intrinsic :: iso_fortran_env, only : error_unit
  use dd3_base_error, only : error_t
  use dd3_base_ranks, only : this_rank
  implicit none
  private
  public :: message_of, put_line, write_line

contains

  !> Write a line that all ranks know on the error stream.
  subroutine write_line(text)
    character(len=*), intent(in) :: text

    if (this_rank() == 0) call put_line(text)
  end subroutine write_line

  !> Write a line on the error stream.
  subroutine put_line(text)
    character(len=*), intent(in) :: text

    integer :: ignored

    ! allow(C181)

    write (error_unit, '(a)', iostat=ignored) text
  end subroutine put_line

  !> Return the message of an error after a word and its code.
  pure function message_of(error, word) result(text)
    type(error_t), intent(in) :: error
    character(len=*), intent(in) :: word
    character(len=:), allocatable :: text

    text = trim(word//" "//error%code)//": "//error%message
  end function message_of

end module dd3_app_error_stream
