! SPDX-License-Identifier: GPL-3.0-or-later
!> From the input file to the case: read, check against the keyword table, fill, cross-check.
module dd3_input_reader
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : text_t
  use dd3_input_block, only : deck_t
  use dd3_input_case, only : case_t
  use dd3_input_check, only : check_deck
  use dd3_input_cross_check, only : cross_check
  use dd3_input_deck, only : read_deck
  use dd3_input_drawbead_check, only : check_drawbeads
  use dd3_input_region_check, only : check_regions
  use dd3_input_fill, only : fill_case
  use dd3_input_phase_check, only : check_phases
  use dd3_input_point_check, only : check_points
  use dd3_input_reference, only : check_references
  use dd3_input_table, only : block_row_t, block_table
  implicit none
  private
  public :: read_case

contains

  !> Read a job. The case is complete only if no error was added.
  subroutine read_case(case, file_name, overrides, errors)
    type(case_t), intent(out) :: case
    character(len=*), intent(in) :: file_name
    !> Texts `name=value` that override the parameters of the file.
    type(text_t), intent(in) :: overrides(:)
    !> Sorted by line on return.
    type(error_list_t), intent(inout) :: errors

    type(deck_t) :: deck
    type(block_row_t), allocatable :: table(:)

    call read_deck(deck, file_name, overrides, errors)
    if (deck%n_block > 0) then
      table = block_table()
      call check_deck(deck, table, file_name, errors)
      call check_references(deck, table, errors)
    end if
    call fill_case(case, deck)
    case%file = file_name
    if (deck%n_block > 0) then
      call cross_check(case, errors)
      call check_drawbeads(case, errors)
      call check_regions(case, errors)
      call check_phases(case, errors)
      call check_points(case, errors)
    end if
    call errors%sort()
  end subroutine read_case

end module dd3_input_reader
