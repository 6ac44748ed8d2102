! SPDX-License-Identifier: GPL-3.0-or-later
!> The function whose zero is the cut: the distance from the curves in the plane of the cut,
!> positive on what stays. It is known everywhere on the sheet, also where that is steep in the
!> plane.
module dd3_sheet_cut_function
  use dd3_base_kinds, only : wp
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : bilinear, corner_sign
  use dd3_mesh_plane_curve, only : is_inside, loop_t
  implicit none
  private
  public :: cut_function_t

  !> Half the distance of the points of a difference quotient, and iterations to a zero.
  real(wp), parameter :: half_step = 1.0e-5_wp
  integer, parameter :: most_bisections = 60, most_iterations = 8
  !> Largest way to a zero in natural coordinates.
  real(wp), parameter :: longest_way = 0.8_wp

  !> The function on a grid.
  type :: cut_function_t
    type(grid_t) :: grid
    !> Positions of the columns in the plane, `(2, n_column)`, mm.
    real(wp), allocatable :: plane(:, :)
    !> Curves in the plane.
    type(loop_t), allocatable :: loop(:)
    logical :: keeps_inside = .true.
  contains
    procedure :: value_at
    procedure :: value
    procedure :: zero_on_edge
    procedure :: zero_near
  end type cut_function_t

contains

  !> Return the function at a point of the plane, mm.
  pure real(wp) function value_at(self, point)
    class(cut_function_t), intent(in) :: self
    real(wp), intent(in) :: point(2)

    real(wp) :: arc, distance
    integer :: k

    value_at = huge(1.0_wp)
    do k = 1, size(self%loop)
      call self%loop(k)%closest(point, arc, distance)
      value_at = min(value_at, distance)
    end do
    if (is_inside(self%loop, point) .neqv. self%keeps_inside) value_at = -value_at
  end function value_at

  !> Return the function at a place of a quadrilateral, mm.
  pure real(wp) function value(self, quad, natural)
    class(cut_function_t), intent(in) :: self
    integer, intent(in) :: quad
    real(wp), intent(in) :: natural(2)

    value = self%value_at(matmul(self%plane(:, self%grid%corner(:, quad)), bilinear(natural)))
  end function value

  !> Return the natural coordinates of the zero on an edge whose ends lie on both sides. It is the
  !> same in both quadrilaterals at the edge.
  pure function zero_on_edge(self, quad, edge) result(natural)
    class(cut_function_t), intent(in) :: self
    integer, intent(in) :: quad
    !> From corner `edge` to the next one.
    integer, intent(in) :: edge
    real(wp) :: natural(2)

    real(wp) :: low, high, middle
    integer :: from, to, i
    logical :: positive

    from = edge
    to = mod(edge, 4) + 1
    if (self%grid%corner(from, quad) > self%grid%corner(to, quad)) then
      from = to
      to = edge
    end if
    low = 0.0_wp
    high = 1.0_wp
    positive = self%value(quad, corner_sign(:, from)) > 0.0_wp
    do i = 1, most_bisections
      middle = 0.5_wp*(low + high)
      natural = corner_sign(:, from) + middle*(corner_sign(:, to) - corner_sign(:, from))
      if ((self%value(quad, natural) > 0.0_wp) .eqv. positive) then
        low = middle
      else
        high = middle
      end if
    end do
  end function zero_on_edge

  !> Move a place to the zero near it by Newton's method; it stays where there is none.
  pure subroutine zero_near(self, quad, natural)
    class(cut_function_t), intent(in) :: self
    integer, intent(in) :: quad
    real(wp), intent(inout) :: natural(2)

    real(wp) :: place(2), gradient(2), here, first
    integer :: i

    place = natural
    first = self%value(quad, place)
    here = first
    do i = 1, most_iterations
      gradient = [self%value(quad, place + [half_step, 0.0_wp]) &
          - self%value(quad, place - [half_step, 0.0_wp]), &
          self%value(quad, place + [0.0_wp, half_step]) &
          - self%value(quad, place - [0.0_wp, half_step])]/(2.0_wp*half_step)
      if (.not. dot_product(gradient, gradient) > 0.0_wp) return
      place = place - here*gradient/dot_product(gradient, gradient)
      if (norm2(place - natural) > longest_way) return
      here = self%value(quad, place)
    end do
    if (abs(here) < 1.0e-3_wp*abs(first)) natural = place
  end subroutine zero_near

end module dd3_sheet_cut_function
