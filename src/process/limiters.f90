!> The limiters of the factor r: how much of the trial increment is taken.
!> Source: Oliveira and Menezes 2004, eqs (9)-(12) and (15)-(18); Teodosiu and Cao 1988.
module dd3_process_limiters
  use dd3_base_kinds, only : wp, pi
  use dd3_base_text, only : to_text
  use dd3_linalg_tensor, only : symmetric_eigen, tensor_from_kelvin
  use dd3_input_case, only : until_displacement
  use dd3_contact_operator, only : status_gap
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_state, only : state_t
  use dd3_process_predictor, only : prediction_t
  use dd3_process_stage, only : until_value
  use dd3_system_contact, only : contact_work_t, touch
  use dd3_system_system, only : system_t
  implicit none
  private
  public :: limit_t, limit_increment

  !> A bound on r with its reason.
  type :: limit_t
    !> The bound.
    real(wp) :: r = huge(1.0_wp)
    !> Which limiter it comes from.
    character(len=16) :: name = ""
    !> The element and point, or the node and tool, that set it.
    character(len=64) :: at = ""
    !> What the limit on the contact forces alone allows, and the node, tool and B that set it;
    !> empty where it is off or nothing touches.
    real(wp) :: r_force = huge(1.0_wp)
    !> See above.
    character(len=64) :: force_at = ""
  end type limit_t

