! SPDX-License-Identifier: GPL-3.0-or-later
!> Closest point of a tool's surface to a node.
!>
!> The global search runs once per increment, and again for a node that has moved far: it projects
!> the node on every patch whose bounding box is near enough and keeps the nearest point; of equal
!> ones it prefers the patch of the last query. All other queries are local: they start from
!> the last closest point and cross edges to neighbouring patches. Patches are extended by a narrow
!> band beyond smooth edges, so that a node near such an edge does not change patch in every
!> iteration. A node deeper inside the tool than a given depth, and one where the sheet turns its
!> face away from the tool, has not come through this part of the surface and is not in contact.
!> With contact beside the border, kinks of the surface are rounded too.
!> Source: Wang and Makinouchi, inside-outside contact search, in: Nakamachi, Makinouchi
!> (eds.), Proc. NUMISHEET (1996); Oliveira, Alves and Menezes, Arch. Comput. Methods Eng. 15
!> (2008) 113-162.
module dd3_tools_closest
  use dd3_base_kinds, only : wp
  use dd3_tools_border_turn, only : limit_turn
  use dd3_tools_hit, only : border_t, hit_t, new_hit, projection_location, on_border
  use dd3_tools_global_search, only : apply_limits, edge_margin, query_t, search_all, &
      search_radius, search_tree
  use dd3_tools_kink, only : round_kink
  use dd3_tools_project, only : project
  use dd3_tools_projection, only : projection_t
  use dd3_tools_surface, only : surface_t, edge_number, edge_parameters
  implicit none
  private
  public :: border_t, hint_t, hit_t, find_contact

  !> Largest number of patches visited in a local search.
  integer, parameter :: most_patches = 4
  !> Largest difference of equal distances, relative to the surface's size.
  real(wp), parameter :: equal_distance = 1.0e-9_wp

  !> What is kept of a node's last query.
  type :: hint_t
    !> Patch of the closest point; 0 if none was found.
    integer :: patch = 0
    !> Parameters of the closest point.
    real(wp) :: u = 0.5_wp, v = 0.5_wp
    !> True if a global search is due.
    logical :: due = .true.
    !> Position of the node in the last global search, in the surface's frame, mm.
    real(wp) :: anchor(3) = 0.0_wp
    !> Lower bound of its distance from the surface there, used if nothing was found, mm.
    real(wp) :: clearance = 0.0_wp
  end type hint_t

