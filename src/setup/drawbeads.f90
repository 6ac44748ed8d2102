! SPDX-License-Identifier: GPL-3.0-or-later
!> Build of the draw-beads from the case: their lines, laws and the faces on which they act.
module dd3_setup_drawbeads
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t, drawbead_spec_t
  use dd3_input_point_file, only : read_points
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_area, part_of_nine
  use dd3_model_terms_drawbead, only : drawbead_t, elastic_slip, new_drawbead
  implicit none
  private
  public :: new_drawbeads

  !> Shortest segment of a line, in thicknesses of the sheet.
  real(wp), parameter :: shortest_segment = 1.0e-6_wp

contains

  !> Build all draw-beads.
  subroutine new_drawbeads(model, case, errors)
    !> With its mesh.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: spacing
    integer :: b, q, n

    allocate (model%drawbead(size(case%drawbead)))
    call find_bead_faces(model)
    if (size(case%drawbead) == 0) return
    spacing = 0.0_wp
    do q = 1, size(model%bead_face, 2)
      spacing = spacing + face_area(model%x0(:, model%bead_face(:, q)))
    end do
    spacing = sqrt(spacing/real(size(model%bead_face, 2), wp))
    n = 0
    do b = 1, size(case%drawbead)
      call build(model%drawbead(b), case%drawbead(b), spacing, model%thickness, errors)
      if (.not. allocated(model%drawbead(b)%line)) cycle
      model%drawbead(b)%offset = n
      n = n + size(model%drawbead(b)%line, 3)
    end do
  end subroutine new_drawbeads

  !> Find the quadrilaterals on the lower and upper faces of the sheet; none without draw-beads.
  pure subroutine find_bead_faces(model)
    type(model_t), intent(inout) :: model

    integer :: f, i, n

    allocate (model%bead_face(4, 4*model%face%n))
    n = 0
    if (size(model%drawbead) > 0) then
      do f = 1, model%face%n
        associate (bottom => model%column(1, model%face%corner(:, f)), &
            node => model%face%node(:, f))
          if (any(bottom == cshift(bottom, 1))) cycle
          do i = 1, merge(4, 1, size(node) == 9)
            n = n + 1
            model%bead_face(:, n) = node(:4)
            if (size(node) == 9) model%bead_face(:, n) = node(part_of_nine(:, i))
          end do
        end associate
      end do
    end if
    model%bead_face = model%bead_face(:, :n)
  end subroutine find_bead_faces

  !> Build a draw-bead; without its line if there was an error.
  subroutine build(self, spec, spacing, thickness, errors)
    type(drawbead_t), intent(out) :: self
    type(drawbead_spec_t), intent(in) :: spec
    !> Length of the intervals, and thickness of the sheet, mm.
    real(wp), intent(in) :: spacing, thickness
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: at
    real(wp), allocatable :: point(:), table(:, :)
    integer :: before

    before = errors%count
    at = spec%source%at("points")
    point = spec%point
    if (len(spec%file) > 0) then
      at = spec%source%at("file")
      call read_points(point, spec%file, at, errors)
    end if
    if (errors%count == before) call check_points(point, thickness, at, errors)
    call check_slopes(spec, thickness, errors)
    if (errors%count > before) return
    table = reshape(spec%table, [2, size(spec%table)/2])
    table(2, :) = spec%force*table(2, :)
    call new_drawbead(self, reshape(point, [2, size(point)/2]), table, spacing, thickness)
    self%name = spec%source%name
    self%tool = spec%tool
    self%from = spec%from
    self%normal = spec%normal
  end subroutine build

  !> Report a line without two points, and points that coincide.
  subroutine check_points(point, thickness, at, errors)
    real(wp), intent(in) :: point(:)
    real(wp), intent(in) :: thickness
    !> Where the line is given.
    type(location_t), intent(in) :: at
    type(error_list_t), intent(inout) :: errors

    integer :: i

    if (size(point) < 4) call errors%push_input(at, "the line has "//to_text(size(point)/2)// &
        " points", "two or more points", code="E132")
    do i = 3, size(point), 2
      if (norm2(point(i:i + 1) - point(i - 2:i - 1)) > shortest_segment*thickness) cycle
      call errors%push_input(at, "points "//to_text(i/2)//" and "//to_text(i/2 + 1)// &
          " of the line coincide", "points that differ", code="E150")
    end do
  end subroutine check_points

  !> Report a limit that falls faster than the elastic slip allows.
  subroutine check_slopes(spec, thickness, errors)
    type(drawbead_spec_t), intent(in) :: spec
    real(wp), intent(in) :: thickness
    type(error_list_t), intent(inout) :: errors

    integer :: i

    associate (table => spec%table, largest => maxval(spec%table(2::2)))
      do i = 3, size(table), 2
        if (table(i - 1) - table(i + 1) <= 0.5_wp*largest*(table(i) - table(i - 2)) &
            /(elastic_slip*thickness)) cycle
        call errors%push_input(spec%source%at("table"), "the force falls too fast: from path "// &
            to_text(table(i - 2), 4)//" to "//to_text(table(i), 4), "a fall by its largest "// &
            "value over "//to_text(2.0_wp*elastic_slip)//" thicknesses or more", code="E150")
      end do
    end associate
  end subroutine check_slopes

end module dd3_setup_drawbeads
