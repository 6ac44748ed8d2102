! SPDX-License-Identifier: GPL-3.0-or-later
!> Normal of the initial sheet, and the axes of its materials. A mesh from a file may stand in any
!> plane: where the input leaves `normal_direction` out, the normal is that of the elements of the
!> material.
module dd3_setup_axes
  use dd3_base_kinds, only : pi, wp
  use dd3_base_error, only : error_list_t
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : newline, to_text
  use dd3_input_case, only : case_t
  use dd3_input_fill_material, only : frame_of
  use dd3_linalg_tensor, only : cross, kelvin_rotation, rotation_about
  use dd3_material_yield_criterion, only : yield_criterion_t
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: set_axes, normal_report, normal_warnings, direction_text

  real(wp), parameter :: degrees = 180.0_wp/pi
  !> Angle between a direction of the input and the sheet, degrees, above which a warning is given.
  real(wp), parameter :: largest_angle = 5.0_wp
  !> Size of the mean normal of the elements, at least, of a sheet that has one.
  real(wp), parameter :: least_mean = 0.5_wp
  !> Deviation of the sheet's normal from that of the default at which it is taken for the same.
  real(wp), parameter :: same_direction = 1.0e-6_wp

contains

  !> Set the axes of the materials whose `normal_direction` the input leaves out: a sheet from a
  !> file has its own normal.
  subroutine set_axes(model, case, errors)
    !> With its mesh and materials.
    type(model_t), intent(inout) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    real(wp) :: normal(3)
    integer :: m

    if (size(case%mesh) == 0) return
    do m = 1, size(case%material)
      associate (material => case%material(m))
        if (material%source%has("normal_direction") .or. .not. any(model%material_of == m)) cycle
        normal = mean_normal(model, m)
        if (norm2(normal) < least_mean) cycle
        normal = normal/norm2(normal)
        if (norm2(normal(:2)) <= same_direction .and. any(abs(model%axes(:, :, m)) > 0.0_wp)) cycle
        ! The laws do not know the two faces apart: upwards, or along the axis that is nearest.
        if (normal(maxloc(abs(normal), dim=1)) < 0.0_wp) normal = -normal
        ! The sum clears negative zeros.
        model%axes(:, :, m) = frame_of(material%source%numbers("rolling_direction"), normal) + &
            0.0_wp
        if (any(abs(model%axes(:, :, m)) > 0.0_wp)) cycle
        if (.not. material%source%given("rolling_direction")) then
          ! Any direction in the sheet, if the law knows none.
          model%axes(:, :, m) = frame_of([0.0_wp, 1.0_wp, 0.0_wp], normal)
          if (is_isotropic(model%material(m)%laws%criterion)) cycle
        end if
        call errors%push_input(material%source%at("rolling_direction"), "the rolling "// &
            "direction of material '"//material%source%called()//"' is normal to the sheet, "// &
            "whose normal is "//direction_text(normal), &
            "rolling_direction in the plane of the sheet", code="E135")
      end associate
    end do
  end subroutine set_axes

  !> Return the mean normal of the elements of a material by area, from bottom to top; shorter than
  !> 1 if the sheet is curved.
  pure function mean_normal(model, m) result(mean)
    type(model_t), intent(in) :: model
    integer, intent(in) :: m
    real(wp) :: mean(3)

    real(wp) :: area(3), total
    integer :: e

    mean = 0.0_wp
    total = 0.0_wp
    do e = 1, model%n_element
      if (model%material_of(e) /= m) cycle
      area = area_of(model, e)
      mean = mean + area
      total = total + norm2(area)
    end do
    mean = mean/max(total, tiny(1.0_wp))
  end function mean_normal

  !> Return the area of the middle surface of an element times its normal, mm2.
  pure function area_of(model, e) result(area)
    type(model_t), intent(in) :: model
    integer, intent(in) :: e
    real(wp) :: area(3)

    real(wp) :: middle(3, 4)

    associate (node => model%connectivity(:8, e))
      middle = 0.5_wp*(model%x0(:, node(:4)) + model%x0(:, node(5:)))
    end associate
    area = 0.5_wp*cross(middle(:, 3) - middle(:, 1), middle(:, 4) - middle(:, 2))
  end function area_of

  !> Whether a criterion has no directions: the value of a stress does not depend on its axes.
  pure logical function is_isotropic(criterion)
    class(yield_criterion_t), intent(in) :: criterion

    real(wp), parameter :: stress(6) = [1.0_wp, -0.3_wp, 0.2_wp, 0.4_wp, 0.1_wp, -0.5_wp]
    real(wp), parameter :: axis(3) = [1.0_wp, 2.0_wp, 3.0_wp]
    real(wp) :: value, turned
    integer :: i

    value = criterion%value(stress)
    is_isotropic = .true.
    do i = 1, 3
      turned = criterion%value(matmul(kelvin_rotation(rotation_about(axis/norm2(axis), &
          real(i, wp))), stress))
      is_isotropic = is_isotropic .and. abs(turned - value) <= 1.0e-9_wp*abs(value)
    end do
  end function is_isotropic

  !> Return a line for each material whose axes are not those of the input, with its end.
  function normal_report(case, model) result(text)
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    character(len=:), allocatable :: text

    integer :: m

    text = ""
    if (size(case%mesh) == 0) return
    do m = 1, size(case%material)
      if (all(abs(model%axes(:, :, m) - case%material(m)%frame) <= 0.0_wp)) cycle
      text = text//"material "//trim(model%material_name(m))//": normal_direction is left out; "// &
          "the normal of the sheet is "//direction_text(model%axes(:, 3, m))// &
          ", the rolling direction "//direction_text(model%axes(:, 1, m))//newline
    end do
  end function normal_report

  !> Warn of orthotropic materials whose axes do not lie in the sheet.
  subroutine normal_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    real(wp) :: angle, rolling(3)
    integer :: m

    ! The sheet of another run has its own axes.
    if (size(case%start) > 0 .or. .not. allocated(model%material_of)) return
    do m = 1, size(case%material)
      if (.not. any(model%material_of == m)) cycle
      if (is_isotropic(model%material(m)%laws%criterion)) cycle
      associate (source => case%material(m)%source)
        angle = largest_deviation(model, m)
        if (angle > largest_angle) call warnings%add_new("W020", "normal_direction = "// &
            direction_text(model%axes(:, 3, m))//" of material '"//source%called()// &
            "' is up to "//to_text(angle, 3)//" degrees away from the normal of the sheet, "// &
            "which is "//direction_text(mean_normal(model, m))//" in the mean: the law would "// &
            "take other directions for those in the sheet", source%at("normal_direction"))
        rolling = source%numbers("rolling_direction")
        angle = degrees*asin(min(1.0_wp, abs(dot_product(rolling, model%axes(:, 3, m)))/ &
            norm2(rolling)))
        if (angle > largest_angle .and. source%given("rolling_direction")) then
          call warnings%add_new("W020", "rolling_direction of material '"//source%called()// &
            "' points out of the sheet by "//to_text(angle, 3)// &
            " degrees; its projection is taken", source%at("rolling_direction"))
        end if
      end associate
    end do
  end subroutine normal_warnings

  !> Return the largest angle between the normal of an element and that of its material, degrees.
  pure real(wp) function largest_deviation(model, m) result(angle)
    type(model_t), intent(in) :: model
    integer, intent(in) :: m

    real(wp) :: area(3)
    integer :: e

    angle = 0.0_wp
    do e = 1, model%n_element
      if (model%material_of(e) /= m) cycle
      area = area_of(model, e)
      angle = max(angle, degrees*acos(min(1.0_wp, abs(dot_product(area, model%axes(:, 3, m)))/ &
          max(norm2(area), tiny(1.0_wp)))))
    end do
  end function largest_deviation

  !> Return a direction as text.
  function direction_text(direction) result(text)
    real(wp), intent(in) :: direction(3)
    character(len=:), allocatable :: text

    real(wp) :: clean(3)

    clean = merge(direction, 0.0_wp, abs(direction) > 1.0e-9_wp)
    text = to_text(clean(1), 4)//" "//to_text(clean(2), 4)//" "//to_text(clean(3), 4)
  end function direction_text

end module dd3_setup_axes
