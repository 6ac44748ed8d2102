! SPDX-License-Identifier: GPL-3.0-or-later
!> Messages of a run: warnings and notes with a stable code, their place in the input and in the
!> process.
module dd3_base_message
  use dd3_base_error, only : location_t
  use dd3_base_text, only : to_text
  implicit none
  private
  public :: message_t, message_list_t, new_message

  !> A message.
  type :: message_t
    !> Severity, W or N, and number; see docs/messages.md.
    character(len=4) :: code = ""
    character(len=:), allocatable :: text
    !> Place in the input that it concerns; without a file if there is none.
    type(location_t) :: at
    !> Phase in which it is given, empty before the first, and accepted increments by then.
    character(len=:), allocatable :: phase
    integer :: increment = 0
  contains
    procedure :: is_warning
    procedure :: line => message_line
  end type message_t

  !> A list of messages.
  type :: message_list_t
    integer :: count = 0
    !> Messages in their order, `item(1:count)`.
    type(message_t), allocatable :: item(:)
  contains
    procedure :: add => list_add
    procedure :: add_new => list_add_new
    procedure :: line => list_line
  end type message_list_t

contains

  !> Make a message.
  function new_message(code, text, at) result(message)
    character(len=*), intent(in) :: code, text
    type(location_t), intent(in), optional :: at
    type(message_t) :: message

    message%code = code
    message%text = text
    message%phase = ""
    if (present(at)) message%at = at
  end function new_message

  !> Whether it is a warning; a note otherwise.
  pure logical function is_warning(self)
    class(message_t), intent(in) :: self

    is_warning = self%code(1:1) == "W"
  end function is_warning

  !> Return the message as one line of the log: place, severity and code, text.
  pure function message_line(self) result(line)
    class(message_t), intent(in) :: self
    character(len=:), allocatable :: line

    line = trim(merge("warning", "note   ", self%is_warning()))//" "//self%code//": "//self%text
    if (.not. allocated(self%at%file)) return
    line = ": "//line
    if (self%at%line > 0) line = ":"//to_text(self%at%line)//line
    line = self%at%file//line
  end function message_line

  !> Append a message.
  subroutine list_add(self, message)
    class(message_list_t), intent(inout) :: self
    type(message_t), intent(in) :: message

    type(message_t), allocatable :: larger(:)

    if (.not. allocated(self%item)) allocate (self%item(8))
    if (self%count == size(self%item)) then
      allocate (larger(2*self%count))
      larger(:self%count) = self%item
      call move_alloc(larger, self%item)
    end if
    self%count = self%count + 1
    self%item(self%count) = message
  end subroutine list_add

  !> Append a new message; no-op if its text is empty.
  subroutine list_add_new(self, code, text, at)
    class(message_list_t), intent(inout) :: self
    character(len=*), intent(in) :: code, text
    type(location_t), intent(in), optional :: at

    if (len(text) > 0) call self%add(new_message(code, text, at))
  end subroutine list_add_new

  !> Return a message as one line of the log.
  pure function list_line(self, i) result(line)
    class(message_list_t), intent(in) :: self
    integer, intent(in) :: i
    character(len=:), allocatable :: line

    line = self%item(i)%line()
  end function list_line

end module dd3_base_message
