! SPDX-License-Identifier: GPL-3.0-or-later
!> Projection of a node on a patch without derivatives, used if Newton's method fails: the best
!> point of a fine grid, improved by golden sections in u and v in turn.
!> Source: Kiefer, Proc. Amer. Math. Soc. 4 (1953) 502-506.
module dd3_tools_golden_section
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : patch_t
  use dd3_tools_projection, only : projection_t, evaluate_projection
  implicit none
  private
  public :: project_by_sections, best_of_grid

  !> Intervals of the grid in u and v.
  integer, parameter :: n_grid = 32

contains

  !> Find the closest point without derivatives.
  pure subroutine project_by_sections(patch, x, lower, upper, projection)
    type(patch_t), intent(in) :: patch
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    type(projection_t), intent(inout) :: projection

    real(wp) :: relative(3)

    relative = x - patch%centre
    call best_of_grid(patch, relative, lower, upper, projection%uv)
    call evaluate_projection(patch, relative, projection)
    call golden_sections(patch, relative, lower, upper, projection)
  end subroutine project_by_sections

  !> Find the closest point of the grid.
  pure subroutine best_of_grid(patch, x, lower, upper, uv)
    type(patch_t), intent(in) :: patch
    !> Position of the node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Parameters of the closest point.
    real(wp), intent(out) :: uv(2)

    type(projection_t) :: trial
    real(wp) :: best
    integer :: i, j

    best = huge(1.0_wp)
    uv = lower
    do j = 0, n_grid
      do i = 0, n_grid
        trial%uv = lower + (upper - lower)*real([i, j], wp)/n_grid
        call evaluate_projection(patch, x, trial)
        if (trial%distance >= best) cycle
        best = trial%distance
        uv = trial%uv
      end do
    end do
  end subroutine best_of_grid

  !> Improve a projection by golden sections in u and v in turn.
  pure subroutine golden_sections(patch, x, lower, upper, projection)
    type(patch_t), intent(in) :: patch
    !> Position of the node relative to the patch's centre, mm.
    real(wp), intent(in) :: x(3)
    !> Bounds of the parameters.
    real(wp), intent(in) :: lower(2), upper(2)
    !> Initial point on entry.
    type(projection_t), intent(inout) :: projection

    integer, parameter :: most_sweeps = 50
    real(wp), parameter :: golden = 0.6180339887498949_wp
    type(projection_t) :: left, right
    real(wp) :: a, b, previous
    integer :: sweep, direction

    do sweep = 1, most_sweeps
      previous = projection%distance
      do direction = 1, 2
        a = max(lower(direction), projection%uv(direction) - 1.0_wp/n_grid)
        b = min(upper(direction), projection%uv(direction) + 1.0_wp/n_grid)
        left = projection
        right = projection
        do while (b - a > 1.0e-9_wp)
          left%uv(direction) = b - golden*(b - a)
          right%uv(direction) = a + golden*(b - a)
          call evaluate_projection(patch, x, left)
          call evaluate_projection(patch, x, right)
          if (left%distance < right%distance) then
            b = right%uv(direction)
          else
            a = left%uv(direction)
          end if
        end do
        if (left%distance < projection%distance) projection = left
        if (right%distance < projection%distance) projection = right
      end do
      if (projection%distance >= previous*(1.0_wp - 1.0e-14_wp)) exit
    end do
    projection%active = 0
    where (projection%uv - lower <= 1.0e-8_wp) projection%active = -1
    where (upper - projection%uv <= 1.0e-8_wp) projection%active = 1
  end subroutine golden_sections

end module dd3_tools_golden_section
