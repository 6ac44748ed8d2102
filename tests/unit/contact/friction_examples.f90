! SPDX-License-Identifier: GPL-3.0-or-later
!> Friction laws for the contact tests.
module friction_examples
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, pair_name
  use dd3_contact_friction, only : friction_t
  implicit none
  private
  public :: add_example

contains

  !> Add a law by its name; none for an empty one.
  recursive subroutine add_example(friction, name)
    type(friction_t), intent(inout) :: friction
    character(len=*), intent(in) :: name

    select case (name)
    case ("power")
      call friction%add_law(name, [law_value_t("p0", 10.0_wp), law_value_t("n", 0.8_wp), &
          law_value_t("p_min", 2.0_wp), law_value_t("p_max", 100.0_wp)])
    case ("light")
      ! Down to the pressures at the onset of contact.
      call friction%add_law("power", [law_value_t("p0", 0.1_wp), law_value_t("n", 0.6_wp), &
          law_value_t("p_min", 1.0e-4_wp)])
    case ("table")
      call friction%add_law(name, [law_value_t(pair_name, 1.2_wp, 1.0_wp), &
          law_value_t(pair_name, 1.0_wp, 20.0_wp), law_value_t(pair_name, 0.7_wp, 150.0_wp)])
    case ("stribeck")
      call friction%add_law(name, [law_value_t("v0", 30.0_wp), law_value_t("r", 0.4_wp), &
          law_value_t("n", 1.5_wp)])
    case ("speed_table")
      call friction%add_law(name, [law_value_t(pair_name, 1.0_wp, 5.0_wp), &
          law_value_t(pair_name, 0.8_wp, 40.0_wp), law_value_t(pair_name, 0.9_wp, 400.0_wp)])
    case ("strain_table")
      call friction%add_law(name, [law_value_t(pair_name, 1.0_wp, 0.0_wp), &
          law_value_t(pair_name, 1.3_wp, 0.2_wp)])
    case ("speed")
      call add_example(friction, "table")
      call add_example(friction, "stribeck")
    case default
      if (len(name) > 0) error stop "no such example"
    end select
  end subroutine add_example

end module friction_examples
