! SPDX-License-Identifier: GPL-3.0-or-later
!> Check of the points of a material's forming limit curve.
module dd3_input_forming_limit_check
  use dd3_base_error, only : error_list_t
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_block, only : block_t
  implicit none
  private
  public :: check_forming_limit

  !> Largest logarithmic strain; larger values are in per cent.
  real(wp), parameter :: largest_strain = 2.0_wp
  character(len=*), parameter :: key = "forming_limit", &
      pairs = "minor and major logarithmic strain of two or more points, as in -0.2 0.5 0 0.3"

contains

  !> Check that the points are pairs of minor and major strain in the order of the minor strain.
  subroutine check_forming_limit(block, errors)
    !> A block *MATERIAL.
    type(block_t), intent(in) :: block
    type(error_list_t), intent(inout) :: errors

    real(wp), allocatable :: strain(:)
    integer :: i

    if (.not. block%has(key)) return
    strain = block%numbers(key)
    if (size(strain) < 4 .or. mod(size(strain), 2) > 0) then
      call errors%push_input(block%at(key), "expected the strains of two or more points, got "// &
          to_text(size(strain))//" numbers", pairs, code="E132")
      return
    end if
    associate (value => block%entry(block%find(key))%value)
      do i = 1, size(strain), 2
        if (any(abs(strain(i:i + 1)) > largest_strain)) then
          call errors%push_input(value(i)%at, "strains above 2", "fractions, not per cent", &
              code="E133")
        else if (strain(i) > strain(i + 1)) then
          call errors%push_input(value(i)%at, "the minor strain is above the major one", pairs, &
              code="E134")
        else if (i > 1) then
          if (strain(i) <= strain(i - 2)) call errors%push_input(value(i)%at, &
              "the minor strain does not increase", pairs, code="E134")
        end if
      end do
    end associate
  end subroutine check_forming_limit

end module dd3_input_forming_limit_check
