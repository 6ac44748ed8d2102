! SPDX-License-Identifier: GPL-3.0-or-later
!> Values of an output field at the nodes and at the cells. A field of the integration points is
!> extrapolated to the nodes of each element and averaged over the elements that share a node; its
!> value at a cell is the mean of its points, by their quadrature weights.
module dd3_output_field_values
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_output_field_table, only : at_nodes_and_cells, at_points, field_t, &
      fill_internal_variable
  implicit none
  private
  public :: field_values, cell_offsets

contains

  !> Evaluate a field.
  subroutine field_values(field, model, state, strain, nodal, cell)
    type(field_t), intent(in) :: field
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Strains in the surface, from `evaluate_strains`.
    real(wp), intent(in) :: strain(:, :, :)
    !> Values at the nodes, `(components, n_node)`.
    real(wp), allocatable, intent(out) :: nodal(:, :)
    !> Values at the cells, `(components, n_element)`; of size zero for a field of the nodes alone.
    real(wp), allocatable, intent(out) :: cell(:, :)

    integer :: e

    allocate (nodal(field%components, model%n_node), source=0.0_wp)
    if (field%location == at_points) then
      allocate (cell(field%components, model%n_element))
      call point_values(field, model, state, nodal, cell)
      return
    end if
    if (field%location /= at_nodes_and_cells) then
      allocate (cell(field%components, 0))
      call field%fill(model, state, nodal)
      return
    end if
    allocate (cell(field%components, model%n_element))
    if (field%strain == 0) then
      call field%fill_both(model, state, nodal, cell)
      return
    end if
    nodal(1, :) = strain(field%strain, :, field%height)
    do e = 1, model%n_element
      cell(:, e) = sum(nodal(:, model%connectivity(:, e)), dim=2)/real(model%element%n_node, wp)
    end do
  end subroutine field_values

  !> Evaluate a field of the integration points.
  subroutine point_values(field, model, state, nodal, cell)
    type(field_t), intent(in) :: field
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Zero on entry.
    real(wp), intent(inout) :: nodal(:, :)
    real(wp), intent(out) :: cell(:, :)

    real(wp), allocatable :: value(:, :)
    integer, allocatable :: sharing(:)
    real(wp) :: weight, whole
    integer :: n, e, p, a, node

    whole = sum(model%element%weight)
    n = model%element%n_point
    allocate (value(field%components, n*model%n_element))
    if (field%variable > 0) then
      call fill_internal_variable(field%variable, model, state, value)
    else
      call field%fill(model, state, value)
    end if
    call count_sharing(model, sharing)
    do e = 1, model%n_element
      cell(:, e) = 0.0_wp
      do p = 1, n
        weight = model%element%weight(p)/whole
        cell(:, e) = cell(:, e) + weight*value(:, (e - 1)*n + p)
        do a = 1, model%element%n_node
          node = model%connectivity(a, e)
          weight = model%element%extrapolation(a, p)/real(sharing(node), wp)
          nodal(:, node) = nodal(:, node) + weight*value(:, (e - 1)*n + p)
        end do
      end do
    end do
    if (field%positive) nodal = max(nodal, 0.0_wp)
  end subroutine point_values

  !> Count the elements that share each node.
  subroutine count_sharing(model, sharing)
    type(model_t), intent(in) :: model
    !> `(n_node)`.
    integer, allocatable, intent(out) :: sharing(:)

    integer :: e, a

    allocate (sharing(model%n_node), source=0)
    do e = 1, model%n_element
      do a = 1, model%element%n_node
        sharing(model%connectivity(a, e)) = sharing(model%connectivity(a, e)) + 1
      end do
    end do
  end subroutine count_sharing

  !> Return the position of each cell's first node in the connectivity, and the end of the last one.
  pure function cell_offsets(model) result(offsets)
    type(model_t), intent(in) :: model
    integer, allocatable :: offsets(:)

    integer :: e

    allocate (offsets(model%n_element + 1))
    do e = 0, model%n_element
      offsets(e + 1) = e*model%element%n_node
    end do
  end function cell_offsets

end module dd3_output_field_values
