! SPDX-License-Identifier: GPL-3.0-or-later
!> Transfer of the state to the integration points of elements that a cut has moved or made, or into
!> which larger ones were divided: through the thickness each point takes the values of the points
!> of its own level, so that the problem is one in the mid-surface. There a linear function is
!> fitted to the points of the old element at this place and of those of the same material around
!> it, weighted by their distance; a linear field is carried exactly, and no value leaves the range
!> of those around it.
!>
!> Stress and internal variables are carried in the material axes, which turn with the sheet; the
!> axes themselves are carried by their components and made orthonormal again.
!> Sources: Baptista, Alves, Oliveira, Rodrigues and Menezes 2007 (transfer of the state after the
!> trimming of hexahedra); Lancaster and Salkauskas, Math. Comput. 37 (1981) 141-158 (moving least
!> squares); Higham, SIAM J. Sci. Stat. Comput. 7 (1986) 1160-1174 (polar decomposition).
module dd3_sheet_transfer
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : inverse, solve_small
  use dd3_sheet_grid, only : grid_t
  use dd3_sheet_location, only : bilinear, place_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: axes_at, bounded_mean, linear_weights, mean_axes, quads_alike, transfer_point, &
      values_at

  !> Softening of the weights, over the distance of the farthest point.
  real(wp), parameter :: softening = 0.1_wp
  !> Iterations of the polar decomposition.
  integer, parameter :: most_iterations = 20

