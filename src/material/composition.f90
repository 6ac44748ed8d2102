! SPDX-License-Identifier: GPL-3.0-or-later
!> The laws of a material: elasticity, a criterion, a hardening law, any number of back-stresses,
!> which add up, and possibly laws of Young's modulus, of the strain rate and of the temperature.
!> The internal variables of a point are the equivalent plastic strain, six components of each
!> back-stress, those of the hardening law, then the rate of the plastic strain if the flow stress
!> depends on it, the rise of the temperature if plastic work heats the material, and what only
!> reports read: the damage of a law of fracture, and the largest ratio of the plastic strain to the
!> forming limit.
module dd3_material_composition
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_material_backstress_law, only : backstress_slot_t
  use dd3_material_description, only : internal_variable_t
  use dd3_material_elasticity, only : elasticity_t
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_fracture_law, only : fracture_slot_t
  use dd3_material_hardening_law, only : hardening_t
  use dd3_material_limits, only : damage_after, forming_limit_t
  use dd3_material_modulus_law, only : modulus_slot_t
  use dd3_material_rate_law, only : rate_slot_t
  use dd3_material_temperature_law, only : temperature_slot_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  implicit none
  private
  public :: composition_t, heat_t, complete, describe_internal_variables
  public :: plastic_work_t, plastic_work
  public :: stiffness_ratio, back_stress_of, flow_stress_after, flow_response_of, apply_factors
  public :: add_back_stresses, evolve_internal_variables

  !> Temperature of the undeformed material, and adiabatic heating.
  type :: heat_t
    real(wp) :: initial = 20.0_wp
    !> Rise of the temperature by plastic work per volume, K mm3/mJ; 0 for a constant temperature.
    real(wp) :: per_work = 0.0_wp
  end type heat_t

  !> Plastic work of an increment per volume, mJ/mm3, and its derivatives in the plastic increment
  !> and in xi, with the stress T = xi + X of its end: dp T:V.
  type :: plastic_work_t
    real(wp) :: value = 0.0_wp, slope = 0.0_wp, gradient(6) = 0.0_wp
  end type plastic_work_t

  !> The laws of a material.
  type :: composition_t
    type(elasticity_t) :: elasticity
    class(yield_criterion_t), allocatable :: criterion
    class(hardening_t), allocatable :: hardening
    type(backstress_slot_t), allocatable :: backstress(:)
    !> Not allocated for a constant modulus.
    type(modulus_slot_t) :: modulus
    !> Not allocated for a flow stress that does not depend on the rate.
    type(rate_slot_t) :: rate
    !> Not allocated for a flow stress that does not depend on the temperature.
    type(temperature_slot_t) :: temperature
    type(heat_t) :: heat
    !> Not allocated without a law of fracture, or without a forming limit curve.
    type(fracture_slot_t) :: fracture
    type(forming_limit_t), allocatable :: forming_limit
    !> Number of internal variables of a point.
    integer :: n_internal = 1
    !> Indices of the hardening law's first and last own internal variable.
    integer :: first = 2, last = 1
    !> Indices of the rate of the plastic strain and of the rise of the temperature; 0 if there is
    !> none.
    integer :: at_rate = 0, at_temperature = 0
    !> Those of the damage and of the ratio to the forming limit, and their number.
    integer :: at_damage = 0, at_forming_limit = 0, n_reported = 0
    !> Whether there is a back-stress of any kind.
    logical :: kinematic = .false.
    !> Whether neither back-stress nor flow stress depends on xi: the matrix of the return mapping
    !> is then symmetric.
    logical :: symmetric = .true.
    !> Whether Young's modulus falls with the plastic strain.
    logical :: softens = .false.
    !> Whether the flow stress depends on the strain rate; on it or on the temperature; on a
    !> temperature that plastic work raises.
    logical :: viscous = .false., scaled = .false., heated = .false.
  end type composition_t

