!> Linear systems for the tests of the solvers; the same in every run.
module sample_systems
  use dd3_base_kinds, only : wp, i8
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern
  implicit none
  private
  public :: grid_matrix, scale_rows, noise, dense_form, pressed_tool

contains

  !> Numbers between -1 and 1.
  subroutine noise(seed, values)
    !> Number of the sequence.
    integer, intent(in) :: seed
    !> The numbers.
    real(wp), intent(out) :: values(:)
    integer(i8) :: state
    integer :: i

    state = 1000_i8*seed + 77
    do i = 1, size(values)
      state = modulo(16807_i8*state, 2147483647_i8)
      values(i) = 2.0_wp*real(state, wp)/2147483647.0_wp - 1.0_wp
    end do
  end subroutine noise

  !> Matrix on a grid of bricks, numbered through the last direction first: noise of a given size
  !> around a Laplacian, and one more row where a tool is asked for that touches every fourth node.
  subroutine grid_matrix(divisions, size_of_noise, matrix, tool)
    !> Number of elements along each direction.
    integer, intent(in) :: divisions(3)
    !> Size of the unsymmetric noise; the Laplacian's blocks are of size one.
    real(wp), intent(in) :: size_of_noise
    !> The matrix.
    type(block_matrix_t), intent(out) :: matrix
    !> Whether a tool's row is added.
    logical, intent(in), optional :: tool
    integer, allocatable :: connectivity(:, :)
    real(wp), allocatable :: values(:)
    integer :: i, j, k, c, e, m, n, node

    m = divisions(3) + 1
    n = m*(divisions(2) + 1)
    allocate (connectivity(8, product(divisions)))
    e = 0
    do i = 0, divisions(1) - 1
      do j = 0, divisions(2) - 1
        do k = 1, divisions(3)
          e = e + 1
          node = k + m*j + n*i
          connectivity(:, e) = node + [0, n, n + m, m, 1, n + 1, n + m + 1, m + 1]
        end do
      end do
    end do
    n = n*(divisions(1) + 1)
    if (present(tool)) then
      call new_pattern(matrix, n, connectivity, [1, 1 + (n + 3)/4], pressed_tool(n))
    else
      call new_pattern(matrix, n, connectivity)
    end if
    allocate (values(size(matrix%value)))
    call noise(1, values)
    matrix%value = size_of_noise*reshape(values, shape(matrix%value))
    do i = 1, matrix%n
      do c = 1, 3
        do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
          matrix%value(c, c, k) = matrix%value(c, c, k) - 1.0_wp
        end do
        matrix%value(c, c, matrix%diagonal(i)) = real(matrix%row_start(i + 1) &
          - matrix%row_start(i), wp)
      end do
    end do
  end subroutine grid_matrix

  !> Nodes that a tool touches: every fourth one.
  function pressed_tool(n) result(nodes)
    !> Number of nodes.
    integer, intent(in) :: n
    integer :: nodes((n + 3)/4), i

    nodes = [(1 + 4*(i - 1), i=1, (n + 3)/4)]
  end function pressed_tool

  !> Multiplies the rows of a system by factors from 1e-2 to 1e4.
  subroutine scale_rows(matrix, b)
    !> The matrix.
    type(block_matrix_t), intent(inout) :: matrix
    !> The right-hand side.
    real(wp), intent(inout) :: b(:)
    real(wp), allocatable :: factor(:)
    integer :: i, c

    allocate (factor(size(b)))
    call noise(2, factor)
    factor = 10.0_wp**(1.0_wp + 3.0_wp*factor)
    b = b*factor
    do i = 1, matrix%n
      do c = 1, 3
        associate (row => matrix%value(c, :, matrix%row_start(i):matrix%row_start(i + 1) - 1))
          row = row*factor(3*i - 3 + c)
        end associate
      end do
    end do
  end subroutine scale_rows

  !> The matrix with all its zeros.
  function dense_form(matrix) result(dense)
    !> The matrix.
    type(block_matrix_t), intent(in) :: matrix
    real(wp) :: dense(3*matrix%n, 3*matrix%n)
    integer :: i, j, k

    dense = 0.0_wp
    do i = 1, matrix%n
      do k = matrix%row_start(i), matrix%row_start(i + 1) - 1
        j = matrix%column(k)
        dense(3*i - 2:3*i, 3*j - 2:3*j) = matrix%value(:, :, k)
      end do
    end do
  end function dense_form

end module sample_systems
