! SPDX-License-Identifier: GPL-3.0-or-later
!> A material: elasticity, yield criterion, hardening law, back-stresses and possibly laws of the
!> modulus, of the strain rate and of the temperature, evaluated at a point.
!> All tensors are Kelvin vectors in the orthotropy axes.
module dd3_material_material
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t, verdict_converged, verdict_retry, &
      verdict_impossible, cause_large_strain, cause_none, cause_not_finite, cause_return_mapping
  use dd3_material_backstress_registry, only : find_backstress
  use dd3_material_composition, only : composition_t, heat_t, add_back_stresses, back_stress_of, &
      complete, plastic_work, stiffness_ratio, flow_response_of, flow_stress_after, &
      describe_composition => describe_internal_variables
  use dd3_material_description, only : internal_variable_t, law_choice_t
  use dd3_material_elasticity, only : elastic_stress, new_elasticity, &
      strain_of => elastic_strain
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_fracture_registry, only : find_fracture
  use dd3_material_hardening_law, only : hardening_slot_t
  use dd3_material_hardening_registry, only : find_hardening
  use dd3_material_limits, only : forming_limit_t
  use dd3_material_modulus_registry, only : find_modulus
  use dd3_material_rate_registry, only : find_rate
  use dd3_material_return_mapping, only : step_t
  use dd3_material_temperature_registry, only : find_temperature
  use dd3_material_update, only : substeps_t, integrate, differentiate, all_finite
  use dd3_material_yield_criterion, only : yield_slot_t
  use dd3_material_yield_registry, only : find_criterion
  implicit none
  private
  public :: material_t, new_material

  !> Elasticity, yield criterion, hardening law and back-stress laws with their parameters.
  type :: material_t
    !> Young's modulus, MPa.
    real(wp) :: young = 0.0_wp
    !> Number of internal variables of a point: equivalent plastic strain first, then six for each
    !> back-stress, then the hardening law's own, rate, temperature and limits, initially zero.
    integer :: n_internal = 1
    !> Number of substeps of a strain increment before any failure.
    integer :: least_substeps = 1
    type(composition_t) :: laws
  contains
    procedure :: update
    procedure :: continuum_tangent
    procedure :: plastic_direction
    procedure :: equivalent_stress
    procedure :: flow_stress
    procedure :: back_stress
    procedure :: elastic_strain
    procedure :: describe_internal_variables
    procedure :: constant_value
  end type material_t

  !> Largest number of substeps of a strain increment.
  integer, parameter :: substep_limit = 64
  !> Largest component of a strain increment that is integrated at all.
  real(wp), parameter :: strain_limit = 10.0_wp

