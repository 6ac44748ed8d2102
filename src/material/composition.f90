!> The laws a material is made of: elasticity, a criterion, a hardening law, any number of
!> back-stresses that add up; and what they say together of a state. The internal variables of a
!> point are the equivalent plastic strain, six components of each back-stress, those of the
!> hardening law.
module dd3_material_composition
  use dd3_base_kinds, only : wp
  use dd3_material_backstress_law, only : backstress_slot_t
  use dd3_material_elasticity, only : elasticity_t
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_hardening_law, only : hardening_t
  use dd3_material_yield_criterion, only : yield_criterion_t
  implicit none
  private
  public :: composition_t, complete, back_stress_of, flow_response_of
  public :: add_back_stresses, advance_internal

  !> The laws of a material.
  type :: composition_t
    !> Elasticity.
    type(elasticity_t) :: elasticity
    !> Yield criterion.
    class(yield_criterion_t), allocatable :: criterion
    !> Hardening law.
    class(hardening_t), allocatable :: hardening
    !> Back-stresses.
    type(backstress_slot_t), allocatable :: backstress(:)
    !> Number of internal variables of a point.
    integer :: n_internal = 1
    !> Where the hardening law's own ones begin and end.
    integer :: first = 2, last = 1
    !> Whether there is a back-stress of any kind.
    logical :: kinematic = .false.
    !> Whether neither back-stress nor flow stress depends on the direction of flow, so that the
    !> matrix of the return mapping is symmetric.
    logical :: symmetric = .true.
  end type composition_t

contains

  !> Fills what follows from the laws.
  subroutine complete(self)
    !> The laws.
    type(composition_t), intent(inout) :: self

    self%first = 2 + 6*size(self%backstress)
    self%last = self%first + self%hardening%n_internal - 1
    self%n_internal = self%last
    self%kinematic = size(self%backstress) > 0 .or. self%hardening%owns_back_stress
    self%symmetric = .not. (self%kinematic .or. self%hardening%follows_path)
  end subroutine complete

  !> A direction for laws asked about an increment of zero, where it has no say.
  pure type(flow_direction_t) function no_direction()
    no_direction%stress = 0.0_wp
    no_direction%equivalent = 0.0_wp
    no_direction%gradient = 0.0_wp
    no_direction%second = 0.0_wp
  end function no_direction

  !> Sum of the back-stresses of a state.
  pure function back_stress_of(self, internal) result(back_stress)
    !> The laws.
    type(composition_t), intent(in) :: self
    !> Internal variables.
    real(wp), intent(in) :: internal(self%n_internal)
    real(wp) :: back_stress(6)
    type(back_response_t) :: back
    integer :: i

    back_stress = 0.0_wp
    do i = 1, size(self%backstress)
      back_stress = back_stress + internal(6*i - 4:6*i + 1)
    end do
    if (self%hardening%owns_back_stress) then
      call self%hardening%back_stress(internal(self%first:self%last), 0.0_wp, no_direction(), back)
      back_stress = back_stress + back%value
    end if
  end function back_stress_of

  !> Flow stress of a state, and its slope.
  pure subroutine flow_response_of(self, internal, flow)
    !> The laws.
    type(composition_t), intent(in) :: self
    !> Internal variables.
    real(wp), intent(in) :: internal(self%n_internal)
    !> Flow stress and its derivatives.
    type(flow_response_t), intent(out) :: flow
    type(flow_direction_t) :: direction

    ! Other laws never look at the direction, and filling it takes longer than their flow stress.
    if (self%hardening%follows_path) direction = no_direction()
    call self%hardening%flow_stress(internal(1), internal(self%first:self%last), 0.0_wp, &
                                    direction, flow)
  end subroutine flow_response_of

  !> Sum of the back-stresses at the end of an increment, with its derivatives.
  pure subroutine add_back_stresses(self, internal, increment, direction, total)
    !> The laws.
    type(composition_t), intent(in) :: self
    !> Internal variables at the start.
    real(wp), intent(in) :: internal(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> The sum.
    type(back_response_t), intent(out) :: total
    type(back_response_t) :: back
    integer :: i

    call self%hardening%back_stress(internal(self%first:self%last), increment, direction, total)
    do i = 1, size(self%backstress)
      call self%backstress(i)%law%back_stress(internal(6*i - 4:6*i + 1), increment, direction, back)
      total%value = total%value + back%value
      total%slope = total%slope + back%slope
      total%gradient = total%gradient + back%gradient
    end do
  end subroutine add_back_stresses

  !> Internal variables at the end of an increment.
  pure subroutine advance_internal(self, old, increment, direction, new)
    !> The laws.
    type(composition_t), intent(in) :: self
    !> Internal variables at the start.
    real(wp), intent(in) :: old(self%n_internal)
    !> Plastic increment.
    real(wp), intent(in) :: increment
    !> The criterion at the effective stress of the end.
    type(flow_direction_t), intent(in) :: direction
    !> Internal variables at the end.
    real(wp), intent(out) :: new(self%n_internal)
    type(back_response_t) :: back
    integer :: i

    new(1) = old(1) + increment
    do i = 1, size(self%backstress)
      call self%backstress(i)%law%back_stress(old(6*i - 4:6*i + 1), increment, direction, back)
      new(6*i - 4:6*i + 1) = back%value
    end do
    if (self%hardening%n_internal > 0) then
      call self%hardening%advance(old(self%first:self%last), increment, direction, &
                                  new(self%first:self%last))
    end if
  end subroutine advance_internal

end module dd3_material_composition
