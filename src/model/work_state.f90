! SPDX-License-Identifier: GPL-3.0-or-later
!> Work since the start of the job, mJ.
module dd3_model_work_state
  use dd3_base_kinds, only : wp
  use dd3_model_state_visitor, only : state_visitor_t
  implicit none
  private
  public :: work_state_t

  !> Work.
  type :: work_state_t
    !> Of the contact forces on the sheet by the motion of the tools; of loads and supports.
    real(wp) :: tools = 0.0_wp, external = 0.0_wp
    !> Of the internal forces, of the equivalent stress, of friction.
    real(wp) :: internal = 0.0_wp, plastic = 0.0_wp, friction = 0.0_wp
    !> Elastic energy that falling moduli added.
    real(wp) :: modulus = 0.0_wp
  contains
    procedure :: walk
  end type work_state_t

contains

  !> Pass every component to a visitor.
  subroutine walk(self, visitor)
    class(work_state_t), intent(inout) :: self
    class(state_visitor_t), intent(inout) :: visitor

    call visitor%one_real("tool_work", self%tools)
    call visitor%one_real("external_work", self%external)
    call visitor%one_real("internal_work", self%internal)
    call visitor%one_real("plastic_work", self%plastic)
    call visitor%one_real("friction_work", self%friction)
    call visitor%one_real("modulus_energy", self%modulus)
  end subroutine walk

end module dd3_model_work_state
