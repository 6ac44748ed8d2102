! SPDX-License-Identifier: GPL-3.0-or-later
!> Forces of the supports of a pressed tool: of the pins of its cushion, which share its force P and
!> follow their strokes s, and of spacers, springs that push it back once they touch,
!>     Q = sum_i a_i f(s_i) P v_i - sum_k c_k <g_k> v_k,    v = A^T d,
!> with shares a, factors f, stiffness c, overlap g and the displacement A of a place by the
!> unknowns of the tool (see dd3_model_pressed_tools). Its derivative by them,
!>     K = -sum_i a_i f'(s_i) P v_i v_i^T - sum_k c_k v_k v_k^T,
!> leaves out the change of the arms v, which is of second order in the tilt.
module dd3_model_tool_supports
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_pressed_tools, only : point_motion
  use dd3_model_tools_state, only : tools_state_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: support_balance, support_rate, support_matrix, on_spacer, cushion_force, spacer_force, &
      spacer_room, has_cushion, has_spacer

contains

  !> Return what the supports of a tool add to its balance with the force at its pivot: N, and N.mm
  !> about the axes of its tilt.
  pure function support_balance(phase, tools, tool) result(balance)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    real(wp) :: balance(3)

    integer :: k

    associate (load => load_of(phase, tools, tool))
      balance = load*pins(phase, tools, tool)
      if (allocated(phase%cushion(tool)%share)) balance(1) = balance(1) - load
    end associate
    do k = 1, size(phase%spacer)
      if (phase%spacer(k)%tool == tool) balance = balance &
          - phase%spacer(k)%stiffness*overlap(phase, tools, k)*arm(phase, tools, tool, &
          phase%spacer(k)%place)
    end do
  end function support_balance

  !> Return the rate of `support_balance` at a fixed position of the tool.
  pure function support_rate(phase, tools, tool, load_rate, tool_rate) result(rate)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    !> Rate of the force on it, N, and of the displacements of the tools, `(3, n_tool)`, mm.
    real(wp), intent(in) :: load_rate, tool_rate(:, :)
    real(wp) :: rate(3)

    integer :: k

    rate = load_rate*pins(phase, tools, tool)
    if (allocated(phase%cushion(tool)%share)) rate(1) = rate(1) - load_rate
    do k = 1, size(phase%spacer)
      associate (spacer => phase%spacer(k))
        if (spacer%tool /= tool .or. .not. overlap(phase, tools, k) > 0.0_wp) cycle
        rate = rate + spacer%stiffness*dot_product(phase%direction(:, tool), &
            tool_rate(:, spacer%other))*arm(phase, tools, tool, spacer%place)
      end associate
    end do
  end function support_rate

  !> Return -K, the stiffness of the supports against the unknowns of a tool.
  pure function support_matrix(phase, tools, tool) result(stiffness)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    real(wp) :: stiffness(3, 3)

    integer :: i, k

    stiffness = 0.0_wp
    associate (cushion => phase%cushion(tool))
      if (allocated(cushion%share)) then
        do i = 1, size(cushion%share)
          stiffness = stiffness + cushion%share(i)*load_of(phase, tools, tool) &
              *cushion%slope(stroke(phase, tools, tool, i)) &
              *square(arm(phase, tools, tool, cushion%place(:, i)))
        end do
      end if
    end associate
    do k = 1, size(phase%spacer)
      associate (spacer => phase%spacer(k))
        if (spacer%tool == tool .and. overlap(phase, tools, k) > 0.0_wp) stiffness = stiffness &
            + spacer%stiffness*square(arm(phase, tools, tool, spacer%place))
      end associate
    end do
  end function support_matrix

  !> Return the forces of the pins along the line of a tool and their moments, over its force.
  pure function pins(phase, tools, tool) result(balance)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    real(wp) :: balance(3)

    integer :: i

    balance = 0.0_wp
    associate (cushion => phase%cushion(tool))
      if (.not. allocated(cushion%share)) return
      do i = 1, size(cushion%share)
        balance = balance + cushion%share(i)*cushion%factor(stroke(phase, tools, tool, i)) &
            *arm(phase, tools, tool, cushion%place(:, i))
      end do
    end associate
  end function pins

  !> Return the force pressed on a tool along its line, N.
  pure real(wp) function load_of(phase, tools, tool)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool

    load_of = dot_product(phase%direction(:, tool), tools%load(:, tool))
  end function load_of

  !> Return v, the displacement along the line of a tool at a place on it by its unknowns.
  pure function arm(phase, tools, tool, place) result(v)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool
    !> In the frame of the surface, mm.
    real(wp), intent(in) :: place(3)
    real(wp) :: v(3)

    type(placement_t) :: placement

    placement = tools%placement(tool)
    v = matmul(phase%direction(:, tool), point_motion(phase, tools, tool, &
        placement%vector_to_global(place) + placement%translation))
  end function arm

  !> Return the product of a vector with itself.
  pure function square(v) result(product)
    real(wp), intent(in) :: v(3)
    real(wp) :: product(3, 3)

    product = spread(v, 2, 3)*spread(v, 1, 3)
  end function square

  !> Return the stroke of a pin: by how much the tool has pushed it back since it is pressed, mm.
  pure real(wp) function stroke(phase, tools, tool, pin)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool, pin

    stroke = -dot_product(phase%direction(:, tool), tools%displacement(:, tool) &
        - tools%rest(:, tool) + matmul(tools%rotation(:, :, tool) - tools%untilted(:, :, tool), &
        phase%cushion(tool)%place(:, pin) - tools%centre(:, tool)))
  end function stroke

  !> Return by how much a spacer is compressed, mm; 0 while it does not touch.
  pure real(wp) function overlap(phase, tools, k)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    !> Number of the spacer.
    integer, intent(in) :: k

    overlap = max(0.0_wp, -room(phase, tools, k))
  end function overlap

  !> Return the way of a spacer until it touches, mm; negative if it does.
  pure real(wp) function room(phase, tools, k)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: k

    type(placement_t) :: own, other

    associate (spacer => phase%spacer(k))
      own = tools%placement(spacer%tool)
      other = tools%placement(spacer%other)
      room = spacer%limit - dot_product(phase%direction(:, spacer%tool), &
          own%vector_to_global(spacer%place) + own%translation - spacer%place - other%translation)
    end associate
  end function room

  !> Return the smallest way of a pressed tool until one of its spacers touches, mm; a huge value
  !> without spacers.
  pure real(wp) function spacer_room(phase, tools, tool)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool

    integer :: k

    spacer_room = huge(1.0_wp)
    do k = 1, size(phase%spacer)
      if (phase%spacer(k)%tool == tool) spacer_room = min(spacer_room, room(phase, tools, k))
    end do
  end function spacer_room

  !> Whether a pressed tool lies on a spacer.
  pure logical function on_spacer(phase, tools, tool)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool

    on_spacer = phase%pressed(tool) .and. spacer_room(phase, tools, tool) < 0.0_wp
  end function on_spacer

  !> Return the force of the cushion on a tool, N.
  pure real(wp) function cushion_force(phase, tools, tool)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool

    real(wp) :: balance(3)

    balance = 0.0_wp
    if (phase%pressed(tool)) balance = load_of(phase, tools, tool)*pins(phase, tools, tool)
    cushion_force = balance(1)
  end function cushion_force

  !> Return the force of the spacers on a tool against its force, N.
  pure real(wp) function spacer_force(phase, tools, tool)
    type(phase_t), intent(in) :: phase
    type(tools_state_t), intent(in) :: tools
    integer, intent(in) :: tool

    integer :: k

    spacer_force = 0.0_wp
    if (.not. phase%pressed(tool)) return
    do k = 1, size(phase%spacer)
      if (phase%spacer(k)%tool == tool) spacer_force = spacer_force &
          + phase%spacer(k)%stiffness*overlap(phase, tools, k)
    end do
  end function spacer_force

  !> Whether a tool has a cushion in some phase.
  pure logical function has_cushion(model, tool)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool

    integer :: i

    has_cushion = any([(allocated(model%phase(i)%cushion(tool)%share), i=1, size(model%phase))])
  end function has_cushion

  !> Whether a tool has spacers in some phase.
  pure logical function has_spacer(model, tool)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool

    integer :: i

    has_spacer = any([(any(model%phase(i)%spacer%tool == tool), i=1, size(model%phase))])
  end function has_spacer

end module dd3_model_tool_supports
