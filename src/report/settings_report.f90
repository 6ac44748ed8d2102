! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings that follow from the model where the input gives no value, as text for `--check` and the
!> log: contact, limits of the predictor, tolerance of the iterations, lengths of the draw-beads on
!> the initial sheet.
module dd3_report_settings_report
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks
  use dd3_base_text, only : newline, to_text
  use dd3_contact_compliant, only : layer_gap
  use dd3_model_model, only : model_t
  use dd3_model_contact_layer, only : contact_penalty
  use dd3_model_phase, only : phase_t
  use dd3_model_terms_bead_points, only : bead_point_t, covered_length, find_bead_points
  use dd3_process_norm, only : final_tolerance, opening_phase_tolerance
  use dd3_settings_accuracy, only : mixed_defaults
  use dd3_settings_limits, only : limit_spec_t
  implicit none
  private
  public :: contact_report, limits_report, drawbead_report, initial_bead_lengths

  !> Pressures whose gap is reported, MPa.
  real(wp), parameter :: reported_pressure(3) = [1.0_wp, 100.0_wp, 500.0_wp]

contains

  !> Return the settings of the contact; empty without candidates.
  function contact_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    text = changes(model, contact_settings)
  end function contact_report

  !> Return the limits of the predictor and the tolerance of the iterations.
  function limits_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    text = changes(model, limits_settings)//changes(model, tolerance_settings)
  end function limits_report

  !> Return a line for the first phase and for each later one with other settings.
  function changes(model, settings) result(text)
    type(model_t), intent(in) :: model
    procedure(contact_settings) :: settings
    character(len=:), allocatable :: text

    character(len=:), allocatable :: before, here
    integer :: i

    text = ""
    before = ""
    if (.not. allocated(model%phase)) return
    do i = 1, size(model%phase)
      here = settings(model, i)
      if (here == before) cycle
      if (i > 1) text = text//"from phase '"//model%phase(i)%name//"': "
      text = text//here//newline
      before = here
    end do
  end function changes

  !> Return the settings of the contact in a phase: the gap under pressure in the compliant
  !> formulation, the penalty in the mixed one, and the search distance.
  function contact_settings(model, i) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    character(len=:), allocatable :: text

    text = ""
    if (model%part%n_point == 0) return
    associate (phase => model%phase(i))
      if (phase%mixed) then
        text = "contact: "//penalties(model, phase)
      else
        text = "contact: "//gaps(model, phase)
      end if
      text = text//", search distance "//to_text(phase%search_distance, 4)//" mm"
      if (abs(phase%search_distance - model%thickness) <= 0.0_wp) text = text//" (the thickness)"
    end associate
  end function contact_settings

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
    real(wp) :: penalty(model%n_contact), ends(2)
    integer :: c

    penalty = [(contact_penalty(model, phase, c), c=1, model%n_contact)]
    ends = [maxval(penalty), -minval(penalty)]
    call largest_over_ranks(2, ends)
    smallest = to_text(-ends(2), 4)
    largest = to_text(ends(1), 4)
    text = "penalty "//smallest
    if (smallest /= largest) text = text//" to "//largest
    text = text//" N/mm"
    if (phase%penalty <= 0.0_wp) text = text//" (automatic)"
  end function penalties

  !> Return the limits of a phase.
  function limits_settings(model, i) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    character(len=:), allocatable :: text

    associate (limits => model%phase(i)%limits)
      text = "limits of an increment: strain "//value(limits%strain, "")//", rotation "// &
          value(limits%rotation, " degrees")//", depth "//value(limits%depth, " thicknesses")// &
          ", r_max "//value(limits%r_max, "")
      if (.not. model%phase(i)%mixed) return
      if (mixed_defaults(limits) /= "") text = text//" ("//mixed_defaults(limits)//")"
    end associate
  end function limits_settings

  !> Return the tolerance in a phase, and that of the input where it is larger.
  function tolerance_settings(model, i) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: i
    character(len=:), allocatable :: text

    associate (phase => model%phase(i), given => model%phase(i)%newton%tolerance)
      text = "tolerance of the iterations: "
      if (any(phase%withdrawn)) text = text//to_text(opening_phase_tolerance(phase), 3)// &
          " while tools are withdrawn, then "
      text = text//to_text(final_tolerance(phase), 3)
      if (final_tolerance(phase) < given) text = text//", as the sheet is free or has its weight"
      if (final_tolerance(phase) < given .or. any(phase%withdrawn)) then
        text = text//" (tolerance of *NEWTON "//to_text(given, 3)//")"
      end if
    end associate
  end function tolerance_settings

  !> Return a limit with its unit.
  pure function value(limit, unit) result(text)
    type(limit_spec_t), intent(in) :: limit
    !> After a blank, or empty.
    character(len=*), intent(in) :: unit
    character(len=:), allocatable :: text

    text = "off"
    if (limit%active) text = to_text(limit%value, 3)//unit
  end function value

  !> Return a line for each draw-bead; empty without draw-beads.
  function drawbead_report(model) result(text)
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    real(wp), allocatable :: length(:)
    integer :: b

    length = initial_bead_lengths(model)
    text = ""
    do b = 1, size(length)
      associate (bead => model%drawbead(b))
        text = text//"draw-bead '"//bead%name//"': "//to_text(bead%length(), 4)//" mm long, "// &
            to_text(length(b), 4)//" mm of it on the sheet, "//to_text(size(bead%line, 3))// &
            " intervals"//newline
      end associate
    end do
  end function drawbead_report

  !> Return the lengths of the draw-beads on the sheet at the start, mm.
  function initial_bead_lengths(model) result(length)
    type(model_t), intent(in) :: model
    real(wp), allocatable :: length(:)

    type(bead_point_t), allocatable :: point(:)
    integer :: b

    allocate (length(0))
    if (.not. allocated(model%drawbead)) return
    call find_bead_points(model, [(.true., b=1, size(model%drawbead))], &
        model%start_positions(), point)
    length = [(covered_length(point, b), b=1, size(model%drawbead))]
  end function initial_bead_lengths

end module dd3_report_settings_report
