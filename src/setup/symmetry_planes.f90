! SPDX-License-Identifier: GPL-3.0-or-later
!> Planes of symmetry of the sheet, by its supports, and what is not symmetric to them: a material
!> whose flow stresses of a stress state and of its mirror image differ, gravity, and tools that
!> reach the plane and move, turn or tilt across it. The part that is computed is then no part of
!> the whole.
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
  !> material is symmetric, and part of a vector that may deviate from a direction.
  real(wp), parameter :: unlike = 1.0e-3_wp

contains

  !> Warn of planes of symmetry that materials, gravity or tools do not have. A plane of symmetry is
  !> a side of the sheet whose nodes are held along its normal, and not all of them in other
  !> directions.
  subroutine symmetry_warnings(case, model, warnings)
    !> Without errors.
    type(case_t), intent(in) :: case
    type(model_t), intent(in) :: model
    type(message_list_t), intent(inout) :: warnings

    character(len=:), allocatable :: motion
    real(wp), allocatable :: x(:, :)
    real(wp) :: difference
    integer :: axis, i, k, node, t

    if (size(case%boundary) == 0) return
    x = model%start_positions()
    do axis = 1, 3
      k = support_along(case, axis)
      node = node_on_plane(model, axis)
      if (k == 0 .or. node == 0) cycle
      do i = 1, size(case%material)
        ! The sheet of another run has its own axes; it has been warned of there.
        if (size(case%start) > 0) exit
        difference = unlikeness(model, i, axis)
        if (difference > unlike) call add("material '"//case%material(i)%source%called()// &
            "' with the rolling direction "//direction_text(model%axes(:, 1, i))// &
            " is not symmetric to it: flow stresses on its two sides would differ by up to "// &
            to_text(100.0_wp*difference, 2)//" %")
      end do
      do i = 1, size(case%phase)
        associate (gravity => case%phase(i)%gravity)
          if (case%phase(i)%has_gravity .and. across(gravity, axis)) call add("gravity of phase '" &
              //case%phase(i)%source%called()//"' has "//to_text(gravity(axis), 4)// &
              " mm/s2 along its normal")
        end associate
      end do
      do t = 1, size(model%tool)
        if (.not. reaches(model, t, axis, x(axis, node))) cycle
        motion = motion_across(case, t, axis)
        if (len(motion) > 0) call add("tool '"//model%tool(t)%name//"', which reaches it, "//motion)
      end do
    end do

  contains

    subroutine add(reason)
      !> What is not symmetric to the plane, "it".
      character(len=*), intent(in) :: reason

      call warnings%add_new("W029", "fix = "//axis_name(axis)//" of '"// &
          case%boundary(k)%source%called()//"': the side "//axis_name(axis)//" = "// &
          to_text(x(axis, node), 4)//" is held like a plane of symmetry, but "//reason// &
          "; compute the whole sheet, unless this is another support", &
          case%boundary(k)%source%at("fix"))
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

  !> Return a node of the first plane of symmetry normal to an axis; 0 for none, as where all nodes
  !> of the sheet are held.
  pure integer function node_on_plane(model, axis) result(on_plane)
    type(model_t), intent(in) :: model
    integer, intent(in) :: axis

    integer :: f

    on_plane = 0
    if (all(model%fixed(axis, :))) return
    do f = 1, model%face%n
      if (.not. is_on_symmetry_plane(model, f, axis)) cycle
      associate (node => model%face%node(:, f))
        if (any(all(model%fixed(:, node), dim=2) .neqv. [1, 2, 3] == axis)) cycle
        on_plane = node(1)
      end associate
      return
    end do
  end function node_on_plane

  !> Whether a vector has a component along an axis.
  pure logical function across(vector, axis)
    real(wp), intent(in) :: vector(3)
    integer, intent(in) :: axis

    across = abs(vector(axis)) > unlike*norm2(vector)
  end function across

  !> Whether a tool at its start reaches a plane, within the thickness of the sheet.
  pure logical function reaches(model, t, axis, place)
    type(model_t), intent(in) :: model
    !> Tool, and the axis normal to the plane.
    integer, intent(in) :: t, axis
    !> Place of the plane on the axis, mm.
    real(wp), intent(in) :: place

    associate (tool => model%tool(t))
      reaches = abs(place - tool%position(axis) - 0.5_wp*(tool%surface%lower(axis) + &
          tool%surface%upper(axis))) <= 0.5_wp*(tool%surface%upper(axis) - &
          tool%surface%lower(axis)) + model%thickness
    end associate
  end function reaches

  !> Return the first motion of a tool that is not symmetric to a plane, with its phase; empty for
  !> none.
  function motion_across(case, t, axis) result(text)
    type(case_t), intent(in) :: case
    !> Tool, and the axis normal to the plane.
    integer, intent(in) :: t, axis
    character(len=:), allocatable :: text

    integer :: i, k

    text = ""
    do i = 1, size(case%phase)
      associate (phase => case%phase(i))
        do k = 1, size(phase%move)
          if (phase%move(k)%tool == t .and. across(phase%move(k)%vector, axis)) text = "moves"
        end do
        do k = 1, size(phase%press)
          if (phase%press(k)%tool == t .and. across(phase%press(k)%vector, axis)) text = "presses"
        end do
        if (len(text) > 0) text = text//" along "//axis_name(axis)
        do k = 1, size(phase%turn)
          associate (direction => phase%turn(k)%value(4:6))
            if (phase%turn(k)%tool == t .and. abs(direction(axis)) < (1.0_wp - unlike)* &
                norm2(direction)) text = "turns about an axis that is not its normal"
          end associate
        end do
        if (any([(phase%tilt(k)%tool == t, k=1, size(phase%tilt))]) .or. &
            any([(phase%pin(k)%tool == t, k=1, size(phase%pin))])) text = "can tilt"
        if (len(text) == 0) cycle
        text = text//" in phase '"//phase%source%called()//"'"
      end associate
      return
    end do
  end function motion_across

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
