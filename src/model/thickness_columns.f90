!> Columns of nodes through the thickness of the sheet, from the pairs of opposite nodes of the
!> elements.
module dd3_model_thickness_columns
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: thickness_columns

contains

  !> Find the column in which each node lies.
  subroutine thickness_columns(model, column)
    type(model_t), intent(in) :: model
    !> Bottom and top node of the column of each node, `(2, n_node)`; a node that is in no column is
    !> its own bottom and top.
    integer, allocatable, intent(out) :: column(:, :)

    integer, allocatable :: next(:, :)
    integer :: e, p, i, below, above

    allocate (next(2, model%n_node), column(2, model%n_node))
    next = 0
    do e = 1, model%n_element
      do p = 1, model%element%n_pair
        below = model%connectivity(model%element%pair(1, p), e)
        above = model%connectivity(model%element%pair(2, p), e)
        next(2, below) = above
        next(1, above) = below
      end do
    end do
    do i = 1, model%n_node
      column(1, i) = last_of(next(1, :), i)
      column(2, i) = last_of(next(2, :), i)
    end do
  end subroutine thickness_columns

  !> Return the last node of a chain.
  pure integer function last_of(next, first)
    !> Next node of each node, 0 at the end.
    integer, intent(in) :: next(:)
    integer, intent(in) :: first

    integer :: steps

    last_of = first
    do steps = 1, size(next)
      if (next(last_of) == 0) return
      last_of = next(last_of)
    end do
  end function last_of

end module dd3_model_thickness_columns