contains

  !> Set the state of one integration point from the old sheet.
  pure subroutine transfer_point(old, grid, plane, element, layer, level, place, material, &
      stress, internal_variables, orientation)
    !> Sheet before the cut, its grid and the positions of its columns in the plane.
    type(sheet_t), intent(in) :: old
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: plane(:, :)
    type(element_t), intent(in) :: element
    !> Layer of the element, and an integration point of the same level.
    integer, intent(in) :: layer, level
    !> Place on the old grid.
    type(place_t), intent(in) :: place
    !> Materials of the elements of its column, from the bottom.
    integer, intent(in) :: material(:)
    real(wp), intent(out) :: stress(:), internal_variables(:), orientation(:, :)

    real(wp), allocatable :: weight(:)
    integer, allocatable :: donor(:, :)

    call find_weights(grid, plane, element, layer, level, place, &
        quads_alike(grid, place%quad, old%mesh%material, material), donor, weight)
    stress = bounded_mean(values_at(old%stress, donor), weight)
    internal_variables = bounded_mean(values_at(old%internal_variables, donor), weight)
    orientation = mean_axes(axes_at(old%orientation, donor), weight)
  end subroutine transfer_point

  !> Return the values at some integration points, `(m, n)`.
  pure function values_at(value, point) result(selected)
    !> `(m, n_point, n_element)`.
    real(wp), intent(in) :: value(:, :, :)
    !> Point and element of each, `(2, n)`.
    integer, intent(in) :: point(:, :)
    real(wp) :: selected(size(value, 1), size(point, 2))

    integer :: k

    do k = 1, size(point, 2)
      selected(:, k) = value(:, point(1, k), point(2, k))
    end do
  end function values_at

  !> Return the axes at some integration points, `(3, 3, n)`.
  pure function axes_at(axes, point) result(selected)
    !> `(3, 3, n_point, n_element)`.
    real(wp), intent(in) :: axes(:, :, :, :)
    !> Point and element of each, `(2, n)`.
    integer, intent(in) :: point(:, :)
    real(wp) :: selected(3, 3, size(point, 2))

    integer :: k

    do k = 1, size(point, 2)
      selected(:, :, k) = axes(:, :, point(1, k), point(2, k))
    end do
  end function axes_at

  !> Return the weighted sum of values, within their range.
  pure function bounded_mean(value, weight) result(mean)
    !> Values, `(m, n)`, and their weights, with the sum 1.
    real(wp), intent(in) :: value(:, :), weight(:)
    real(wp) :: mean(size(value, 1))

    real(wp) :: low(size(value, 1)), high(size(value, 1))
    integer :: k

    low = huge(1.0_wp)
    high = -huge(1.0_wp)
    mean = 0.0_wp
    do k = 1, size(weight)
      low = min(low, value(:, k))
      high = max(high, value(:, k))
      mean = mean + weight(k)*value(:, k)
    end do
    mean = min(high, max(low, mean))
  end function bounded_mean

  !> Return the weighted sum of axes, made orthonormal.
  pure function mean_axes(axes, weight) result(mean)
    !> Axes as columns, `(3, 3, n)`, and their weights, with the sum 1.
    real(wp), intent(in) :: axes(:, :, :), weight(:)
    real(wp) :: mean(3, 3)

    integer :: k

    mean = 0.0_wp
    do k = 1, size(weight)
      mean = mean + weight(k)*axes(:, :, k)
    end do
    call make_orthonormal(mean)
  end function mean_axes

  !> Find the integration points around a place on the grid, and their weights.
  pure subroutine find_weights(grid, plane, element, layer, level, place, around, donor, weight)
    type(grid_t), intent(in) :: grid
    real(wp), intent(in) :: plane(:, :)
    type(element_t), intent(in) :: element
    integer, intent(in) :: layer, level
    type(place_t), intent(in) :: place
    !> Quadrilaterals whose points are taken.
    integer, intent(in) :: around(:)
    !> Point and element of each, `(2, n)`.
    integer, allocatable, intent(out) :: donor(:, :)
    real(wp), allocatable, intent(out) :: weight(:)

    integer, allocatable :: same_level(:)
    real(wp), allocatable :: offset(:, :)
    real(wp) :: point(2)
    integer :: i, k, p

    point = matmul(plane(:, grid%corner(:, place%quad)), bilinear(place%natural))
    same_level = pack([(p, p=1, element%n_point)], &
        abs(element%point(3, :) - element%point(3, level)) < 1.0e-9_wp)
    allocate (donor(2, size(around)*size(same_level)), offset(2, size(around)*size(same_level)))
    k = 0
    do i = 1, size(around)
      do p = 1, size(same_level)
        k = k + 1
        donor(:, k) = [same_level(p), grid%element(layer, around(i))]
        offset(:, k) = matmul(plane(:, grid%corner(:, around(i))), &
            bilinear(element%point(:2, same_level(p)))) - point
      end do
    end do
    weight = linear_weights(offset)
  end subroutine find_weights

  !> Return the weights of values at points around a place: those of the linear function fitted by
  !> weighted least squares, evaluated at the place.
  pure function linear_weights(offset) result(weight)
    !> Points from the place, `(2, n)`.
    real(wp), intent(in) :: offset(:, :)
    real(wp) :: weight(size(offset, 2))

    real(wp) :: near(2, size(offset, 2)), matrix(3, 3), row(3, 1)
    logical :: regular
    integer :: k

    near = offset/sqrt(maxval(sum(offset**2, dim=1)))
    weight = (1.0_wp/(sum(near**2, dim=1) + softening**2))**2
    matrix = 0.0_wp
    do k = 1, size(weight)
      row(:, 1) = [1.0_wp, near(:, k)]
      matrix = matrix + weight(k)*matmul(row, transpose(row))
    end do
    row(:, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
    call solve_small(3, 1, matrix, row, regular)
    if (.not. regular) row(:, 1) = [1.0_wp, 0.0_wp, 0.0_wp]
    weight = weight*(row(1, 1) + row(2, 1)*near(1, :) + row(3, 1)*near(2, :))
    weight = weight/sum(weight)
  end function linear_weights

  !> Return those of a quadrilateral and its neighbours whose elements have given materials, as the
  !> internal variables of other materials have another meaning; the first alone if there is none.
  pure function quads_alike(grid, quad, material, wanted) result(alike)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: quad
    !> Material of each element, `(n_element)`, and those wanted, from the bottom, `(n_layer)`.
    integer, intent(in) :: material(:), wanted(:)
    integer, allocatable :: alike(:)

    integer :: i

    associate (around => quads_around(grid, quad))
      alike = pack(around, [(all(material(grid%element(:, around(i))) == wanted), &
          i=1, size(around))])
    end associate
    if (size(alike) == 0) alike = [quad]
  end function quads_alike

  !> Return a quadrilateral and those that have a corner in common with it.
  pure function quads_around(grid, quad) result(around)
    type(grid_t), intent(in) :: grid
    integer, intent(in) :: quad
    integer, allocatable :: around(:)

    integer :: i, k

    around = [quad]
    do i = 1, 4
      associate (c => grid%corner(i, quad))
        do k = grid%first(c), grid%first(c + 1) - 1
          if (all(around /= grid%quad_at(k))) around = [around, grid%quad_at(k)]
        end do
      end associate
    end do
  end function quads_around

  !> Replace a matrix by the nearest rotation.
  pure subroutine make_orthonormal(matrix)
    real(wp), intent(inout) :: matrix(3, 3)

    real(wp) :: inverted(3, 3), next(3, 3)
    logical :: regular
    integer :: i

    do i = 1, most_iterations
      call inverse(matrix, inverted, regular)
      if (.not. regular) return
      next = 0.5_wp*(matrix + transpose(inverted))
      if (maxval(abs(next - matrix)) < 1.0e-14_wp) exit
      matrix = next
    end do
  end subroutine make_orthonormal

end module dd3_sheet_transfer
