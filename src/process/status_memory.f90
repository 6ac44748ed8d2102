!> Contact status of the candidates in the last iterations, for the cause of a failure: whether
!> it settled.
module dd3_process_status_memory
  implicit none
  private
  public :: new_status_memory, record_status, unsettled

  !> Number of iterations whose status is kept.
  integer, parameter :: n_kept = 3
  !> Value before the first iteration.
  integer, parameter :: unknown = -1

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

end module dd3_process_status_memory
