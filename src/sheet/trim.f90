! SPDX-License-Identifier: GPL-3.0-or-later
!> Cut of a sheet along closed curves. Seen through its thickness the sheet is a grid of
!> quadrilaterals. A function of the place on the sheet is zero on the cut: the distance from the
!> curves in the plane normal to the direction of projection (dd3_sheet_projection,
!> dd3_sheet_cut_function). The lines on which it is zero are found on the initial sheet, which is
!> flat (dd3_sheet_contour), and so is all that follows. What is well inside stays as it is; a layer
!> of new quadrilaterals joins it to the lines (dd3_sheet_core, dd3_sheet_fitting), the columns near
!> the cut are moved for their shape (dd3_sheet_smoothing), and the state of what is new or moved is
!> that of the old sheet at its place (dd3_sheet_rebuild, dd3_sheet_transfer). A sheet with divided
!> elements gets a uniform grid near the cut first (dd3_sheet_cut_levels).
module dd3_sheet_trim
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : pi, wp
  use dd3_base_text, only : newline, to_text
  use dd3_element_table, only : element_t
  use dd3_input_case, only : trim_spec_t
  use dd3_sheet_contour, only : find_contours
  use dd3_sheet_core, only : columns_that_stay, find_chains, select_core
  use dd3_sheet_curves, only : curve_t, read_curves
  use dd3_sheet_cut_border, only : on_sheet, warn_of_border
  use dd3_sheet_cut_function, only : cut_function_t
  use dd3_sheet_cut_levels, only : divide_near_cut
  use dd3_sheet_fitting, only : fit_chain, fit_t
  use dd3_sheet_grid, only : new_grid
  use dd3_sheet_location, only : bilinear, locate, place_t
  use dd3_mesh_plane_curve, only : crossing_segments, is_inside, loop_t
  use dd3_sheet_projection, only : project_curves
  use dd3_sheet_rebuild, only : cut_t, least_sine_at, rebuild
  use dd3_sheet_sheet, only : sheet_t
  use dd3_sheet_smoothing, only : smooth
  implicit none
  private
  public :: trim_sheet

  !> Rings of old columns beside the chains that may move.
  integer, parameter :: n_ring = 2
  !> Least sine of an angle of an element near the cut.
  real(wp), parameter :: least_sine = 0.15_wp

