!> Closest point of a tool's surface to a node.
!>
!> The whole surface is searched once per increment, and when a node has come far: patches whose
!> box lies near enough are sampled and solved one by one, the nearest first-hand solution wins,
!> and among equals the patch of the last query does. In between, a query starts from the last
!> closest point, and steps over to the neighbour where it leaves a patch. The patches go on in a
!> narrow band beyond smooth edges, so that a node near such an edge does not change patch with
!> every iteration. What lies deeper inside than a given depth is on the wrong side and no
!> contact.
!> Source: Wang and Makinouchi, inside-outside contact search, in: Nakamachi, Makinouchi
!> (eds.), Proc. NUMISHEET (1996); Oliveira, Alves and Menezes, Arch. Comput. Methods Eng. 15
!> (2008) 113-162.
module dd3_contact_closest
  use dd3_base_kinds, only : wp
  use dd3_contact_bezier, only : patch_t
  use dd3_contact_surface, only : surface_t, edge_of, edge_parameters
  use dd3_contact_project, only : foot_t, project, project_globally
  use dd3_contact_hit, only : hit_t, new_hit, place_of, place_border
  implicit none
  private
  public :: hint_t, hit_t, find_contact

  !> Patches passed in one local query.
  integer, parameter :: most_steps = 4
  !> Distances that differ by less than this share of the surface's size are equal.
  real(wp), parameter :: equal = 1.0e-9_wp
  !> A foot held at an edge must be nearer than another one by this share of the surface's size.
  real(wp), parameter :: held = 1.0e-12_wp

  !> What is remembered of a node's last query.
  type :: hint_t
    !> Patch of the last closest point; 0 for none.
    integer :: patch = 0
    !> Its parameters.
    real(wp) :: u = 0.5_wp, v = 0.5_wp
    !> Whether the whole surface is to be searched next time.
    logical :: due = .true.
    !> Where the node stood when the whole surface was searched last, in the surface's frame, mm.
    real(wp) :: anchor(3) = 0.0_wp
    !> Lower bound of its distance from the surface there, known where nothing was found, mm.
    real(wp) :: clearance = 0.0_wp
  end type hint_t

