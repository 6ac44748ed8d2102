! SPDX-License-Identifier: GPL-3.0-or-later
!> A material from its specification in the input.
module dd3_laws_material
  use dd3_base_digest, only : digest_t
  use dd3_base_error, only : error_list_t
  use dd3_input_case, only : material_spec_t
  use dd3_laws_choice, only : choose_checked
  use dd3_material_check, only : law_backstress, law_hardening, law_yield
  use dd3_material_description, only : law_choice_t
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

    type(law_choice_t) :: yield, hardening
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
    if (errors%count > found .or. .not. spec%source%valid) return
    if (yield%name == "" .or. hardening%name == "") return
    call new_material(material, spec%young, spec%poisson, yield, hardening, backstress)
    call digest%add([spec%young, spec%poisson])
    call add_law(digest, yield)
    call add_law(digest, hardening)
    do i = 1, size(backstress)
      call add_law(digest, backstress(i))
    end do
    check_sum = digest%value()
  end subroutine make_material

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
