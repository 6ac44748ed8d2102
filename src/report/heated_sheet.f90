! SPDX-License-Identifier: GPL-3.0-or-later
!> Sheet that plastic work has heated until little of its flow stress is left.
module dd3_report_heated_sheet
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_base_text, only : to_text
  use dd3_model_model, only : model_t
  use dd3_model_state, only : state_t
  use dd3_report_node_report, only : place_of_node
  implicit none
  private
  public :: heat_warning

  !> Factor on the flow stress below which the sheet is near melting.
  real(wp), parameter :: little = 0.1_wp

contains

  !> Return a warning on a sheet that is near melting; empty otherwise.
  function heat_warning(model, state) result(text)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    !> Of each element: part of the flow stress that is lost, and the rise of the temperature.
    real(wp) :: lost(model%n_element), rise(model%n_element), factor, slope
    integer :: e, i

    text = ""
    if (.not. any(model%material%laws%at_temperature > 0)) return
    lost = 0.0_wp
    rise = 0.0_wp
    do i = 1, size(model%part%element)
      e = model%part%element(i)
      associate (laws => model%material(model%material_of(e))%laws)
        if (.not. (laws%at_temperature > 0 .and. allocated(laws%temperature%law))) cycle
        rise(e) = maxval(state%sheet%internal_variables(laws%at_temperature, :, i))
        call laws%temperature%law%factor(laws%heat%initial + rise(e), factor, slope)
        lost(e) = 1.0_wp - factor
      end associate
    end do
    call largest_over_ranks(size(lost), lost)
    call largest_over_ranks(size(rise), rise)
    e = maxloc(lost, dim=1)
    if (lost(e) < 1.0_wp - little) return
    text = "plastic work has heated element "//to_text(e)//", beside "//place_of_node(model, &
        state, model%connectivity(1, e))//", to "//to_text(model%material(model%material_of( &
        e))%laws%heat%initial + rise(e), 4)//": "//to_text(100*(1.0_wp - lost(e)), 2)// &
        " % of the flow stress is left"
  end function heat_warning

end module dd3_report_heated_sheet
