! SPDX-License-Identifier: GPL-3.0-or-later
!> Columns of nodes through the thickness of the sheet, from the pairs of opposite nodes of the
!> elements.
module dd3_model_thickness_columns
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: set_columns, set_thickness

  !> Largest relative difference of thicknesses that count as equal.
  real(wp), parameter :: round_off = 1.0e-6_wp

contains

  !> Find the column in which each node lies, and the end of a fibre of it.
  pure subroutine set_columns(model)
    !> With its mesh; gets `column` and `fibre_end`.
    type(model_t), intent(inout) :: model

    integer, allocatable :: column(:, :)
    integer :: above(model%n_node), node, top
    logical :: has_below(model%n_node)
    integer :: e, p, i

    model%fibre_end = [(0, i=1, model%n_node)]
    above = 0
    has_below = .false.
    do e = 1, model%n_element
      do p = 1, model%element%n_pair
        associate (pair => model%connectivity(model%element%pair(:, p), e))
          above(pair(1)) = pair(2)
          has_below(pair(2)) = .true.
          model%fibre_end(pair) = [pair(2), pair(1)]
        end associate
      end do
    end do
    allocate (column(2, model%n_node), source=spread([(i, i=1, model%n_node)], 1, 2))
    do i = 1, model%n_node
      if (has_below(i)) cycle
      top = i
      do while (above(top) > 0)
        top = above(top)
      end do
      node = i
      do
        column(:, node) = [i, top]
        if (above(node) == 0) exit
        node = above(node)
      end do
    end do
    call add_middle_nodes(model, column)
    call move_alloc(column, model%column)
  end subroutine set_columns

  !> Add the nodes in the middle of edges through the thickness to the columns of these edges.
  pure subroutine add_middle_nodes(model, column)
    type(model_t), intent(in) :: model
    !> As in the model.
    integer, intent(inout) :: column(:, :)

    integer :: e, a, p

    associate (element => model%element)
      do a = 1, element%n_node
        if (abs(element%node(3, a)) > 0.5_wp) cycle
        do p = 1, element%n_pair
          if (any(abs(element%node(:2, a) - element%node(:2, element%pair(1, p))) > 0.5_wp)) cycle
          do e = 1, model%n_element
            column(:, model%connectivity(a, e)) = &
                column(:, model%connectivity(element%pair(1, p), e))
          end do
        end do
      end do
    end associate
  end subroutine add_middle_nodes

  !> Set the thickness of a mesh from a file; that of a structured blank is given.
  pure subroutine set_thickness(model, given)
    !> With its columns.
    type(model_t), intent(inout) :: model
    !> mm; 0 for a mesh from a file.
    real(wp), intent(in) :: given

    real(wp) :: length(model%n_node)
    integer :: i

    model%thickness = given
    if (given > 0.0_wp) return
    length = [(norm2(model%x0(:, model%column(2, i)) - model%x0(:, model%column(1, i))), &
        i=1, model%n_node)]
    model%thickness = minval(length, mask=length > 0.0_wp)
    where (length <= 0.0_wp) length = model%thickness
    if (maxval(length) > (1.0_wp + round_off)*model%thickness) model%node_thickness = length
  end subroutine set_thickness

end module dd3_model_thickness_columns
