! SPDX-License-Identifier: GPL-3.0-or-later
!> Elimination of the bound nodes from the reduced system. With the displacements u_h = B u_p of a
!> bound node by those of its parents, the columns of the node are given to the parents by B, its
!> row and its force by B^T; the change of B under the force of the node adds to the rows of the
!> parents. What is left is a unit row. Of several ranks each does so with what it has added itself,
!> and the rank of the node adds what is there once.
module dd3_system_bound_rows
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t, position_of
  use dd3_linalg_partition, only : holds_row
  use dd3_linalg_tensor, only : identity
  use dd3_model_model, only : model_t
  use dd3_sheet_surface_point, only : most_point_nodes, surface_point_t
  implicit none
  private
  public :: eliminate_bound_nodes, set_bound_displacements

contains

  !> Give the rows and columns of the bound nodes to their parents.
  subroutine eliminate_bound_nodes(matrix, rhs, model, x, force)
    !> With the contributions of the elements, the terms and the contact points of this rank.
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(inout) :: rhs(:)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Forces on the bound nodes, `(3, size(bound, 2))`, N.
    real(wp), intent(in) :: force(:, :)

    real(wp) :: b(3, 3, most_point_nodes)
    integer :: i

    do i = 1, model%n_bound
      call model%bound_point(i)%gradient(x, b)
      call give_columns(matrix, model%bound(1, i), model%bound_point(i), b)
    end do
    do i = 1, model%n_bound
      call model%bound_point(i)%gradient(x, b)
      call give_row(matrix, rhs, model%bound(1, i), model%bound_point(i), b)
      if (holds_row(matrix, model%bound(1, i))) then
        call add_change(matrix, model%bound_point(i), x, force(:, i))
      end if
    end do
  end subroutine eliminate_bound_nodes

  !> Give the columns of a node to its parents. The pattern is symmetric.
  subroutine give_columns(matrix, node, point, b)
    type(block_matrix_t), intent(inout) :: matrix
    integer, intent(in) :: node
    type(surface_point_t), intent(in) :: point
    !> Derivatives in the displacements of the parents.
    real(wp), intent(in) :: b(:, :, :)

    real(wp) :: block(3, 3)
    integer :: i, k, row

    do k = matrix%row_start(node), matrix%row_start(node + 1) - 1
      row = matrix%column(k)
      associate (at => position_of(matrix, row, node))
        if (at == 0) cycle
        block = matrix%value(:, :, at)
        matrix%value(:, :, at) = 0.0_wp
      end associate
      do i = 1, point%n_node
        call add(matrix, row, point%node(i), matmul(block, b(:, :, i)))
      end do
    end do
  end subroutine give_columns

  !> Give the row of a node to its parents, and leave a unit row on its rank.
  subroutine give_row(matrix, rhs, node, point, b)
    type(block_matrix_t), intent(inout) :: matrix
    real(wp), intent(inout) :: rhs(:)
    integer, intent(in) :: node
    type(surface_point_t), intent(in) :: point
    real(wp), intent(in) :: b(:, :, :)

    integer :: i, k

    do i = 1, point%n_node
      associate (own => rhs(3*node - 2:3*node), parent => 3*point%node(i))
        rhs(parent - 2:parent) = rhs(parent - 2:parent) + matmul(own, b(:, :, i))
      end associate
      do k = matrix%row_start(node), matrix%row_start(node + 1) - 1
        if (all(abs(matrix%value(:, :, k)) <= 0.0_wp)) cycle
        call add(matrix, point%node(i), matrix%column(k), &
            matmul(transpose(b(:, :, i)), matrix%value(:, :, k)))
      end do
    end do
    rhs(3*node - 2:3*node) = 0.0_wp
    if (matrix%diagonal(node) == 0) return
    matrix%value(:, :, matrix%row_start(node):matrix%row_start(node + 1) - 1) = 0.0_wp
    if (holds_row(matrix, node)) matrix%value(:, :, matrix%diagonal(node)) = identity
  end subroutine give_row

  !> Add the derivative of the forces on the parents of a constant force on a bound node.
  subroutine add_change(matrix, point, x, force)
    type(block_matrix_t), intent(inout) :: matrix
    type(surface_point_t), intent(in) :: point
    real(wp), intent(in) :: x(:, :)
    !> N.
    real(wp), intent(in) :: force(3)

    real(wp) :: block(3, 3, most_point_nodes, most_point_nodes)
    integer :: i, j

    call point%bending_stiffness(x, force, block)
    do j = 1, point%n_node
      do i = 1, point%n_node
        call add(matrix, point%node(i), point%node(j), block(:, :, i, j))
      end do
    end do
  end subroutine add_change

  !> Add a block; no-op where the matrix has none, as that of a region at nodes that are held.
  subroutine add(matrix, row, column, block)
    type(block_matrix_t), intent(inout) :: matrix
    integer, intent(in) :: row, column
    real(wp), intent(in) :: block(3, 3)

    integer :: k

    k = position_of(matrix, row, column)
    if (k > 0) matrix%value(:, :, k) = matrix%value(:, :, k) + block
  end subroutine add

  !> Set the displacements of the bound nodes in the solution of the linear system from those of
  !> their parents.
  subroutine set_bound_displacements(model, x, solution)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3*n_row)`, mm.
    real(wp), intent(inout) :: solution(:)

    real(wp) :: b(3, 3, most_point_nodes), u(3)
    integer :: i, k

    do i = 1, model%n_bound
      call model%bound_point(i)%gradient(x, b)
      u = 0.0_wp
      do k = 1, model%bound_point(i)%n_node
        associate (parent => 3*model%bound_point(i)%node(k))
          u = u + matmul(b(:, :, k), solution(parent - 2:parent))
        end associate
      end do
      solution(3*model%bound(1, i) - 2:3*model%bound(1, i)) = u
    end do
  end subroutine set_bound_displacements

end module dd3_system_bound_rows
