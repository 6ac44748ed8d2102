! SPDX-License-Identifier: GPL-3.0-or-later
!> Laws of the strain rate: a factor on the flow stress of any hardening law.
module dd3_material_rate_law
  use dd3_base_kinds, only : wp
  use dd3_material_law, only : law_t
  implicit none
  private
  public :: rate_t, rate_slot_t

  !> Base of the laws of the rate.
  type, abstract, extends(law_t) :: rate_t
  contains
    procedure(factor_interface), deferred :: factor
    procedure :: factor_at
  end type rate_t

  !> Container of a law of any type; not allocated for a flow stress that does not depend on it.
  type :: rate_slot_t
    class(rate_t), allocatable :: law
  end type rate_slot_t

  abstract interface
    !> Evaluate the factor on the flow stress, which does not fall with the rate.
    pure subroutine factor_interface(self, rate, value, slope)
      import :: rate_t, wp
      class(rate_t), intent(in) :: self
      !> Rate of the equivalent plastic strain, not negative, 1/s.
      real(wp), intent(in) :: rate
      !> Factor and its finite derivative in the rate, s.
      real(wp), intent(out) :: value, slope
    end subroutine factor_interface
  end interface

contains

  !> Evaluate the factor at a plastic strain, on which it does not depend by default.
  pure subroutine factor_at(self, strain, rate, value, slope, by_strain)
    class(rate_t), intent(in) :: self
    !> Equivalent plastic strain, and its rate, 1/s.
    real(wp), intent(in) :: strain, rate
    !> Factor and its derivatives in the rate, s, and in the strain.
    real(wp), intent(out) :: value, slope, by_strain

    associate (unused => strain)
    end associate
    call self%factor(rate, value, slope)
    by_strain = 0.0_wp
  end subroutine factor_at

end module dd3_material_rate_law
