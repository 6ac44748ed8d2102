!> Limits of the predictor by the accuracy that the user states. Their errors are those of
!> docs/reports/increments.md.
module dd3_input_accuracy
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_input_case, only : limit_spec_t, limits_spec_t
  implicit none
  private
  public :: set_by_accuracy, accuracy_names, default_by_accuracy

  !> Level of the accuracy: maximum strain increment, rotation increment in degrees, and depth over
  !> the thickness.
  type :: level_t
    character(len=8) :: name
    real(wp) :: strain, rotation, depth
  end type level_t

  type(level_t), parameter :: level(3) = [ &
      level_t("draft", strain=0.125_wp, rotation=5.0_wp, depth=0.2_wp), &
      level_t("standard", strain=0.1_wp, rotation=4.0_wp, depth=0.1_wp), &
      level_t("fine", strain=0.025_wp, rotation=1.0_wp, depth=0.05_wp)]

  !> Fractions of these limits in the mixed formulation. Its active set settles with smaller
  !> increments only, and it has no resistance behind a gap.
  real(wp), parameter :: mixed_fraction = 0.5_wp, mixed_depth_fraction = 0.1_wp

contains

  !> Set the limits that the input does not give.
  pure subroutine set_by_accuracy(limits, mixed)
    type(limits_spec_t), intent(inout) :: limits
    !> Whether the contact is of the mixed formulation.
    logical, intent(in) :: mixed

    real(wp) :: fraction, depth_fraction
    integer :: i

    fraction = merge(mixed_fraction, 1.0_wp, mixed)
    depth_fraction = merge(mixed_depth_fraction, 1.0_wp, mixed)
    do i = 1, size(level)
      if (level(i)%name /= limits%accuracy) cycle
      call set_default(limits%strain, fraction*level(i)%strain)
      call set_default(limits%rotation, fraction*level(i)%rotation)
      call set_default(limits%depth, depth_fraction*level(i)%depth)
    end do
  end subroutine set_by_accuracy

  !> Set a limit that is not given.
  pure subroutine set_default(limit, value)
    type(limit_spec_t), intent(inout) :: limit
    real(wp), intent(in) :: value

    if (.not. limit%given) limit = limit_spec_t(active=.true., value=value)
  end subroutine set_default

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
    !> Any of strain, rotation, depth.
    character(len=*), intent(in) :: key
    character(len=:), allocatable :: text

    real(wp) :: value(size(level)), fraction
    integer :: i

    fraction = mixed_fraction
    select case (key)
      case ("strain")
        value = level%strain
      case ("rotation")
        value = level%rotation
      case ("depth")
        value = level%depth
        fraction = mixed_depth_fraction
    end select
    text = "default: "//trim(level(1)%name)//" "//to_text(value(1))
    do i = 2, size(level)
      text = text//", "//trim(level(i)%name)//" "//to_text(value(i))
    end do
    text = text//"; mixed: "//to_text(fraction)//" times that"
  end function default_by_accuracy

end module dd3_input_accuracy
