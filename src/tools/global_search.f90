! SPDX-License-Identifier: GPL-3.0-or-later
!> Closest point of a whole surface to a node. A tree of bounding boxes gives the patches that are
!> near enough; of equal points that of the first patch is kept.
module dd3_tools_global_search
  use dd3_base_kinds, only : wp
  use dd3_tools_box_tree, only : box_distance, box_walk_t, leaf_size, nearest_beyond, next_leaf, &
      start_walk
  use dd3_tools_hit, only : border_t, hit_t, new_hit
  use dd3_tools_oriented_box, only : oriented_distance
  use dd3_tools_project, only : project_globally
  use dd3_tools_projection, only : projection_t
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: query_t, apply_limits, search_radius, search_tree, search_all, edge_margin

  !> Distance, relative to the surface's size, by which a point on an edge must be nearer than
  !> another one to be preferred.
  real(wp), parameter :: edge_margin = 1.0e-12_wp

  !> Distances that differ by less, relative to the coordinates, may be equal but for round-off.
  real(wp), parameter :: tie_margin = 1.0e-11_wp
  !> Largest number of patches with equal distances in a search by the tree.
  integer, parameter :: most_ties = 32

  !> A query for the closest point.
  type :: query_t
    !> Position of the node in the surface's frame, mm.
    real(wp) :: x(3)
    !> Largest distances of a contact outside and inside the tool, mm.
    real(wp) :: search_distance, depth
    !> Contact beside the border.
    type(border_t) :: border
    !> Outward normal of the sheet; zero if unknown.
    real(wp) :: outward(3) = 0.0_wp
  end type query_t

  !> A patch with its distances from a node.
  type :: tie_t
    integer :: patch
    !> Distances of its box and its closest point, and the latter with the margin of edges, mm.
    real(wp) :: box, near, distance
  end type tie_t

  !> Patches at nearly the same distance from a node, ascending: `item(1:n)`.
  type :: ties_t
    integer :: n
    type(tie_t) :: item(most_ties)
  end type ties_t

  !> Closest point on a patch.
  type :: candidate_t
    !> Its distance, and the one that is compared, in which points inside a patch are preferred, mm.
    real(wp) :: near, distance
    !> False if the point is too far, or if the limits of the query exclude it. One that is outside
    !> by more than the search distance is accepted without being found: there is no contact, and a
    !> node outside the nearest part of the surface that faces the sheet is not inside another one,
    !> whose border it is nearest to.
    logical :: accepted
    !> Only set if accepted.
    type(hit_t) :: hit
  end type candidate_t

