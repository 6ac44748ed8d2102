! SPDX-License-Identifier: GPL-3.0-or-later
!> Planes of symmetry of the sheet, by its supports, and what is not symmetric to them: a material
!> whose flow stresses of a stress state and of its mirror image differ, and gravity. The part that
!> is computed is then no part of the whole.
module dd3_setup_symmetry_planes
  use dd3_base_kinds, only : wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : axis_name, to_text
  use dd3_input_case, only : case_t
  use dd3_linalg_tensor, only : identity, kelvin_rotation
  use dd3_model_model, only : model_t
  use dd3_model_rim, only : is_on_symmetry_plane
  use dd3_setup_axes, only : direction_text
  implicit none
  private
  public :: symmetry_warnings

  !> Relative difference of the flow stresses of a stress and its mirror image up to which a
  !> material is symmetric, and part of gravity along the normal up to which this is.
  real(wp), parameter :: unlike = 1.0e-3_wp

contains

  !> Warn of planes of symmetry that materials or gravity do not have. A plane of symmetry is a side
  !> of the sheet whose nodes are held along its normal, and not all of them in other directions.
  subroutine symmetry_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    character(len=:), allocatable :: plane
    real(wp) :: difference
    integer :: axis, i, k

    ! The sheet of another run has its own axes; it has been warned of there.
    if (size(case%start) > 0 .or. .not. allocated(model%material_of)) return
    do axis = 1, 3
      k = support_along(case, axis)
      if (k == 0) cycle
      plane = plane_along(model, axis)
      if (len(plane) == 0) cycle
      do i = 1, size(case%material)
        difference = unlikeness(model, i, axis)
        if (difference > unlike) call add("material '"//case%material(i)%source%called()// &
            "' with the rolling direction "//direction_text(model%axes(:, 1, i))// &
            ": flow stresses on its two sides would differ by up to "// &
            to_text(100.0_wp*difference, 2)//" %")
      end do
      do i = 1, size(case%phase)
        associate (gravity => case%phase(i)%gravity)
          if (case%phase(i)%has_gravity .and. abs(gravity(axis)) > unlike*norm2(gravity)) call &
              add("gravity of phase '"//case%phase(i)%source%called()//"', "// &
              to_text(gravity(axis), 4)//" mm/s2 along "//axis_name(axis))
        end associate
      end do
    end do

  contains

    subroutine add(what)
      !> What is not symmetric to the plane.
      character(len=*), intent(in) :: what

      call warnings%add_new("W029", "fix = "//axis_name(axis)//" of '"// &
          case%boundary(k)%source%called()//"': the side "//plane//" is held like a plane of "// &
          "symmetry, which is none of "//what//"; compute the whole sheet, unless this is "// &
          "another support", case%boundary(k)%source%at("fix"))
    end subroutine add

  end subroutine symmetry_warnings

  !> Return the first support along an axis, if there is one along this axis only; 0 for none.
  pure integer function support_along(case, axis) result(k)
    type(case_t), intent(in) :: case
    integer, intent(in) :: axis

    do k = 1, size(case%boundary)
      if (case%boundary(k)%fix(axis) .and. count(case%boundary(k)%fix) == 1) return
    end do
    k = 0
  end function support_along

  !> Return the place of the first plane of symmetry normal to an axis, "x = 0"; empty for none, as
  !> where all nodes of the sheet are held.
  function plane_along(model, axis) result(text)
    type(model_t), intent(in) :: model
    integer, intent(in) :: axis
    character(len=:), allocatable :: text

    integer :: f

    text = ""
    if (all(model%fixed(axis, :))) return
    do f = 1, model%face%n
      if (.not. is_on_symmetry_plane(model, f, axis)) cycle
      associate (node => model%face%node(:, f))
        if (any(all(model%fixed(:, node), dim=2) .neqv. [1, 2, 3] == axis)) cycle
        text = axis_name(axis)//" = "//to_text(model%x0(axis, node(1)), 4)
      end associate
      return
    end do
  end function plane_along

  !> Return the largest relative difference of the flow stresses of a material for stresses in the
  !> sheet and for their mirror images; 0 for a material that is not used.
  pure real(wp) function unlikeness(model, m, axis) result(difference)
    type(model_t), intent(in) :: model
    !> Number of the material, and the axis normal to the mirror.
    integer, intent(in) :: m, axis

    !> Kelvin, in the axes of the material.
    real(wp), parameter :: stress(6, 5) = reshape([ &
        1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
        0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, &
        0.5_wp, 0.5_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.7_wp, &
        0.9_wp, 0.2_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.5_wp, &
        1.0_wp, -0.3_wp, 0.0_wp, 0.0_wp, 0.0_wp, -0.4_wp], [6, 5])
    real(wp) :: mirror(6, 6), value
    integer :: i

    difference = 0.0_wp
    if (.not. any(model%material_of == m)) return
    associate (normal => model%axes(axis, :, m), criterion => model%material(m)%laws%criterion)
      mirror = kelvin_rotation(identity - 2.0_wp*spread(normal, 2, 3)*spread(normal, 1, 3))
      do i = 1, size(stress, 2)
        value = criterion%value(stress(:, i))
        difference = max(difference, &
            abs(criterion%value(matmul(mirror, stress(:, i))) - value)/value)
      end do
    end associate
  end function unlikeness

end module dd3_setup_symmetry_planes
