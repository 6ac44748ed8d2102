! SPDX-License-Identifier: GPL-3.0-or-later
!> Depth by which tools enter the faces of the sheet between its contact points, at which alone the
!> contact holds: a tool can pass a face where it is more strongly curved than they resolve, or
!> narrower than their distance. The faces are quadrilaterals between these points, which lie on
!> curved faces (surface_point.f90).
!> Measured both ways: points of the faces inside the tool, and points of the tool behind the faces.
module dd3_report_tool_depth
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : broadcast_reals, rank_of_smallest, this_rank
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_linalg_tensor, only : cross
  use dd3_model_contact_layer, only : deflection_at
  use dd3_model_contact_points, only : points_of_face
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_normal, part_of_nine
  use dd3_model_state, only : state_t
  use dd3_model_tolerances, only : wrong_side_depth
  use dd3_tools_bezier, only : n_sample, normal_at, patch_t, position_at
  use dd3_tools_box_tree, only : overlapping
  use dd3_tools_closest, only : find_contact, hint_t, hit_t
  use dd3_tools_curvature, only : smallest_radius
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: tool_depth_t, measure_tool_depth, observe_tools

  !> Fractions of the corners at the points of a face: centre and middles of the edges.
  real(wp), parameter :: h = 0.5_wp, q = 0.25_wp, o = 0.0_wp
  real(wp), parameter :: sample_shape(4, 5) = &
      reshape([q, q, q, q, h, h, o, o, o, h, h, o, o, o, h, h, h, o, o, h], [4, 5])
  !> Depth below which a tool does not enter a face, in thicknesses.
  real(wp), parameter :: slight_depth = 1.0e-3_wp
  !> Margin around a face in which closest points of its points are looked for, in diagonals.
  real(wp), parameter :: margin = 0.25_wp
  !> Distance beside a face that is round-off, in diagonals: a point on the edge of the sheet lies
  !> behind it.
  real(wp), parameter :: beside = 1.0e-6_wp
  !> Least -m.n of the normals of sheet and tool that face each other.
  real(wp), parameter :: facing = 0.05_wp

  !> Largest depth of a tool.
  type :: tool_depth_t
    !> mm; 0 if the tool enters no face.
    real(wp) :: depth = 0.0_wp
    !> Face of the sheet, as in `sheet_faces_t`; 0 for none.
    integer :: face = 0
    !> Deepest point, in the frame of the tool, mm.
    real(wp) :: x(3) = 0.0_wp
  end type tool_depth_t

  !$omp declare reduction(deeper: tool_depth_t: omp_out = deeper(omp_out, omp_in)) &
  !$omp& initializer(omp_priv = omp_orig)
  !> Faces that a thread takes at a time.
  integer, parameter :: chunk = 32

  !> Part of a face of the sheet between four contact points, in the frame of a tool.
  type :: face_t
    integer :: number = 0
    !> Corners, mm, and outward unit normal.
    real(wp) :: x(3, 4) = 0.0_wp, normal(3) = 0.0_wp
    !> Longest diagonal, and thickness of the sheet, mm.
    real(wp) :: size = 0.0_wp, thickness = 0.0_wp
    !> Largest depth that is looked for, mm.
    real(wp) :: search_depth = 0.0_wp
    !> Deflection of the tool at its corners, mm; no part of a depth.
    real(wp) :: deflection = 0.0_wp
    !> Bounding box of the face and the space behind it within the search depth, mm.
    real(wp) :: lower(3) = 0.0_wp, upper(3) = 0.0_wp
    !> Largest component of a corner along the normal, mm.
    real(wp) :: height = 0.0_wp
  end type face_t

