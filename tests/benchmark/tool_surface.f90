! SPDX-License-Identifier: GPL-3.0-or-later
!> Processor time and memory of reading a tool of many patches, and the time of closest-point
!> queries on it. The tool is a wavy sheet of n x n patches of degrees 2 and 2 with common edges;
!> its file is made if it is missing.
!>
!>     benchmark_tool_surface folder n
!>
!> The number of patches is n*n.
program benchmark_tool_surface
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_setup_tool_surface, only : read_tool_surface
  use dd3_tools_closest, only : find_contact, hint_t, hit_t
  use dd3_tools_surface, only : surface_t
  implicit none

  !> Side of the tool and height of its waves, mm.
  real(wp), parameter :: side = 300.0_wp, height = 20.0_wp
  !> Number of queries.
  integer, parameter :: n_query = 100000
  type(surface_t) :: surface
  type(error_list_t) :: errors
  type(location_t) :: here
  character(len=1000) :: folder, word, file
  real(wp) :: start
  integer :: n
  logical :: there

  call get_command_argument(1, folder)
  call get_command_argument(2, word)
  read (word, *) n
  file = trim(folder)//"/wavy_"//trim(word)//".bez"
  inquire (file=trim(file), exist=there)
  if (.not. there) call write_file(trim(file))
  start = seconds()
  call read_tool_surface(surface, trim(file), here, errors)
  if (errors%count > 0) then
    print '(a)', errors%item(1)%message
    stop 1
  end if
  print '(i0, a, f0.3, a, a, a, i0, a)', size(surface%patch), " patches: read in ", &
      seconds() - start, " s, ", memory(), "; ", count(surface%edge%patch > 0)/2, " joined edges"
  call time_queries("near", 0.3_wp, ordered=.false.)
  call time_queries("in order", 0.3_wp, ordered=.true.)
  call time_queries("far", 40.0_wp, ordered=.false.)

contains

  !> Return a point of the surface; u, v from 0 to 1.
  pure function point(u, v)
    real(wp), intent(in) :: u, v
    real(wp) :: point(3)

    point = [side*u, side*v, height*sin(7.0_wp*u)*cos(5.0_wp*v)]
  end function point

  !> Write the patches that interpolate 3 x 3 points of the surface each.
  subroutine write_file(name)
    character(len=*), intent(in) :: name

    real(wp) :: control(3, 0:2, 0:2)
    integer :: unit, i, j

    open (newunit=unit, file=name, status="replace", action="write")
    do j = 0, n - 1
      do i = 0, n - 1
        call set_control(control, i, j)
        write (unit, '(a)') "patch 2 2"
        write (unit, '(3(1x, g0))') control
      end do
    end do
    close (unit)
  end subroutine write_file

  !> Set the control points of a patch: Lagrange to Bernstein along u, then along v.
  pure subroutine set_control(control, i, j)
    real(wp), intent(out) :: control(3, 0:2, 0:2)
    integer, intent(in) :: i, j

    integer :: a, b

    do b = 0, 2
      do a = 0, 2
        control(:, a, b) = point(real(2*i + a, wp)/(2*n), real(2*j + b, wp)/(2*n))
      end do
    end do
    control(:, 1, :) = 2.0_wp*control(:, 1, :) - 0.5_wp*(control(:, 0, :) + control(:, 2, :))
    control(:, :, 1) = 2.0_wp*control(:, :, 1) - 0.5_wp*(control(:, :, 0) + control(:, :, 2))
  end subroutine set_control

  !> Time searches of the whole surface from points at a height above it.
  subroutine time_queries(name, above, ordered)
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: above
    !> True for the nodes of a square grid row by row, as a run makes them; else random points.
    logical, intent(in) :: ordered

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp), allocatable :: uv(:, :)
    real(wp) :: began, total
    integer, allocatable :: seed(:)
    integer :: i, k, n_found, repeated

    call random_seed(size=k)
    seed = [(i, i=1, k)]
    call random_seed(put=seed)
    allocate (uv(2, n_query))
    call random_number(uv)
    if (ordered) call set_rows(uv)
    ! A linear scan of many patches is timed with fewer queries.
    repeated = n_query
    total = 0.0_wp
    n_found = 0
    began = seconds()
    do i = 1, n_query
      hint = hint_t()
      call find_contact(surface, point(uv(1, i), uv(2, i)) + [0.0_wp, 0.0_wp, above], hint, &
          1.0_wp, 0.5_wp, hit)
      if (hit%found) total = total + hit%distance
      if (hit%found) n_found = n_found + 1
      repeated = i
      if (seconds() - began > 10.0_wp) exit
    end do
    print '(a8, f10.3, a, i0, a, i0, a, es22.15, a)', name, 1.0e6_wp*(seconds() - began) &
        /repeated, " us (", n_found, " of ", repeated, " found, sum ", total, ")"
  end subroutine time_queries

  !> Set the points of a square grid row by row.
  pure subroutine set_rows(uv)
    !> u, v of the points.
    real(wp), intent(out) :: uv(:, :)

    integer :: i, n_row

    n_row = ceiling(sqrt(real(size(uv, 2), wp)))
    do i = 1, size(uv, 2)
      uv(:, i) = (real([modulo(i - 1, n_row), (i - 1)/n_row], wp) + 0.5_wp)/real(n_row, wp)
    end do
  end subroutine set_rows

  !> Return the processor time of this run, s.
  real(wp) function seconds()

    call cpu_time(seconds)
  end function seconds

  !> Return the largest memory of this run.
  function memory() result(text)
    character(len=:), allocatable :: text

    character(len=200) :: line
    integer :: unit, status

    text = "memory unknown"
    open (newunit=unit, file="/proc/self/status", action="read", iostat=status)
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      if (status == 0 .and. line(:6) == "VmHWM:") text = trim(adjustl(line(7:)))
    end do
    close (unit)
  end function memory

end program benchmark_tool_surface
