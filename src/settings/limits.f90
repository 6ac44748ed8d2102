! SPDX-License-Identifier: GPL-3.0-or-later
!> Settings of the limits of the predictor.
module dd3_settings_limits
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: limit_spec_t, limits_spec_t

  !> Limit with a switch.
  type :: limit_spec_t
    logical :: active = .false.
    !> If not active, a value that never limits.
    real(wp) :: value = huge(1.0_wp)
    !> Whether the input gives it.
    logical :: given = .false.
  end type limit_spec_t

  !> Limits of the predictor; all are off until set.
  type :: limits_spec_t
    !> Accuracy, from which the limits strain, rotation, depth and r_max follow that are not
    !> given.
    character(len=8) :: accuracy = "standard"
    !> Maximum strain increment.
    type(limit_spec_t) :: strain
    !> Maximum rotation increment, degrees.
    type(limit_spec_t) :: rotation
    !> Maximum stress increments tangential (a) and normal (b) to the yield surface, over the flow
    !> stress.
    type(limit_spec_t) :: stress_tangential, stress_normal
    !> c, d, e of the contact force limit.
    type(limit_spec_t) :: force(3)
    !> Floor of the reference contact force.
    type(limit_spec_t) :: force_floor = limit_spec_t(value=0.0_wp)
    !> Maximum predicted depth of a node beyond the onset of contact, over the thickness.
    type(limit_spec_t) :: depth
    !> Maximum fraction of the plastic points that unload in a prediction that is not repeated.
    type(limit_spec_t) :: unloading
    !> Minimum and maximum of the factor r on the trial increment.
    type(limit_spec_t) :: r_min = limit_spec_t(value=0.0_wp), r_max
  end type limits_spec_t

end module dd3_settings_limits
