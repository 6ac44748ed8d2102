! SPDX-License-Identifier: GPL-3.0-or-later
!> Tools under a prescribed force. Each has three unknowns q = (s, t_1, t_2): its displacement along
!> the line d of its force, and, if it tilts, its rotations about two axes e_1 and e_2 across the
!> line, through a pivot c on the tool. A point p of the tool moves by
!>     dw = A(p) dq,    A = [d, e_1 x (p - c), e_2 x (p - c)],
!> and the forces f of the sheet at points p balance the force P on the tool, which acts at its
!> pivot:
!>     Q = sum A(p)^T f + (d.P, -k phi_1, -k phi_2) = 0,
!> phi being the tilt so far and k the stiffness of its support. As the tool tilts, a force turns
!> with the normal n under it, df = S dq, S = [0, w_1 x f, w_2 x f], w_i = e_i - n n.e_i, and its
!> moment changes as the point moves, f.dA = P^T (dp - d ds), P = [0, f x e_1, f x e_2]. Without
!> tilt the last two columns of all three are zero, and q = (s, 0, 0).
module dd3_model_pressed_tools
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : cross, identity, rotation_about
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_model_tools_state, only : tools_state_t
  implicit none
  private
  public :: point_motion, force_turn, arm_change, tool_balance, unknowns_of, motion_of
  public :: is_free, support_stiffness, motion_at, turn_tools, begin_tilts, tilt_of, &
      contact_moment, as_forces

