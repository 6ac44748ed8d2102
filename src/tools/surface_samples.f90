! SPDX-License-Identifier: GPL-3.0-or-later
!> Points of a tool's surface with its normals, for the turn of the normal over a length: close
!> together across curved patches, farther apart along the straight lines of a curved patch and
!> along borders of patches, none inside patches that are nearly flat over the length.
module dd3_tools_surface_samples
  use dd3_base_kinds, only : i8, wp
  use dd3_tools_bezier, only : evaluate, normal_at, patch_t, position_at, unit_normal
  use dd3_tools_surface, only : edge_parameters, surface_t
  implicit none
  private
  public :: surface_samples_t, new_surface_samples, close_spacing

  !> Spacing of the points over the length, where the normal turns along the line of the points and
  !> where it hardly does.
  real(wp), parameter :: close_spacing = 0.25_wp, wide_spacing = 0.5_wp
  !> Turns of the normal over the length, rad, up to which a part of a patch is nearly flat, and up
  !> to which the wide spacing is enough; and the factor by which the turn between points of the
  !> probe is raised for what lies between them.
  real(wp), parameter :: slight_turn = 0.03_wp, moderate_turn = 0.1_wp, raise = 2.0_wp
  !> Intervals of the probe in u and v, and most points of a part that is not divided.
  integer, parameter :: n_probe = 8, most_points = 512
  !> Largest number of halvings of a patch.
  integer, parameter :: most_halvings = 24
  !> Most points that are kept in a cell of the size of the close spacing, and the difference of
  !> their normals up to which one is enough.
  integer, parameter :: most_in_cell = 4
  real(wp), parameter :: same_normal = 1.0e-3_wp

  !> Points of a surface.
  type :: surface_samples_t
    integer :: n = 0
    !> Positions, mm, and unit normals, `(3, n)`.
    real(wp), allocatable :: x(:, :), normal(:, :)
  end type surface_samples_t

  !> Rectangle in the plane of the parameters of a patch.
  type :: part_t
    real(wp) :: lower(2) = 0.0_wp, upper(2) = 1.0_wp
  end type part_t

