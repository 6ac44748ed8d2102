!> Warnings of magnitudes that nearly always mean a wrong unit or a slip of the pen. Nothing is
!> refused: a unit cube of a model material is a fair case.
module dd3_app_warnings
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : location_t
  use dd3_base_text, only : text_t, to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: unit_warnings

  !> Young's moduli of sheet metals lie well between these, MPa.
  real(wp), parameter :: least_young = 1.0e3_wp, largest_young = 1.0e6_wp
  !> The first flow stress of a sheet metal over Young's modulus lies well between these.
  real(wp), parameter :: least_strain = 1.0e-5_wp, largest_strain = 0.1_wp
  !> Thicknesses of sheets lie well between these, mm.
  real(wp), parameter :: least_thickness = 1.0e-2_wp, largest_thickness = 1.0e2_wp
  !> Equivalent stress of unit tension along rolling: 1 in most published sets, near it in others.
  real(wp), parameter :: least_tension = 0.8_wp, largest_tension = 1.25_wp
  !> What is said of a magnitude.
  character(len=*), parameter :: about_units = "unusual; units are N, mm and MPa"

contains

  !> The warnings, each with file and line.
  subroutine unit_warnings(case, model, warnings)
    !> The case, without errors.
    type(case_t), intent(in) :: case
    !> The model made of it.
    type(model_t), intent(in) :: model
    !> The warnings, a line each.
    type(text_t), allocatable, intent(out) :: warnings(:)

    integer :: i

    allocate (warnings(0))
    do i = 1, size(case%material)
      associate (material => case%material(i))
        if (outside(material%young, least_young, largest_young)) then
          call add(warnings, material%source%at("young"), "young = "//to_text(material%young)// &
              " MPa of material '"//material%source%called()//"'", about_units)
        end if
        call look_at_criterion(case, model, i, warnings)
        call look_at_flow_stress(case, model, i, warnings)
      end associate
    end do
    do i = 1, size(case%blank)
      associate (blank => case%blank(i))
        if (.not. outside(blank%size(3), least_thickness, largest_thickness)) cycle
        call add(warnings, blank%source%at("size"), "thickness = "//to_text(blank%size(3))// &
            " mm of blank '"//blank%source%called()//"'", about_units)
      end associate
    end do
  end subroutine unit_warnings

  !> Warns of a criterion whose yield stress along rolling is far from the hardening law's.
  subroutine look_at_criterion(case, model, i, warnings)
    !> The case.
    type(case_t), intent(in) :: case
    !> The model.
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    !> Receives the warning.
    type(text_t), allocatable, intent(inout) :: warnings(:)

    real(wp), parameter :: tension(6) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    real(wp) :: equivalent

    equivalent = model%material(i)%laws%criterion%value(tension)
    if (.not. outside(equivalent, least_tension, largest_tension)) return
    call add(warnings, case%material(i)%yield%at, "material '"//case%material(i)%source%called()// &
        "' yields along rolling at "//to_text(1/equivalent, 3)//" times the flow stress of its "// &
        "hardening law", "unusual; are these the parameters of "//case%material(i)%yield%name//"?")
  end subroutine look_at_criterion

  !> Warns of a flow stress that is large or nothing beside Young's modulus.
  subroutine look_at_flow_stress(case, model, i, warnings)
    !> The case.
    type(case_t), intent(in) :: case
    !> The model.
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    !> Receives the warning.
    type(text_t), allocatable, intent(inout) :: warnings(:)

    real(wp) :: start(model%material(i)%n_internal), stress

    start = 0.0_wp
    stress = model%material(i)%flow_stress(start)
    if (.not. outside(stress, least_strain*case%material(i)%young, &
        largest_strain*case%material(i)%young)) return
    call add(warnings, case%material(i)%hardening%at, "first flow stress = "// &
        to_text(stress, 4)//" MPa of material '"//case%material(i)%source%called()// &
        "', young = "// &
        to_text(case%material(i)%young)//" MPa", about_units)
  end subroutine look_at_flow_stress

  !> Whether a value lies outside its bounds.
  pure logical function outside(value, lower, upper)
    !> The value and its bounds.
    real(wp), intent(in) :: value, lower, upper

    outside = value < lower .or. value > upper
  end function outside

  !> Adds a warning.
  subroutine add(warnings, at, what, remark)
    !> The warnings.
    type(text_t), allocatable, intent(inout) :: warnings(:)
    !> Where the value is written.
    type(location_t), intent(in) :: at
    !> The value, in words.
    character(len=*), intent(in) :: what
    !> What is said of it.
    character(len=*), intent(in) :: remark

    type(text_t) :: warning

    warning%s = ""
    if (allocated(at%file)) warning%s = at%file//":"//to_text(at%line)//": "
    warning%s = warning%s//"warning: "//what//": "//remark
    warnings = [warnings, warning]
  end subroutine add

end module dd3_app_warnings
