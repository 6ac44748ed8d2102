! SPDX-License-Identifier: GPL-3.0-or-later
!> The sheet as a membrane between tools: the least sum of squares of the slopes of its height over
!> a grid in the plane, between the heights of the tools below and above it. A rough shape of the
!> sheet that needs no mechanics.
module dd3_run_membrane
  use dd3_base_kinds, only : pi, wp
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_tools_bezier, only : patch_t, position_at
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: membrane_t, bound_by_tools, new_membrane, slope_at, span_membrane

  !> Grid spacing over the length of the undivided elements, and most grid points in a direction.
  real(wp), parameter :: spacing = 0.5_wp
  integer, parameter :: most_points = 200
  !> Distance of the points of a patch over the spacing of the grid, and most of them in a
  !> direction.
  real(wp), parameter :: fineness = 0.5_wp
  integer, parameter :: most_on_patch = 400
  !> Sweeps of the over-relaxation.
  integer, parameter :: n_sweep = 400
  !> Height of a place that no tool bounds, mm.
  real(wp), parameter :: unbounded = 1.0e30_wp

  !> The sheet over a grid in the plane.
  type :: membrane_t
    real(wp) :: corner(2) = 0.0_wp, step = 0.0_wp
    !> Places of the blank.
    logical, allocatable :: inside(:, :)
    !> Height of the sheet and its bounds by tools below and above, mm.
    real(wp), allocatable :: z(:, :), lower(:, :), upper(:, :)
  end type membrane_t

