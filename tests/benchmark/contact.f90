! SPDX-License-Identifier: GPL-3.0-or-later
!> Time closest-point queries and the contact operator on the tools of the bending test, in ns.
!>
!>     benchmark_contact [folder of the tool files]
program benchmark_contact
  use dd3_base_kinds, only : wp
  use dd3_base_clock, only : wall_time
  use dd3_base_error, only : location_t, error_list_t
  use dd3_setup_tool_surface, only : read_tool_surface
  use dd3_contact_friction, only : coulomb, sliding_t
  use dd3_contact_operator, only : contact_operator_of_status, contact_status
  use dd3_tools_surface, only : surface_t
  use dd3_tools_closest, only : hint_t, hit_t, find_contact
  implicit none

  !> Number of queries per measurement, and of the nodes that make them.
  integer, parameter :: n_query = 1000000, n_node = 64
  type(surface_t) :: punch
  type(error_list_t) :: errors
  type(location_t) :: here
  character(len=1000) :: folder

  folder = "input_files/bending"
  if (command_argument_count() > 0) call get_command_argument(1, folder)
  call read_tool_surface(punch, trim(folder)//"/punch.bez", here, errors)
  if (errors%count > 0) then
    print '(a)', errors%item(1)%message
    stop 1
  end if
  call time_queries("tracked on the flat", 5.0_wp, 15.0_wp, 0.0_wp, 0.0_wp, .false.)
  call time_queries("tracked on the fillet", 0.0_wp, 0.0_wp, 0.2_wp, 1.3_wp, .false.)
  call time_queries("tracked over both", 15.0_wp, 20.0_wp, 0.0_wp, 1.3_wp, .false.)
  call time_queries("searched on the flat", 5.0_wp, 15.0_wp, 0.0_wp, 0.0_wp, .true.)
  call time_queries("searched on the fillet", 0.0_wp, 0.0_wp, 0.2_wp, 1.3_wp, .true.)
  call time_far()
  call time_operator()

contains

  !> Time queries of nodes on the punch that move by a micrometre from query to query.
  subroutine time_queries(name, x_first, x_last, angle_first, angle_last, due)
    character(len=*), intent(in) :: name
    !> Range of positions on the flat, mm, and on the fillet, rad.
    real(wp), intent(in) :: x_first, x_last, angle_first, angle_last
    !> Whether each query searches the whole surface.
    logical, intent(in) :: due

    type(hint_t) :: hint(n_node)
    type(hit_t) :: hit
    real(wp) :: x(3, n_node), start, total, s, a
    integer :: i, k, n

    do k = 1, n_node
      s = real(k - 1, wp)/(n_node - 1)
      a = angle_first + s*(angle_last - angle_first)
      if (x_last > 0.0_wp .and. (angle_last <= 0.0_wp .or. mod(k, 2) == 0)) then
        x(:, k) = [x_first + s*(x_last - x_first), 5.0_wp + s, 0.77_wp]
      else
        x(:, k) = [20.0_wp + 5.01_wp*sin(a), 5.0_wp + s, 5.78_wp - 5.01_wp*cos(a)]
      end if
    end do
    total = 0.0_wp
    n = merge(n_query/10, n_query, due)
    start = wall_time()
    do i = 1, n
      k = 1 + mod(i, n_node)
      x(1, k) = x(1, k) + 1.0e-3_wp*(mod(i/n_node, 2) - 0.5_wp)
      if (due) hint(k)%due = .true.
      call find_contact(punch, x(:, k), hint(k), 0.78_wp, 0.39_wp, hit)
      total = total + hit%distance
    end do
    call report(name, wall_time() - start, n, total)
  end subroutine time_queries

  !> Time queries of nodes far from the punch.
  subroutine time_far()
    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: x(3), start, total
    integer :: i

    total = 0.0_wp
    start = wall_time()
    do i = 1, n_query
      x = [10.0_wp, 5.0_wp, -9.0_wp + 1.0e-6_wp*i]
      call find_contact(punch, x, hint, 0.78_wp, 0.39_wp, hit)
      if (hit%found) total = total + 1.0_wp
    end do
    call report("far from the tool", wall_time() - start, n_query, total)
  end subroutine time_far

  !> Time the operator of a slipping node on a curved tool.
  subroutine time_operator()
    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp), parameter :: penalty(2) = 1.0e3_wp
    real(wp) :: start, total, force(3), d(3, 3), e(3, 3), lambda(3), slip(3)
    integer :: i, status

    call find_contact(punch, [23.0_wp, 5.0_wp, 1.7_wp], hint, 0.78_wp, 0.39_wp, hit)
    slip = [0.01_wp, 0.002_wp, 0.0_wp]
    total = 0.0_wp
    start = wall_time()
    do i = 1, n_query
      lambda = -100.0_wp*hit%normal + [0.0_wp, 1.0_wp, 1.0e-5_wp*i]
      status = contact_status(hit%normal, hit%distance, lambda, slip, penalty, &
          coulomb(0.144_wp), sliding_t())
      call contact_operator_of_status(status, hit%normal, hit%distance, hit%dnormal, lambda, &
          slip, penalty, coulomb(0.144_wp), sliding_t(), force, d, e)
      total = total + force(1) + d(1, 2) + e(2, 3)
    end do
    call report("operator", wall_time() - start, n_query, total)
  end subroutine time_operator

  !> Print the time per call.
  subroutine report(name, seconds, n, total)
    character(len=*), intent(in) :: name
    !> Time of all calls, s.
    real(wp), intent(in) :: seconds
    !> Number of calls.
    integer, intent(in) :: n
    !> Sum of the results, so that the compiler cannot drop any.
    real(wp), intent(in) :: total

    print '(a24, f10.1, a, es12.4, a)', name, 1.0e9_wp*seconds/n, " ns   (", total, ")"
  end subroutine report

end program benchmark_contact