contains

  !> Find the closest point of a surface to a node.
  pure subroutine find_contact(surface, x, hint, search_distance, depth, hit, outward, border)
    type(surface_t), intent(in) :: surface
    !> Position of the node in the surface's frame, mm.
    real(wp), intent(in) :: x(3)
    type(hint_t), intent(inout) :: hint
    !> Largest distance of a contact outside the tool, mm.
    real(wp), intent(in) :: search_distance
    !> Largest depth of a contact inside the tool, mm.
    real(wp), intent(in) :: depth
    type(hit_t), intent(out) :: hit
    !> Outward normal of the sheet at the node: the tool's must be opposite.
    real(wp), intent(in), optional :: outward(3)
    !> Contact beside the border; none by default.
    type(border_t), intent(in), optional :: border

    type(query_t) :: query

    query = query_t(x, search_distance, depth, border_t())
    if (present(border)) query%border = border
    if (present(outward)) query%outward = outward
    call search(surface, query, hint, hit)
    if (.not. hit%found) return
    if (.not. hit%border .and. query%border%reach > 0.0_wp) then
      call round_kink(hit, surface, x, query%border)
    end if
    hit%gap_gradient = hit%normal
    if (hit%border) call limit_turn(hit, surface%patch(hit%patch), x, query%border%turn)
  end subroutine find_contact

  !> Search from the last closest point, or the whole surface.
  pure subroutine search(surface, query, hint, hit)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hint_t), intent(inout) :: hint
    type(hit_t), intent(out) :: hit

    real(wp) :: moved

    if (.not. hint%due) then
      moved = sum((query%x - hint%anchor)**2)
      if (hint%patch == 0) then
        if (sqrt(moved) + search_radius(query) < hint%clearance) return
      else if (moved <= (0.5_wp*surface%patch(hint%patch)%shorter_side)**2) then
        call search_locally(surface, query, hint, hit)
        if (hit%found) return
      end if
    end if
    call search_globally(surface, query, hint, hit)
  end subroutine search

  !> Search from the last closest point.
  pure subroutine search_locally(surface, query, hint, hit)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hint_t), intent(inout) :: hint
    !> Not found if a global search is needed.
    type(hit_t), intent(inout) :: hit

    type(projection_t) :: projection
    integer :: k
    logical :: ok

    k = hint%patch
    projection%uv = [hint%u, hint%v]
    call project_across_edges(surface, query%x, k, projection, ok)
    if (.not. ok) return
    call new_hit(hit, surface, k, query%x, projection, query%border%radius)
    call apply_limits(hit, query)
    if (hit%found) call keep_point(hint, hit)
  end subroutine search_locally

  !> Keep the closest point for the next query.
  pure subroutine keep_point(hint, hit)
    type(hint_t), intent(inout) :: hint
    type(hit_t), intent(in) :: hit

    hint%patch = hit%patch
    hint%u = hit%u
    hint%v = hit%v
  end subroutine keep_point

  !> Project on a patch and, across its edges, on the neighbours.
  pure subroutine project_across_edges(surface, x, k, projection, ok)
    type(surface_t), intent(in) :: surface
    !> Position of the node, mm.
    real(wp), intent(in) :: x(3)
    !> Patch of the initial point on entry, of the closest point on return.
    integer, intent(inout) :: k
    !> `uv` is the initial point on entry.
    type(projection_t), intent(inout) :: projection
    !> False if the closest point is beside the surface or the search did not end.
    logical, intent(out) :: ok

    type(projection_t) :: other
    real(wp) :: lower(2), upper(2), t
    integer :: visited, a, e, next

    ok = .false.
    call parameter_bounds(surface, k, lower, upper)
    call project(surface%patch(k), x, lower, upper, projection)
    do visited = 1, most_patches
      ok = all(projection%active == 0)
      if (ok .or. all(projection%active /= 0)) return
      a = merge(1, 2, projection%active(1) /= 0)
      e = edge_number(a, projection%active(a) > 0)
      next = surface%edge(e, k)%patch
      if (next == 0) then
        ok = .not. surface%edge(e, k)%pole &
            .and. projection_location(surface, k, projection) /= on_border
        return
      end if
      t = projection%uv(3 - a)
      other%uv = edge_parameters(surface%edge(e, k)%edge, &
          merge(1.0_wp - t, t, surface%edge(e, k)%reversed))
      call parameter_bounds(surface, next, lower, upper)
      call project(surface%patch(next), x, lower, upper, other)
      if (any(other%active /= 0) &
          .and. other%distance >= projection%distance - edge_margin*surface%size) then
        ok = .true.
        return
      end if
      projection = other
      k = next
    end do
    ok = .false.
  end subroutine project_across_edges

  !> Return the bounds of a patch's parameters, with the bands beyond its smooth edges.
  pure subroutine parameter_bounds(surface, k, lower, upper)
    type(surface_t), intent(in) :: surface
    !> Number of the patch.
    integer, intent(in) :: k
    real(wp), intent(out) :: lower(2), upper(2)

    lower = -surface%edge([1, 3], k)%band
    upper = 1.0_wp + surface%edge([2, 4], k)%band
  end subroutine parameter_bounds

  !> Search the whole surface.
  pure subroutine search_globally(surface, query, hint, hit)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hint_t), intent(inout) :: hint
    type(hit_t), intent(out) :: hit

    real(wp) :: best, clearance
    logical :: ok

    call search_tree(surface, query, hit, best, clearance, ok)
    if (.not. ok) call search_all(surface, query, hit, best, clearance)
    if (hint%patch > 0) call prefer_last_patch(surface, query, hint, best, hit)
    hint%due = .false.
    hint%anchor = query%x
    hint%clearance = clearance
    hint%patch = 0
    if (hit%found) call keep_point(hint, hit)
  end subroutine search_globally

  !> Replace the hit by one on the patch of the last query if that is as near and inside the patch.
  pure subroutine prefer_last_patch(surface, query, hint, best, hit)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hint_t), intent(in) :: hint
    !> Distance of the hit, mm.
    real(wp), intent(in) :: best
    type(hit_t), intent(inout) :: hit

    type(projection_t) :: projection
    type(hit_t) :: candidate
    real(wp) :: lower(2), upper(2)

    if (hint%patch == hit%patch) return
    call parameter_bounds(surface, hint%patch, lower, upper)
    projection%uv = [hint%u, hint%v]
    call project(surface%patch(hint%patch), query%x, lower, upper, projection)
    if (any(projection%active /= 0)) return
    if (projection%distance > best + equal_distance*surface%size) return
    call new_hit(candidate, surface, hint%patch, query%x, projection, query%border%radius)
    call apply_limits(candidate, query)
    if (candidate%found) hit = candidate
  end subroutine prefer_last_patch

end module dd3_tools_closest
