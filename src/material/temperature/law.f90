! SPDX-License-Identifier: GPL-3.0-or-later
!> Laws of the temperature: a factor on the flow stress of any hardening law.
module dd3_material_temperature_law
  use dd3_base_kinds, only : wp
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: temperature_t, temperature_slot_t

  !> Base of the laws of the temperature.
  type, abstract, extends(law_t) :: temperature_t
  contains
    procedure(factor_interface), deferred :: factor
  end type temperature_t

  !> Container of a law of any type; not allocated for a flow stress that does not depend on it.
  type :: temperature_slot_t
    class(temperature_t), allocatable :: law
  end type temperature_slot_t

  abstract interface
    !> Evaluate the factor on the flow stress, which is positive.
    pure subroutine factor_interface(self, temperature, value, slope)
      import :: temperature_t, wp
      class(temperature_t), intent(in) :: self
      !> In the unit of the law's parameters, degrees Celsius or K.
      real(wp), intent(in) :: temperature
      !> Factor and its derivative in the temperature.
      real(wp), intent(out) :: value, slope
    end subroutine factor_interface
  end interface

end module dd3_material_temperature_law