contains

  !> Finds the point of a surface that a node touches or is nearest to.
  pure subroutine find_contact(surface, x, hint, search_distance, depth, hit)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The node, in the surface's frame, mm.
    real(wp), intent(in) :: x(3)
    !> What is remembered of the node.
    type(hint_t), intent(inout) :: hint
    !> Nodes farther outside than this have no contact, mm.
    real(wp), intent(in) :: search_distance
    !> Nodes deeper inside than this are on the wrong side, mm.
    real(wp), intent(in) :: depth
    !> The closest point.
    type(hit_t), intent(out) :: hit

    type(foot_t) :: foot
    real(wp) :: moved
    integer :: k
    logical :: ok

    if (.not. hint%due) then
      moved = sum((x - hint%anchor)**2)
      if (hint%patch == 0) then
        if (sqrt(moved) + max(search_distance, depth) < hint%clearance) return
      else if (moved <= (0.5_wp*surface%patch(hint%patch)%reach)**2) then
        k = hint%patch
        foot%at = [hint%u, hint%v]
        call follow(surface, x, k, foot, ok)
        if (ok) call new_hit(hit, surface, k, x, foot)
        if (hit%found) call accept(hit, search_distance, depth)
        if (hit%found) then
          hint%patch = k
          hint%u = hit%u
          hint%v = hit%v
          return
        end if
      end if
    end if
    call search_surface(surface, x, hint, search_distance, depth, hit)
  end subroutine find_contact

  !> Drops a hit that is too far off or too deep.
  pure subroutine accept(hit, search_distance, depth)
    !> The hit.
    type(hit_t), intent(inout) :: hit
    !> Largest distance outside, mm.
    real(wp), intent(in) :: search_distance
    !> Largest depth inside, mm.
    real(wp), intent(in) :: depth

    hit%found = hit%found .and. hit%distance <= search_distance .and. hit%distance > -depth
  end subroutine accept

  !> Follows the closest point from a known patch over its edges.
  pure subroutine follow(surface, x, k, foot, ok)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> The patch.
    integer, intent(inout) :: k
    !> Where to start; the foot.
    type(foot_t), intent(inout) :: foot
    !> Whether it ended inside a patch or on an edge; else the whole surface must be searched.
    logical, intent(out) :: ok

    type(foot_t) :: other
    real(wp) :: lower(2), upper(2)
    integer :: step, a, e, next

    ok = .false.
    call bounds(surface, k, lower, upper)
    call project(surface%patch(k), x, lower, upper, foot)
    do step = 1, most_steps
      ok = all(foot%side == 0)
      if (ok .or. all(foot%side /= 0)) return
      a = merge(1, 2, foot%side(1) /= 0)
      e = edge_of(a, foot%side(a) > 0)
      next = surface%edge(e, k)%patch
      if (next == 0) then
        ok = .not. surface%edge(e, k)%pole .and. place_of(surface, k, foot) /= place_border
        return
      end if
      other%at = edge_parameters(surface%edge(e, k)%edge, &
                                 merge(1.0_wp - foot%at(3 - a), foot%at(3 - a), &
                                       surface%edge(e, k)%reversed))
      call bounds(surface, next, lower, upper)
      call project(surface%patch(next), x, lower, upper, other)
      if (any(other%side /= 0) .and. other%distance >= foot%distance - held*surface%size) then
        ok = .true.
        return
      end if
      foot = other
      k = next
    end do
    ok = .false.
  end subroutine follow

  !> Bounds of a patch's parameters, with the bands beyond its smooth edges.
  pure subroutine bounds(surface, k, lower, upper)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The patch.
    integer, intent(in) :: k
    !> The bounds.
    real(wp), intent(out) :: lower(2), upper(2)

    lower = -surface%edge([1, 3], k)%band
    upper = 1.0_wp + surface%edge([2, 4], k)%band
  end subroutine bounds

  !> Searches the whole surface.
  pure subroutine search_surface(surface, x, hint, search_distance, depth, hit)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> What is remembered of the node.
    type(hint_t), intent(inout) :: hint
    !> Largest distance outside, mm.
    real(wp), intent(in) :: search_distance
    !> Largest depth inside, mm.
    real(wp), intent(in) :: depth
    !> The closest point.
    type(hit_t), intent(out) :: hit

    type(foot_t) :: foot
    type(hit_t) :: candidate
    real(wp) :: reach, best, value, clearance, near
    integer :: k

    reach = max(search_distance, depth)
    best = huge(1.0_wp)
    clearance = huge(1.0_wp)
    do k = 1, size(surface%patch)
      near = box_distance(surface%patch(k), x)
      if (near <= min(reach, best)) then
        call project_globally(surface%patch(k), x, [0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp], foot)
        near = foot%distance
      end if
      clearance = min(clearance, near)
      if (near > min(reach, best)) cycle
      value = foot%distance
      if (any(foot%side /= 0)) value = value + held*surface%size
      if (value >= best) cycle
      call new_hit(candidate, surface, k, x, foot)
      if (candidate%found) then
        call accept(candidate, search_distance, depth)
        if (.not. candidate%found) cycle
      end if
      hit = candidate
      best = value
    end do
    if (hint%patch > 0) call prefer_last(surface, x, hint, search_distance, depth, best, hit)
    hint%due = .false.
    hint%anchor = x
    hint%clearance = clearance
    hint%patch = 0
    if (.not. hit%found) return
    hint%patch = hit%patch
    hint%u = hit%u
    hint%v = hit%v
  end subroutine search_surface

  !> Takes the patch of the last query where it is as near as the best one and the foot lies
  !> inside it.
  pure subroutine prefer_last(surface, x, hint, search_distance, depth, best, hit)
    !> The surface.
    type(surface_t), intent(in) :: surface
    !> The node, mm.
    real(wp), intent(in) :: x(3)
    !> What is remembered of the node.
    type(hint_t), intent(in) :: hint
    !> Largest distance outside, mm.
    real(wp), intent(in) :: search_distance
    !> Largest depth inside, mm.
    real(wp), intent(in) :: depth
    !> Distance of the best foot, mm.
    real(wp), intent(in) :: best
    !> The closest point.
    type(hit_t), intent(inout) :: hit

    type(foot_t) :: foot
    type(hit_t) :: candidate
    real(wp) :: lower(2), upper(2)

    if (hint%patch == hit%patch) return
    call bounds(surface, hint%patch, lower, upper)
    foot%at = [hint%u, hint%v]
    call project(surface%patch(hint%patch), x, lower, upper, foot)
    if (any(foot%side /= 0) .or. foot%distance > best + equal*surface%size) return
    call new_hit(candidate, surface, hint%patch, x, foot)
    call accept(candidate, search_distance, depth)
    if (candidate%found) hit = candidate
  end subroutine prefer_last

  !> Distance of a point from a patch's box, mm; the patch is no nearer.
  pure real(wp) function box_distance(patch, x)
    !> The patch.
    type(patch_t), intent(in) :: patch
    !> The point, mm.
    real(wp), intent(in) :: x(3)

    real(wp) :: outside(3)

    outside = max(patch%lower - x, x - patch%upper, 0.0_wp)
    box_distance = sqrt(dot_product(outside, outside))
  end function box_distance

end module dd3_contact_closest
