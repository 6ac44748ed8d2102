!> Time the element kernels for every element of the registry, in microseconds per element.
program benchmark_element
  use dd3_base_clock, only : wall_time
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_element_force, only : element_cauchy, element_force
  use dd3_element_log_strain, only : element_strain
  use dd3_element_kinematics, only : element_gradients, element_kinematics
  use dd3_element_rate, only : element_rate
  use dd3_element_registry, only : element_names, new_element
  use dd3_element_stiffness, only : element_stiffness
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t, new_element_work
  implicit none

  !> The best of several rounds of many calls counts.
  integer, parameter :: rounds = 5, calls = 20000
  character(len=16), allocatable :: name(:)
  integer :: i

  name = element_names()
  do i = 1, size(name)
    call measure(trim(name(i)))
  end do

contains

  !> Time the kernels of one element and print a line.
  subroutine measure(name)
    character(len=*), intent(in) :: name

    type(element_t) :: element
    type(element_work_t) :: work
    type(verdict_t) :: verdict
    type(error_t), allocatable :: error
    real(wp), allocatable :: x(:, :), moved(:, :), axes(:, :, :)
    real(wp) :: best(6), start
    integer :: call_number, k, round

    call new_element(element, name, error)
    call new_element_work(work, element)
    allocate (x(3, element%n_node), moved(3, element%n_node), axes(3, 3, element%n_point))
    call prepare(element, x, moved, axes, work)
    best = huge(1.0_wp)
    do round = 1, rounds
      do k = 1, 6
        start = wall_time()
        do call_number = 1, calls
          select case (k)
          case (1)
            call element_kinematics(element, x, moved, work, verdict)
          case (2)
            call element_strain(element, axes, work)
          case (3)
            call element_cauchy(element, work)
            call element_force(element, work)
          case (4)
            call element_cauchy(element, work)
            call element_stiffness(element, work)
          case (5)
            call element_gradients(element, moved, work, verdict)
          case (6)
            call element_rate(element, x, axes, work)
          end select
        end do
        best(k) = min(best(k), (wall_time() - start)/real(calls, wp)*1.0e6_wp)
      end do
    end do
    print '(a, 6(2x, a, f7.2))', name//", us:", "kinematics", best(1), "strain", best(2), &
        "force", best(3), "stiffness", best(4), "gradients", best(5), "rate", best(6)
  end subroutine measure

  !> Return a distorted element with a small strain, stresses and moduli.
  subroutine prepare(element, x, moved, axes, work)
    type(element_t), intent(in) :: element
    !> Committed and trial positions, mm.
    real(wp), intent(out) :: x(:, :), moved(:, :)
    !> Material axes.
    real(wp), intent(out) :: axes(:, :, :)
    !> Gets stress and tangent.
    type(element_work_t), intent(inout) :: work

    integer :: i

    call random_number(x)
    call random_number(moved)
    call random_number(work%stress)
    work%stress = 200.0_wp*work%stress
    x = element%node + 0.1_wp*x
    moved = x + 0.003_wp*moved
    axes = 0.0_wp
    work%tangent = 1.0e5_wp
    do i = 1, 6
      if (i <= 3) axes(i, i, :) = 1.0_wp
      work%tangent(i, i, :) = 2.0e5_wp
    end do
  end subroutine prepare

end program benchmark_element