contains

  !> Cut a sheet. It may be used if no error was added.
  subroutine trim_sheet(sheet, spec, element, errors)
    type(sheet_t), intent(inout) :: sheet
    type(trim_spec_t), intent(in) :: spec
    type(element_t), intent(in) :: element
    type(error_list_t), intent(inout) :: errors

    type(cut_t) :: cut
    type(cut_function_t) :: cutting
    type(curve_t), allocatable :: curve(:)
    type(loop_t), allocatable :: line(:)
    type(fit_t), allocatable :: fit(:)
    logical, allocatable :: stays(:)
    logical :: divided
    integer :: before, i

    before = errors%count
    call read_curves(curve, spec, errors)
    do
      call check_sheet(cut, sheet, spec, element, errors)
      if (errors%count > before) return
      cutting%grid = cut%grid
      cutting%keeps_inside = spec%keeps_inside
      call project_curves(sheet, cut%grid, spec, curve, cutting%plane, cutting%loop, errors)
      if (errors%count == before) call check_crossings(spec, curve, cutting%loop, errors)
      if (errors%count > before) return
      stays = columns_that_stay(cutting)
      call divide_near_cut(sheet, cut%grid, element, stays, n_ring + 2, divided)
      if (.not. divided) exit
    end do
    allocate (cut%kept(cut%grid%n_quad))
    call select_core(cutting, stays, cut%kept)
    call check_core(spec, cutting, cut%kept, curve, errors)
    if (errors%count > before) return
    call warn_of_border(sheet, spec, cutting, curve)
    call find_contours(cutting, stays, cut%plane, line)
    call find_chains(cut%grid, cut%kept, cut%chain)
    allocate (fit(size(cut%chain)))
    do i = 1, size(fit)
      call fit_chain(fit(i), cut%chain(i), line, cut%plane)
    end do
    call check_fits(spec, sheet, cut, fit, line, errors)
    if (errors%count > before) return
    call new_patch(cut, sheet, fit, line)
    call smooth(cut%patch, line)
    call snap(cut, cutting)
    call rebuild(sheet, cut, element, spec%name)
    call report_cut(sheet, cut, spec, errors)
  end subroutine trim_sheet

  !> Make the grid of a sheet that can be cut: of elements with eight nodes, initially flat, without
  !> a set of the cut's name.
  subroutine check_sheet(cut, sheet, spec, element, errors)
    type(cut_t), intent(inout) :: cut
    type(sheet_t), intent(in) :: sheet
    type(trim_spec_t), intent(in) :: spec
    type(element_t), intent(in) :: element
    type(error_list_t), intent(inout) :: errors

    logical :: regular
    integer :: q

    if (sheet%mesh%find_set(spec%name) > 0) call errors%push_input(spec%source%named, "'"// &
        spec%source%called()//"' is a set of the sheet", "another name", code="E123")
    regular = element%n_node == 8
    if (regular) call new_grid(cut%grid, sheet%mesh, regular)
    if (.not. regular) then
      call errors%push_input(spec%source%opened, "a sheet of element "//trim(element%name)// &
          " in layers that end within it cannot be cut", &
          "elements with 8 nodes, the same number of layers everywhere", code="E153")
      return
    end if
    if (allocated(sheet%mesh%bound) .and. .not. allocated(sheet%mesh%level)) then
      call errors%push_input(spec%source%opened, "a sheet with bound nodes that was not made "// &
          "by divisions of elements into four cannot be cut", "elements with whole faces in "// &
          "common, or each divided into four", code="E153")
      return
    end if
    cut%plane = sheet%mesh%x(:2, cut%grid%node(0, :))
    do q = 1, cut%grid%n_quad
      if (area_of(cut%plane(:, cut%grid%corner(:, q))) > 0.0_wp) cycle
      call errors%push_input(spec%source%opened, "the initial sheet is not flat: its element "// &
          to_text(cut%grid%element(1, q))//" has no area along z", &
          "a sheet that began as a flat blank normal to z", code="E153")
      return
    end do
  end subroutine check_sheet

  !> Return twice the area of a quadrilateral, negative if it is turned over.
  pure real(wp) function area_of(corner)
    real(wp), intent(in) :: corner(2, 4)

    associate (u => corner(:, 3) - corner(:, 1), v => corner(:, 4) - corner(:, 2))
      area_of = u(1)*v(2) - u(2)*v(1)
    end associate
  end function area_of

  !> Report curves that cross each other or themselves.
  subroutine check_crossings(spec, curve, loop, errors)
    type(trim_spec_t), intent(in) :: spec
    type(curve_t), intent(in) :: curve(:)
    type(loop_t), intent(in) :: loop(:)
    type(error_list_t), intent(inout) :: errors

    integer :: place(2, 2)

    place = crossing_segments(loop)
    if (place(1, 1) == 0) return
    if (place(1, 1) == place(1, 2)) then
      call errors%push_input(curve(place(1, 1))%at, "the curve that begins here crosses itself"// &
          " on the sheet", "a curve without crossings in cut '"//spec%name//"'", code="E153")
    else
      call errors%push_input(curve(place(1, 2))%at, "the curve that begins here crosses another"// &
          " one on the sheet", "curves of cut '"//spec%name//"' that do not cross", code="E153")
    end if
  end subroutine check_crossings

  !> Report a cut that leaves all or nothing, and curves within an element.
  subroutine check_core(spec, cutting, kept, curve, errors)
    type(trim_spec_t), intent(in) :: spec
    type(cut_function_t), intent(in) :: cutting
    logical, intent(in) :: kept(:)
    type(curve_t), intent(in) :: curve(:)
    type(error_list_t), intent(inout) :: errors

    integer :: i, k, before

    if (.not. any(kept)) call errors%push_input(spec%source%opened, &
        "nothing of the sheet stays in cut '"//spec%name//"'", "curves within which the sheet "// &
        "has several elements (see keep, along)", code="E153")
    before = errors%count
    do k = 1, size(cutting%loop)
      if (any([(is_inside(cutting%loop(k:k), cutting%plane(:, i)), &
          i=1, size(cutting%plane, 2))])) cycle
      if (.not. on_sheet(cutting, cutting%loop(k)%point(:, 1))) cycle
      call errors%push_input(curve(k)%at, "the curve that begins here lies within an element", &
          "a larger curve, or a finer mesh there", code="E153")
    end do
    if (errors%count == before .and. all(kept)) call errors%push_input(spec%source%opened, &
        "cut '"//spec%name//"' misses the sheet: nothing is cut off", &
        "curves on the sheet (see keep, along)", code="E153")
  end subroutine check_core

  !> Report chains that do not follow a line of the cut of their own, and lines that none follows.
  subroutine check_fits(spec, sheet, cut, fit, line, errors)
    type(trim_spec_t), intent(in) :: spec
    type(sheet_t), intent(in) :: sheet
    type(cut_t), intent(in) :: cut
    type(fit_t), intent(in) :: fit(:)
    type(loop_t), intent(in) :: line(:)
    type(error_list_t), intent(inout) :: errors

    integer :: i, k, node

    do i = 1, size(fit)
      k = fit(i)%loop
      if (k > 0) then
        if (count(fit%loop == k) == 1) cycle
      end if
      node = cut%grid%node(0, cut%chain(i)%column(1))
      call errors%push_input(spec%source%opened, "the elements do not follow cut '"//spec%name// &
          "' near "//point_text(sheet%x(:, node))//": it leaves a strip that is narrower than "// &
          "two elements, or meets the border of the sheet at a small angle", &
          "a smoother curve, or a finer mesh there", code="E153")
      return
    end do
    do k = 1, size(line)
      if (any(fit%loop == k)) cycle
      node = cut%grid%node(0, minloc(sum((cut%plane - spread(line(k)%point(:, 1), 2, &
          cut%grid%n_column))**2, dim=1), dim=1))
      call errors%push_input(spec%source%opened, "cut '"//spec%name//"' leaves a part that is "// &
          "narrower than two elements near "//point_text(sheet%x(:, node)), &
          "curves that leave larger parts, or a finer mesh there", code="E153")
      return
    end do
  end subroutine check_fits

  !> Set the quadrilaterals after the cut: those that stay, and a layer between each chain and its
  !> points on the curve.
  pure subroutine new_patch(cut, sheet, fit, loop)
    type(cut_t), intent(inout) :: cut
    type(sheet_t), intent(in) :: sheet
    type(fit_t), intent(in) :: fit(:)
    type(loop_t), intent(in) :: loop(:)

    integer :: c, i, j, k, n, n_column, n_kept, n_new, q

    associate (grid => cut%grid, patch => cut%patch)
      n_kept = count(cut%kept)
      n_new = sum([(size(cut%chain(k)%column) - merge(0, 1, cut%chain(k)%closed), k=1, size(fit))])
      n_column = grid%n_column + sum([(size(cut%chain(k)%column), k=1, size(fit))])
      allocate (patch%corner(4, n_kept + n_new))
      allocate (patch%plane(2, n_column), patch%metric(3, n_column), patch%free(n_column))
      allocate (patch%loop(n_column), cut%source(n_column), source=0)
      allocate (patch%arc(n_column), source=0.0_wp)
      patch%corner(:, :n_kept) = grid%corner(:, pack([(q, q=1, grid%n_quad)], cut%kept))
      patch%plane(:, :grid%n_column) = cut%plane
      patch%metric(:, :grid%n_column) = metric_of(sheet, cut)
      patch%free = .false.
      call free_near_chains(cut)
      cut%source(:grid%n_column) = [(c, c=1, grid%n_column)]
      c = grid%n_column
      q = n_kept
      do k = 1, size(fit)
        n = size(cut%chain(k)%column)
        do i = 1, n
          c = c + 1
          cut%source(c) = cut%chain(k)%column(i)
          patch%plane(:, c) = loop(fit(k)%loop)%at(fit(k)%arc(i))
          patch%metric(:, c) = patch%metric(:, cut%source(c))
          patch%arc(c) = fit(k)%arc(i)
          if (.not. fit(k)%fixed(i)) patch%loop(c) = fit(k)%loop
          if (i == n .and. .not. cut%chain(k)%closed) exit
          j = merge(c + 1, c + 1 - n, i < n)
          q = q + 1
          patch%corner(:, q) = [cut%chain(k)%column(mod(i, n) + 1), cut%chain(k)%column(i), c, j]
        end do
      end do
    end associate
  end subroutine new_patch

  !> Move the new columns from the lines, which are polygons, to the curves.
  pure subroutine snap(cut, cutting)
    type(cut_t), intent(inout) :: cut
    type(cut_function_t), intent(in) :: cutting

    type(place_t) :: place
    integer :: c

    associate (grid => cut%grid, patch => cut%patch)
      do c = grid%n_column + 1, size(cut%source)
        if (patch%loop(c) == 0) cycle
        place = locate(grid, cut%plane, patch%plane(:, c), grid%quad_at(grid%first(cut%source(c))))
        call cutting%zero_near(place%quad, place%natural)
        patch%plane(:, c) = matmul(cut%plane(:, grid%corner(:, place%quad)), &
            bilinear(place%natural))
      end do
    end associate
  end subroutine snap

  !> Free the columns of the chains and some rings beside them, those at the border of the sheet
  !> apart.
  pure subroutine free_near_chains(cut)
    type(cut_t), intent(inout) :: cut

    logical :: near(cut%grid%n_column), border(cut%grid%n_column)
    integer :: i, k, q, ring

    associate (grid => cut%grid)
      near = .false.
      border = .false.
      do k = 1, size(cut%chain)
        near(cut%chain(k)%column) = .true.
      end do
      do ring = 1, n_ring
        cut%patch%free(:grid%n_column) = near
        do q = 1, grid%n_quad
          if (.not. cut%kept(q)) cycle
          if (any(cut%patch%free(grid%corner(:, q)))) near(grid%corner(:, q)) = .true.
        end do
      end do
      do q = 1, grid%n_quad
        do i = 1, 4
          if (grid%neighbour(i, q) == 0) border(grid%corner([i, mod(i, 4) + 1], q)) = .true.
        end do
      end do
      cut%patch%free(:grid%n_column) = near .and. .not. border
    end associate
  end subroutine free_near_chains

  !> Return the metric at the columns: the mean over the quadrilaterals at each.
  pure function metric_of(sheet, cut) result(metric)
    type(sheet_t), intent(in) :: sheet
    type(cut_t), intent(in) :: cut
    real(wp) :: metric(3, cut%grid%n_column)

    real(wp) :: u(2), v(2), a(3), b(3), determinant, inverted(2, 2), product(2, 2)
    integer :: number(cut%grid%n_column), q

    metric = 0.0_wp
    number = 0
    associate (grid => cut%grid)
      do q = 1, grid%n_quad
        associate (c => grid%corner(:, q))
          u = cut%plane(:, c(3)) - cut%plane(:, c(1))
          v = cut%plane(:, c(4)) - cut%plane(:, c(2))
          determinant = u(1)*v(2) - u(2)*v(1)
          a = sheet%x(:, grid%node(0, c(3))) - sheet%x(:, grid%node(0, c(1)))
          b = sheet%x(:, grid%node(0, c(4))) - sheet%x(:, grid%node(0, c(2)))
          ! The inverse of the matrix with the columns u and v.
          inverted = reshape([v(2), -u(2), -v(1), u(1)], [2, 2])/determinant
          product = reshape([dot_product(a, a), dot_product(a, b), dot_product(a, b), &
              dot_product(b, b)], [2, 2])
          product = matmul(transpose(inverted), matmul(product, inverted))
          metric(:, c) = metric(:, c) + spread([product(1, 1), product(1, 2), product(2, 2)], 2, 4)
          number(c) = number(c) + 1
        end associate
      end do
    end associate
    metric = metric/spread(real(number, wp), 1, 3)
  end function metric_of

  !> Report what the cut has made of the sheet, and elements of bad shape as an error.
  subroutine report_cut(sheet, cut, spec, errors)
    !> After the cut.
    type(sheet_t), intent(inout) :: sheet
    type(cut_t), intent(in) :: cut
    type(trim_spec_t), intent(in) :: spec
    type(error_list_t), intent(inout) :: errors

    real(wp) :: sine, worst
    integer :: e, first, at

    first = cut%grid%n_layer*count(cut%kept)
    worst = 1.0_wp
    at = 1
    do e = 1, sheet%mesh%n_element
      sine = least_sine_at(sheet%x, sheet%mesh%connectivity(:, e))
      if (sine >= worst) cycle
      ! Elements away from the cut have the shapes that they had.
      if (e <= first) then
        if (.not. any(cut%patch%free(cut%patch%corner(:, (e - 1)/cut%grid%n_layer + 1)))) cycle
      end if
      worst = sine
      at = e
    end do
    sheet%report = sheet%report//"cut '"//spec%name//"': "// &
        to_text(cut%grid%n_layer*count(.not. cut%kept))//" elements removed, "// &
        to_text(sheet%mesh%n_element - first)//" new; least angle "// &
        to_text(180.0_wp/pi*asin(max(0.0_wp, worst)), 3)//" degrees"//newline
    if (worst > least_sine) return
    call errors%push_input(spec%source%opened, "cut '"//spec%name//"' makes an element of bad "// &
        "shape near "//point_text(sheet%x(:, sheet%mesh%connectivity(1, at)))// &
        ": the sine of an angle is "//to_text(worst, 2), &
        "a smoother curve that meets the border of the sheet at a large angle, a finer mesh, "// &
        "or another direction (along)", code="E153")
  end subroutine report_cut

  !> Return a point as text.
  pure function point_text(x) result(text)
    real(wp), intent(in) :: x(3)
    character(len=:), allocatable :: text

    text = to_text(x(1), 4)//" "//to_text(x(2), 4)//" "//to_text(x(3), 4)
  end function point_text

end module dd3_sheet_trim
