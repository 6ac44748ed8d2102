!> Round-off of the residual: a node's position is the multiple of `spacing` nearest to the
!> solution, and the stiffness turns that difference into a force that no iteration removes.
!> Source: Tisseur 2001, Newton's method in floating point arithmetic, SIAM J. Matrix Anal. Appl.
!> 22, 1038-1057: the residual of Newton's method stalls at u |J| |x|, u the unit round-off and J
!> the Jacobian. Here the differences are random, uniform in the interval of rounding, so that their
!> variance is spacing**2/12 and the squares of their forces add.
module dd3_system_round_off
  use dd3_base_kinds, only : wp
  use dd3_linalg_matrix, only : block_matrix_t
  use dd3_system_partition, only : partition_t
  implicit none
  private
  public :: attainable_residual

  !> Residual that counts as zero, over the root mean square of the round-off. In S-shaped rails
  !> (input_files/rail, 48 to 1080 elements) residuals stall at 1.0 to 3.5 times the latter, as the
  !> parameters of the enhanced strains, the stresses and the forces are rounded too.
  real(wp), parameter :: multiple = 5.0_wp

contains

  !> Return the norm of the residual below which it is round-off, N.
  function attainable_residual(stiffness, x, partition) result(residual)
    !> Of the sheet; its first rows are those of the nodes, N/mm.
    type(block_matrix_t), intent(in) :: stiffness
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    type(partition_t), intent(in) :: partition
    real(wp) :: residual

    real(wp) :: variance(3, size(x, 2)), square(1, size(x, 2))
    integer :: node, k, i

    variance = spacing(x)**2/12.0_wp
    square = 0.0_wp
    do node = 1, size(x, 2)
      do k = stiffness%row_start(node), stiffness%row_start(node + 1) - 1
        associate (neighbour => stiffness%column(k))
          if (neighbour > size(x, 2)) cycle
          do i = 1, 3
            square(1, node) = square(1, node) &
                + sum(stiffness%value(:, i, k)**2)*variance(i, neighbour)
          end do
        end associate
      end do
    end do
    call partition%share_nodes(square)
    residual = multiple*sqrt(sum(square))
  end function attainable_residual

end module dd3_system_round_off
