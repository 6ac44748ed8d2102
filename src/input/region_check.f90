! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of relations between the values of the regions of a blank.
module dd3_input_region_check
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_block, only : block_t
  use dd3_input_case, only : case_t
  implicit none
  private
  public :: check_regions

contains

  !> Check all regions. Blocks with earlier errors are skipped.
  subroutine check_regions(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    integer :: i

    do i = 1, size(case%region)
      associate (region => case%region(i))
        if (.not. region%source%valid) cycle
        if (size(case%blank) == 0) call errors%push_input(region%source%opened, &
            "a region is a part of *BLANK, which this input does not have", &
            "*BLANK; the elements of *MESH have material_of", code="E124")
        call check_line(region%source, errors)
        if (region%source%has("thickness")) cycle
        if (region%source%has("step")) call errors%push_input(region%source%at("step"), &
            "a region of the thickness of the blank has no step", "thickness = t", code="E125")
        if (.not. region%source%has("material")) call errors%push_input(region%source%opened, &
            "region '"//region%source%called()//"' is as the blank", &
            "thickness = t or material = name", code="E125")
      end associate
    end do
  end subroutine check_regions

  !> Check that the line is given once; points of the input must be pairs.
  subroutine check_line(block, errors)
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    integer :: n

    if (block%has("points") .eqv. block%has("file")) then
      call errors%push_input(block%opened, "region '"//block%called()//"' has "// &
          trim(merge("both file and points", "no line             ", block%has("file"))), &
          "points = x1 y1 x2 y2 ..., or file = a file of points", code="E132")
    else if (block%has("points")) then
      n = size(block%numbers("points"))
      if (mod(n, 2) > 0) call errors%push_input(block%at("points"), to_text(n)// &
          " numbers", "points = x1 y1 x2 y2 ...", code="E132")
    end if
  end subroutine check_line

end module dd3_input_region_check
