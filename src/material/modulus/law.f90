! SPDX-License-Identifier: GPL-3.0-or-later
!> Laws of Young's modulus over the equivalent plastic strain.
module dd3_material_modulus_law
  use dd3_base_kinds, only : wp
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: modulus_t, modulus_slot_t

  !> Base of the laws of the modulus.
  type, abstract, extends(law_t) :: modulus_t
  contains
    procedure(young_at_interface), deferred :: young_at
  end type modulus_t

  !> Container of a law of any type; not allocated for a constant modulus.
  type :: modulus_slot_t
    class(modulus_t), allocatable :: law
  end type modulus_slot_t

  abstract interface
    !> Return Young's modulus of a plastic strain, MPa.
    pure real(wp) function young_at_interface(self, initial, plastic_strain)
      import :: modulus_t, wp
      class(modulus_t), intent(in) :: self
      !> Young's modulus of the material as delivered, MPa.
      real(wp), intent(in) :: initial
      !> Equivalent plastic strain.
      real(wp), intent(in) :: plastic_strain
    end function young_at_interface
  end interface

end module dd3_material_modulus_law
