! SPDX-License-Identifier: GPL-3.0-or-later
!> Curves and sheet in one plane. With a direction of projection it is the plane normal to that; for
!> curves on the sheet it is that of the initial sheet, on which they are mapped through the
!> thickness, along the columns of nodes: closest points of the middle would change their order
!> where the sheet is bent. A point beyond a plane of symmetry at which the sheet ends is mapped by
!> its mirror image: the curve is that of the whole.
module dd3_sheet_projection
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : sqrt2, wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : trim_spec_t
  use dd3_linalg_tensor, only : cross, identity
  use dd3_sheet_curves, only : curve_t
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : bilinear, corner_sign
  use dd3_mesh_plane_curve, only : loop_t, new_loop
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: project_curves

  !> Distance between the points at which a curve on the sheet is mapped, and largest distance of
  !> the curve from the sheet, over the length of the elements.
  real(wp), parameter :: spacing = 0.25_wp, largest_distance = 1.0_wp
  !> Quadrilaterals examined for a point, iterations on each, largest natural coordinate.
  integer, parameter :: n_near = 9, most_iterations = 20
  real(wp), parameter :: farthest = 10.0_wp
  !> Distance of the border from a plane of symmetry, over the length of the elements.
  real(wp), parameter :: on_plane = 1.0e-3_wp

  !> A plane of symmetry x = const. or y = const. at which the sheet ends.
  type :: mirror_t
    !> Its normal: 1, 2.
    integer :: axis = 0
    !> Whether the sheet is on the side of the larger coordinate.
    logical :: above = .true.
    !> Its place now and on the initial sheet, mm.
    real(wp) :: now = 0.0_wp, initial = 0.0_wp
  end type mirror_t

