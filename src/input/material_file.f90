! SPDX-License-Identifier: GPL-3.0-or-later
!> A single material from a file or a text: its block *MATERIAL, read and checked as in a job. Other
!> blocks are skipped, so that the file may be a whole job; *PARAMETER and *INCLUDE take effect.
module dd3_input_material_file
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : join, same_name, text_t
  use dd3_input_block, only : deck_t
  use dd3_input_case, only : material_spec_t
  use dd3_input_check, only : check_blocks
  use dd3_input_cross_check, only : check_material
  use dd3_input_deck, only : read_deck
  use dd3_input_fill_material, only : fill_material
  use dd3_input_table, only : block_table
  implicit none
  private
  public :: read_material

contains

  !> Read a material. It is complete only if no error was added.
  subroutine read_material(material, file_name, name, errors, content)
    type(material_spec_t), intent(out) :: material
    character(len=*), intent(in) :: file_name
    !> Name of the material, in upper or lower case; empty for the only one.
    character(len=*), intent(in) :: name
    !> Sorted by line on return.
    type(error_list_t), intent(inout) :: errors
    !> Text in place of the file, whose name is then that in messages.
    character(len=*), intent(in), optional :: content

    type(deck_t) :: deck
    type(text_t) :: no_overrides(0)
    integer :: before

    before = errors%count
    call read_deck(deck, file_name, no_overrides, errors, content)
    if (errors%count == before) call keep_material(deck, file_name, name, errors)
    if (errors%count == before) call check_blocks(deck, block_table(), errors)
    if (errors%count == before) call fill_material(material, deck%block(1))
    if (errors%count == before) call check_material(material, errors)
    call errors%sort()
  end subroutine read_material

  !> Keep the blocks of the material alone, more than one if it is given twice.
  subroutine keep_material(deck, file_name, name, errors)
    type(deck_t), intent(inout) :: deck
    character(len=*), intent(in) :: file_name, name
    type(error_list_t), intent(inout) :: errors

    type(location_t) :: whole_file
    character(len=60), allocatable :: known(:)
    integer :: i, n

    whole_file%file = file_name
    allocate (known(0))
    n = 0
    do i = 1, deck%n_block
      if (deck%block(i)%keyword /= "material") cycle
      known = [character(len=60) :: known, deck%block(i)%name]
      if (name /= "" .and. .not. same_name(deck%block(i)%name, name)) cycle
      n = n + 1
      deck%block(n) = deck%block(i)
    end do
    deck%n_block = n
    if (size(known) == 0) then
      call errors%push_input(whole_file, "the block *MATERIAL is missing", "*MATERIAL name", &
          code="E121")
    else if (n == 0) then
      call errors%push_input(whole_file, "there is no material '"//name//"'", &
          "one of: "//join(known, " "), code="E113")
    else if (name == "" .and. n > 1) then
      call errors%push_input(whole_file, "there are several materials, and none is named", &
          "one of: "//join(known, " "), code="E113")
    end if
  end subroutine keep_material

end module dd3_input_material_file