contains

  !> Find points of a surface.
  subroutine new_surface_samples(self, surface, length)
    type(surface_samples_t), intent(out) :: self
    type(surface_t), intent(in) :: surface
    !> Length over which the turn is wanted, mm.
    real(wp), intent(in) :: length

    integer :: i, k

    allocate (self%x(3, 1024), self%normal(3, 1024))
    do i = 1, size(surface%patch)
      call add_part(self, surface%patch(i), part_t(), length, most_halvings)
      do k = 1, 4
        if (.not. surface%edge(k, i)%pole) call add_edge(self, surface%patch(i), k, length)
      end do
    end do
    call thin_out(self, close_spacing*length)
  end subroutine new_surface_samples

  !> Add the points inside a part of a patch: the centres of equal cells, or those of its halves.
  recursive subroutine add_part(self, patch, part, length, n_halving)
    type(surface_samples_t), intent(inout) :: self
    type(patch_t), intent(in) :: patch
    type(part_t), intent(in) :: part
    real(wp), intent(in) :: length
    !> Number of halvings left.
    integer, intent(in) :: n_halving

    real(wp) :: side(2), turn(2), cells(2)
    type(part_t) :: half(2)
    integer :: axis, i, j, n(2)

    if (patch%flat) return
    if (patch%size <= close_spacing*length) then
      call add_point(self, patch, 0.5_wp*(part%lower + part%upper))
      return
    end if
    call probe(patch, part, side, turn)
    turn = raise*length*turn
    if (all(turn <= slight_turn)) return
    cells = side/(merge(close_spacing, wide_spacing, turn > moderate_turn)*length)
    if (product(max(1.0_wp, cells)) > most_points .and. n_halving > 0) then
      half = part
      axis = maxloc(cells, dim=1)
      half(1)%upper(axis) = 0.5_wp*(part%lower(axis) + part%upper(axis))
      half(2)%lower(axis) = half(1)%upper(axis)
      call add_part(self, patch, half(1), length, n_halving - 1)
      call add_part(self, patch, half(2), length, n_halving - 1)
      return
    end if
    n = max(1, ceiling(min(cells, real(most_points, wp))))
    do j = 1, n(2)
      do i = 1, n(1)
        call add_point(self, patch, part%lower &
            + (real([i, j], wp) - 0.5_wp)/real(n, wp)*(part%upper - part%lower))
      end do
    end do
  end subroutine add_part

  !> Measure a part of a patch by a grid of its points.
  subroutine probe(patch, part, side, turn)
    type(patch_t), intent(in) :: patch
    type(part_t), intent(in) :: part
    !> Largest length of the lines along u and along v, mm.
    real(wp), intent(out) :: side(2)
    !> Largest turn of the normal along u and along v, 1/mm.
    real(wp), intent(out) :: turn(2)

    real(wp) :: x(3, 0:n_probe, 0:n_probe), normal(3, 0:n_probe, 0:n_probe), uv(2)
    real(wp) :: first(3, 2), second(3, 3), total(2), step
    logical :: regular(0:n_probe, 0:n_probe)
    integer :: i, j, k, d(2)

    do j = 0, n_probe
      do i = 0, n_probe
        uv = part%lower + real([i, j], wp)/n_probe*(part%upper - part%lower)
        call evaluate(patch, uv(1), uv(2), x(:, i, j), first, second)
        call unit_normal(patch, first, normal(:, i, j), regular(i, j))
      end do
    end do
    side = 0.0_wp
    turn = 0.0_wp
    do j = 0, n_probe
      total = 0.0_wp
      do i = 1, n_probe
        do k = 1, 2
          ! Interval i of the line j along direction k.
          d = merge([i, j], [j, i], k == 1)
          associate (a => d, b => d - merge([1, 0], [0, 1], k == 1))
            step = norm2(x(:, a(1), a(2)) - x(:, b(1), b(2)))
            total(k) = total(k) + step
            if (.not. (regular(a(1), a(2)) .and. regular(b(1), b(2)))) cycle
            if (step <= epsilon(1.0_wp)*patch%size) cycle
            turn(k) = max(turn(k), norm2(normal(:, a(1), a(2)) - normal(:, b(1), b(2)))/step)
          end associate
        end do
      end do
      side = max(side, total)
    end do
  end subroutine probe

  !> Add the points of an edge of a patch, its ends among them.
  subroutine add_edge(self, patch, k, length)
    type(surface_samples_t), intent(inout) :: self
    type(patch_t), intent(in) :: patch
    !> Number of the edge.
    integer, intent(in) :: k
    real(wp), intent(in) :: length

    real(wp) :: side, spacing
    integer :: i, n

    side = patch%length(merge(3, 1, mod(k, 2) == 0), merge(2, 1, k <= 2))
    spacing = merge(wide_spacing, close_spacing, patch%flat)*length
    n = max(1, ceiling(side/spacing))
    do i = 0, n
      call add_point(self, patch, edge_parameters(k, real(i, wp)/real(n, wp)))
    end do
  end subroutine add_edge

  !> Add a point of a patch, if it has a normal.
  subroutine add_point(self, patch, uv)
    type(surface_samples_t), intent(inout) :: self
    type(patch_t), intent(in) :: patch
    real(wp), intent(in) :: uv(2)

    real(wp) :: normal(3)
    logical :: regular

    call normal_at(patch, uv(1), uv(2), normal, regular)
    if (.not. regular) return
    if (self%n == size(self%x, 2)) then
      self%x = reshape(self%x, [3, 2*self%n], pad=[0.0_wp])
      self%normal = reshape(self%normal, [3, 2*self%n], pad=[0.0_wp])
    end if
    self%n = self%n + 1
    self%x(:, self%n) = position_at(patch, uv(1), uv(2))
    self%normal(:, self%n) = normal
  end subroutine add_point

  !> Keep few of the points in each cell: one, then again and again the one whose normal differs
  !> most from those kept. Borders are those of two patches, and patches much smaller than the
  !> length have more points than are needed.
  subroutine thin_out(self, size_of)
    type(surface_samples_t), intent(inout) :: self
    !> Size of the cells, mm.
    real(wp), intent(in) :: size_of

    integer, allocatable :: cell(:), chosen(:)
    real(wp), allocatable :: square(:)
    logical, allocatable :: kept(:)
    integer :: n_cell, i, round

    allocate (cell(self%n), chosen(self%n), square(self%n), kept(self%n))
    call find_cells(self%x(:, :self%n), size_of, cell, n_cell)
    kept = .false.
    square = huge(1.0_wp)
    do round = 1, most_in_cell
      chosen(:n_cell) = 0
      do i = 1, self%n
        if (square(i) <= same_normal**2) cycle
        associate (best => chosen(cell(i)))
          if (best == 0) then
            best = i
          else if (square(i) > square(best)) then
            best = i
          end if
        end associate
      end do
      do i = 1, self%n
        associate (best => chosen(cell(i)))
          if (best == 0) cycle
          kept(best) = .true.
          square(i) = min(square(i), sum((self%normal(:, i) - self%normal(:, best))**2))
        end associate
      end do
    end do
    associate (point => pack([(i, i=1, self%n)], kept))
      self%n = size(point)
      self%x = self%x(:, point)
      self%normal = self%normal(:, point)
    end associate
  end subroutine thin_out

  !> Find the cell in which each point lies, by a hash table.
  subroutine find_cells(x, size_of, cell, n_cell)
    real(wp), intent(in) :: x(:, :)
    !> Size of the cells, mm.
    real(wp), intent(in) :: size_of
    !> Number of the cell of each point, and number of cells.
    integer, intent(out) :: cell(:), n_cell

    integer(i8), parameter :: factor(3) = [73856093_i8, 19349663_i8, 83492791_i8]
    integer(i8), allocatable :: key(:, :)
    integer, allocatable :: first(:), next(:)
    integer :: i, k, place

    allocate (key(3, size(x, 2)), next(size(x, 2)))
    allocate (first(2*size(x, 2) + 1), source=0)
    n_cell = 0
    do i = 1, size(x, 2)
      associate (new => key(:, n_cell + 1))
        new = floor(x(:, i)/size_of, i8)
        place = 1 + int(modulo(sum(factor*new), size(first, kind=i8)))
        k = first(place)
        do while (k > 0)
          if (all(key(:, k) == new)) exit
          k = next(k)
        end do
      end associate
      if (k == 0) then
        n_cell = n_cell + 1
        k = n_cell
        next(k) = first(place)
        first(place) = k
      end if
      cell(i) = k
    end do
  end subroutine find_cells

end module dd3_tools_surface_samples