contains

  !> Return A, the displacement of a place on a pressed tool by its unknowns.
  pure function point_motion(phase, tools, tool, place) result(a)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    !> mm.
    real(wp), intent(in) :: place(3)
    real(wp) :: a(3, 3)

    a = moments(phase, tool, place - tools%centre(:, tool) - tools%displacement(:, tool))
    a(:, 1) = phase%direction(:, tool)
  end function point_motion

  !> Whether each unknown of a tool is free: none of one that is not pressed, the first of one that
  !> does not tilt.
  pure function is_free(phase, tool) result(free)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    logical :: free(3)

    free = [phase%pressed(tool), phase%tilts(tool), phase%tilts(tool)]
  end function is_free

  !> Return the stiffness of the support of a tool against each of its unknowns: 0, and k in
  !> N.mm/rad.
  pure function support_stiffness(phase, tool) result(stiffness)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    real(wp) :: stiffness(3)

    stiffness = [0.0_wp, phase%tilt(tool)%stiffness, phase%tilt(tool)%stiffness]
  end function support_stiffness

  !> Return S, the change of a force on a pressed tool as the tool tilts.
  pure function force_turn(phase, tool, normal, force) result(s)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    !> Of the tool, a unit vector, and the force, N.
    real(wp), intent(in) :: normal(3), force(3)
    real(wp) :: s(3, 3)

    s = moments(phase, tool, force) &
        - spread(cross(normal, force), 2, 3)*spread(tilt_along(phase, tool, normal), 1, 3)
  end function force_turn

  !> Return P, the change of the moments of a force by the motion of its point.
  pure function arm_change(phase, tool, force) result(p)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    !> N.
    real(wp), intent(in) :: force(3)
    real(wp) :: p(3, 3)

    p = -moments(phase, tool, force)
  end function arm_change

  !> Return 0 and the products e_1 x v and e_2 x v of a vector v with the axes of the tilt of a
  !> tool; zero without tilt.
  pure function moments(phase, tool, vector) result(product)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    real(wp), intent(in) :: vector(3)
    real(wp) :: product(3, 3)

    product = 0.0_wp
    if (.not. phase%tilts(tool)) return
    associate (axis => across(phase%direction(:, tool)))
      product(:, 2) = cross(axis(:, 1), vector)
      product(:, 3) = cross(axis(:, 2), vector)
    end associate
  end function moments

  !> Return 0 and the components of a vector along the axes of the tilt of a tool; zero without
  !> tilt.
  pure function tilt_along(phase, tool, vector) result(component)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    real(wp), intent(in) :: vector(3)
    real(wp) :: component(3)

    component = 0.0_wp
    if (phase%tilts(tool)) component(2:3) = matmul(vector, across(phase%direction(:, tool)))
  end function tilt_along

  !> Return two unit vectors across a line and each other.
  pure function across(line) result(axis)
    !> Unit vector.
    real(wp), intent(in) :: line(3)
    real(wp) :: axis(3, 2)

    axis(:, 1) = cross(line, identity(:, minloc(abs(line), dim=1)))
    axis(:, 1) = axis(:, 1)/norm2(axis(:, 1))
    axis(:, 2) = cross(line, axis(:, 1))
  end function across

  !> Return Q, the residual of the balance of a pressed tool: N, and N.mm about the axes of its
  !> tilt.
  function tool_balance(model, state, tool, point_force) result(balance)
    type(model_t), intent(in) :: model
    !> Has the force on the tool and that of the sheet.
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    !> Forces of the contact points of this rank, `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    real(wp) :: balance(3)

    balance = 0.0_wp
    associate (phase => model%phase(state%phase), tools => state%tools)
      balance(1) = dot_product(phase%direction(:, tool), tools%load(:, tool) &
          + tools%force(:, tool))
      if (.not. phase%tilts(tool)) return
      balance(2:3) = matmul(contact_moment(model, state, tool, point_force) &
          - phase%tilt(tool)%stiffness*tilt_of(tools, tool), across(phase%direction(:, tool)))
    end associate
  end function tool_balance

  !> Return the residual of the balance of a tool as forces: its moments over the arm of the tool,
  !> N.
  pure function as_forces(phase, tool, balance) result(force)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    !> N, and N.mm.
    real(wp), intent(in) :: balance(3)
    real(wp) :: force(3)

    force = [balance(1), balance(2:3)/phase%tilt(tool)%arm]
  end function as_forces

  !> Return the moment of contact forces on a tool about a point, its centre by default, N.mm.
  function contact_moment(model, state, tool, point_force, about) result(moment)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    integer, intent(in) :: tool
    !> `(3, n_contact)`, N.
    real(wp), intent(in) :: point_force(:, :)
    !> mm.
    real(wp), intent(in), optional :: about(3)
    real(wp) :: moment(3)

    type(surface_point_t) :: point
    real(wp) :: centre(3)
    integer :: c

    centre = state%tools%centre(:, tool) + state%tools%displacement(:, tool)
    if (present(about)) centre = about
    moment = 0.0_wp
    do c = 1, model%n_contact
      if (state%contact%tool(c) /= tool .or. state%contact%status(c) == status_gap) cycle
      point = model%contact_point(c)%at_place(state%contact%place(c))
      moment = moment + cross(point%position(state%x) - centre, point_force(:, c))
    end do
    call sum_over_ranks(3, moment)
  end function contact_moment

  !> Return the unknowns of a pressed tool from its motion.
  pure function unknowns_of(phase, tool, displacement, tilt) result(q)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    !> Of the pivot, mm, and rotation vector, rad.
    real(wp), intent(in) :: displacement(3), tilt(3)
    real(wp) :: q(3)

    q = tilt_along(phase, tool, tilt)
    q(1) = dot_product(phase%direction(:, tool), displacement)
  end function unknowns_of

  !> Set the motion of a pressed tool from its unknowns.
  pure subroutine motion_of(phase, tool, q, displacement, tilt)
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    real(wp), intent(in) :: q(3)
    !> Of the pivot, mm, and rotation vector, rad.
    real(wp), intent(out) :: displacement(3), tilt(3)

    displacement = q(1)*phase%direction(:, tool)
    tilt = 0.0_wp
    if (phase%tilts(tool)) tilt = matmul(across(phase%direction(:, tool)), q(2:3))
  end subroutine motion_of

  !> Return the displacement of a place on a tool, mm.
  pure function motion_at(tools, tool, place, displacement, tilt) result(motion)
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    !> Of the place and of the pivot, mm, and rotation vector, rad.
    real(wp), intent(in) :: place(3), displacement(3), tilt(3)
    real(wp) :: motion(3)

    motion = displacement &
        + cross(tilt, place - tools%centre(:, tool) - tools%displacement(:, tool))
  end function motion_at

  !> Turn the tools by rotation vectors from given rotations.
  pure subroutine turn_tools(start, tilt, rotation)
    !> `(3, 3, n_tool)`.
    real(wp), intent(in) :: start(:, :, :)
    !> `(3, n_tool)`, rad.
    real(wp), intent(in) :: tilt(:, :)
    !> `(3, 3, n_tool)`.
    real(wp), intent(inout) :: rotation(:, :, :)

    integer :: t

    do t = 1, size(tilt, 2)
      associate (angle => norm2(tilt(:, t)))
        rotation(:, :, t) = start(:, :, t)
        if (angle > 0.0_wp) rotation(:, :, t) = matmul(rotation_about(tilt(:, t)/angle, angle), &
            start(:, :, t))
      end associate
    end do
  end subroutine turn_tools

  !> Refer the displacements of the tools that begin to tilt in a phase to their pivots, and their
  !> tilt to their present rotations.
  pure subroutine begin_tilts(phase, tilted, tools)
    type(phase_t), intent(in) :: phase
    !> Tools that tilted in the phase before, `(n_tool)`.
    logical, intent(in) :: tilted(:)
    type(tools_state_t), intent(inout) :: tools

    integer :: t

    do t = 1, size(tilted)
      if (.not. phase%tilts(t)) cycle
      call tools%refer_to(t, phase%tilt(t)%pivot)
      if (.not. tilted(t)) tools%untilted(:, :, t) = tools%rotation(:, :, t)
    end do
  end subroutine begin_tilts

  !> Return the tilt of a tool, the rotation vector from where it stood untilted, rad.
  pure function tilt_of(tools, tool) result(tilt)
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    real(wp) :: tilt(3)

    real(wp) :: turn(3, 3), sine

    turn = matmul(tools%rotation(:, :, tool), transpose(tools%untilted(:, :, tool)))
    tilt = 0.5_wp*[turn(3, 2) - turn(2, 3), turn(1, 3) - turn(3, 1), turn(2, 1) - turn(1, 2)]
    sine = norm2(tilt)
    if (sine > 0.0_wp) tilt = atan2(sine, 0.5_wp*(turn(1, 1) + turn(2, 2) + turn(3, 3) - 1.0_wp)) &
        /sine*tilt
  end function tilt_of

end module dd3_model_pressed_tools
