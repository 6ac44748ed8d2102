! SPDX-License-Identifier: GPL-3.0-or-later
!> Warnings of unusual materials: values most often caused by a wrong unit or a parameter in the
!> wrong place.
module dd3_app_material_warnings
  use dd3_app_unusual, only : add_unusual, outside, unusual_unit
  use dd3_base_error, only : location_t
  use dd3_base_kinds, only : sqrt2, wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: material_warnings

  !> Usual range of Young's modulus, MPa.
  real(wp), parameter :: least_young = 1.0e3_wp, largest_young = 1.0e6_wp
  !> Usual range of the modulus at large plastic strain divided by Young's modulus; published sheets
  !> have 0.7 to 0.95.
  real(wp), parameter :: least_chord = 0.4_wp, largest_chord = 1.0_wp + 1.0e-6_wp
  !> Usual range of the initial flow stress divided by Young's modulus.
  real(wp), parameter :: least_strain = 1.0e-5_wp, largest_strain = 0.1_wp
  !> Usual range of the equivalent stress under unit tension in the rolling direction; 1 in most
  !> published sets.
  real(wp), parameter :: least_tension = 0.8_wp, largest_tension = 1.25_wp
  !> Usual range of r-values; a published set for a titanium alloy has 19.
  real(wp), parameter :: least_r = 0.05_wp, largest_r = 25.0_wp
  !> Usual range of the density, t/mm3.
  real(wp), parameter :: least_density = 1.0e-10_wp, largest_density = 3.0e-8_wp
  !> Rate, 1/s, and the largest usual factor there: mild steel has 1.5.
  real(wp), parameter :: fast = 1.0_wp, largest_factor = 3.0_wp
  !> Heating after which a law of the temperature acts, below 273, and largest usual increase of the
  !> flow stress by it.
  real(wp), parameter :: warm = 250.0_wp, largest_increase = 1.2_wp