contains

  !> Return the distance within which patches are searched, mm. A node that has gone a quarter turn
  !> around the border is found.
  pure real(wp) function search_radius(query)
    type(query_t), intent(in) :: query

    search_radius = max(query%search_distance, query%depth, &
        sqrt(2.0_wp)*query%border%radius + query%border%reach)
  end function search_radius

  !> Whether the surface faces the sheet at a hit.
  pure logical function faces(hit, query)
    type(hit_t), intent(in) :: hit
    type(query_t), intent(in) :: query

    faces = dot_product(hit%normal, query%outward) <= 0.0_wp
  end function faces

  !> Discard a hit that is too far outside, too deep inside, or from which the sheet faces away.
  pure subroutine apply_limits(hit, query)
    type(hit_t), intent(inout) :: hit
    type(query_t), intent(in) :: query

    if (hit%border) hit%found = hit%found .and. hit%distance < query%border%reach
    hit%found = hit%found .and. hit%distance <= query%search_distance &
        .and. hit%distance > -query%depth .and. faces(hit, query)
  end subroutine apply_limits

  !> Search the patches whose boxes are near, nearest first. The result is that of `search_all`, bit
  !> for bit: patches at nearly the same distance are compared in its order.
  pure subroutine search_tree(surface, query, hit, best, clearance, ok)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hit_t), intent(out) :: hit
    !> Distance of the hit, or a huge value; lower bound of the distance of all patches, mm.
    real(wp), intent(out) :: best, clearance
    !> False if too many patches have the same distance.
    logical, intent(out) :: ok

    type(box_walk_t) :: walk
    type(ties_t) :: ties
    type(candidate_t) :: candidate
    type(tie_t) :: tie
    real(wp) :: radius, margin, near(leaf_size)
    integer :: i, first, last

    radius = search_radius(query)
    margin = tie_margin*(surface%size + maxval(abs(query%x)))
    best = huge(1.0_wp)
    clearance = huge(1.0_wp)
    ok = .true.
    ties%n = 0
    call start_walk(walk, surface%tree, query%x)
    do
      call next_leaf(walk, surface%tree, min(radius, best + margin), first, last)
      if (last < first) exit
      near = huge(1.0_wp)
      do i = first, last
        near(i - first + 1) = oriented_distance(surface%box(i), query%x)
      end do
      do
        i = minloc(near, dim=1)
        ! Also where the position of the node is not a number.
        if (.not. near(i) <= min(radius, best + margin) + margin) exit
        near(i) = huge(1.0_wp)
        call examine_place(surface, query, first + i - 1, min(radius, best + margin), candidate, &
            tie)
        clearance = min(clearance, candidate%near)
        if (.not. candidate%accepted) cycle
        call add_tie(ties, tie, min(best, candidate%distance) + margin, ok)
        if (.not. ok) return
        if (candidate%distance >= best) cycle
        best = candidate%distance
        hit = candidate%hit
      end do
      clearance = min(clearance, minval(near))
    end do
    if (best < huge(1.0_wp)) then
      call decide(surface, query, radius, ties, best, hit)
    else
      clearance = min(clearance, nearest_beyond(surface%tree, query%x, radius))
    end if
  end subroutine search_tree

  !> Project on the patch at a place of the tree, if its box is near enough.
  pure subroutine examine_place(surface, query, place, limit, candidate, tie)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    integer, intent(in) :: place
    !> Largest distance of interest, mm.
    real(wp), intent(in) :: limit
    type(candidate_t), intent(inout) :: candidate
    !> Only set if the candidate is accepted.
    type(tie_t), intent(inout) :: tie

    associate (k => surface%tree%number(place))
      tie%box = box_distance(surface%patch(k)%lower, surface%patch(k)%upper, query%x)
      candidate%accepted = tie%box <= limit
      candidate%near = tie%box
      if (.not. candidate%accepted) return
      call examine(surface, query, k, limit, candidate)
      tie = tie_t(k, tie%box, candidate%near, candidate%distance)
    end associate
  end subroutine examine_place

  !> Project on a patch.
  pure subroutine examine(surface, query, k, limit, candidate)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    !> Number of the patch.
    integer, intent(in) :: k
    !> Largest distance of interest, mm.
    real(wp), intent(in) :: limit
    type(candidate_t), intent(inout) :: candidate

    type(projection_t) :: projection

    call project_globally(surface%patch(k), query%x, [0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp], projection)
    candidate%near = projection%distance
    candidate%distance = projection%distance
    if (any(projection%active /= 0)) then
      candidate%distance = projection%distance + edge_margin*surface%size
    end if
    candidate%accepted = projection%distance <= limit
    if (.not. candidate%accepted) return
    associate (hit => candidate%hit)
      call new_hit(hit, surface, k, query%x, projection, query%border%radius)
      if (.not. hit%found) return
      candidate%accepted = hit%border .or. (faces(hit, query) .and. &
          hit%distance > query%search_distance)
      call apply_limits(hit, query)
      candidate%accepted = candidate%accepted .or. hit%found
    end associate
  end subroutine examine

  !> Add a patch, and drop those that are farther than a limit.
  pure subroutine add_tie(self, tie, limit, ok)
    type(ties_t), intent(inout) :: self
    type(tie_t), intent(in) :: tie
    !> mm.
    real(wp), intent(in) :: limit
    !> False if there is no room.
    logical, intent(out) :: ok

    integer :: i, n

    n = 0
    do i = 1, self%n
      if (self%item(i)%distance > limit) cycle
      n = n + 1
      self%item(n) = self%item(i)
    end do
    ok = n < most_ties
    if (.not. ok) return
    self%n = n + 1
    do i = n, 1, -1
      if (self%item(i)%patch < tie%patch) exit
      self%item(i + 1) = self%item(i)
    end do
    self%item(i + 1) = tie
  end subroutine add_tie

  !> Decide between patches at nearly the same distance as `search_all` does.
  pure subroutine decide(surface, query, radius, ties, best, hit)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    real(wp), intent(in) :: radius
    type(ties_t), intent(in) :: ties
    !> Distance of the hit, mm.
    real(wp), intent(inout) :: best
    type(hit_t), intent(inout) :: hit

    type(candidate_t) :: candidate
    integer :: i, chosen

    if (ties%n < 2) return
    best = huge(1.0_wp)
    chosen = 0
    do i = 1, ties%n
      associate (tie => ties%item(i))
        if (max(tie%box, tie%near) > min(radius, best)) cycle
        if (tie%distance >= best) cycle
        best = tie%distance
        chosen = tie%patch
      end associate
    end do
    if (chosen == hit%patch) return
    call examine(surface, query, chosen, huge(1.0_wp), candidate)
    hit = candidate%hit
  end subroutine decide

  !> Search all patches in their order.
  pure subroutine search_all(surface, query, hit, best, clearance)
    type(surface_t), intent(in) :: surface
    type(query_t), intent(in) :: query
    type(hit_t), intent(out) :: hit
    !> Distance of the hit, or a huge value; lower bound of the distance of all patches, mm.
    real(wp), intent(out) :: best, clearance

    type(candidate_t) :: candidate
    real(wp) :: radius, near
    integer :: k

    radius = search_radius(query)
    best = huge(1.0_wp)
    clearance = huge(1.0_wp)
    do k = 1, size(surface%patch)
      near = box_distance(surface%patch(k)%lower, surface%patch(k)%upper, query%x)
      if (near > min(radius, best)) then
        clearance = min(clearance, near)
        cycle
      end if
      call examine(surface, query, k, min(radius, best), candidate)
      clearance = min(clearance, candidate%near)
      if (.not. candidate%accepted .or. candidate%distance >= best) cycle
      hit = candidate%hit
      best = candidate%distance
    end do
  end subroutine search_all

end module dd3_tools_global_search
