! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings of curves of a cut that go beyond the border of the sheet, or lie beside it.
module dd3_sheet_cut_border
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : trim_spec_t
  use dd3_sheet_curves, only : curve_t
  use dd3_sheet_cut_function, only : cut_function_t
  use dd3_sheet_location, only : natural_coordinates
  use dd3_mesh_plane_curve, only : is_inside, loop_t
  use dd3_sheet_sheet, only : sheet_t
  implicit none
  private
  public :: on_sheet, warn_of_border

  !> Distance of a curve beyond the border of the sheet that is told, over the length of the
  !> element's side there.
  real(wp), parameter :: told_distance = 0.01_wp

  !> A side of an element on the border of the sheet.
  type :: side_t
    !> One end, and the vector to the other, mm.
    real(wp) :: from(2) = 0.0_wp, along(2) = 0.0_wp
  end type side_t

contains

  !> Warn of curves that bound what stays and go beyond the border of the sheet, and of curves
  !> beside the sheet. Other curves across the border are notches. A curve that is symmetric to a
  !> straight part of the border is that of the whole of a sheet of which a half is there.
  subroutine warn_of_border(sheet, spec, cutting, curve)
    type(sheet_t), intent(inout) :: sheet
    type(trim_spec_t), intent(in) :: spec
    type(cut_function_t), intent(in) :: cutting
    type(curve_t), intent(in) :: curve(:)

    real(wp), allocatable :: beyond(:)
    character(len=:), allocatable :: text
    logical :: cuts
    integer :: i, k

    do k = 1, size(cutting%loop)
      associate (loop => cutting%loop(k))
        beyond = distances_beyond(cutting, loop)
        cuts = any(beyond <= 0.0_wp)
        if (.not. cuts) cuts = any([(is_inside(cutting%loop(k:k), cutting%plane(:, i)), &
            i=1, size(cutting%plane, 2))])
      end associate
      text = ""
      if (.not. cuts) then
        text = "lies beside the sheet, "//to_text(minval(beyond), 3)// &
            " mm beyond its border, and cuts nothing"
      else if (spec%keeps_inside .and. any(beyond > 0.0_wp)) then
        text = "goes up to "//to_text(maxval(beyond), 3)//" mm beyond the border of the sheet, "// &
            "which stays as it is there"
      end if
      if (len(text) > 0) call sheet%warnings%add_new("W125", "the curve of cut '"//spec%name// &
          "' that begins here "//text, curve(k)%at)
    end do
  end subroutine warn_of_border

  !> Return the distances of the points of a curve from the border of the sheet, mm, 0 on the sheet,
  !> very near to it, and beyond a side to which the curve is symmetric.
  function distances_beyond(cutting, loop) result(distance)
    type(cut_function_t), intent(in) :: cutting
    type(loop_t), intent(in) :: loop
    real(wp) :: distance(size(loop%point, 2))

    type(side_t) :: side, before
    logical :: symmetric
    integer :: i

    symmetric = .false.
    do i = 1, size(distance)
      call find_beyond(cutting, loop%point(:, i), distance(i), side)
      if (.not. distance(i) > 0.0_wp) cycle
      if (.not. same_line(side, before)) symmetric = is_symmetric(loop, side)
      before = side
      if (symmetric) distance(i) = 0.0_wp
    end do
  end function distances_beyond

  !> Find the distance of a point of the plane from the border of the sheet, 0 on the sheet and very
  !> near to it, and the nearest side.
  pure subroutine find_beyond(cutting, point, distance, side)
    type(cut_function_t), intent(in) :: cutting
    real(wp), intent(in) :: point(2)
    !> mm.
    real(wp), intent(out) :: distance
    type(side_t), intent(out) :: side

    real(wp) :: from(2), along(2), away
    integer :: i, q

    distance = 0.0_wp
    if (on_sheet(cutting, point)) return
    distance = huge(1.0_wp)
    associate (grid => cutting%grid)
      do q = 1, grid%n_quad
        do i = 1, 4
          if (grid%neighbour(i, q) /= 0) cycle
          from = cutting%plane(:, grid%corner(i, q))
          along = cutting%plane(:, grid%corner(mod(i, 4) + 1, q)) - from
          away = norm2(point - from - along*max(0.0_wp, min(1.0_wp, &
              dot_product(point - from, along)/max(tiny(1.0_wp), dot_product(along, along)))))
          if (away >= distance) cycle
          distance = away
          side = side_t(from, along)
        end do
      end do
    end associate
    if (distance <= told_distance*norm2(side%along)) distance = 0.0_wp
  end subroutine find_beyond

  !> Whether two sides lie on one line.
  pure logical function same_line(a, b)
    type(side_t), intent(in) :: a, b

    same_line = .false.
    if (norm2(b%along) > 0.0_wp) same_line = &
        max(away_from_line(a, b%from), away_from_line(a, b%from + b%along)) <= &
        told_distance*norm2(a%along)
  end function same_line

  !> Return the distance of a point from the line of a side, mm.
  pure real(wp) function away_from_line(side, point)
    type(side_t), intent(in) :: side
    real(wp), intent(in) :: point(2)

    associate (d => point - side%from, along => side%along)
      away_from_line = abs(d(1)*along(2) - d(2)*along(1))/norm2(along)
    end associate
  end function away_from_line

  !> Whether a curve is symmetric to the line of a side: the mirror images of its points lie on it.
  pure logical function is_symmetric(loop, side)
    type(loop_t), intent(in) :: loop
    type(side_t), intent(in) :: side

    real(wp) :: image(2), from(2), along(2), away
    integer :: i, k, n

    n = size(loop%point, 2)
    do i = 1, n
      associate (d => loop%point(:, i) - side%from)
        image = side%from + 2.0_wp*dot_product(d, side%along)/sum(side%along**2)*side%along - d
      end associate
      away = huge(1.0_wp)
      do k = 1, n
        from = loop%point(:, k)
        along = loop%point(:, mod(k, n) + 1) - from
        away = min(away, norm2(image - from - along*max(0.0_wp, min(1.0_wp, &
            dot_product(image - from, along)/max(tiny(1.0_wp), sum(along**2))))))
      end do
      is_symmetric = away <= told_distance*norm2(side%along)
      if (.not. is_symmetric) return
    end do
  end function is_symmetric

  !> Whether a point of the plane lies on the sheet.
  pure logical function on_sheet(cutting, point)
    type(cut_function_t), intent(in) :: cutting
    real(wp), intent(in) :: point(2)

    real(wp) :: natural(2), corner(2, 4)
    integer :: q

    do q = 1, cutting%grid%n_quad
      corner = cutting%plane(:, cutting%grid%corner(:, q))
      if (any(point < minval(corner, dim=2)) .or. any(point > maxval(corner, dim=2))) cycle
      call natural_coordinates(corner, point, natural, on_sheet)
      if (on_sheet) on_sheet = all(abs(natural) <= 1.0_wp)
      if (on_sheet) return
    end do
    on_sheet = .false.
  end function on_sheet

end module dd3_sheet_cut_border
