! SPDX-License-Identifier: GPL-3.0-or-later
!> Points at which draw-beads act on the sheet: integration points of the parts of their lines that
!> lie on its faces, seen along z. A bead acts with half its force on the lower faces and with half
!> on the upper ones, so that it does not bend the sheet. Faces with 9 nodes count as four
!> quadrilaterals.
module dd3_model_terms_bead_points
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_normal
  use dd3_model_terms_drawbead, only : drawbead_t
  implicit none
  private
  public :: bead_point_t, find_bead_points, covered_length

  !> Least component along z of the normal of a face on which a bead acts.
  real(wp), parameter :: steepest = 0.2_wp
  !> Shortest part of an interval that counts.
  real(wp), parameter :: shortest = 1.0e-12_wp
  !> Abscissae of the two Gauss points on 0 to 1.
  real(wp), parameter :: abscissa(2) = 0.5_wp + [-0.5_wp, 0.5_wp]/sqrt(3.0_wp)
  !> Natural coordinates of the corners of a quadrilateral.
  real(wp), parameter :: corner(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, &
      1.0_wp, -1.0_wp, 1.0_wp], [2, 4])
  !> Iterations to natural coordinates; they converge quadratically.
  integer, parameter :: iterations = 8

  !> Integration point of a bead on a face.
  type :: bead_point_t
    !> Bead, and interval counted over all beads.
    integer :: bead = 0, interval = 0
    !> Nodes of the quadrilateral and their shape functions.
    integer :: node(4) = 0
    real(wp) :: shape(4) = 0.0_wp
    !> Length of the bead, half of that seen along z, mm.
    real(wp) :: weight = 0.0_wp
    !> Unit vector across the bead along the face, and the one whose product with a displacement
    !> along the face is the slip in that direction.
    real(wp) :: direction(3) = 0.0_wp, across(3) = 0.0_wp
    !> Derivative of the restraining force in the slip, N/mm2.
    real(wp) :: stiffness = 0.0_wp
  end type bead_point_t

