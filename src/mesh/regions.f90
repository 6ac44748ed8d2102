! SPDX-License-Identifier: GPL-3.0-or-later
!> Regions of a tailored blank: materials and thicknesses of the elements of its mesh. An element
!> belongs to the last region that holds its centre. At the border of two regions the columns of
!> nodes have the common part of both sections: the thicker one decreases over one element.
module dd3_mesh_regions
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : axis_name, newline, to_text
  use dd3_input_case, only : blank_spec_t, case_t, region_spec_t
  use dd3_mesh_mesh, only : mesh_t
  use dd3_mesh_weld_line, only : new_weld_line, weld_line_t
  implicit none
  private
  public :: new_weld_lines, set_regions

  !> Least common part of two sections over the thinner one.
  real(wp), parameter :: least_common = 0.5_wp
  !> Corners of an element, and of its lower face.
  integer, parameter :: n_corner = 8, n_lower = 4

contains

  !> Make the weld lines of all regions; they may be used if no error was added.
  subroutine new_weld_lines(line, case, errors)
    type(weld_line_t), allocatable, intent(out) :: line(:)
    !> With a blank, or without regions.
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    real(wp) :: centre(2)
    integer :: i

    allocate (line(size(case%region)))
    do i = 1, size(line)
      associate (blank => case%blank(1))
        centre = blank%origin(:2)
        if (.not. blank%radius > 0.0_wp) centre = centre + 0.5_wp*blank%size(:2)
        call new_weld_line(line(i), case%region(i), centre, norm2(blank%size(:2)), errors)
      end associate
    end do
  end subroutine new_weld_lines

  !> Set the materials and the thickness of a mesh by its regions, and their report.
  subroutine set_regions(mesh, case, line, natural, errors)
    !> Of uniform thickness, and of the material of the blank.
    type(mesh_t), intent(inout) :: mesh
    type(case_t), intent(in) :: case
    type(weld_line_t), intent(in) :: line(:)
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    integer :: region(mesh%n_element), e, i

    if (size(line) == 0) return
    region = 0
    do e = 1, mesh%n_element
      associate (centre => sum(mesh%x(:2, mesh%connectivity(:n_lower, e)), dim=2)/real(n_lower, wp))
        do i = 1, size(line)
          if (line(i)%holds(centre)) region(e) = i
        end do
      end associate
      if (region(e) == 0) cycle
      if (case%region(region(e))%material > 0) mesh%material(e) = case%region(region(e))%material
    end do
    do i = 1, size(line)
      if (.not. any(region == i)) call errors%push_input(case%region(i)%source%opened, &
          "no element has its centre in region '"//case%region(i)%source%called()//"'", &
          "a region with elements that no later one takes; a finer mesh", code="E154")
    end do
    if (errors%count > 0) return
    call set_thickness(mesh, case, region, natural, errors)
    mesh%report = report(mesh, case, line, region)
  end subroutine set_regions

  !> Move the nodes to the faces of the regions.
  subroutine set_thickness(mesh, case, region, natural, errors)
    type(mesh_t), intent(inout) :: mesh
    type(case_t), intent(in) :: case
    !> Of each element; 0 for the blank.
    integer, intent(in) :: region(:)
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    real(wp) :: face(2, mesh%n_node), thinnest(mesh%n_node), own(2)
    integer :: e, a, n

    associate (blank => case%blank(1), cell => mesh%connectivity)
      face = spread([-huge(1.0_wp), huge(1.0_wp)], 2, mesh%n_node)
      thinnest = huge(1.0_wp)
      do e = 1, mesh%n_element
        own = faces_of(blank, case%region, region(e))
        do a = 1, n_corner
          n = cell(a, e)
          face(:, n) = [max(face(1, n), own(1)), min(face(2, n), own(2))]
          thinnest(n) = min(thinnest(n), own(2) - own(1))
        end do
      end do
      do e = 1, mesh%n_element
        associate (n => cell(:n_corner, e))
          if (region(e) == 0 .or. all(face(2, n) - face(1, n) >= least_common*thinnest(n))) cycle
        end associate
        call errors%push_input(case%region(region(e))%source%at("step"), "the sections on both "// &
            "sides of the weld line have less than half of the thinner one in common", &
            "the same step in both regions, or step = both", code="E154")
        return
      end do
      do e = 1, mesh%n_element
        do a = n_corner + 1, mesh%n_element_node
          face(:, cell(a, e)) = matmul(face(:, cell(:n_lower, e)), weights(natural(:, a), natural))
        end do
      end do
      if (any(abs(face(2, :) - face(1, :) - blank%size(3)) > 0.0_wp)) mesh%thickness = 0.0_wp
      mesh%x(3, :) = blank%origin(3) + face(1, :) &
          + (mesh%x(3, :) - blank%origin(3))/blank%size(3)*(face(2, :) - face(1, :))
    end associate
  end subroutine set_thickness

  !> Return z of the lower and the upper face of a region over the lower face of the blank, mm.
  pure function faces_of(blank, region, i) result(face)
    type(blank_spec_t), intent(in) :: blank
    type(region_spec_t), intent(in) :: region(:)
    !> 0 for the blank.
    integer, intent(in) :: i
    real(wp) :: face(2)

    face = [0.0_wp, blank%size(3)]
    if (i == 0) return
    if (.not. region(i)%thickness > 0.0_wp) return
    associate (difference => region(i)%thickness - blank%size(3))
      select case (region(i)%step)
      case ("bottom")
        face(1) = -difference
      case ("both")
        face = face + 0.5_wp*difference*[-1.0_wp, 1.0_wp]
      case default
        face(2) = region(i)%thickness
      end select
    end associate
  end function faces_of

  !> Return the bilinear shape functions of the lower face at a natural point.
  pure function weights(point, natural) result(weight)
    real(wp), intent(in) :: point(3), natural(:, :)
    real(wp) :: weight(n_lower)

    weight = 0.25_wp*(1.0_wp + point(1)*natural(1, :n_lower)) &
        *(1.0_wp + point(2)*natural(2, :n_lower))
  end function weights

  !> Return a line on each region, with its end.
  function report(mesh, case, line, region) result(text)
    type(mesh_t), intent(in) :: mesh
    type(case_t), intent(in) :: case
    type(weld_line_t), intent(in) :: line(:)
    integer, intent(in) :: region(:)
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    do i = 1, size(line)
      associate (spec => case%region(i), blank => case%blank(1))
        text = text//"region "//spec%source%called()//": "//to_text(count(region == i))// &
            " elements of "//to_text(merge(spec%thickness, blank%size(3), &
            spec%thickness > 0.0_wp), 4)//" mm, "//case%material(merge(spec%material, &
            blank%material, spec%material > 0))%name//"; "
        if (line(i)%axis > 0) then
          text = text//"node line "//to_text(line(i)%number)//" across "// &
              axis_name(line(i)%axis)//" lies on the weld line, moved by up to "// &
              to_text(line(i)%moved, 3)//" mm"
        else
          text = text//"those with their centres in it; the line divides "// &
              to_text(n_divided(mesh, line(i)))
        end if
      end associate
      text = text//newline
    end do
  end function report

  !> Return the number of elements with corners on both sides of a weld line.
  pure integer function n_divided(mesh, line)
    type(mesh_t), intent(in) :: mesh
    type(weld_line_t), intent(in) :: line

    integer :: e, a, n

    n_divided = 0
    do e = 1, mesh%n_element
      n = count([(line%holds(mesh%x(:2, mesh%connectivity(a, e))), a=1, n_lower)])
      if (n > 0 .and. n < n_lower) n_divided = n_divided + 1
    end do
  end function n_divided

end module dd3_mesh_regions
