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
    integer :: element

    call find_thinnest(model, state, element, thinning)
    has_necked = thinning > necked
  end function has_necked

  !> Return a warning on a sheet that has necked; empty otherwise.
  function necking_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: thinning
    integer :: element

    text = ""
    call find_thinnest(model, state, element, thinning)
    if (thinning > necked) text = "the sheet is thinned by "//to_text(100.0_wp*thinning, 3)// &
        " % in element "//to_text(element)//", beside "//place_of_node(model, state, &
        model%connectivity(1, element))//": it has necked or torn there, and what follows "// &
        "depends on the length of the elements"
  end function necking_warning

  !> Find the element that is thinned most, and its thinning over the initial thickness; zero
  !> without columns of nodes. A neck is as wide as an element: at its nodes, where the thickness is
  !> the mean of the elements around, it is hidden in part.
  pure subroutine find_thinnest(model, state, element, thinning)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(out) :: element
    real(wp), intent(out) :: thinning

    real(wp) :: nodal(model%n_node), start(model%n_element), now(model%n_element)

    call sheet_thickness(model, model%x0, nodal, start)
    call sheet_thickness(model, state%x, nodal, now)
    now = merge(1.0_wp - now/max(start, tiny(1.0_wp)), 0.0_wp, start > 0.0_wp)
    element = maxloc(now, dim=1)
    thinning = now(element)
  end subroutine find_thinnest

end module dd3_report_necked_sheet
