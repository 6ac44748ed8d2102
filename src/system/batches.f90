!> Batches of consecutive elements for the threads, coloured such that batches of one colour share
!> no node.
module dd3_system_batches
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: batches_t, new_batches

  !> Elements in a batch.
  integer, parameter :: batch_size = 8

  !> Coloured batches.
  type :: batches_t
    !> First element of each batch, and the end of the last one, `(n_batch + 1)`.
    integer, allocatable :: start(:)
    !> Batches sorted by colour, `(n_batch)`.
    integer, allocatable :: coloured(:)
    !> Position of the first batch of each colour, and the end of the last one, `(n_colour + 1)`.
    integer, allocatable :: colour_start(:)
  end type batches_t

contains

  !> Colour the batches greedily in their order: two colours for a mesh numbered section by section.
  subroutine new_batches(self, model)
    type(batches_t), intent(out) :: self
    type(model_t), intent(in) :: model

    logical, allocatable :: left(:), taken(:)
    integer :: i, n, n_batch

    n_batch = (model%n_element + batch_size - 1)/batch_size
    self%start = [(min(1 + i*batch_size, model%n_element + 1), i=0, n_batch)]
    allocate (self%coloured(n_batch), left(n_batch), taken(model%n_node))
    left = .true.
    self%colour_start = [1]
    n = 0
    do while (any(left))
      taken = .false.
      do i = 1, n_batch
        if (.not. left(i)) cycle
        associate (nodes => model%connectivity(:, self%start(i):self%start(i + 1) - 1))
          if (any(taken(reshape(nodes, [size(nodes)])))) cycle
          taken(reshape(nodes, [size(nodes)])) = .true.
        end associate
        left(i) = .false.
        n = n + 1
        self%coloured(n) = i
      end do
      self%colour_start = [self%colour_start, n + 1]
    end do
  end subroutine new_batches

end module dd3_system_batches
