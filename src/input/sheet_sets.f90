! SPDX-License-Identifier: GPL-3.0-or-later
!> Names of the node sets that the program makes for a sheet, and portions of a round blank.
module dd3_input_sheet_sets
  use dd3_input_block, only : deck_t
  use dd3_input_case, only : blank_sets
  implicit none
  private
  public :: sheet_sets, round_sets, n_quarters, set_name_length

  integer, parameter :: set_name_length = 5
  !> Sets of a mesh from a file, and of the sheet of another run, besides its own.
  character(len=set_name_length), parameter :: mesh_sets(3) = &
      [character(len=set_name_length) :: "z_min", "z_max", "all"]

contains

  !> Return the sets of a round blank: those of its planes of symmetry, then rim, faces and all.
  pure function round_sets(portion) result(name)
    !> quarter, half or full.
    character(len=*), intent(in) :: portion
    character(len=set_name_length), allocatable :: name(:)

    name = [character(len=set_name_length) :: "x_min", "y_min", "rim", "z_min", "z_max", "all"]
    if (portion == "half") name = name([1, 3, 4, 5, 6])
    if (portion == "full") name = name(3:)
  end function round_sets

  !> Return the number of quarters of a portion of a round blank.
  pure integer function n_quarters(portion)
    !> quarter, half or full.
    character(len=*), intent(in) :: portion

    n_quarters = 1
    if (portion == "half") n_quarters = 2
    if (portion == "full") n_quarters = 4
  end function n_quarters

  !> Return the sets of the sheet of an input; those of a box if it has none.
  pure function sheet_sets(deck) result(name)
    type(deck_t), intent(in) :: deck
    character(len=set_name_length), allocatable :: name(:)

    integer :: i

    name = blank_sets
    do i = 1, deck%n_block
      associate (block => deck%block(i))
        if (block%keyword == "mesh" .or. block%keyword == "start") name = mesh_sets
        if (block%keyword /= "blank" .or. block%find("radius") == 0) cycle
        name = round_sets(block%word("portion"))
      end associate
    end do
  end function sheet_sets

end module dd3_input_sheet_sets
