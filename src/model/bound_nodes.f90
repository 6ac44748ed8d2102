! SPDX-License-Identifier: GPL-3.0-or-later
!> Bound nodes: where elements of different sizes meet, the nodes in the middle of an edge of the
!> larger element are bound to it. Those of elements that bend are points of its surface that is
!> curved by the directions of the columns at its ends: a mean of the two ends would miss the sag of
!> a bent edge, and the smaller elements would shear. Edges of other elements are straight. The
!> columns at the ends, the parents, carry the forces of a bound node by the transposed derivative
!> of its position; a parent is not bound itself.
module dd3_model_bound_nodes
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks, this_rank
  use dd3_model_model, only : model_t
  use dd3_sheet_surface_point, only : edge_point, middle_point
  implicit none
  private
  public :: set_bound_nodes, follow_parents, give_to_parents, forces_on_bound, share_bound

contains

  !> Set the points of the bound nodes, and the nodes on which the forces of each element act.
  subroutine set_bound_nodes(model, bound)
    !> With its mesh and its columns.
    type(model_t), intent(inout) :: model
    !> Bound nodes and the ends of their edges, `(3, n)`; not allocated if there are none.
    integer, allocatable, intent(in) :: bound(:, :)

    integer :: i

    model%n_bound = 0
    if (allocated(bound)) then
      model%n_bound = size(bound, 2)
      model%bound = bound
      allocate (model%bound_point(model%n_bound))
    end if
    do i = 1, model%n_bound
      if (model%element%n_enhanced > 0) then
        model%bound_point(i) = edge_point(model%bound(2:, i), &
            [other_end(model, model%bound(2, i)), other_end(model, model%bound(3, i))], 0.5_wp)
      else
        model%bound_point(i) = middle_point(model%bound(2:, i))
      end if
    end do
    call set_coupling(model)
  end subroutine set_bound_nodes

  !> Return the end of the column of a node that is not the node.
  pure integer function other_end(model, node)
    type(model_t), intent(in) :: model
    integer, intent(in) :: node

    other_end = model%column(1, node)
    if (other_end == node) other_end = model%column(2, node)
  end function other_end

  !> Set the nodes that the forces of each element act on: its own, and the parents of its bound
  !> nodes, as many for all elements; a node may be repeated.
  subroutine set_coupling(model)
    type(model_t), intent(inout) :: model

    integer, allocatable :: list(:)
    integer :: point(model%n_node), e, i, k, most, pass

    model%coupling = model%connectivity
    if (model%n_bound == 0) return
    point = 0
    point(model%bound(1, :)) = [(i, i=1, size(model%bound, 2))]
    most = size(model%connectivity, 1)
    do pass = 1, 2
      do e = 1, model%n_element
        list = model%connectivity(:, e)
        do i = 1, size(model%connectivity, 1)
          if (point(model%connectivity(i, e)) == 0) cycle
          associate (parent => model%bound_point(point(model%connectivity(i, e))))
            do k = 1, parent%n_node
              if (all(list /= parent%node(k))) list = [list, parent%node(k)]
            end do
          end associate
        end do
        most = max(most, size(list))
        if (pass == 2) model%coupling(:, e) = [list, (list(1), k=size(list) + 1, most)]
      end do
      if (pass == 1) then
        deallocate (model%coupling)
        allocate (model%coupling(most, model%n_element))
      end if
    end do
  end subroutine set_coupling

  !> Set the positions of the bound nodes from those of their parents.
  pure subroutine follow_parents(model, x)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(inout) :: x(:, :)

    integer :: i

    do i = 1, model%n_bound
      x(:, model%bound(1, i)) = model%bound_point(i)%position(x)
    end do
  end subroutine follow_parents

  !> Give all ranks the forces on bound nodes: a parent may belong to another rank than the node.
  subroutine share_bound(model, force)
    type(model_t), intent(in) :: model
    !> `(3, n_node)`, N; of several ranks each has those on its nodes.
    real(wp), intent(inout) :: force(:, :)

    real(wp) :: on_bound(3, model%n_bound)
    integer :: i, rank

    if (.not. model%part%divided .or. model%n_bound == 0) return
    rank = this_rank()
    on_bound = forces_on_bound(model, force)
    do i = 1, model%n_bound
      if (model%part%node_owner(model%bound(1, i)) /= rank) on_bound(:, i) = 0.0_wp
    end do
    call sum_over_ranks(size(on_bound), on_bound)
    force(:, model%bound(1, :)) = on_bound
  end subroutine share_bound

  !> Return those of nodal forces that are on bound nodes, `(3, n_bound)`.
  pure function forces_on_bound(model, force) result(on_bound)
    type(model_t), intent(in) :: model
    !> `(3, n_node)`, N.
    real(wp), intent(in) :: force(:, :)
    real(wp) :: on_bound(3, model%n_bound)

    integer :: i

    do i = 1, model%n_bound
      on_bound(:, i) = force(:, model%bound(1, i))
    end do
  end function forces_on_bound

  !> Give the forces on bound nodes to their parents.
  pure subroutine give_to_parents(model, x, force)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_node)`, N; zero at bound nodes on return.
    real(wp), intent(inout) :: force(:, :)

    real(wp) :: bound_force(3)
    integer :: i

    do i = 1, model%n_bound
      bound_force = force(:, model%bound(1, i))
      force(:, model%bound(1, i)) = 0.0_wp
      call model%bound_point(i)%add_nodal_forces(x, bound_force, force)
    end do
  end subroutine give_to_parents

end module dd3_model_bound_nodes