contains

  !> Lay a grid over the sheet.
  subroutine new_membrane(self, model, x)
    type(membrane_t), intent(out) :: self
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    real(wp) :: size_of(2)
    integer :: n(2), f, i, j, k(2), n_side

    self%corner = minval(x(:2, :), dim=2)
    size_of = maxval(x(:2, :), dim=2) - self%corner
    self%step = max(spacing*model%undivided_length, maxval(size_of)/real(most_points, wp))
    n = max(1, ceiling(size_of/self%step - 1.0e-6_wp))
    allocate (self%inside(n(1), n(2)), source=.false.)
    allocate (self%z(n(1), n(2)), source=sum(x(3, :))/real(size(x, 2), wp))
    allocate (self%lower(n(1), n(2)), source=-unbounded)
    allocate (self%upper(n(1), n(2)), source=unbounded)
    n_side = 1 + ceiling(1.5_wp/spacing)
    do f = 1, size(model%contact_face)
      associate (corner => x(:2, model%face%corner(:, model%contact_face(f))))
        do j = 0, n_side - 1
          do i = 0, n_side - 1
            k = cell_of(self, bilinear(corner, (real([i, j], wp) + 0.5_wp)/real(n_side, wp)))
            if (all(k > 0)) self%inside(k(1), k(2)) = .true.
          end do
        end do
      end associate
    end do
  end subroutine new_membrane

  !> Return the point of a quadrilateral at parameters from 0 to 1.
  pure function bilinear(corner, at) result(x)
    real(wp), intent(in) :: corner(2, 4), at(2)
    real(wp) :: x(2)

    associate (u => at(1), v => at(2))
      x = (1.0_wp - v)*((1.0_wp - u)*corner(:, 1) + u*corner(:, 2)) &
          + v*((1.0_wp - u)*corner(:, 4) + u*corner(:, 3))
    end associate
  end function bilinear

  !> Return the cell of a point; zeros outside the grid.
  pure function cell_of(self, x) result(cell)
    type(membrane_t), intent(in) :: self
    real(wp), intent(in) :: x(2)
    integer :: cell(2)

    cell = 1 + floor((x - self%corner)/self%step)
    if (any(cell < 1 .or. cell > shape(self%z))) cell = 0
  end function cell_of

  !> Bound the height of the sheet by the tools on either side of it that are not pressed.
  subroutine bound_by_tools(self, model, state, number)
    type(membrane_t), intent(inout) :: self
    type(model_t), intent(in) :: model
    !> With the placements of the tools.
    type(state_t), intent(in) :: state
    !> Of the phase.
    integer, intent(in) :: number

    integer :: tool, p

    do tool = 1, model%n_tool
      if (.not. model%phase(number)%acts(tool) .or. model%phase(number)%pressed(tool)) cycle
      do p = 1, size(model%tool(tool)%surface%patch)
        call bound_by_patch(self, model%tool(tool)%surface%patch(p), state%placement(tool), &
            is_above(model, tool))
      end do
    end do
  end subroutine bound_by_tools

  !> Whether a tool meets the upper face of the sheet.
  pure logical function is_above(model, tool)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool

    real(wp) :: x(3, model%n_node)
    integer :: node

    is_above = .false.
    x = model%start_positions()
    do node = 1, model%n_node
      if (.not. model%member(tool, node)) cycle
      is_above = x(3, node) >= maxval(x(3, model%column(:, node)))
      return
    end do
  end function is_above

  !> Bound the height of the sheet by a patch of a tool.
  pure subroutine bound_by_patch(self, patch, placement, above)
    type(membrane_t), intent(inout) :: self
    type(patch_t), intent(in) :: patch
    type(placement_t), intent(in) :: placement
    logical, intent(in) :: above

    real(wp) :: x(3)
    integer :: n, i, j, cell(2)

    n = min(most_on_patch, 1 + ceiling(patch%size/(fineness*self%step)))
    do j = 0, n
      do i = 0, n
        x = placement%vector_to_global(position_at(patch, real(i, wp)/real(n, wp), &
            real(j, wp)/real(n, wp))) + placement%translation
        cell = cell_of(self, x(:2))
        if (any(cell == 0)) cycle
        associate (lower => self%lower(cell(1), cell(2)), upper => self%upper(cell(1), cell(2)))
          if (above) upper = min(upper, x(3))
          if (.not. above) lower = max(lower, x(3))
        end associate
      end do
    end do
  end subroutine bound_by_patch

  !> Find the heights with the least sum of squares of the slopes between the bounds, by successive
  !> over-relaxation.
  pure subroutine span_membrane(self)
    type(membrane_t), intent(inout) :: self

    real(wp) :: mean, relaxation
    integer :: sweep, i, j

    relaxation = 2.0_wp/(1.0_wp + sin(pi/real(max(2, maxval(shape(self%z))), wp)))
    do sweep = 1, n_sweep
      do j = 1, size(self%z, 2)
        do i = 1, size(self%z, 1)
          if (.not. self%inside(i, j)) cycle
          associate (z => self%z(i, j), lower => self%lower(i, j), upper => self%upper(i, j))
            mean = mean_around(self, i, j)
            z = z + relaxation*(mean - z)
            z = max(lower, min(upper, z))
            if (lower > upper) z = 0.5_wp*(lower + upper)
          end associate
        end do
      end do
    end do
  end subroutine span_membrane

  !> Return the mean height of the neighbours of a cell; at the rim that of the cell stands in.
  pure real(wp) function mean_around(self, i, j) result(mean)
    type(membrane_t), intent(in) :: self
    integer, intent(in) :: i, j

    mean = 0.25_wp*(height(i - 1, j) + height(i + 1, j) + height(i, j - 1) + height(i, j + 1))

  contains

    !> Return the height of a neighbour.
    pure real(wp) function height(k, l)
      integer, intent(in) :: k, l

      height = self%z(i, j)
      if (k < 1 .or. l < 1 .or. k > size(self%z, 1) .or. l > size(self%z, 2)) return
      if (self%inside(k, l)) height = self%z(k, l)
    end function height

  end function mean_around

  !> Return the slope of the sheet, from the differences to the neighbours.
  pure real(wp) function slope_at(self, i, j) result(slope)
    type(membrane_t), intent(in) :: self
    integer, intent(in) :: i, j

    slope = norm2([along(max(i - 1, 1), j, min(i + 1, size(self%z, 1)), j), &
        along(i, max(j - 1, 1), i, min(j + 1, size(self%z, 2)))])

  contains

    !> Return the slope between two cells.
    pure real(wp) function along(i1, j1, i2, j2)
      integer, intent(in) :: i1, j1, i2, j2

      along = 0.0_wp
      if (i1 == i2 .and. j1 == j2) return
      if (.not. (self%inside(i1, j1) .and. self%inside(i2, j2))) return
      along = (self%z(i2, j2) - self%z(i1, j1))/(self%step*real(max(i2 - i1, j2 - j1), wp))
    end function along

  end function slope_at

end module dd3_run_membrane
