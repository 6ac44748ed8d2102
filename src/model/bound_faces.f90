! SPDX-License-Identifier: GPL-3.0-or-later
!> Faces between elements of different sizes: they belong to one element each, but are not on the
!> boundary of the sheet.
module dd3_model_bound_faces
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: remove_inner_faces

contains

  !> Remove the faces between elements of different sizes from those on the boundary.
  pure subroutine remove_inner_faces(model)
    !> With columns and bound nodes.
    type(model_t), intent(inout) :: model

    integer :: parents(2, model%n_node), first(model%n_node), next(model%n_bound)
    logical :: kept(model%face%n)
    integer :: f, i

    if (model%n_bound == 0) return
    parents = 0
    first = 0
    do i = 1, model%n_bound
      associate (bottom => model%column(1, model%bound(:, i)))
        parents(:, bottom(1)) = bottom(2:)
        next(i) = first(minval(bottom(2:)))
        first(minval(bottom(2:))) = i
      end associate
    end do
    do f = 1, model%face%n
      kept(f) = .not. is_inner(model%column(1, model%face%corner(:, f)))
    end do
    associate (left => pack([(f, f=1, model%face%n)], kept))
      model%face%n = size(left)
      model%face%corner = model%face%corner(:, left)
      model%face%element = model%face%element(left)
      model%face%node = model%face%node(:, left)
    end associate

  contains

    !> Whether the columns of a face are the ends of an edge with a bound column, or such a column
    !> and one of its parents.
    pure logical function is_inner(bottom)
      !> Lowest nodes of the columns at the corners.
      integer, intent(in) :: bottom(4)

      integer :: i, low, high

      is_inner = .false.
      low = minval(bottom)
      high = maxval(bottom)
      ! A face across the thickness has two columns.
      if (low == high .or. any(bottom /= low .and. bottom /= high)) return
      is_inner = any(parents(:, low) == high) .or. any(parents(:, high) == low)
      i = first(low)
      do while (i > 0 .and. .not. is_inner)
        is_inner = any(model%column(1, model%bound(2:, i)) == high)
        i = next(i)
      end do
    end function is_inner

  end subroutine remove_inner_faces

end module dd3_model_bound_faces
