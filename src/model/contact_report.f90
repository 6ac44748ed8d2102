!> Settings of the contact as text, for `--check` and the log: the gap under pressure in the
!> compliant formulation, the penalty in the mixed one, and the search distance. Without values in
!> the input they follow from the model. Gaps of the layers at the end of a phase.
module dd3_model_contact_report
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : newline, to_text
  use dd3_contact_compliant, only : gap_under_force, layer_gap
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_layer, only : layer_at
  use dd3_model_model, only : model_t
  use dd3_model_penalty, only : contact_penalty
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  implicit none
  private
  public :: contact_report, gap_note

  !> Pressures whose gap is reported, MPa.
  real(wp), parameter :: reported_pressure(3) = [1.0_wp, 100.0_wp, 500.0_wp]

contains

  !> Return a line for the first phase and for each later one with other values; empty without
  !> candidates.
  function contact_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    integer :: i

    text = ""
    if (model%n_contact == 0) return
    do i = 1, size(model%phase)
      if (i > 1) then
        if (same_values(model%phase(i), model%phase(i - 1))) cycle
        text = text//"from phase '"//model%phase(i)%name//"': "
      end if
      text = text//values(model, model%phase(i))//newline
    end do
  end function contact_report

  !> Whether two phases have the same settings.
  pure logical function same_values(a, b)
    type(phase_t), intent(in) :: a, b

    same_values = (a%mixed .eqv. b%mixed) .and. abs(a%layer - b%layer) <= 0.0_wp .and. &
        abs(a%penalty - b%penalty) <= 0.0_wp .and. abs(a%search_distance - b%search_distance) <= 0.0_wp
  end function same_values

  !> Return the values of a phase.
  function values(model, phase) result(text)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    character(len=:), allocatable :: text

    if (phase%mixed) then
      text = "contact: "//penalties(model, phase)
    else
      text = "contact: "//gaps(model, phase)
    end if
    text = text//", search distance "//to_text(phase%search_distance, 4)//" mm"
    if (abs(phase%search_distance - model%thickness) <= 0.0_wp) text = text//" (the thickness)"
  end function values

  !> Return the height of the layer, and the gaps that some pressures leave, of the sheet's first
  !> material.
  function gaps(model, phase) result(text)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    character(len=:), allocatable :: text

    integer :: i

    associate (height => phase%layer*model%thickness, &
        young => model%material(model%material_of(1))%young)
      text = "layer "//to_text(height, 3)//" mm, in it gaps of"
      do i = 1, size(reported_pressure)
        if (i > 1) text = text//","
        text = text//" "//to_text(height*layer_gap(reported_pressure(i), young), 2)
      end do
    end associate
    text = text//" mm at"
    do i = 1, size(reported_pressure)
      if (i > 1) text = text//","
      text = text//" "//to_text(nint(reported_pressure(i)))
    end do
    text = text//" MPa"
  end function gaps

  !> Return the smallest and the largest penalty of the candidates.
  function penalties(model, phase) result(text)
    type(model_t), intent(in) :: model
    type(phase_t), intent(in) :: phase
    character(len=:), allocatable :: text

    character(len=:), allocatable :: smallest, largest
    real(wp) :: penalty(model%n_contact)
    integer :: c

    penalty = [(contact_penalty(model, phase, c), c=1, model%n_contact)]
    smallest = to_text(minval(penalty), 4)
    largest = to_text(maxval(penalty), 4)
    text = "penalty "//smallest
    if (smallest /= largest) text = text//" to "//largest
    text = text//" N/mm"
    if (phase%penalty <= 0.0_wp) text = text//" (automatic)"
  end function penalties

  !> Return a note on the mean gap between sheet and tools, weighted by the contact forces: what the
  !> layers keep the sheet off the tools. Empty in the mixed formulation and without contact.
  function gap_note(model, state) result(text)
    type(model_t), intent(in) :: model
    !> State at the end of the phase.
    type(state_t), intent(in) :: state
    character(len=:), allocatable :: text

    real(wp) :: moment(model%n_tool), total(model%n_tool), force
    integer :: c, tool

    text = ""
    associate (phase => model%phase(state%phase))
      if (phase%mixed) return
      moment = 0.0_wp
      total = 0.0_wp
      do c = 1, model%n_contact
        if (state%status(c) == status_gap) cycle
        force = norm2(state%lambda(:, c))
        associate (t => state%contact_tool(c))
          moment(t) = moment(t) + force*gap_under_force(layer_at(model, phase, c), force)
          total(t) = total(t) + force
        end associate
      end do
      do tool = 1, model%n_tool
        if (total(tool) <= 0.0_wp) cycle
        text = text//", "//to_text(moment(tool)/total(tool), 2)//" mm at '"// &
            model%tool(tool)%name//"'"
      end do
      if (len(text) > 0) text = "phase '"//phase%name// &
          "': mean gap in the contact layers by force"//text(2:)
    end associate
  end function gap_note

end module dd3_model_contact_report