contains

  !> Set the components that derive from the laws.
  subroutine complete(self)
    type(composition_t), intent(inout) :: self

    self%first = 2 + 6*size(self%backstress)
    self%last = self%first + self%hardening%n_internal - 1
    self%n_internal = self%last
    self%viscous = allocated(self%rate%law)
    if (self%viscous) then
      self%n_internal = self%n_internal + 1
      self%at_rate = self%n_internal
    end if
    self%scaled = self%viscous .or. allocated(self%temperature%law)
    if (self%heat%per_work > 0.0_wp) then
      self%n_internal = self%n_internal + 1
      self%at_temperature = self%n_internal
    end if
    self%heated = self%at_temperature > 0 .and. allocated(self%temperature%law)
    call add_reported(self)
    self%kinematic = size(self%backstress) > 0 .or. self%hardening%owns_back_stress
    self%softens = allocated(self%modulus%law)
    self%symmetric = .not. (self%kinematic .or. self%hardening%path_dependent .or. self%heated)
  end subroutine complete

  !> Append the internal variables that only reports read.
  subroutine add_reported(self)
    type(composition_t), intent(inout) :: self

    if (allocated(self%fracture%law)) then
      self%n_internal = self%n_internal + 1
      self%at_damage = self%n_internal
    end if
    if (allocated(self%forming_limit)) then
      self%n_internal = self%n_internal + 1
      self%at_forming_limit = self%n_internal
    end if
    self%n_reported = count([self%at_damage, self%at_forming_limit] > 0)
  end subroutine add_reported

  !> Describe the internal variables of a point in their order, the equivalent plastic strain first.
  !> Names that occur more than once are numbered: back_stress_1, back_stress_2.
  subroutine describe_internal_variables(self, rows)
    type(composition_t), intent(in) :: self
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    type(internal_variable_t), allocatable :: own(:)
    integer :: i

    allocate (rows(1))
    rows(1) = internal_variable_t("equivalent_plastic_strain", "", &
        "equivalent plastic strain, conjugate to the equivalent stress", 1)
    do i = 1, size(self%backstress)
      call self%backstress(i)%law%describe_internal_variables(own)
      rows = [rows, own]
    end do
    call self%hardening%describe_internal_variables(own)
    rows = [rows, own]
    if (self%viscous) rows = [rows, internal_variable_t("plastic_strain_rate", "1/s", &
        "rate of the equivalent plastic strain in the last increment", 1)]
    if (self%at_temperature > 0) rows = [rows, internal_variable_t("temperature", "C", &
        "temperature by adiabatic heating", 1, offset=self%heat%initial)]
    if (self%at_damage > 0) rows = [rows, internal_variable_t("fracture_damage", "", &
        "damage of the law of fracture, which reaches 1 at fracture", 1)]
    if (self%at_forming_limit > 0) rows = [rows, internal_variable_t("forming_limit_ratio", "", &
        "largest ratio so far of the plastic strain to that of the forming limit", 1)]
    rows(1)%first = 1
    do i = 2, size(rows)
      rows(i)%first = rows(i - 1)%first + rows(i - 1)%n_component
    end do
    call number_repeated_names(rows)
  end subroutine describe_internal_variables

  !> Append a number to each name that occurs more than once.
  subroutine number_repeated_names(rows)
    type(internal_variable_t), intent(inout) :: rows(:)

    character(len=len(rows%name)) :: name
    integer :: i, k, n

    do i = 1, size(rows)
      name = rows(i)%name
      if (count(rows%name == name) < 2) cycle
      n = 0
      do k = i, size(rows)
        if (rows(k)%name /= name) cycle
        n = n + 1
        rows(k)%name = trim(name)//"_"//to_text(n)
      end do
    end do
  end subroutine number_repeated_names

  !> Return a direction for laws evaluated at an increment of zero, on which it has no influence.
  pure type(flow_direction_t) function no_direction()
    no_direction%stress = 0.0_wp
    no_direction%equivalent = 0.0_wp
    no_direction%gradient = 0.0_wp
    no_direction%second = 0.0_wp
  end function no_direction

  !> Return Young's modulus of a state over that of the undeformed material, which scales the whole
  !> elastic stiffness.
  pure real(wp) function stiffness_ratio(self, plastic_strain)
    type(composition_t), intent(in) :: self
    !> Equivalent plastic strain.
    real(wp), intent(in) :: plastic_strain

    stiffness_ratio = 1.0_wp
    if (self%softens) stiffness_ratio = self%modulus%law%young_at(self%elasticity%young, &
        plastic_strain)/self%elasticity%young
  end function stiffness_ratio

  !> Return the sum of the back-stresses of a state, MPa.
  pure function back_stress_of(self, internal_variables) result(back_stress)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: internal_variables(self%n_internal)
    real(wp) :: back_stress(6)

    type(back_response_t) :: back
    integer :: i

    back_stress = 0.0_wp
    do i = 1, size(self%backstress)
      back_stress = back_stress + internal_variables(6*i - 4:6*i + 1)
    end do
    if (self%hardening%owns_back_stress) then
      call self%hardening%back_stress(internal_variables(self%first:self%last), 0.0_wp, &
          no_direction(), back)
      back_stress = back_stress + back%value
    end if
  end function back_stress_of

  !> Evaluate the flow stress of a state and its slope at a constant rate, that of the state; with a
  !> frequency, at rest.
  pure subroutine flow_response_of(self, internal_variables, frequency, flow)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: internal_variables(self%n_internal)
    !> As for `flow_stress_after`.
    real(wp), intent(in) :: frequency
    type(flow_response_t), intent(out) :: flow

    type(flow_direction_t) :: direction

    ! Other laws ignore the direction, and filling it takes longer than their flow stress.
    if (self%hardening%path_dependent) direction = no_direction()
    call flow_stress_after(self, internal_variables, 0.0_wp, frequency, direction, &
        plastic_work_t(), flow)
  end subroutine flow_response_of

  !> Evaluate the flow stress at the end of a plastic increment with its derivatives.
  pure subroutine flow_stress_after(self, start, increment, frequency, direction, work, flow)
    type(composition_t), intent(in) :: self
    !> Internal variables at the start.
    real(wp), intent(in) :: start(self%n_internal)
    real(wp), intent(in) :: increment
    !> Inverse of the time of the increment, 1/s; 0 without a time: the rate is that of the start.
    real(wp), intent(in) :: frequency
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Of the increment; zero to take the temperature of the start.
    type(plastic_work_t), intent(in) :: work
    type(flow_response_t), intent(out) :: flow

    call self%hardening%flow_stress(start(1), start(self%first:self%last), increment, direction, &
        flow)
    if (self%scaled) call apply_factors(self, start, increment, frequency, work, flow)
  end subroutine flow_stress_after

  !> Return the plastic work of an increment.
  pure type(plastic_work_t) function plastic_work(self, increment, direction, back) result(work)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Back-stress of the end; not used if there is none.
    type(back_response_t), intent(in) :: back

    work%slope = direction%equivalent
    work%gradient = increment*direction%gradient
    if (self%kinematic) then
      work%slope = work%slope + dot_product(direction%gradient, back%value)
      work%gradient = work%gradient + increment*(matmul(direction%gradient, back%gradient) &
          + matmul(direction%second, back%value))
    end if
    work%value = increment*work%slope
    if (self%kinematic) work%slope = work%slope &
        + increment*dot_product(direction%gradient, back%slope)
  end function plastic_work

  !> Multiply the flow stress of the hardening law by the factors of the strain rate and of the
  !> temperature; arguments as for `flow_stress_after`.
  pure subroutine apply_factors(self, start, increment, frequency, work, flow)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment, frequency
    type(plastic_work_t), intent(in) :: work
    type(flow_response_t), intent(inout) :: flow

    real(wp) :: factor, slope, by_strain

    if (self%viscous) then
      call self%rate%law%factor_at(start(1) + increment, &
          rate_after(self, start, increment, frequency), factor, slope, by_strain)
      flow%slope = factor*flow%slope + flow%value*(slope*frequency + by_strain)
      flow%gradient = factor*flow%gradient
      flow%value = factor*flow%value
    end if
    if (allocated(self%temperature%law)) call apply_temperature(self, start, work, flow)
  end subroutine apply_factors

  !> Multiply a flow stress by the factor of the temperature at the end of a plastic increment.
  pure subroutine apply_temperature(self, start, work, flow)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal)
    type(plastic_work_t), intent(in) :: work
    type(flow_response_t), intent(inout) :: flow

    real(wp) :: factor, slope

    call self%temperature%law%factor(temperature_of(self, start) + self%heat%per_work*work%value, &
        factor, slope)
    slope = self%heat%per_work*slope*flow%value
    flow%slope = factor*flow%slope + slope*work%slope
    flow%gradient = factor*flow%gradient + slope*work%gradient
    flow%value = factor*flow%value
  end subroutine apply_temperature

  !> Return the temperature of a state.
  pure real(wp) function temperature_of(self, internal_variables)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: internal_variables(self%n_internal)

    temperature_of = self%heat%initial
    if (self%at_temperature > 0) temperature_of = temperature_of &
        + internal_variables(self%at_temperature)
  end function temperature_of

  !> Return the rate of the plastic strain over an increment, 1/s; arguments as for
  !> `flow_stress_after`.
  pure real(wp) function rate_after(self, start, increment, frequency)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment, frequency

    rate_after = start(self%at_rate)
    if (frequency > 0.0_wp) rate_after = increment*frequency
  end function rate_after

  !> Evaluate the sum of the back-stresses at the end of a plastic increment.
  pure subroutine add_back_stresses(self, start, increment, direction, total)
    type(composition_t), intent(in) :: self
    !> Internal variables at the start.
    real(wp), intent(in) :: start(self%n_internal)
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: total

    type(back_response_t) :: back
    integer :: i

    call self%hardening%back_stress(start(self%first:self%last), increment, direction, total)
    do i = 1, size(self%backstress)
      call self%backstress(i)%law%back_stress(start(6*i - 4:6*i + 1), increment, direction, back)
      total%value = total%value + back%value
      total%slope = total%slope + back%slope
      total%gradient = total%gradient + back%gradient
    end do
  end subroutine add_back_stresses

  !> Evolve the internal variables over an increment.
  pure subroutine evolve_internal_variables(self, start, increment, frequency, stress, direction, &
      evolved)
    type(composition_t), intent(in) :: self
    !> Internal variables at the start.
    real(wp), intent(in) :: start(self%n_internal)
    !> Plastic increment; 0 for an elastic one.
    real(wp), intent(in) :: increment
    !> As for `flow_stress_after`.
    real(wp), intent(in) :: frequency
    !> Stress of the end, MPa.
    real(wp), intent(in) :: stress(6)
    !> The criterion at the effective stress of the end; not used for an elastic increment.
    type(flow_direction_t), intent(in) :: direction
    !> Internal variables at the end.
    real(wp), intent(out) :: evolved(self%n_internal)

    type(back_response_t) :: back
    integer :: i

    evolved = start
    if (self%viscous) evolved(self%at_rate) = rate_after(self, start, increment, frequency)
    if (.not. increment > 0.0_wp) return
    evolved(1) = start(1) + increment
    if (self%n_reported > 0) call evolve_reported(self, increment, stress, direction, evolved)
    if (self%at_temperature > 0) evolved(self%at_temperature) = start(self%at_temperature) &
        + self%heat%per_work*increment*dot_product(stress, direction%gradient)
    do i = 1, size(self%backstress)
      call self%backstress(i)%law%back_stress(start(6*i - 4:6*i + 1), increment, direction, back)
      evolved(6*i - 4:6*i + 1) = back%value
    end do
    if (self%hardening%n_internal > 0) then
      call self%hardening%evolve(start(self%first:self%last), increment, direction, &
          evolved(self%first:self%last))
    end if
  end subroutine evolve_internal_variables

  !> Evolve the internal variables that only reports read over a plastic increment.
  pure subroutine evolve_reported(self, increment, stress, direction, evolved)
    type(composition_t), intent(in) :: self
    real(wp), intent(in) :: increment, stress(6)
    type(flow_direction_t), intent(in) :: direction
    !> With the plastic strain of the end.
    real(wp), intent(inout) :: evolved(self%n_internal)

    if (self%at_damage > 0) then
      associate (damage => evolved(self%at_damage))
        damage = damage_after(self%fracture%law, damage, increment, stress)
      end associate
    end if
    if (self%at_forming_limit > 0) then
      associate (ratio => evolved(self%at_forming_limit))
        ratio = max(ratio, self%forming_limit%ratio(evolved(1), direction%gradient))
      end associate
    end if
  end subroutine evolve_reported

end module dd3_material_composition
