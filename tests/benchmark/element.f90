! SPDX-License-Identifier: GPL-3.0-or-later
!> Time the element kernels for every element of the registry, in microseconds per element; an
!> element with a choice of points through the thickness with 5 and with 7. Columns: deformation,
!> internal forces and element stiffness, each with the transformation of the stresses that it
!> needs, addition of the stiffness to a block matrix, increments of first order.
program benchmark_element
  use dd3_base_clock, only : wall_time
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_base_verdict, only : verdict_t
  use dd3_element_registry, only : element_names, new_element
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_linalg_matrix, only : add_element, block_matrix_t, find_positions, new_pattern
  implicit none

  !> The best of many short rounds counts, which other programs on the machine disturb least.
  integer, parameter :: rounds = 500, calls = 20
  character(len=16), allocatable :: name(:)
  integer :: i

  name = element_names()
  do i = 1, size(name)
    call measure(trim(name(i)), 5)
    call measure(trim(name(i)), 7)
  end do

contains

  !> Time the kernels of one element and print a line.
  subroutine measure(name, thickness_points)
    character(len=*), intent(in) :: name
    integer, intent(in) :: thickness_points

    type(element_t) :: element
    type(element_work_t) :: work
    type(verdict_t) :: verdict
    type(error_t), allocatable :: error
    type(block_matrix_t) :: matrix
    real(wp), allocatable :: axes(:, :, :)
    integer, allocatable :: position(:, :, :)
    real(wp) :: best(5), start
    integer :: call_number, k, round

    call new_element(element, name, error, thickness_points)
    if (element%n_thickness_point == 0 .and. thickness_points == 5) return
    call new_element_work(work, element%n_node, element%n_point, element%n_group, &
        element%n_enhanced)
    allocate (axes(3, 3, element%n_point))
    call prepare(element, axes, work)
    call make_matrix(element%n_node, matrix, position)
    best = huge(1.0_wp)
    do round = 1, rounds
      do k = 1, 5
        start = wall_time()
        do call_number = 1, calls
          select case (k)
          case (1)
            call element%deform(element, axes, work, verdict)
          case (2)
            call element%set_stress(element, work)
            call element%evaluate_force(element, work)
          case (3)
            call element%set_stress(element, work)
            call element%evaluate_stiffness(element, work)
          case (4)
            call add_element(matrix, element%n_node, position(:, :, 1), work%stiffness)
          case (5)
            call element%evaluate_rate(element, element%node, axes, work)
          case default
            error stop "no such measurement"
          end select
        end do
        best(k) = min(best(k), (wall_time() - start)/real(calls, wp)*1.0e6_wp)
      end do
    end do
    print '(a, 5(2x, a, f7.2))', name//", "//to_text(element%n_point)//" points, us:", &
        "deformation", best(1), "force", best(2), "stiffness", best(3), "addition", best(4), &
        "rate", best(5)
  end subroutine measure

  !> Make the matrix of a row of elements, the first of which is timed.
  subroutine make_matrix(n_node, matrix, position)
    integer, intent(in) :: n_node
    type(block_matrix_t), intent(out) :: matrix
    integer, allocatable, intent(out) :: position(:, :, :)

    integer, parameter :: n = 50
    integer :: connectivity(n_node, n), a, e

    connectivity = reshape([((a + (e - 1)*n_node/2, a=1, n_node), e=1, n)], [n_node, n])
    call new_pattern(matrix, maxval(connectivity), connectivity)
    call find_positions(matrix, connectivity, position)
  end subroutine make_matrix

  !> Return a distorted element with a small strain, stresses and moduli.
  subroutine prepare(element, axes, work)
    type(element_t), intent(in) :: element
    !> Material axes.
    real(wp), intent(out) :: axes(:, :, :)
    !> Gets positions, stress and tangent.
    type(element_work_t), intent(inout) :: work

    integer :: i

    call random_number(work%x_committed)
    call random_number(work%x_trial)
    call random_number(work%stress)
    work%stress = 200.0_wp*work%stress
    work%x_initial = element%node
    work%x_committed = element%node + 0.1_wp*work%x_committed
    work%x_trial = work%x_committed + 0.003_wp*work%x_trial
    axes = 0.0_wp
    work%tangent = 1.0e5_wp
    do i = 1, 6
      if (i <= 3) axes(i, i, :) = 1.0_wp
      work%tangent(i, i, :) = 2.0e5_wp
    end do
  end subroutine prepare

end program benchmark_element