contains

  !> Find the points of all active beads. A bead with a tool moves with it.
  subroutine find_bead_points(model, active, x, point, displacement)
    type(model_t), intent(in) :: model
    !> `(n_bead)`.
    logical, intent(in) :: active(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    type(bead_point_t), allocatable, intent(out) :: point(:)
    !> Displacements of the tools, `(3, n_tool)`, mm; by default they are at their positions of the
    !> input.
    real(wp), intent(in), optional :: displacement(:, :)

    type(drawbead_t) :: bead
    integer :: b, q

    allocate (point(0))
    do b = 1, size(model%drawbead)
      if (.not. active(b)) cycle
      bead = model%drawbead(b)
      if (bead%tool > 0 .and. present(displacement)) then
        call bead%move(displacement(:2, bead%tool) - model%tool(bead%tool)%position(:2))
      end if
      do q = 1, size(model%bead_face, 2)
        associate (node => model%bead_face(:, q))
          call add_face(bead, b, node, x(:, node), point)
        end associate
      end do
    end do
  end subroutine find_bead_points

  !> Return the length of a bead on the sheet, mm.
  pure real(wp) function covered_length(point, bead)
    type(bead_point_t), intent(in) :: point(:)
    integer, intent(in) :: bead

    covered_length = sum(point%weight, mask=point%bead == bead)
  end function covered_length

  !> Add the points of a bead on a quadrilateral.
  subroutine add_face(bead, number, node, x, point)
    type(drawbead_t), intent(in) :: bead
    integer, intent(in) :: number, node(4)
    !> mm.
    real(wp), intent(in) :: x(3, 4)
    type(bead_point_t), allocatable, intent(inout) :: point(:)

    type(bead_point_t) :: new
    real(wp) :: normal(3), lower(2), upper(2), part(2)
    integer :: i, g

    lower = minval(x(:2, :), dim=2)
    upper = maxval(x(:2, :), dim=2)
    if (any(lower > bead%upper .or. upper < bead%lower)) return
    normal = face_normal(x)
    if (abs(normal(3)) < steepest) return
    new%bead = number
    new%node = node
    do i = 1, size(bead%line, 3)
      associate (line => bead%line(:, :, i))
        if (any(maxval(line, dim=2) < lower .or. minval(line, dim=2) > upper)) cycle
        call clip(line, node, x, normal(3) > 0.0_wp, part)
        if (part(2) - part(1) <= shortest) cycle
        new%interval = bead%offset + i
        call set_direction(new, line, normal)
        new%weight = 0.25_wp*(part(2) - part(1))*norm2(line(:, 2) - line(:, 1))
        do g = 1, 2
          new%shape = shape_at(x(:2, :), line(:, 1) + (part(1) + abscissa(g)*(part(2) - part(1))) &
              *(line(:, 2) - line(:, 1)))
          point = [point, new]
        end do
      end associate
    end do
  end subroutine add_face

  !> Find the part of a line inside a quadrilateral, seen along z. A line on an edge belongs to one
  !> of the two faces that share the edge; both compute their sides of it with the same round-off.
  pure subroutine clip(line, node, x, anticlockwise, part)
    real(wp), intent(in) :: line(2, 2)
    !> Corners, and whether they turn anticlockwise.
    integer, intent(in) :: node(4)
    real(wp), intent(in) :: x(3, 4)
    logical, intent(in) :: anticlockwise
    !> Parameters of its ends, 0 to 1; equal if no part is inside.
    real(wp), intent(out) :: part(2)

    real(wp) :: side(2)
    integer :: a, b, e, next

    part = [0.0_wp, 1.0_wp]
    do e = 1, 4
      next = mod(e, 4) + 1
      a = merge(e, next, node(e) <= node(next))
      b = e + next - a
      side = [side_of(x(:2, a), x(:2, b), line(:, 1)), side_of(x(:2, a), x(:2, b), line(:, 2))]
      if (a == e .neqv. anticlockwise) side = -side
      if (all(abs(side) <= 0.0_wp)) then
        if (a == e .eqv. anticlockwise) cycle
        part = 0.0_wp
      else if (all(side <= 0.0_wp)) then
        part = 0.0_wp
      else if (side(1) < 0.0_wp) then
        part(1) = max(part(1), side(1)/(side(1) - side(2)))
      else if (side(2) < 0.0_wp) then
        part(2) = min(part(2), side(1)/(side(1) - side(2)))
      end if
      if (part(2) <= part(1)) exit
    end do
    part(2) = max(part(1), part(2))
  end subroutine clip

  !> Return twice the area of a triangle, positive for a point to the left of the line from a to b.
  pure real(wp) function side_of(a, b, point)
    real(wp), intent(in) :: a(2), b(2), point(2)

    side_of = (b(1) - a(1))*(point(2) - a(2)) - (b(2) - a(2))*(point(1) - a(1))
  end function side_of

  !> Set the direction across a bead along a face. A slip s along it is s times the cosine of its
  !> inclination in plan.
  pure subroutine set_direction(point, line, normal)
    type(bead_point_t), intent(inout) :: point
    real(wp), intent(in) :: line(2, 2)
    !> Unit normal of the face.
    real(wp), intent(in) :: normal(3)

    real(wp) :: in_plan(3), along(3)

    along = [line(:, 2) - line(:, 1), 0.0_wp]
    in_plan = cross(along, [0.0_wp, 0.0_wp, 1.0_wp])/norm2(along)
    point%direction = in_plan - dot_product(in_plan, normal)*normal
    point%direction = point%direction/norm2(point%direction)
    point%across = in_plan/dot_product(in_plan, point%direction)
  end subroutine set_direction

  !> Return the bilinear shape functions of a quadrilateral at a point in plan.
  pure function shape_at(x, point) result(shape)
    !> Corners in plan, and point, mm.
    real(wp), intent(in) :: x(2, 4), point(2)
    real(wp) :: shape(4)

    real(wp) :: xi(2), off(2), along(2, 2), determinant
    integer :: i

    xi = 0.0_wp
    do i = 1, iterations
      shape = 0.25_wp*(1.0_wp + corner(1, :)*xi(1))*(1.0_wp + corner(2, :)*xi(2))
      off = point - matmul(x, shape)
      along(:, 1) = matmul(x, 0.25_wp*corner(1, :)*(1.0_wp + corner(2, :)*xi(2)))
      along(:, 2) = matmul(x, 0.25_wp*corner(2, :)*(1.0_wp + corner(1, :)*xi(1)))
      determinant = along(1, 1)*along(2, 2) - along(1, 2)*along(2, 1)
      if (.not. abs(determinant) > 0.0_wp) exit
      xi(1) = xi(1) + (off(1)*along(2, 2) - off(2)*along(1, 2))/determinant
      xi(2) = xi(2) + (off(2)*along(1, 1) - off(1)*along(2, 1))/determinant
      xi = min(1.0_wp, max(-1.0_wp, xi))
    end do
    shape = 0.25_wp*(1.0_wp + corner(1, :)*xi(1))*(1.0_wp + corner(2, :)*xi(2))
  end function shape_at

end module dd3_model_terms_bead_points
