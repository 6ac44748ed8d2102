! SPDX-License-Identifier: GPL-3.0-or-later
!> Tools that cross each other: points of one tool that a phase moved from the front of another
!> tool's surface to behind it. Points are samples of the patches, and only those not far behind are
!> found, so that slight overlaps may be missed.
module dd3_report_tool_crossing
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_tools_bezier, only : n_sample, position_at
  use dd3_tools_closest, only : find_contact, hint_t, hit_t
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: crossing_t, find_crossing

  !> Depth below which tools only touch each other, in thicknesses.
  real(wp), parameter :: notable_depth = 0.01_wp
  !> Distance behind a surface within which points are looked for, in thicknesses and in sizes of
  !> their patch, the larger of the two.
  real(wp), parameter :: depth_in_thicknesses = 2.0_wp, depth_in_patches = 0.5_wp
  !> Number of patches from which on every fourth line of samples is used.
  integer, parameter :: many_patches = 100

  !> Deepest point of one tool in another.
  type :: crossing_t
    !> mm; 0 if they have not crossed.
    real(wp) :: depth = 0.0_wp
    !> Its position, mm.
    real(wp) :: x(3) = 0.0_wp
  end type crossing_t

contains

  !> Find where two tools that have not turned have crossed in the running phase.
  pure function find_crossing(model, state, a, b) result(crossing)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Numbers of the tools.
    integer, intent(in) :: a, b
    type(crossing_t) :: crossing

    real(wp) :: moved(3), offset(3)

    if (any(abs(state%tools%angle([a, b])) > 0.0_wp)) return
    associate (now => state%tools%displacement, start => state%start%tool_displacement)
      offset = now(:, a) - now(:, b)
      moved = offset - (start(:, a) - start(:, b))
      if (norm2(moved) <= notable_depth*model%thickness) return
      call probe(crossing, model, a, b, offset, moved, now(:, b))
      call probe(crossing, model, b, a, -offset, -moved, now(:, a))
    end associate
  end function find_crossing

  !> Find points of a tool that have passed the surface of another one.
  pure subroutine probe(self, model, a, b, offset, moved, origin)
    type(crossing_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> Tool of the points, and the other one.
    integer, intent(in) :: a, b
    !> Displacement of the first relative to the second, and its part in the phase, mm.
    real(wp), intent(in) :: offset(3), moved(3)
    !> Displacement of the second, mm.
    real(wp), intent(in) :: origin(3)

    real(wp) :: x(3), depth, search_depth
    integer :: k, i, j, step

    associate (patch => model%tool(a)%surface%patch, surface => model%tool(b)%surface)
      step = merge(4, 1, size(patch) > many_patches)
      do k = 1, size(patch)
        search_depth = min(norm2(moved), max(depth_in_thicknesses*model%thickness, &
            depth_in_patches*patch(k)%size))
        if (any(patch(k)%lower + offset > surface%upper + search_depth .or. &
            patch(k)%upper + offset < surface%lower - search_depth)) cycle
        do j = 0, n_sample, step
          do i = 0, n_sample, step
            x = position_at(patch(k), real(i, wp)/n_sample, real(j, wp)/n_sample) + offset
            depth = depth_behind(surface, x, moved, search_depth)
            if (depth <= max(self%depth, notable_depth*model%thickness)) cycle
            self%depth = depth
            self%x = x + origin
          end do
        end do
      end do
    end associate
  end subroutine probe

  !> Return the depth of a point behind a surface if it was in front of it before it moved, mm; 0
  !> otherwise.
  pure real(wp) function depth_behind(surface, x, moved, search_depth) result(depth)
    type(surface_t), intent(in) :: surface
    !> Point and its displacement relative to the surface, mm.
    real(wp), intent(in) :: x(3), moved(3)
    !> Largest depth, mm.
    real(wp), intent(in) :: search_depth

    type(hint_t) :: hint
    type(hit_t) :: hit

    depth = 0.0_wp
    if (any(x > surface%upper + search_depth .or. x < surface%lower - search_depth)) return
    call find_contact(surface, x, hint, search_depth, search_depth, hit)
    if (.not. hit%found .or. hit%distance >= 0.0_wp) return
    depth = -hit%distance
    hint = hint_t()
    call find_contact(surface, x - moved, hint, search_depth + norm2(moved), search_depth, hit)
    if (.not. hit%found .or. hit%distance < 0.0_wp) depth = 0.0_wp
  end function depth_behind

end module dd3_report_tool_crossing
