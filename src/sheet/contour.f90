! SPDX-License-Identifier: GPL-3.0-or-later
!> The cut on the initial sheet, which is flat: the lines on which the cut function is zero, from
!> border to border or closed, with what stays on their left. Through each quadrilateral a line goes
!> from the edge on which the function falls below zero to that on which it rises.
!> Source of the cases of a quadrilateral: Lorensen and Cline, Comput. Graphics 21 (1987) 163-169.
module dd3_sheet_contour
  use dd3_base_kinds, only : wp
  use dd3_sheet_cut_function, only : cut_function_t
  use dd3_sheet_location, only : bilinear, inside, natural_coordinates
  use dd3_mesh_plane_curve, only : loop_t
  implicit none
  private
  public :: find_contours

  !> Parts of a line within a quadrilateral.
  integer, parameter :: n_part = 6
  !> Distance of corners that coincide, over the length of the line.
  real(wp), parameter :: coincident = 1.0e-9_wp

contains

  !> Find the lines.
  subroutine find_contours(cut, stays, initial, contour)
    type(cut_function_t), intent(in) :: cut
    !> Whether each column stays.
    logical, intent(in) :: stays(:)
    !> Positions of the columns on the initial sheet, `(2, n_column)`, mm.
    real(wp), intent(in) :: initial(:, :)
    type(loop_t), allocatable, intent(out) :: contour(:)

    logical :: pending(4, cut%grid%n_quad)
    type(loop_t) :: line
    integer :: edge, quad, turn

    ! Edges on which lines enter a quadrilateral and have not been followed.
    do quad = 1, cut%grid%n_quad
      associate (here => stays(cut%grid%corner(:, quad)))
        pending(:, quad) = here .and. .not. cshift(here, 1)
      end associate
    end do
    allocate (contour(0))
    ! Lines that begin at the border first; the others are closed.
    do turn = 1, 2
      do quad = 1, cut%grid%n_quad
        do edge = 1, 4
          if (.not. pending(edge, quad)) cycle
          if (turn == 1 .and. cut%grid%neighbour(edge, quad) > 0) cycle
          call follow(cut, stays, initial, quad, edge, pending, line)
          contour = [contour, line]
        end do
      end do
    end do
  end subroutine find_contours

  !> Follow a line from an edge on.
  subroutine follow(cut, stays, initial, first_quad, first_edge, pending, line)
    type(cut_function_t), intent(in) :: cut
    logical, intent(in) :: stays(:)
    real(wp), intent(in) :: initial(:, :)
    integer, intent(in) :: first_quad, first_edge
    logical, intent(inout) :: pending(:, :)
    type(loop_t), intent(out) :: line

    real(wp), allocatable :: point(:, :), larger(:, :)
    logical, allocatable :: corner(:), more(:)
    real(wp) :: part(2, 0:n_part)
    integer :: quad, edge, before, n, i, k, kink

    quad = first_quad
    edge = first_edge
    allocate (point(2, 64*n_part), corner(64*n_part))
    n = 0
    do
      pending(edge, quad) = .false.
      call cross_quad(cut, stays, quad, edge, before, part, kink)
      if (n + n_part + 1 > size(corner)) then
        allocate (larger(2, 2*size(corner)), more(2*size(corner)))
        larger(:, :n) = point(:, :n)
        more(:n) = corner(:n)
        call move_alloc(larger, point)
        call move_alloc(more, corner)
      end if
      do i = 0, n_part
        point(:, n + i + 1) = matmul(initial(:, cut%grid%corner(:, quad)), bilinear(part(:, i)))
        corner(n + i + 1) = i == kink
      end do
      n = n + n_part
      i = cut%grid%neighbour(before, quad)
      line%closed = .false.
      if (i == 0) exit
      edge = edge_between(cut, i, quad)
      quad = i
      line%closed = quad == first_quad .and. edge == first_edge
      if (line%closed .or. .not. pending(edge, quad)) exit
    end do
    if (.not. line%closed) n = n + 1
    line%point = point(:, :n)
    allocate (line%arc(n + 1))
    line%arc(1) = 0.0_wp
    do i = 1, n
      line%arc(i + 1) = line%arc(i) + norm2(line%point(:, mod(i, n) + 1) - line%point(:, i))
    end do
    ! A corner on an edge is found in both quadrilaterals.
    do i = 1, n
      if (.not. corner(i)) cycle
      do k = 1, i - 1
        if (norm2(line%point(:, k) - line%point(:, i)) > coincident*line%length()) cycle
        corner(i) = corner(i) .and. .not. corner(k)
      end do
    end do
    line%corner = pack(line%arc(:n), corner(:n))
  end subroutine follow

  !> Cross a quadrilateral from an edge to the next one on which the function rises above zero.
  subroutine cross_quad(cut, stays, quad, edge, leaves, part, kink)
    type(cut_function_t), intent(in) :: cut
    logical, intent(in) :: stays(:)
    integer, intent(in) :: quad, edge
    !> Edge on which the line leaves.
    integer, intent(out) :: leaves
    !> Natural coordinates along the line.
    real(wp), intent(out) :: part(2, 0:n_part)
    !> Part at which a corner of the curves lies; -1 for none.
    integer, intent(out) :: kink

    logical :: here(4)
    integer :: i, k

    here = stays(cut%grid%corner(:, quad))
    leaves = mod(edge, 4) + 1
    if (count(here) == 2 .and. (here(1) .eqv. here(3))) then
      ! Two lines: around the corner that goes, or around that which stays.
      if (cut%value(quad, [0.0_wp, 0.0_wp]) <= 0.0_wp) leaves = mod(edge + 2, 4) + 1
    else
      do while (here(leaves) .or. .not. here(mod(leaves, 4) + 1))
        leaves = mod(leaves, 4) + 1
      end do
    end if
    part(:, 0) = cut%zero_on_edge(quad, edge)
    part(:, n_part) = cut%zero_on_edge(quad, leaves)
    do i = 1, n_part - 1
      part(:, i) = part(:, 0) + real(i, wp)/real(n_part, wp)*(part(:, n_part) - part(:, 0))
      call cut%zero_near(quad, part(:, i))
    end do
    kink = -1
    do k = 1, size(cut%loop)
      do i = 1, size(cut%loop(k)%corner)
        call add_kink(cut, quad, cut%loop(k)%at(cut%loop(k)%corner(i)), part, kink)
      end do
    end do
  end subroutine cross_quad

  !> Put the nearest inner part of a line on a corner of the curves, if that lies within the
  !> quadrilateral.
  subroutine add_kink(cut, quad, corner, part, kink)
    type(cut_function_t), intent(in) :: cut
    integer, intent(in) :: quad
    real(wp), intent(in) :: corner(2)
    real(wp), intent(inout) :: part(2, 0:n_part)
    integer, intent(inout) :: kink

    real(wp) :: natural(2), margin(2)
    logical :: found
    integer :: i

    associate (vertex => cut%plane(:, cut%grid%corner(:, quad)))
      margin = (inside - 1.0_wp)*(maxval(vertex, dim=2) - minval(vertex, dim=2))
      if (any(corner < minval(vertex, dim=2) - margin) .or. &
          any(corner > maxval(vertex, dim=2) + margin)) return
      call natural_coordinates(vertex, corner, natural, found)
    end associate
    if (.not. found .or. any(abs(natural) > inside)) return
    kink = minloc([(norm2(part(:, i) - natural), i=1, n_part - 1)], dim=1)
    part(:, kink) = natural
    ! The other parts lie on straight lines beside it again.
    do i = 1, kink - 1
      part(:, i) = part(:, 0) + real(i, wp)/real(kink, wp)*(natural - part(:, 0))
      call cut%zero_near(quad, part(:, i))
    end do
    do i = kink + 1, n_part - 1
      part(:, i) = natural + real(i - kink, wp)/real(n_part - kink, wp)*(part(:, n_part) - natural)
      call cut%zero_near(quad, part(:, i))
    end do
  end subroutine add_kink

  !> Return the edge of a quadrilateral across which another one lies.
  pure integer function edge_between(cut, quad, other)
    type(cut_function_t), intent(in) :: cut
    integer, intent(in) :: quad, other

    edge_between = findloc(cut%grid%neighbour(:, quad), other, dim=1)
  end function edge_between

end module dd3_sheet_contour
