!> A material: elasticity, yield criterion, hardening law and back-stresses, and what the rest of
!> the program asks of it at a point. All tensors are Kelvin vectors in the orthotropy axes.
module dd3_material_material
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_t
  use dd3_material_backstress_registry, only : find_backstress
  use dd3_material_composition, only : composition_t, add_back_stresses, back_stress_of, complete, &
      flow_response_of
  use dd3_material_description, only : law_choice_t
  use dd3_material_elasticity, only : elastic_stress, new_elasticity
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_hardening_law, only : hardening_slot_t
  use dd3_material_hardening_registry, only : find_hardening
  use dd3_material_update, only : update_point
  use dd3_material_yield_criterion, only : yield_slot_t
  use dd3_material_yield_registry, only : find_criterion
  implicit none
  private
  public :: material_t, new_material

  !> A material.
  type :: material_t
    !> Young's modulus, MPa.
    real(wp) :: young = 0.0_wp
    !> Number of internal variables of a point: equivalent plastic strain first, then six for each
    !> back-stress, then the hardening law's own. All are zero at the start.
    integer :: n_internal = 1
    !> Parts a strain increment is cut into from the outset.
    integer :: least_parts = 1
    !> The laws.
    type(composition_t) :: laws
  contains
    procedure :: update
    procedure :: continuum_tangent
    procedure :: plastic_direction
    procedure :: equivalent_stress
    procedure :: flow_stress
    procedure :: back_stress
  end type material_t

contains

  !> Makes a material of its laws, which have been checked.
  subroutine new_material(self, young, poisson, criterion, hardening, backstress)
    !> The material.
    type(material_t), intent(out) :: self
    !> Young's modulus, MPa; Poisson's ratio, above -1 and below 1/2.
    real(wp), intent(in) :: young, poisson
    !> Yield criterion and hardening law.
    type(law_choice_t), intent(in) :: criterion, hardening
    !> Back-stresses; may be of size zero.
    type(law_choice_t), intent(in) :: backstress(:)
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
    call complete(self%laws)
    self%n_internal = self%laws%n_internal
  end subroutine new_material

  !> Brings a point to the end of a strain increment. Where that fails the state of the start comes
  !> back with the elastic tangent, and the verdict says why.
  pure subroutine update(self, stress_old, internal_old, strain, stress, internal, tangent, &
                         plastic, verdict)
    !> The material.
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables at the start.
    real(wp), intent(in) :: stress_old(6), internal_old(self%n_internal)
    !> Logarithmic strain increment.
    real(wp), intent(in) :: strain(6)
    !> Stress, MPa, and internal variables at the end.
    real(wp), intent(out) :: stress(6), internal(self%n_internal)
    !> Consistent tangent d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)
    !> Whether plastic flow took place.
    logical, intent(out) :: plastic
    !> How it ended; iterations are those of the return mapping. Node, element and point are left
    !> as they were.
    type(verdict_t), intent(inout) :: verdict

    call update_point(self%laws, self%least_parts, stress_old, internal_old, strain, &
                      stress, internal, tangent, plastic, verdict)
  end subroutine update

  !> Tangent of the rate equations, for the predictor: elastic, or that of plastic flow at the
  !> state, C - CV (x) CV / (V.CV + Y' + V.dX/dp).
  pure subroutine continuum_tangent(self, stress, internal, plastic, tangent)
    !> The material.
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal(self%n_internal)
    !> Whether the point flows.
    logical, intent(in) :: plastic
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)
    type(flow_direction_t) :: direction
    type(flow_response_t) :: flow
    type(back_response_t) :: back
    real(wp) :: rate(6), modulus
    integer :: j

    tangent = self%laws%elasticity%stiffness
    if (.not. plastic) return
    call self%laws%criterion%second_derivative(stress - self%back_stress(internal), direction)
    call self%laws%hardening%flow_stress(internal(1), internal(self%laws%first:self%laws%last), &
                                         0.0_wp, direction, flow)
    rate = elastic_stress(self%laws%elasticity, direction%gradient)
    modulus = dot_product(direction%gradient, rate) + flow%slope
    if (self%laws%kinematic) then
      call add_back_stresses(self%laws, internal, 0.0_wp, direction, back)
      modulus = modulus + dot_product(direction%gradient, back%slope)
    end if
    if (.not. modulus > 0.0_wp) return
    do j = 1, 6
      tangent(:, j) = tangent(:, j) - (rate(j)/modulus)*rate
    end do
  end subroutine continuum_tangent

  !> Direction of plastic flow V = d sb/dT of a state.
  pure function plastic_direction(self, stress, internal) result(direction)
    !> The material.
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal(self%n_internal)
    real(wp) :: direction(6), value

    call self%laws%criterion%gradient(stress - self%back_stress(internal), value, direction)
  end function plastic_direction

  !> Equivalent stress sb(T - X) of a state, MPa.
  pure real(wp) function equivalent_stress(self, stress, internal)
    !> The material.
    class(material_t), intent(in) :: self
    !> Stress, MPa, and internal variables.
    real(wp), intent(in) :: stress(6), internal(self%n_internal)

    equivalent_stress = self%laws%criterion%value(stress - self%back_stress(internal))
  end function equivalent_stress

  !> Flow stress Y of a state, MPa.
  pure real(wp) function flow_stress(self, internal)
    !> The material.
    class(material_t), intent(in) :: self
    !> Internal variables.
    real(wp), intent(in) :: internal(self%n_internal)
    type(flow_response_t) :: flow

    call flow_response_of(self%laws, internal, flow)
    flow_stress = flow%value
  end function flow_stress

  !> Sum X of the back-stresses of a state, MPa.
  pure function back_stress(self, internal)
    !> The material.
    class(material_t), intent(in) :: self
    !> Internal variables.
    real(wp), intent(in) :: internal(self%n_internal)
    real(wp) :: back_stress(6)

    back_stress = back_stress_of(self%laws, internal)
  end function back_stress

end module dd3_material_material
