! SPDX-License-Identifier: GPL-3.0-or-later
!> Reproducible linear systems and solver options for the tests of the solvers.
module sample_systems
  use dd3_base_kinds, only : wp, i8
  use dd3_linalg_matrix, only : block_matrix_t, new_pattern
  use dd3_linalg_solver, only : solver_options_t
  implicit none
  private
  public :: grid_matrix, scale_rows, noise, dense_form, pressed_tool, sample_options

contains

  !> Return options of a solver that the sample systems suit.
  pure type(solver_options_t) function sample_options(method) result(options)
    character(len=*), intent(in) :: method

    options%method = method
    options%ilu_level = 2
    options%tolerance = 1.0e-10_wp
    options%iterations = 200
    options%ordering = "none"
  end function sample_options

  !> Return pseudo-random numbers between -1 and 1.
  subroutine noise(seed, values)
    integer, intent(in) :: seed
    real(wp), intent(out) :: values(:)

    integer(i8) :: state
    integer :: i

    state = 1000_i8*seed + 77
    do i = 1, size(values)
      state = modulo(16807_i8*state, 2147483647_i8)
      values(i) = 2.0_wp*real(state, wp)/2147483647.0_wp - 1.0_wp
    end do
  end subroutine noise

  !> Build the matrix of a grid of bricks, numbered in the last direction first: a Laplacian plus
  !> noise, optionally with one more row for a tool that touches every fourth node.
  subroutine grid_matrix(divisions, size_of_noise, matrix, tool)
    !> Number of elements in each direction.
    integer, intent(in) :: divisions(3)
    !> Size of the unsymmetric noise; the blocks of the Laplacian are of size one.
    real(wp), intent(in) :: size_of_noise
    type(block_matrix_t), intent(out) :: matrix
    !> Present to add the row of the tool.
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
        matrix%value(c, c, matrix%diagonal(i)) = &
            real(matrix%row_start(i + 1) - matrix%row_start(i), wp)
      end do
    end do
  end subroutine grid_matrix

  !> Return every fourth of n nodes, those that the tool touches.
  function pressed_tool(n) result(nodes)
    integer, intent(in) :: n
    integer :: nodes((n + 3)/4)

    integer :: i

    nodes = [(1 + 4*(i - 1), i=1, (n + 3)/4)]
  end function pressed_tool

  !> Multiply the rows of a system by factors from 1e-2 to 1e4.
  subroutine scale_rows(matrix, b)
    type(block_matrix_t), intent(inout) :: matrix
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

  !> Return a matrix as a dense array.
  function dense_form(matrix) result(dense)
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
