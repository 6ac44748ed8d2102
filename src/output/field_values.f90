! SPDX-License-Identifier: GPL-3.0-or-later
!> Values of an output field at the nodes and at the cells. A field of the integration points is
!> extrapolated to the nodes of each element and averaged over the elements that share a node; its
!> value at a cell is the mean of its points, by their quadrature weights.
module dd3_output_field_values
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_part, only : of_elements
  use dd3_model_state, only : state_t
  use dd3_output_field_table, only : at_nodes_and_cells, at_points, field_t, &
      field_table, fill_internal_variable
  implicit none
  private
  public :: field_values, give_values

contains

  !> Evaluate a field on rank 0. The other ranks give their values, see `give_values`.
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
    logical :: counts(model%n_element)
    real(wp) :: weight, whole
    integer :: n, e, p, a, node

    call gather_points(field, model, state, value)
    whole = sum(model%element%weight)
    n = field%components
    counts = .true.
    if (field%variable > 0) counts = &
        model%internal_variable(field%variable)%is_known(model%material_of)
    call count_sharing(model, counts, sharing)
    do e = 1, model%n_element
      cell(:, e) = 0.0_wp
      do p = 1, model%element%n_point
        associate (at_point => value(n*(p - 1) + 1:n*p, e))
          weight = model%element%weight(p)/whole
          cell(:, e) = cell(:, e) + weight*at_point
          if (.not. counts(e)) cycle
          do a = 1, model%element%n_node
            node = model%connectivity(a, e)
            weight = model%element%extrapolation(a, p)/real(sharing(node), wp)
            nodal(:, node) = nodal(:, node) + weight*at_point
          end do
        end associate
      end do
    end do
    if (field%positive) nodal = max(nodal, 0.0_wp)
  end subroutine point_values

  !> Evaluate a field at the integration points of this rank and gather it on rank 0.
  subroutine gather_points(field, model, state, value)
    type(field_t), intent(in) :: field
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> `(components*n_point, n_element)` on rank 0.
    real(wp), allocatable, intent(out) :: value(:, :)

    real(wp), allocatable :: own(:, :)

    associate (n_point => model%element%n_point)
      allocate (own(field%components, n_point*size(model%part%element)))
      if (field%variable > 0) then
        call fill_internal_variable(field%variable, model, state, own)
      else
        call field%fill(model, state, own)
      end if
      call model%part%gather(of_elements, field%components*n_point, size(model%part%element), own, &
          value)
    end associate
  end subroutine gather_points

  !> Give rank 0 the values of the integration points and the contact points of this rank for all
  !> fields.
  subroutine give_values(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    type(field_t), allocatable :: field(:)
    real(wp), allocatable :: unused(:, :), nodal(:, :)
    integer :: i

    field = field_table(model)
    do i = 1, size(field)
      if (field(i)%location == at_points) then
        call gather_points(field(i), model, state, unused)
      else if (field(i)%location /= at_nodes_and_cells) then
        allocate (nodal(field(i)%components, model%n_node))
        call field(i)%fill(model, state, nodal)
        deallocate (nodal)
      end if
    end do
  end subroutine give_values

  !> Count the elements that share each node.
  subroutine count_sharing(model, counts, sharing)
    type(model_t), intent(in) :: model
    !> Elements that count, `(n_element)`.
    logical, intent(in) :: counts(:)
    !> `(n_node)`.
    integer, allocatable, intent(out) :: sharing(:)

    integer :: e, a

    allocate (sharing(model%n_node), source=0)
    do e = 1, model%n_element
      if (.not. counts(e)) cycle
      do a = 1, model%element%n_node
        sharing(model%connectivity(a, e)) = sharing(model%connectivity(a, e)) + 1
      end do
    end do
  end subroutine count_sharing

end module dd3_output_field_values