contains

  !> Initialise a material with laws whose parameters have been checked.
  subroutine new_material(self, young, poisson, criterion, hardening, backstress, modulus, rate, &
      temperature, heat, fracture, forming_limit)
    type(material_t), intent(out) :: self
    !> Young's modulus, MPa; Poisson's ratio, above -1 and below 1/2.
    real(wp), intent(in) :: young, poisson
    type(law_choice_t), intent(in) :: criterion, hardening
    !> May be of size zero.
    type(law_choice_t), intent(in) :: backstress(:)
    !> Law of the modulus; absent or with a name that is none of the registry for a constant one.
    type(law_choice_t), intent(in), optional :: modulus
    !> Law of the strain rate, likewise.
    type(law_choice_t), intent(in), optional :: rate
    !> Law of the temperature, likewise, and heating; none by default.
    type(law_choice_t), intent(in), optional :: temperature
    type(heat_t), intent(in), optional :: heat
    !> Law of fracture, likewise, and forming limit curve; none if it has no points.
    type(law_choice_t), intent(in), optional :: fracture
    type(forming_limit_t), intent(in), optional :: forming_limit

    type(yield_slot_t) :: found_criterion
    type(hardening_slot_t) :: found_hardening
    integer :: i

    self%young = young
    call new_elasticity(self%laws%elasticity, young, poisson)
    call find_criterion(criterion%name, found_criterion)
    call found_criterion%law%set(criterion%values)
    call move_alloc(found_criterion%law, self%laws%criterion)
    call find_hardening(hardening%name, found_hardening)
    call found_hardening%law%set(hardening%values)
    call move_alloc(found_hardening%law, self%laws%hardening)
    allocate (self%laws%backstress(size(backstress)))
    do i = 1, size(backstress)
      call find_backstress(backstress(i)%name, self%laws%backstress(i))
      call self%laws%backstress(i)%law%set(backstress(i)%values)
    end do
    if (present(modulus)) then
      call find_modulus(modulus%name, self%laws%modulus)
      if (allocated(self%laws%modulus%law)) call self%laws%modulus%law%set(modulus%values)
    end if
    if (present(rate)) then
      call find_rate(rate%name, self%laws%rate)
      if (allocated(self%laws%rate%law)) call self%laws%rate%law%set(rate%values)
    end if
    if (present(temperature)) then
      call find_temperature(temperature%name, self%laws%temperature)
      if (allocated(self%laws%temperature%law)) call self%laws%temperature%law%set( &
          temperature%values)
    end if
    if (present(heat)) self%laws%heat = heat
    if (present(fracture)) then
      call find_fracture(fracture%name, self%laws%fracture)
      if (allocated(self%laws%fracture%law)) call self%laws%fracture%law%set(fracture%values)
    end if
    if (present(forming_limit)) then
      if (allocated(forming_limit%minor)) self%laws%forming_limit = forming_limit
    end if
    call complete(self%laws)
    self%n_internal = self%laws%n_internal
  end subroutine new_material

  !> Integrate stress and internal variables over a strain increment in one step or, if that fails,
  !> in 2, 4 ... 64 substeps. If all fail, return the initial state with the elastic tangent.
  pure subroutine update(self, stress_committed, internal_committed, strain, stress, &
      internal_variables, tangent, plastic, verdict, time)
    class(material_t), intent(in) :: self
    !> Committed stress, MPa, and internal variables.
    real(wp), intent(in) :: stress_committed(6), internal_committed(self%n_internal)
    !> Logarithmic strain increment.
    real(wp), intent(in) :: strain(6)
    !> Stress, MPa, and internal variables at the end.
    real(wp), intent(out) :: stress(6), internal_variables(self%n_internal)
    !> Consistent tangent d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)
    !> Whether plastic flow occurred, in the last substep.
    logical, intent(out) :: plastic
    !> Iterations are those of the return mapping. Node, element and point are not changed.
    type(verdict_t), intent(inout) :: verdict
    !> Time of the increment, s; 0, the default, for none: the strain rate is that of the state.
    real(wp), intent(in), optional :: time

    type(substeps_t) :: substeps
    type(step_t) :: step

    plastic = .false.
    verdict%outcome = verdict_impossible
    verdict%iterations = 0
    verdict%norm = 0.0_wp
    verdict%cause = cause_none
    if (.not. all_finite(stress_committed, internal_committed, strain)) then
      verdict%cause = cause_not_finite
    else if (any(abs(strain) > strain_limit)) then
      verdict%outcome = verdict_retry
      verdict%cause = cause_large_strain
      verdict%value(1) = maxval(abs(strain))
    else
      substeps%count = self%least_substeps
      if (present(time)) substeps%time = time
      do while (substeps%count <= substep_limit)
        call integrate(self%laws, substeps, stress_committed, internal_committed, strain, &
            internal_variables, step)
        stress = step%stress
        if (step%converged) call differentiate(self%laws, substeps, stress_committed, &
            internal_committed, strain, step, tangent)
        verdict%iterations = verdict%iterations + step%iterations
        verdict%norm = step%norm
        if (step%converged) then
          verdict%outcome = verdict_converged
          plastic = step%plastic
          return
        end if
        substeps%count = 2*substeps%count
      end do
      verdict%outcome = verdict_retry
      verdict%cause = cause_return_mapping
      verdict%value = [maxval(abs(strain)), internal_committed(1), step%overstress, step%norm]
    end if
    stress = stress_committed
    internal_variables = internal_committed
    tangent = self%laws%elasticity%stiffness
  end subroutine update

  !> Evaluate the tangent of the rate equations, for the predictor: elastic, or for plastic flow
  !> C - CV (x) CV / (V.CV + Y' + V.dX/dp). A strain rate stays that of the state.
  pure subroutine continuum_tangent(self, stress, internal_variables, plastic, tangent)
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal_variables(self%n_internal)
    !> Whether the point is in plastic flow.
    logical, intent(in) :: plastic
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)

    type(flow_direction_t) :: direction
    type(flow_response_t) :: flow
    type(back_response_t) :: back
    real(wp) :: rate(6), modulus, ratio
    integer :: j

    ratio = stiffness_ratio(self%laws, internal_variables(1))
    tangent = ratio*self%laws%elasticity%stiffness
    if (.not. plastic) return
    call self%laws%criterion%second_derivative(stress - self%back_stress(internal_variables), &
        direction)
    if (self%laws%kinematic) call add_back_stresses(self%laws, internal_variables, 0.0_wp, &
        direction, back)
    call flow_stress_after(self%laws, internal_variables, 0.0_wp, 0.0_wp, direction, &
        plastic_work(self%laws, 0.0_wp, direction, back), flow)
    rate = ratio*elastic_stress(self%laws%elasticity, direction%gradient)
    modulus = dot_product(direction%gradient, rate) + flow%slope
    if (self%laws%kinematic) modulus = modulus + dot_product(direction%gradient, back%slope)
    if (.not. modulus > 0.0_wp) return
    do j = 1, 6
      tangent(:, j) = tangent(:, j) - (rate(j)/modulus)*rate
    end do
  end subroutine continuum_tangent

  !> Return the direction of plastic flow V = d sb/dT of a state.
  pure function plastic_direction(self, stress, internal_variables) result(direction)
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal_variables(self%n_internal)
    real(wp) :: direction(6)

    real(wp) :: value

    call self%laws%criterion%gradient(stress - self%back_stress(internal_variables), value, &
        direction)
  end function plastic_direction

  !> Return the equivalent stress sb(T - X) of a state, MPa.
  pure real(wp) function equivalent_stress(self, stress, internal_variables)
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal_variables(self%n_internal)

    equivalent_stress = self%laws%criterion%value(stress - self%back_stress(internal_variables))
  end function equivalent_stress

  !> Return the flow stress Y of a state at its strain rate, MPa.
  pure real(wp) function flow_stress(self, internal_variables)
    class(material_t), intent(in) :: self
    real(wp), intent(in) :: internal_variables(self%n_internal)

    type(flow_response_t) :: flow

    call flow_response_of(self%laws, internal_variables, 0.0_wp, flow)
    flow_stress = flow%value
  end function flow_stress

  !> Return the sum X of the back-stresses of a state, MPa.
  pure function back_stress(self, internal_variables)
    class(material_t), intent(in) :: self
    real(wp), intent(in) :: internal_variables(self%n_internal)
    real(wp) :: back_stress(6)

    back_stress = back_stress_of(self%laws, internal_variables)
  end function back_stress

  !> Return the elastic strain of a state.
  pure function elastic_strain(self, stress, plastic_strain) result(strain)
    class(material_t), intent(in) :: self
    !> Stress, MPa; equivalent plastic strain.
    real(wp), intent(in) :: stress(6), plastic_strain
    real(wp) :: strain(6)

    strain = strain_of(self%laws%elasticity, stress)/stiffness_ratio(self%laws, plastic_strain)
  end function elastic_strain

  !> Describe the internal variables of a point in their order, the equivalent plastic strain first.
  subroutine describe_internal_variables(self, rows)
    class(material_t), intent(in) :: self
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    call describe_composition(self%laws, rows)
  end subroutine describe_internal_variables

  !> Return the value of an internal variable of other materials that this one lacks: its
  !> temperature, which is constant; zero of any other.
  pure real(wp) function constant_value(self, name)
    class(material_t), intent(in) :: self
    character(len=*), intent(in) :: name

    constant_value = merge(self%laws%heat%initial, 0.0_wp, name == "temperature")
  end function constant_value

end module dd3_material_material
