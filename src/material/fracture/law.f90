! SPDX-License-Identifier: GPL-3.0-or-later
!> Laws of ductile fracture: the plastic strain to fracture on a path of constant stress state. They
!> have no influence on the stress.
module dd3_material_fracture_law
  use dd3_base_kinds, only : wp
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: fracture_t, fracture_slot_t

  !> Base of the laws of fracture.
  type, abstract, extends(law_t) :: fracture_t
    !> Exponent n of the growth of the damage D, dD/dp = n D^(1-1/n)/strain.
    real(wp) :: exponent = 1.0_wp
  contains
    procedure(strain_interface), deferred :: strain
  end type fracture_t

  !> Container of a law of any type; not allocated for none.
  type :: fracture_slot_t
    class(fracture_t), allocatable :: law
  end type fracture_slot_t

  abstract interface
    !> Return the equivalent plastic strain to fracture, positive; huge where there is none.
    pure real(wp) function strain_interface(self, triaxiality, lode)
      import :: fracture_t, wp
      class(fracture_t), intent(in) :: self
      !> Mean stress over von Mises's equivalent stress; normalised Lode angle, -1 to 1: 1 in
      !> uniaxial, -1 in equibiaxial tension.
      real(wp), intent(in) :: triaxiality, lode
    end function strain_interface
  end interface

end module dd3_material_fracture_law