contains

  !> Set the positions of the columns and the loops in the plane.
  subroutine project_curves(sheet, grid, spec, curve, plane, loop, errors)
    type(sheet_t), intent(in) :: sheet
    type(grid_t), intent(in) :: grid
    type(trim_spec_t), intent(in) :: spec
    type(curve_t), intent(in) :: curve(:)
    !> `(2, n_column)`, mm.
    real(wp), allocatable, intent(out) :: plane(:, :)
    type(loop_t), allocatable, intent(out) :: loop(:)
    !> Gets curves that lie off the sheet.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: base(3, 2), column(3, 2, grid%n_column)
    real(wp), allocatable :: mapped(:, :)
    integer :: k

    associate (bottom => sheet%x(:, grid%node(0, :)), &
        top => sheet%x(:, grid%node(grid%n_layer, :)))
      column(:, 1, :) = 0.5_wp*(bottom + top)
      column(:, 2, :) = 0.5_wp*(top - bottom)
    end associate
    allocate (loop(size(curve)))
    if (norm2(spec%along) > 0.0_wp) then
      base = base_across(spec%along)
      plane = matmul(transpose(base), column(:, 1, :))
      do k = 1, size(curve)
        call new_loop(loop(k), matmul(transpose(base), curve(k)%point))
      end do
      return
    end if
    plane = sheet%mesh%x(:2, grid%node(0, :))
    do k = 1, size(curve)
      call map_curve(grid, column, plane, curve(k), spec, mapped, errors)
      call new_loop(loop(k), mapped)
    end do
  end subroutine project_curves

  !> Return two unit vectors normal to a direction and to each other; for z these are x and y.
  pure function base_across(direction) result(base)
    real(wp), intent(in) :: direction(3)
    real(wp) :: base(3, 2)

    real(wp) :: axis(3)

    axis = direction/norm2(direction)
    base(:, 1) = identity(:, minloc(abs(axis), dim=1))
    base(:, 1) = base(:, 1) - dot_product(base(:, 1), axis)*axis
    base(:, 1) = base(:, 1)/norm2(base(:, 1))
    base(:, 2) = cross(axis, base(:, 1))
  end function base_across

  !> Return the planes of symmetry at which the sheet may end: a coordinate is extreme on a part of
  !> the border, which was straight along the other one.
  pure function mirrors_of(grid, middle, plane) result(mirror)
    type(grid_t), intent(in) :: grid
    !> Positions of the columns now, `(3, n_column)`, and on the initial sheet, `(2, n_column)`, mm.
    real(wp), intent(in) :: middle(:, :), plane(:, :)
    type(mirror_t), allocatable :: mirror(:)

    type(mirror_t) :: this
    real(wp) :: near
    integer :: i, q, side, n
    logical :: is_straight

    allocate (mirror(0))
    near = on_plane*mean_length(grid, plane)
    do side = 1, 4
      this%axis = (side + 1)/2
      this%above = mod(side, 2) == 1
      this%now = merge(minval(middle(this%axis, :)), maxval(middle(this%axis, :)), this%above)
      n = 0
      is_straight = .true.
      do q = 1, grid%n_quad
        do i = 1, 4
          if (grid%neighbour(i, q) /= 0) cycle
          associate (ends => grid%corner([i, mod(i, 4) + 1], q))
            if (any(abs(middle(this%axis, ends) - this%now) > near)) cycle
            if (n == 0) this%initial = plane(this%axis, ends(1))
            is_straight = is_straight .and. &
                all(abs(plane(this%axis, ends) - this%initial) <= near)
          end associate
          n = n + 1
        end do
      end do
      if (n > 0 .and. is_straight) mirror = [mirror, this]
    end do
  end function mirrors_of

  !> Map a curve on the initial sheet.
  subroutine map_curve(grid, column, plane, curve, spec, mapped, errors)
    type(grid_t), intent(in) :: grid
    !> Columns: the middle and the vector from there to the top, `(3, 2, n_column)`; their positions
    !> on the initial sheet, `(2, n_column)`; mm.
    real(wp), intent(in) :: column(:, :, :), plane(:, :)
    type(curve_t), intent(in) :: curve
    type(trim_spec_t), intent(in) :: spec
    !> `(2, n)`, mm.
    real(wp), allocatable, intent(out) :: mapped(:, :)
    type(error_list_t), intent(inout) :: errors

    type(mirror_t), allocatable :: mirror(:)
    real(wp) :: step, distance, largest, point(3)
    integer :: i, j, k, n, total

    mirror = mirrors_of(grid, column(:, 1, :), plane)
    step = mean_length(grid, plane)
    n = size(curve%point, 2)
    total = 0
    do i = 1, n
      total = total + parts(i)
    end do
    allocate (mapped(2, total))
    largest = 0.0_wp
    k = 0
    do i = 1, n
      do j = 1, parts(i)
        k = k + 1
        associate (from => curve%point(:, i), to => curve%point(:, mod(i, n) + 1))
          point = from + (real(j - 1, wp)/real(parts(i), wp))*(to - from)
        end associate
        call map_point(grid, column, plane, point, mapped(:, k), distance)
        call map_image(point, mapped(:, k), distance)
        largest = max(largest, distance)
      end do
    end do
    if (largest <= largest_distance*step) return
    call errors%push_input(curve%at, "the curve that begins here lies up to "// &
        to_text(largest, 3)//" mm off the sheet", "a curve on the sheet, or a direction of "// &
        "projection in cut '"//spec%name//"' (along)", code="E153")

  contains

    !> Map a point that lies beyond planes of symmetry by its mirror image, if that is near the
    !> sheet or not farther from it.
    pure subroutine map_image(point, mapped, distance)
      real(wp), intent(in) :: point(3)
      real(wp), intent(inout) :: mapped(2), distance

      real(wp) :: image(3), place(2), off
      logical :: beyond(size(mirror))
      integer :: i

      image = point
      do i = 1, size(mirror)
        associate (one => mirror(i))
          beyond(i) = (image(one%axis) < one%now) .eqv. one%above
          if (beyond(i)) image(one%axis) = 2.0_wp*one%now - image(one%axis)
        end associate
      end do
      if (.not. any(beyond)) return
      call map_point(grid, column, plane, image, place, off)
      if (off > max(distance, spacing*step)) return
      do i = 1, size(mirror)
        if (beyond(i)) place(mirror(i)%axis) = 2.0_wp*mirror(i)%initial - place(mirror(i)%axis)
      end do
      mapped = place
      distance = off
    end subroutine map_image

    !> Return the number of parts of a segment.
    pure integer function parts(i)
      integer, intent(in) :: i

      parts = max(1, ceiling(norm2(curve%point(:, mod(i, n) + 1) - curve%point(:, i)) &
          /(spacing*step)))
    end function parts

  end subroutine map_curve

  !> Return the mean length of the diagonals of the quadrilaterals over that of a square's sides,
  !> mm.
  pure real(wp) function mean_length(grid, plane)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: plane(:, :)

    integer :: q

    mean_length = sum([(norm2(plane(:, grid%corner(3, q)) - plane(:, grid%corner(1, q))), &
        q=1, grid%n_quad)])/(sqrt2*real(grid%n_quad, wp))
  end function mean_length

  !> Map a point to the initial sheet by its natural coordinates in the quadrilateral, among those
  !> near it, that it lies in or is next to; beyond the border of the sheet they are extended.
  pure subroutine map_point(grid, column, plane, point, mapped, distance)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: column(:, :, :), plane(:, :), point(3)
    real(wp), intent(out) :: mapped(2)
    !> Distance from the sheet, mm.
    real(wp), intent(out) :: distance

    real(wp) :: to_centre(grid%n_quad), natural(3), excess, least, off
    logical :: left(grid%n_quad)
    integer :: k, q

    do q = 1, grid%n_quad
      to_centre(q) = norm2(0.25_wp*sum(column(:, 1, grid%corner(:, q)), dim=2) - point)
    end do
    left = .true.
    least = huge(1.0_wp)
    mapped = 0.0_wp
    distance = huge(1.0_wp)
    do k = 1, min(n_near, grid%n_quad)
      q = minloc(to_centre, dim=1, mask=left)
      left(q) = .false.
      associate (corner => grid%corner(:, q))
        call find_natural(column(:, 1, corner), column(:, 2, corner), point, natural)
        off = max(0.0_wp, abs(natural(3)) - 1.0_wp)* &
            norm2(matmul(column(:, 2, corner), bilinear(natural(:2))))
        excess = max(0.0_wp, maxval(abs(natural(:2))) - 1.0_wp) &
            + off/max(tiny(1.0_wp), to_centre(q))
        if (excess >= least) cycle
        least = excess
        mapped = matmul(plane(:, corner), bilinear(natural(:2)))
        distance = off
      end associate
    end do
  end subroutine map_point

  !> Find the natural coordinates of a point in a quadrilateral with a thickness, which are extended
  !> beyond its sides, by Newton's method; the third one is -1 at the bottom and 1 at the top.
  pure subroutine find_natural(middle, half, point, natural)
    real(wp), intent(in) :: middle(3, 4), half(3, 4), point(3)
    real(wp), intent(out) :: natural(3)

    real(wp) :: place(3, 4), residual(3), a(3), b(3), c(3), volume, step(3)
    integer :: i

    natural = 0.0_wp
    do i = 1, most_iterations
      place = middle + natural(3)*half
      residual = point - matmul(place, bilinear(natural(:2)))
      a = matmul(place, 0.25_wp*corner_sign(1, :)*(1.0_wp + corner_sign(2, :)*natural(2)))
      b = matmul(place, 0.25_wp*corner_sign(2, :)*(1.0_wp + corner_sign(1, :)*natural(1)))
      c = matmul(half, bilinear(natural(:2)))
      volume = dot_product(a, cross(b, c))
      if (.not. abs(volume) > 0.0_wp) exit
      step = [dot_product(residual, cross(b, c)), dot_product(residual, cross(c, a)), &
          dot_product(residual, cross(a, b))]/volume
      natural = max(-farthest, min(farthest, natural + step))
      if (maxval(abs(step)) < 1.0e-10_wp) exit
    end do
  end subroutine find_natural

end module dd3_sheet_projection
