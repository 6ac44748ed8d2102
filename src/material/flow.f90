! SPDX-License-Identifier: GPL-3.0-or-later
!> Results of criterion, hardening law and back-stress laws at one stress, for the return mapping.
!> Tensors are Kelvin vectors and matrices in the orthotropy axes.
module dd3_material_flow
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: flow_direction_t, flow_response_t, back_response_t

  !> The criterion at the effective stress xi = T - X.
  type :: flow_direction_t
    !> Effective stress xi, MPa.
    real(wp) :: stress(6)
    !> Equivalent stress sb(xi), MPa.
    real(wp) :: equivalent
    !> Flow direction V = d sb/d xi.
    real(wp) :: gradient(6)
    !> Second derivative H = d2 sb/d xi2, 1/MPa.
    real(wp) :: second(6, 6)
  end type flow_direction_t

  !> The hardening law at the end of a plastic increment.
  type :: flow_response_t
    !> Flow stress Y, MPa.
    real(wp) :: value
    !> Derivative in the plastic increment, MPa.
    real(wp) :: slope
    !> Derivative in xi: zero except for laws that depend on the strain path.
    real(wp) :: gradient(6)
  end type flow_response_t

  !> A back-stress at the end of a plastic increment.
  type :: back_response_t
    !> Back-stress X, MPa.
    real(wp) :: value(6)
    !> Derivative in the plastic increment, MPa.
    real(wp) :: slope(6)
    !> Derivative in xi.
    real(wp) :: gradient(6, 6)
  end type back_response_t

end module dd3_material_flow
