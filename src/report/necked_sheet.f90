! SPDX-License-Identifier: GPL-3.0-or-later
!> Sheet that has necked: behind the maximum of the force the strains concentrate within a strip
!> about as wide as the sheet is thick, or, in a calculation, as its elements are long.
module dd3_report_necked_sheet
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_model_model, only : model_t
  use dd3_model_sheet_thickness, only : sheet_thickness
  use dd3_model_state, only : state_t
  use dd3_report_node_report, only : place_of_node
  implicit none
  private
  public :: has_necked, necking_warning

  !> Thinning above which the sheet counts as necked. Forming limits of sheets of 1 to 3 mm in plane
  !> strain are 27 to 40 % of thinning at the most (Keeler and Brazier 1977, n = 0.21).
  real(wp), parameter :: necked = 0.4_wp

contains

  !> Whether the sheet has necked anywhere.
  pure logical function has_necked(model, state)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state

    real(wp) :: thinning
    integer :: node

    call find_thinnest(model, state, node, thinning)
    has_necked = thinning > necked
  end function has_necked

  !> Return a warning on a sheet that has necked; empty otherwise.
  function necking_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: thinning
    integer :: node

    text = ""
    call find_thinnest(model, state, node, thinning)
    if (thinning > necked) text = "the sheet is thinned by "//to_text(100.0_wp*thinning, 3)// &
        " % at "//place_of_node(model, state, node)//": it has necked or torn there, and what "// &
        "follows depends on the length of the elements"
  end function necking_warning

  !> Find the node at which the sheet is thinned most, and the thinning there, over the initial
  !> thickness; zero without columns of nodes.
  pure subroutine find_thinnest(model, state, node, thinning)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(out) :: node
    real(wp), intent(out) :: thinning

    real(wp) :: start(model%n_node), now(model%n_node), cell(model%n_element)

    call sheet_thickness(model, model%x0, start, cell)
    call sheet_thickness(model, state%x, now, cell)
    now = merge(1.0_wp - now/max(start, tiny(1.0_wp)), 0.0_wp, start > 0.0_wp)
    node = maxloc(now, dim=1)
    thinning = now(node)
  end subroutine find_thinnest

end module dd3_report_necked_sheet