contains

  !> Add the warnings of all materials.
  subroutine material_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    integer :: i, before

    do i = 1, size(case%material)
      associate (material => case%material(i))
        if (outside(material%young, least_young, largest_young)) then
          call add_unusual(warnings, "W001", material%source%at("young"), "young = "// &
              to_text(material%young)//" MPa of material '"//material%source%called()//"'", &
              unusual_unit)
        end if
        before = warnings%count
        call check_criterion(case, model, i, warnings)
        if (warnings%count == before) call check_r_values(case, model, i, warnings)
        call check_flow_stress(case, model, i, warnings)
        call check_density(case, i, warnings)
        call check_modulus(case, model, i, warnings)
        call check_rate(case, model, i, warnings)
        call check_temperature(case, model, i, warnings)
      end associate
    end do
  end subroutine material_warnings

  !> Warn of a modulus that falls by an unusual part of Young's modulus.
  subroutine check_modulus(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    !> Plastic strain at which published moduli have saturated.
    real(wp), parameter :: large = 1.0_wp
    real(wp) :: young

    if (.not. allocated(model%material(i)%laws%modulus%law)) return
    associate (material => case%material(i))
      young = model%material(i)%laws%modulus%law%young_at(material%young, large)
      if (.not. outside(young/material%young, least_chord, largest_chord)) return
      call add_unusual(warnings, "W025", material%modulus%at, "modulus of material '"// &
          material%source%called()//"' at a plastic strain of 1 = "//to_text(young, 4)// &
          " MPa, young = "//to_text(material%young)//" MPa", &
          "unusual; sheets lose 5 to 30 % of it, and the unit is MPa")
    end associate
  end subroutine check_modulus

  !> Warn of a law of the rate that raises the flow stress by an unusual factor.
  subroutine check_rate(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    real(wp) :: factor, slope

    if (.not. allocated(model%material(i)%laws%rate%law)) return
    associate (material => case%material(i))
      call model%material(i)%laws%rate%law%factor(fast, factor, slope)
      if (factor <= largest_factor) return
      call add_unusual(warnings, "W026", material%rate%at, "flow stress of material '"// &
          material%source%called()//"' at 1 /s = "//to_text(factor, 3)//" times the static one", &
          "unusual; steels have less than 1.6, aluminium about 1: the unit of rates is 1/s")
    end associate
  end subroutine check_rate

  !> Warn of a law of the temperature that does not act near the initial temperature, as one with
  !> parameters in kelvin, or that raises the flow stress.
  subroutine check_temperature(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    !> Temperatures above the initial one at which the factor is compared.
    integer, parameter :: n = 20
    real(wp), parameter :: step = 25.0_wp
    character(len=:), allocatable :: what
    real(wp) :: start, factor(n), slope
    integer :: k

    if (.not. allocated(model%material(i)%laws%temperature%law)) return
    associate (material => case%material(i), law => model%material(i)%laws%temperature%law)
      call law%factor(material%initial_temperature, start, slope)
      do k = 1, n
        call law%factor(material%initial_temperature + step*real(k, wp), factor(k), slope)
      end do
      what = "law of the temperature of material '"//material%source%called()//"'"
      if (.not. any(abs(factor(:nint(warm/step)) - start) > 0.0_wp)) then
        call add_unusual(warnings, "W027", material%temperature%at, what//" does not act from "// &
            to_text(material%initial_temperature)//", initial_temperature, to "// &
            to_text(material%initial_temperature + warm), &
            "unusual; give both on one scale, initial_temperature = 293 with a law in kelvin")
      else if (maxval(factor) > largest_increase*start) then
        call add_unusual(warnings, "W027", material%temperature%at, what// &
            " raises the flow stress by the factor "//to_text(maxval(factor)/start, 3)//" at "// &
            to_text(material%initial_temperature + step*real(maxloc(factor, dim=1), wp)), &
            "unusual; metals soften when they are heated")
      end if
    end associate
  end subroutine check_temperature

  !> Warn if the yield stress in the rolling direction is far from the flow stress.
  subroutine check_criterion(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    real(wp), parameter :: tension(6) = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    real(wp) :: equivalent

    equivalent = model%material(i)%laws%criterion%value(tension)
    if (.not. outside(equivalent, least_tension, largest_tension)) return
    call add_unusual(warnings, "W002", case%material(i)%yield%at, "material '"// &
        case%material(i)%source%called()//"' yields in the rolling direction at "// &
        to_text(1/equivalent, 3)//" times the flow stress of its hardening law", &
        "unusual; are these the parameters of "//case%material(i)%yield%name//"?")
  end subroutine check_criterion

  !> Warn if the initial flow stress is unusually large or small compared with Young's modulus.
  subroutine check_flow_stress(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    real(wp) :: start(model%material(i)%n_internal), stress

    start = 0.0_wp
    stress = model%material(i)%flow_stress(start)
    if (.not. outside(stress, least_strain*case%material(i)%young, &
        largest_strain*case%material(i)%young)) return
    call add_unusual(warnings, "W003", case%material(i)%hardening%at, "initial flow stress = "// &
        to_text(stress, 4)//" MPa of material '"//case%material(i)%source%called()// &
        "', young = "//to_text(case%material(i)%young)//" MPa", unusual_unit)
  end subroutine check_flow_stress

  !> Warn of r-values that are most often per cent, or the parameters of another law.
  subroutine check_r_values(case, model, i, warnings)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    character(len=*), parameter :: name(3) = ["r0 ", "r45", "r90"]
    character(len=:), allocatable :: remark
    type(location_t) :: at
    real(wp) :: r(3)
    integer :: k, p

    r = [(r_value(model, i, 45*(k - 1)), k=1, 3)]
    if (all(r >= least_r .and. r <= largest_r)) return
    associate (law => case%material(i)%yield)
      at = law%at
      do p = size(law%parameter), 1, -1
        k = findloc(name == law%parameter(p)%key, .true., dim=1)
        if (k == 0) cycle
        if (outside(r(k), least_r, largest_r)) at = law%parameter(p)%at
      end do
    end associate
    remark = "unusual; they are ratios of the strains along width and thickness"
    k = maxloc(r, dim=1)
    if (r(k) > largest_r .and. r(k) < 100*largest_r) remark = remark//", not per cent: "// &
        to_text(r(k)/100, 4)//" for "//to_text(r(k), 4)//"?"
    call add_unusual(warnings, "W021", at, "material '"//case%material(i)%source%called()// &
        "' has the r-values "//to_text(r(1), 4)//", "//to_text(r(2), 4)//", "//to_text(r(3), 4)// &
        " at 0, 45, 90 degrees from the rolling direction", remark)
  end subroutine check_r_values

  !> Return the r-value of a material in tension: the ratio of the plastic strains along the width
  !> and the thickness.
  real(wp) function r_value(model, i, angle)
    type(model_t), intent(in) :: model
    !> Number of the material, and angle from the rolling direction, degrees: 0, 45 or 90.
    integer, intent(in) :: i, angle

    real(wp) :: c, s, stress(6), normal(6), value

    c = merge(sqrt2/2, merge(1.0_wp, 0.0_wp, angle == 0), angle == 45)
    s = merge(sqrt2/2, merge(1.0_wp, 0.0_wp, angle == 90), angle == 45)
    stress = [c**2, s**2, 0.0_wp, 0.0_wp, 0.0_wp, sqrt2*s*c]
    call model%material(i)%laws%criterion%gradient(stress, value, normal)
    r_value = huge(1.0_wp)
    if (abs(normal(3)) > tiny(1.0_wp)) then
      r_value = (s**2*normal(1) + c**2*normal(2) - sqrt2*s*c*normal(6))/normal(3)
    end if
  end function r_value

  !> Warn of an unusual density.
  subroutine check_density(case, i, warnings)
    type(case_t), intent(in) :: case
    !> Number of the material.
    integer, intent(in) :: i
    type(message_list_t), intent(inout) :: warnings

    !> Other units in t/mm3.
    real(wp), parameter :: factor(3) = [1.0e-3_wp, 1.0e-9_wp, 1.0e-12_wp]
    character(len=*), parameter :: unit(3) = ["kg/mm3", "g/cm3 ", "kg/m3 "]
    character(len=:), allocatable :: remark
    integer :: k

    associate (material => case%material(i))
      if (material%density <= 0.0_wp) return
      if (.not. outside(material%density, least_density, largest_density)) return
      remark = "unusual; the unit is t/mm3, 7.85e-9 for steel"
      do k = size(factor), 1, -1
        if (outside(factor(k)*material%density, least_density, largest_density)) cycle
        remark = remark//"; given in "//trim(unit(k))//"? then it is "// &
            to_text(factor(k)*material%density, 4)
        exit
      end do
      call add_unusual(warnings, "W022", material%source%at("density"), "density = "// &
          to_text(material%density, 4)//" t/mm3 of material '"//material%source%called()//"'", &
          remark)
    end associate
  end subroutine check_density

end module dd3_app_material_warnings