contains

  !> The factor r of this increment, with the limiter that won: eq. (18), and r never past the end
  !> of the phase or the next output.
  function limit_increment(model, phase, state, system, prediction, growth, &
      next_output) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state
    !> The predictor's system.
    type(system_t), intent(in) :: system
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    !> Bound that grows again after a cut-back.
    real(wp), intent(in) :: growth
    !> Progress of the phase at the next output of fields.
    real(wp), intent(in) :: next_output
    type(limit_t) :: limit

    type(limit_t) :: ends, force

    limit = limit_t(phase%limits%r_max%value, "r_max", "")
    call consider(limit, strain_limit(model, phase, prediction, limit%r))
    call consider(limit, rotation_limit(phase, prediction))
    call consider(limit, stress_limit(model, phase, state, system, prediction))
    force = force_limit(model, phase, state, system%contact, prediction)
    call consider(limit, force)
    if (limit%r < phase%limits%r_min%value) &
      limit = limit_t(phase%limits%r_min%value, "r_min", limit%at)
    call consider(limit, limit_t(growth, "cutback", ""))
    call consider(limit, gap_limit(model, phase, system%contact, prediction))
    ends = limit_t((1.0_wp - state%progress)/prediction%progress, "phase", "")
    call consider(ends, until_limit(model, phase, state, prediction))
    if (next_output <= 1.0_wp) &
      call consider(ends, limit_t((next_output - state%progress)/prediction%progress, "output", ""))
    call consider(limit, ends)
    limit%r_force = force%r
    limit%force_at = force%at
  end function limit_increment

  !> Keeps the smaller bound.
  subroutine consider(limit, candidate)
    !> The bound so far.
    type(limit_t), intent(inout) :: limit
    !> Another one.
    type(limit_t), intent(in) :: candidate

    if (candidate%r < limit%r) limit = candidate
  end subroutine consider

  !> Text for a point.
  function point_text(element, point) result(text)
    !> Element and integration point.
    integer, intent(in) :: element, point
    character(len=:), allocatable :: text

    text = "element "//to_text(element)//" point "//to_text(point)
  end function point_text

  !> Largest principal strain increment, eq. (9).
  function strain_limit(model, phase, prediction, r) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    !> The bound so far: points that cannot come below it are passed over by their strain's norm.
    real(wp), intent(in) :: r
    type(limit_t) :: limit

    real(wp) :: values(3), vectors(3, 3), norm, largest
    integer :: e, p

    if (.not. phase%limits%strain%active) return
    limit%name = "strain"
    largest = phase%limits%strain%value/r
    do e = 1, model%n_element
      do p = 1, model%element%n_point
        norm = norm2(prediction%strain(:, p, e))
        if (norm <= largest) cycle
        call symmetric_eigen(tensor_from_kelvin(prediction%strain(:, p, e)), values, vectors)
        if (maxval(abs(values)) <= largest) cycle
        largest = maxval(abs(values))
        limit%r = phase%limits%strain%value/largest
        limit%at = point_text(e, p)
      end do
    end do
  end function strain_limit

  !> Largest rotation increment, eq. (10).
  function rotation_limit(phase, prediction) result(limit)
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    type(limit_t) :: limit

    integer :: place(2)

    if (.not. phase%limits%rotation%active) return
    place = maxloc(prediction%rotation)
    limit%name = "rotation"
    limit%at = point_text(place(2), place(1))
    if (prediction%rotation(place(1), place(2)) <= 0.0_wp) return
    limit%r = phase%limits%rotation%value*pi/180.0_wp/prediction%rotation(place(1), place(2))
  end function rotation_limit

  !> Stress increments normal and tangential to the yield surface, eq. (11), with the modulus of
  !> cos(theta): a negative one, in unloading, would enlarge the bound.
  function stress_limit(model, phase, state, system, prediction) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state
    !> Holds the continuum tangents.
    type(system_t), intent(in) :: system
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    type(limit_t) :: limit

    real(wp) :: change(6), direction(6), size_of_change, normal, along, inverse_a, inverse_b, r
    integer :: e, p

    if (.not. (phase%limits%stress_tangential%active .or. phase%limits%stress_normal%active)) return
    inverse_a = 0.0_wp
    inverse_b = 0.0_wp
    if (phase%limits%stress_tangential%active) &
      inverse_a = 1.0_wp/phase%limits%stress_tangential%value
    if (phase%limits%stress_normal%active) inverse_b = 1.0_wp/phase%limits%stress_normal%value
    limit%name = "stress"
    do e = 1, model%n_element
      associate (material => model%material(model%material_of(e)))
        do p = 1, model%element%n_point
          change = matmul(system%tangent(:, :, p, e), prediction%strain(:, p, e))
          size_of_change = norm2(change)
          if (size_of_change <= 0.0_wp .or. norm2(state%stress(:, p, e)) <= 0.0_wp) cycle
          direction = material%plastic_direction(state%stress(:, p, e), state%internal(:, p, e))
          normal = abs(dot_product(direction, change))/(norm2(direction)*size_of_change)
          normal = min(1.0_wp, normal)
          along = sqrt(1.0_wp - normal**2)
          r = material%flow_stress(state%internal(:, p, e)) &
              /(size_of_change*(normal*inverse_b + along*inverse_a))
          if (r < limit%r) then
            limit%r = r
            limit%at = point_text(e, p)
          end if
        end do
      end associate
    end do
  end function stress_limit

  !> Increment of the contact forces inside an ellipsoid, eqs (15)-(17). The size B of the force has
  !> a floor, a share of the mean contact force: to the letter, eq. (16), a node that has just
  !> touched would stop the increment.
  function force_limit(model, phase, state, contact, prediction) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state
    !> The contact at the committed state.
    type(contact_work_t), intent(in) :: contact
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    type(limit_t) :: limit

    real(wp) :: b, mean, ellipsoid, r
    integer :: c, n

    if (.not. phase%limits%force(1)%active) return
    limit%name = "force"
    n = count(state%status /= status_gap)
    if (n == 0) return
    mean = sum(norm2(state%lambda, dim=1), mask=state%status /= status_gap)/real(n, wp)
    do c = 1, model%n_contact
      if (state%status(c) == status_gap .or. contact%status(c) == status_gap) cycle
      b = max(norm2(state%lambda(:, c)), phase%limits%force_floor%value*mean)
      ellipsoid = ellipsoid_norm(prediction%lambda(:, c), contact%normal(:, c), &
          phase%limits%force%value)
      if (ellipsoid <= 0.0_wp) cycle
      r = b/ellipsoid
      if (r < limit%r) then
        limit%r = r
        limit%at = "node "//to_text(model%contact_node(c))//" tool " &
            //model%tool(contact%tool(c))%name &
                   //" B="//to_text(b, 4)
      end if
    end do
  end function force_limit

  !> Length of a force increment in the ellipsoid's measure, eq. (15); the first tangent is the
  !> projection of the x axis, or of y where the normal is along x.
  pure real(wp) function ellipsoid_norm(force, normal, axes)
    !> The force increment and the tool's normal.
    real(wp), intent(in) :: force(3), normal(3)
    !> The ellipsoid's axes c, d, e.
    real(wp), intent(in) :: axes(3)

    real(wp) :: first(3), along, along_first, across

    first = [1.0_wp, 0.0_wp, 0.0_wp]
    if (abs(normal(1)) > 0.9_wp) first = [0.0_wp, 1.0_wp, 0.0_wp]
    first = first - dot_product(first, normal)*normal
    first = first/norm2(first)
    along = dot_product(force, normal)
    along_first = dot_product(force, first)
    across = norm2(force - along*normal - along_first*first)
    ellipsoid_norm = sqrt((along/axes(1))**2 + (along_first/axes(2))**2 + (across/axes(3))**2)
  end function ellipsoid_norm

  !> First contact: a tool that touches nothing arrives at touch and no further. The predictor
  !> closes no gap, so that without this bound it would see no resistance. A tool that touches
  !> already runs over no node so deep that it would be lost on the wrong side.
  function gap_limit(model, phase, contact, prediction) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The contact at the committed state.
    type(contact_work_t), intent(in) :: contact
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    type(limit_t) :: limit

    real(wp) :: approach, depth, r
    logical :: touching(model%n_tool)
    integer :: c, node, tool

    touching = .false.
    do c = 1, model%n_contact
      if (contact%status(c) /= status_gap) touching(contact%tool(c)) = .true.
    end do
    do c = 1, model%n_contact
      tool = contact%tool(c)
      if (tool == 0 .or. contact%status(c) /= status_gap) cycle
      if (.not. phase%active(tool)) cycle
      node = model%contact_node(c)
      approach = dot_product(prediction%tool_displacement(:, tool) &
          - prediction%displacement(:, node), contact%normal(:, c))
      if (approach <= 0.0_wp) cycle
      depth = merge(0.5_wp*model%contact_depth, 0.5_wp*touch, touching(tool))
      r = (max(contact%distance(c), 0.0_wp) + depth)/approach
      if (r < limit%r) then
        limit%name = merge("gap          ", "first contact", touching(tool))
        limit%r = r
        limit%at = "node "//to_text(node)//" tool "//model%tool(tool)%name
      end if
    end do
  end function gap_limit

  !> An early end of the phase by a tool's displacement or force, extrapolated linearly. The size is
  !> met with either sign: that in which the value goes, or, from above, comes.
  function until_limit(model, phase, state, prediction) result(limit)
    !> The model.
    type(model_t), intent(in) :: model
    !> The running phase.
    type(phase_t), intent(in) :: phase
    !> The committed state.
    type(state_t), intent(in) :: state
    !> The trial increment.
    type(prediction_t), intent(in) :: prediction
    type(limit_t) :: limit

    real(wp) :: left, rate, line(3)
    integer :: tool, c

    tool = phase%until%tool
    if (tool == 0) return
    limit%name = "until"
    line = phase%direction(:, tool)
    if (phase%until%kind == until_displacement) then
      rate = dot_product(line, prediction%tool_displacement(:, tool))
    else
      rate = 0.0_wp
      do c = 1, model%n_contact
        if (state%contact_tool(c) == tool) rate = rate + dot_product(line, prediction%lambda(:, c))
      end do
    end if
    if (phase%until_from_below) then
      left = phase%until%value - sign(1.0_wp, rate)*until_value(phase, state)
    else
      left = -phase%until%value - sign(1.0_wp, rate)*until_value(phase, state)
    end if
    if (left > 0.0_wp .and. abs(rate) > 0.0_wp) limit%r = left/abs(rate)
  end function until_limit

end module dd3_process_limiters
