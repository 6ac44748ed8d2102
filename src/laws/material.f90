! SPDX-License-Identifier: GPL-3.0-or-later
!> A material from its specification in the input.
module dd3_laws_material
  use dd3_base_kinds, only : wp
  use dd3_base_digest, only : digest_t
  use dd3_base_error, only : error_list_t
  use dd3_base_text, only : to_text
  use dd3_input_case, only : material_spec_t
  use dd3_laws_choice, only : choose_checked
  use dd3_material_check, only : law_backstress, law_fracture, law_hardening, law_modulus, &
      law_rate, law_temperature, law_yield
  use dd3_material_composition, only : heat_t
  use dd3_material_description, only : law_choice_t
  use dd3_material_limits, only : forming_limit_t
  use dd3_material_material, only : material_t, new_material
  implicit none
  private
  public :: make_material

contains

  !> Make a material; it is incomplete if errors were added or the specification has some.
  subroutine make_material(material, spec, check_sum, errors)
    type(material_t), intent(inout) :: material
    type(material_spec_t), intent(in) :: spec
    !> Check sum of elasticity, laws and parameters; 0 if the material is incomplete.
    integer, intent(out) :: check_sum
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(law_choice_t) :: yield, hardening, modulus, rate, temperature, fracture
    type(law_choice_t), allocatable :: backstress(:)
    type(digest_t) :: digest
    integer :: found, i

    check_sum = 0
    found = errors%count
    if (spec%source%has("yield")) call choose_checked(law_yield, spec%yield, yield, errors)
    if (spec%source%has("hardening")) call choose_checked(law_hardening, spec%hardening, &
        hardening, errors)
    allocate (backstress(size(spec%backstress)))
    do i = 1, size(backstress)
      call choose_checked(law_backstress, spec%backstress(i), backstress(i), errors)
    end do
    if (spec%source%has("modulus")) call choose_checked(law_modulus, spec%modulus, modulus, errors)
    if (spec%source%has("rate")) call choose_checked(law_rate, spec%rate, rate, errors)
    if (spec%source%has("temperature")) call choose_checked(law_temperature, spec%temperature, &
        temperature, errors)
    if (spec%source%has("fracture")) call choose_checked(law_fracture, spec%fracture, fracture, &
        errors)
    if (errors%count > found .or. .not. spec%source%valid) return
    if (yield%name == "" .or. hardening%name == "") return
    call new_material(material, spec%young, spec%poisson, yield, hardening, backstress, &
        modulus, rate, temperature, heating(spec), fracture, limit_of(spec))
    call check_modulus(material, spec, errors)
    call check_heating(material, spec, errors)
    if (errors%count > found) return
    call digest%add([spec%young, spec%poisson])
    call add_law(digest, yield)
    call add_law(digest, hardening)
    do i = 1, size(backstress)
      call add_law(digest, backstress(i))
    end do
    if (material%laws%softens) call add_law(digest, modulus)
    if (material%laws%viscous) call add_law(digest, rate)
    if (material%laws%scaled .or. material%laws%at_temperature > 0) then
      if (allocated(material%laws%temperature%law)) call add_law(digest, temperature)
      call digest%add([material%laws%heat%initial, material%laws%heat%per_work])
    end if
    if (material%laws%at_damage > 0) call add_law(digest, fracture)
    if (material%laws%at_forming_limit > 0) call digest%add(spec%forming_limit)
    check_sum = digest%value()
  end subroutine make_material

  !> Return the forming limit curve of a material; without points if there is none.
  pure type(forming_limit_t) function limit_of(spec) result(limit)
    type(material_spec_t), intent(in) :: spec

    if (.not. allocated(spec%forming_limit)) return
    associate (n => size(spec%forming_limit))
      if (n < 4 .or. modulo(n, 2) > 0) return
      limit%minor = spec%forming_limit(1:n:2)
      limit%major = spec%forming_limit(2:n:2)
    end associate
  end function limit_of

  !> Return the temperature and the heating of a material.
  pure type(heat_t) function heating(spec)
    type(material_spec_t), intent(in) :: spec

    heating%initial = spec%initial_temperature
    if (spec%heat_capacity > 0.0_wp .and. spec%density > 0.0_wp) heating%per_work = &
        spec%heat_fraction/(spec%density*spec%heat_capacity)
  end function heating

  !> Require a density for heating, keys of the heating with an effect, and a temperature at which
  !> the flow stress is not lost.
  subroutine check_heating(material, spec, errors)
    type(material_t), intent(in) :: material
    type(material_spec_t), intent(in) :: spec
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    !> Factor on the flow stress that is as good as none.
    real(wp), parameter :: least = 0.01_wp
    real(wp) :: factor, slope

    if (spec%heat_capacity > 0.0_wp .and. .not. spec%density > 0.0_wp) then
      call errors%push_input(spec%source%at("heat_capacity"), "heating needs the density", &
          "density = t/mm3; 7.85e-9 for steel", code="E165")
    end if
    if (.not. spec%heat_capacity > 0.0_wp .and. spec%source%given("heat_fraction")) then
      call errors%push_input(spec%source%at("heat_fraction"), "heat_fraction has no effect "// &
          "without heat_capacity", "heat_capacity = mJ/(t K)", code="E165")
    end if
    if (.not. allocated(material%laws%temperature%law)) return
    call material%laws%temperature%law%factor(spec%initial_temperature, factor, slope)
    if (factor > least) return
    call errors%push_input(spec%temperature%at, "at the initial temperature of "// &
        to_text(spec%initial_temperature)//" no flow stress is left", &
        "an initial temperature below the melting point", code="E149")
  end subroutine check_heating

  !> Require that a law of the modulus begins at `young` and does not end above it.
  subroutine check_modulus(material, spec, errors)
    type(material_t), intent(in) :: material
    type(material_spec_t), intent(in) :: spec
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    !> Plastic strain at which a law has saturated; relative difference of equal moduli.
    real(wp), parameter :: large = 1.0e6_wp, tolerance = 1.0e-6_wp
    real(wp) :: first, last

    if (.not. material%laws%softens) return
    associate (law => material%laws%modulus%law)
      first = law%young_at(spec%young, 0.0_wp)
      last = law%young_at(spec%young, large)
    end associate
    if (abs(first - spec%young) > tolerance*spec%young) then
      call errors%push_input(spec%modulus%at, "the modulus is "//to_text(first)// &
          " MPa at zero plastic strain", "young = "//to_text(spec%young), code="E149")
    else if (last > spec%young*(1 + tolerance)) then
      call errors%push_input(spec%modulus%at, "the modulus rises from "//to_text(spec%young)// &
          " to "//to_text(last)//" MPa", "a modulus that falls with the plastic strain", &
          code="E149")
    end if
  end subroutine check_modulus

  !> Add a law and its values to a check sum.
  subroutine add_law(digest, law)
    type(digest_t), intent(inout) :: digest
    type(law_choice_t), intent(in) :: law

    integer :: k

    call digest%add(law%name)
    do k = 1, size(law%values)
      call digest%add(law%values(k)%name)
      call digest%add([law%values(k)%abscissa, law%values(k)%value])
    end do
  end subroutine add_law

end module dd3_laws_material
