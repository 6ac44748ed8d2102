! SPDX-License-Identifier: GPL-3.0-or-later
!> Limits of the predictor by the accuracy that the user states. Their errors are those of
!> docs/reports/increments.md.
module dd3_settings_accuracy
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_settings_limits, only : limit_spec_t, limits_spec_t
  implicit none
  private
  public :: set_by_accuracy, accuracy_names, default_by_accuracy, mixed_defaults

  !> Level of the accuracy: maximum strain increment, rotation increment in degrees, depth over the
  !> thickness, and factor on the trial increment.
  type :: level_t
    character(len=8) :: name
    real(wp) :: strain, rotation, depth, r_max
  end type level_t

  type(level_t), parameter :: level(3) = [ &
      level_t("draft", strain=0.125_wp, rotation=5.0_wp, depth=0.2_wp, r_max=1.0_wp), &
      level_t("standard", strain=0.1_wp, rotation=4.0_wp, depth=0.1_wp, r_max=1.0_wp), &
      level_t("fine", strain=0.025_wp, rotation=1.0_wp, depth=0.05_wp, r_max=0.5_wp)]

  !> Divisors of strain and rotation, and of the depth, in the mixed formulation. Its active set
  !> settles with smaller increments only, and it has no resistance behind a gap.
  real(wp), parameter :: mixed_divisor = 2.0_wp, mixed_depth_divisor = 10.0_wp

contains

  !> Set the limits that the input does not give.
  pure subroutine set_by_accuracy(limits, mixed)
    type(limits_spec_t), intent(inout) :: limits
    !> Whether the contact is of the mixed formulation.
    logical, intent(in) :: mixed

    real(wp) :: divisor, depth_divisor
    integer :: i

    divisor = merge(mixed_divisor, 1.0_wp, mixed)
    depth_divisor = merge(mixed_depth_divisor, 1.0_wp, mixed)
    do i = 1, size(level)
      if (level(i)%name /= limits%accuracy) cycle
      call set_default(limits%strain, level(i)%strain/divisor)
      call set_default(limits%rotation, level(i)%rotation/divisor)
      call set_default(limits%depth, level(i)%depth/depth_divisor)
      call set_default(limits%r_max, level(i)%r_max)
    end do
  end subroutine set_by_accuracy

  !> Set a limit that is not given.
  pure subroutine set_default(limit, value)
    type(limit_spec_t), intent(inout) :: limit
    real(wp), intent(in) :: value

    if (.not. limit%given) limit = limit_spec_t(active=.true., value=value)
  end subroutine set_default

  !> Return a note on the limits that are smaller by default in the mixed formulation, as a text;
  !> empty if all are given.
  pure function mixed_defaults(limits) result(text)
    type(limits_spec_t), intent(in) :: limits
    character(len=:), allocatable :: text

    text = ""
    if (.not. limits%strain%given) text = text//", strain 1/"//to_text(mixed_divisor)
    if (.not. limits%rotation%given) text = text//", rotation 1/"//to_text(mixed_divisor)
    if (.not. limits%depth%given) text = text//", depth 1/"//to_text(mixed_depth_divisor)
    if (text == "") return
    text = "of accuracy = "//trim(limits%accuracy)//" in the mixed formulation: "//text(3:)
  end function mixed_defaults

  !> Return the names of the levels, separated by blanks.
  pure function accuracy_names() result(text)
    character(len=:), allocatable :: text

    integer :: i

    text = trim(level(1)%name)
    do i = 2, size(level)
      text = text//" "//trim(level(i)%name)
    end do
  end function accuracy_names

  !> Return the defaults of a limit as a text.
  pure function default_by_accuracy(key) result(text)
    !> Any of strain, rotation, depth, r_max.
    character(len=*), intent(in) :: key
    character(len=:), allocatable :: text

    real(wp) :: value(size(level)), divisor
    integer :: i

    divisor = mixed_divisor
    select case (key)
      case ("strain")
        value = level%strain
      case ("rotation")
        value = level%rotation
      case ("depth")
        value = level%depth
        divisor = mixed_depth_divisor
      case ("r_max")
        value = level%r_max
        divisor = 1.0_wp
      case default
        value = 0.0_wp
    end select
    text = "default: "//trim(level(1)%name)//" "//to_text(value(1))
    do i = 2, size(level)
      text = text//", "//trim(level(i)%name)//" "//to_text(value(i))
    end do
    if (divisor > 1.0_wp) text = text//"; mixed: 1/"//to_text(divisor)//" of that"
  end function default_by_accuracy

end module dd3_settings_accuracy