contains

  !> Record contact and depth of the active tools in the state.
  subroutine observe_tools(model, state)
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(inout) :: state

    type(tool_depth_t) :: found
    integer :: tool

    state%observed%depth = 0.0_wp
    do tool = 1, model%n_tool
      if (.not. model%phase(state%phase)%active(tool)) cycle
      if (.not. state%tools%touched(tool)) state%tools%touched(tool) = state%tools%touches(tool)
      found = measure_tool_depth(model, state, tool)
      state%observed%depth(tool) = found%depth
      if (found%depth <= state%observed%largest_depth(tool)) cycle
      state%observed%largest_depth(tool) = found%depth
      state%observed%deepest_face(tool) = found%face
      associate (x => state%x(:, model%face%corner(:, found%face)))
        state%observed%deepest_radius(tool) = smallest_radius(model%tool(tool)%surface, found%x, &
            norm2(x(:, 3) - x(:, 1)))
      end associate
    end do
  end subroutine observe_tools

  !> Measure the depth of a tool in the faces whose nodes are its candidates, each rank in those of
  !> its elements: in the quadrilaterals between the contact points.
  function measure_tool_depth(model, state, tool) result(self)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    type(tool_depth_t) :: self

    integer :: f, k, rank

    rank = this_rank()
    self%depth = slight_depth*model%thickness
    !$omp parallel do num_threads(threads_for(size(model%contact_face), least_nodes)) &
    !$omp& schedule(dynamic, chunk) private(f) reduction(deeper: self)
    do k = 1, size(model%contact_face)
      f = model%contact_face(k)
      if (model%part%owner(model%face%element(f)) /= rank) cycle
      if (.not. all(model%member(tool, model%face%node(:, f)))) cycle
      if (size(model%face%node, 1) > 4) then
        call probe_quadratic_face(self, model, state, tool, k)
      else
        call probe_divided_face(self, model, state, tool, k)
      end if
    end do
    !$omp end parallel do
    if (self%face == 0) self%depth = 0.0_wp
    if (model%part%divided) call share_deepest(self)
  end function measure_tool_depth

  !> Return the larger of two depths; of equal ones that of the face with the lower number.
  pure type(tool_depth_t) function deeper(a, b)
    type(tool_depth_t), intent(in) :: a, b

    deeper = a
    if (b%depth > a%depth .or. (b%depth >= a%depth .and. b%face > 0 .and. &
        (b%face < a%face .or. a%face == 0))) deeper = b
  end function deeper

  !> Give all ranks the largest depth; of equal ones that of the face with the lowest number.
  subroutine share_deepest(self)
    type(tool_depth_t), intent(inout) :: self

    real(wp) :: values(5)

    values = [self%depth, real(self%face, wp), self%x]
    call broadcast_reals(rank_of_smallest(-self%depth, self%face), size(values), values)
    self = tool_depth_t(values(1), nint(values(2)), values(3:))
  end subroutine share_deepest

  !> Measure the depth of a tool in a face with 9 nodes, or between the corners of one with 8.
  pure subroutine probe_quadratic_face(self, model, state, tool, k)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Tool, and number among the contact faces.
    integer, intent(in) :: tool, k

    integer :: i

    associate (node => model%face%node(:, model%contact_face(k)))
      if (size(node) < 9) then
        call probe_part(self, model, state, tool, k, state%x(:, node(:4)), model%face_point(:4, k))
        return
      end if
      do i = 1, 4
        associate (part => part_of_nine(:, i))
          call probe_part(self, model, state, tool, k, state%x(:, node(part)), &
              model%face_point(part, k))
        end associate
      end do
    end associate
  end subroutine probe_quadratic_face

  !> Measure the depth of a tool in a face with 4 nodes, which is curved between them where contact
  !> points are.
  pure subroutine probe_divided_face(self, model, state, tool, k)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Tool, and number among the contact faces.
    integer, intent(in) :: tool, k

    real(wp) :: x(3, size(model%face_point, 1))
    integer :: part(4), n, i, j

    n = nint(sqrt(real(size(model%face_point, 1), wp)))
    if (is_far(model, state, tool, model%face%corner(:, model%contact_face(k)))) return
    x = points_of_face(model, state%x, k)
    do j = 1, n - 1
      do i = 1, n - 1
        part = i + n*(j - 1) + [0, 1, n + 1, n]
        call probe_part(self, model, state, tool, k, x(:, part), model%face_point(part, k))
      end do
    end do
  end subroutine probe_divided_face

  !> Whether the tool is farther from a face than twice its diagonal.
  pure logical function is_far(model, state, tool, corner)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool, corner(4)

    type(placement_t) :: placement
    real(wp) :: x(3, 4), reach
    integer :: i

    placement = state%placement(tool)
    do i = 1, 4
      x(:, i) = placement%to_tool(state%x(:, corner(i)))
    end do
    associate (surface => model%tool(tool)%surface, diagonal => norm2(x(:, 3) - x(:, 1)))
      reach = max(wrong_side_depth*model%thickness_at(corner(1)), 2.0_wp*diagonal)
      is_far = any(minval(x, dim=2) - reach > surface%upper .or. &
          maxval(x, dim=2) + reach < surface%lower)
    end associate
  end function is_far

  !> Measure the depth of a tool in a part of a face.
  pure subroutine probe_part(self, model, state, tool, k, x, point)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    !> Tool, and number among the contact faces.
    integer, intent(in) :: tool, k
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    !> Contact points at them; 0 for those of another rank.
    integer, intent(in) :: point(4)

    type(face_t) :: face
    type(hint_t) :: hint(4)
    type(hit_t) :: hit
    integer :: i
    logical :: near

    call set_face(face, model, state%placement(tool), model%contact_face(k), x)
    do i = 1, 4
      if (point(i) == 0) cycle
      if (state%contact%tool(point(i)) == tool) face%deflection = &
          max(face%deflection, deflection_at(model, state, point(i)))
    end do
    call probe_patches(self, model, face, tool, near)
    if (.not. near) return
    do i = 1, 4
      if (point(i) > 0) then
        hint(i) = state%contact%hint(tool, point(i))
      else
        call find_contact(model%tool(tool)%surface, face%x(:, i), hint(i), face%size, face%size, &
            hit)
      end if
    end do
    call probe_tool(self, model, face, hint, tool)
  end subroutine probe_part

  !> Set a part of a face in the frame of a tool.
  pure subroutine set_face(self, model, placement, f, x)
    type(face_t), intent(out) :: self
    type(model_t), intent(in) :: model
    type(placement_t), intent(in) :: placement
    integer, intent(in) :: f
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)

    integer :: i

    self%number = f
    do i = 1, 4
      self%x(:, i) = placement%to_tool(x(:, i))
    end do
    self%normal = face_normal(self%x)
    self%size = max(norm2(self%x(:, 3) - self%x(:, 1)), norm2(self%x(:, 4) - self%x(:, 2)))
    self%thickness = model%thickness_at(model%face%corner(1, f))
    self%search_depth = max(wrong_side_depth*self%thickness, self%size)
    self%lower = minval(self%x, dim=2) - self%search_depth*max(self%normal, 0.0_wp) &
        - beside*self%size
    self%upper = maxval(self%x, dim=2) - self%search_depth*min(self%normal, 0.0_wp) &
        + beside*self%size
    self%height = maxval(matmul(self%normal, self%x))
  end subroutine set_face

  !> Keep a larger depth behind the deflected surface.
  pure subroutine keep_larger(self, depth, x, face)
    type(tool_depth_t), intent(inout) :: self
    !> Depth and place, mm.
    real(wp), intent(in) :: depth, x(3)
    type(face_t), intent(in) :: face

    if (depth - face%deflection <= self%depth) return
    self%depth = depth - face%deflection
    self%face = face%number
    self%x = x
  end subroutine keep_larger

  !> Measure the depth of points of the tool behind a face.
  pure subroutine probe_patches(self, model, face, tool, near)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(face_t), intent(in) :: face
    integer, intent(in) :: tool
    !> Whether a patch may lie behind the face, or behind a margin around it.
    logical, intent(out) :: near

    real(wp) :: edge
    integer, allocatable :: patch(:)
    integer :: k

    edge = margin*face%size
    near = .false.
    associate (surface => model%tool(tool)%surface)
      if (any(face%lower - edge > surface%upper .or. face%upper + edge < surface%lower)) return
      patch = overlapping(surface%tree, face%lower - edge, face%upper + edge)
      do k = 1, size(patch)
        if (largest_depth(surface%patch(patch(k)), face) <= self%depth) cycle
        near = .true.
        call probe_patch(self, model, face, tool, patch(k))
      end do
    end associate
  end subroutine probe_patches

  !> Measure the depth of points of a face in the tool. All points are in front of the tool if its
  !> centre is far enough.
  pure subroutine probe_tool(self, model, face, hint, tool)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(face_t), intent(in) :: face
    !> Last closest points of the corners.
    type(hint_t), intent(in) :: hint(4)
    integer, intent(in) :: tool

    type(hint_t) :: start
    type(hit_t) :: hit
    real(wp) :: x(3)
    integer :: i

    start = hint(maxloc(hint%patch, dim=1))
    if (start%patch > 0 .and. all(hint%patch == start%patch)) then
      ! The closest points of all corners lie on one patch: if it is plane, no other is deeper.
      if (model%tool(tool)%surface%patch(start%patch)%flat) return
    end if
    do i = 1, size(sample_shape, 2)
      x = matmul(face%x, sample_shape(:, i))
      start%due = start%patch == 0
      start%anchor = x
      call find_contact(model%tool(tool)%surface, x, start, face%size, face%size, hit)
      if (.not. hit%found) cycle
      if (hit%distance > 0.5_wp*face%size) return
      if (dot_product(hit%normal, face%normal) > -facing) cycle
      call keep_larger(self, -hit%distance, x, face)
    end do
  end subroutine probe_tool

  !> Return an upper bound of the depth of a patch behind a face, from its bounding box, mm.
  pure real(wp) function largest_depth(patch, face)
    type(patch_t), intent(in) :: patch
    type(face_t), intent(in) :: face

    largest_depth = face%height - dot_product(face%normal, patch%centre) &
        + 0.5_wp*dot_product(abs(face%normal), patch%upper - patch%lower)
  end function largest_depth

  !> Measure the depth of points of a patch behind a face; those of a plane lie on its edges, as no
  !> inner point is deeper than all of them.
  pure subroutine probe_patch(self, model, face, tool, k)
    type(tool_depth_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    type(face_t), intent(in) :: face
    integer, intent(in) :: tool, k

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: point(3), normal(3), depth
    integer :: i, j
    logical :: regular

    associate (patch => model%tool(tool)%surface%patch(k))
      do j = 0, n_sample
        do i = 0, n_sample
          if (patch%flat .and. mod(i, n_sample) > 0 .and. mod(j, n_sample) > 0) cycle
          point = grid_point(patch, i, j)
          if (face%height - dot_product(face%normal, point) <= self%depth) cycle
          if (any(point < face%lower .or. point > face%upper)) cycle
          call locate(face, point, depth)
          if (depth <= self%depth .or. depth > face%search_depth) cycle
          call normal_at(patch, real(i, wp)/n_sample, real(j, wp)/n_sample, normal, regular)
          if (.not. regular .or. dot_product(normal, face%normal) >= -facing) cycle
          if (depth > face%thickness) then
            ! A part of the tool deeper than the thickness may be one behind the sheet.
            hint = hint_t()
            call find_contact(model%tool(tool)%surface, point + depth*face%normal, hint, &
                face%search_depth, face%search_depth, hit)
            if (.not. hit%found .or. hit%distance >= 0.0_wp) cycle
          end if
          call keep_larger(self, depth, point, face)
        end do
      end do
    end associate
  end subroutine probe_patch

  !> Return a point of the grid of a patch, mm: the stored one, if there is one.
  pure function grid_point(patch, i, j) result(point)
    type(patch_t), intent(in) :: patch
    integer, intent(in) :: i, j
    real(wp) :: point(3)

    if (patch%flat) then
      point = patch%control(:, 0, 0) &
          + real(i, wp)/n_sample*(patch%control(:, 1, 0) - patch%control(:, 0, 0)) &
          + real(j, wp)/n_sample*(patch%control(:, 0, 1) - patch%control(:, 0, 0))
    else if (patch%n_interval == n_sample) then
      point = patch%centre + patch%sample(:, i, j)
    else
      point = position_at(patch, real(i, wp)/n_sample, real(j, wp)/n_sample)
    end if
  end function grid_point

  !> Find the depth of a point behind a face along its normal: behind one of the four triangles
  !> between the centre and the edges.
  pure subroutine locate(face, point, depth)
    type(face_t), intent(in) :: face
    real(wp), intent(in) :: point(3)
    !> mm; negative in front of the face, and if the point lies beside it.
    real(wp), intent(out) :: depth

    real(wp) :: centre(3), a(3), b(3), r(3), area, along(2)
    integer :: i

    depth = -1.0_wp
    centre = 0.25_wp*sum(face%x, dim=2)
    r = point - centre
    do i = 1, 4
      a = face%x(:, i) - centre
      b = face%x(:, mod(i, 4) + 1) - centre
      area = dot_product(face%normal, cross(a, b))
      if (area <= 0.0_wp) cycle
      along(1) = dot_product(face%normal, cross(r, b))/area
      along(2) = dot_product(face%normal, cross(a, r))/area
      if (any(along < -beside) .or. sum(along) > 1.0_wp + beside) cycle
      depth = dot_product(face%normal, along(1)*a + along(2)*b - r)
      return
    end do
  end subroutine locate

end module dd3_report_tool_depth
