!> Contact status of the candidates in the last iterations, for the reason of a failure: which of
!> them kept opening and closing, or sticking and slipping.
module dd3_process_status_memory
  use dd3_base_text, only : to_text
  use dd3_contact_operator, only : status_gap, status_slip
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: new_status_memory, record_status, unsettled, status_changes

  !> Number of iterations whose status is kept.
  integer, parameter :: n_kept = 3
  !> Value before the first iteration.
  integer, parameter :: unknown = -1
  !> Largest number of nodes listed in a message.
  integer, parameter :: most_listed = 4

contains

  !> Make the memory of an attempt: no iteration yet.
  pure subroutine new_status_memory(memory, n_contact)
    !> `(n_contact, n_kept)`, the newest first.
    integer, allocatable, intent(inout) :: memory(:, :)
    integer, intent(in) :: n_contact

    if (.not. allocated(memory)) allocate (memory(n_contact, n_kept))
    memory = unknown
  end subroutine new_status_memory

  !> Record the status in an iteration.
  pure subroutine record_status(memory, status)
    integer, intent(inout) :: memory(:, :)
    integer, intent(in) :: status(:)

    memory(:, 2:) = memory(:, :n_kept - 1)
    memory(:, 1) = status
  end subroutine record_status

  !> Whether the status of each candidate changed in the last iterations.
  pure function unsettled(memory) result(changing)
    integer, intent(in) :: memory(:, :)
    logical :: changing(size(memory, 1))

    changing = any(memory /= unknown .and. memory /= spread(memory(:, 1), 2, n_kept), dim=2)
  end function unsettled

  !> Return a list of the nodes whose status did not settle in the last iterations; empty if there
  !> are none.
  function status_changes(model, memory, room) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: memory(:, :)
    !> Largest length of the text.
    integer, intent(in) :: room
    character(len=:), allocatable :: text

    character(len=:), allocatable :: node
    integer :: c, listed
    logical :: changing(size(memory, 1))

    text = ""
    changing = unsettled(memory)
    if (.not. any(changing)) return
    text = "contact status changes at "//to_text(count(changing))//" nodes: "
    if (count(changing) == 1) text = "contact status changes at 1 node: "
    listed = 0
    do c = 1, size(changing)
      if (.not. changing(c)) cycle
      node = "node "//to_text(model%contact_node(c))//course(memory(c, :))
      if (listed > 0) node = "; "//node
      if (listed == most_listed .or. len(text) + len(node) > room) return
      text = text//node
      listed = listed + 1
    end do
  end function status_changes

  !> Return the names of the status of a candidate, the oldest first, each after a blank.
  pure function course(kept) result(text)
    !> The newest first.
    integer, intent(in) :: kept(:)
    character(len=:), allocatable :: text

    character(len=5), parameter :: names(status_gap:status_slip) = ["gap  ", "stick", "slip "]
    integer :: i

    text = ""
    do i = size(kept), 1, -1
      if (kept(i) /= unknown) text = text//" "//trim(names(kept(i)))
    end do
  end function course

end module dd3_process_status_memory
