! SPDX-License-Identifier: GPL-3.0-or-later
!> Limiters of the factor r, the fraction of the trial increment that is made. Each limiter is a
!> function that returns a bound with its location, applied in `limit_increment`.
!> Source: Oliveira and Menezes 2004, eqs (9)-(12) and (15)-(18); Teodosiu and Cao 1988.
module dd3_process_limiters
  use dd3_base_kinds, only : wp, pi
  use dd3_base_ranks, only : any_rank, broadcast_integers, count_over_ranks, rank_of_smallest, &
      sum_over_ranks
  use dd3_contact_operator, only : status_gap
  use dd3_linalg_tensor, only : symmetric_eigen, tensor_from_kelvin
  use dd3_sheet_surface_point, only : surface_point_t
  use dd3_model_contact_layer, only : offset_rate, progress_left
  use dd3_model_model, only : model_t
  use dd3_model_pressed_tools, only : motion_at
  use dd3_model_state, only : state_t
  use dd3_model_terms_drawbeads, only : presses_by_bead
  use dd3_process_phase_end, only : next_output_progress, until_value
  use dd3_process_step_control, only : limit_t, stepper_t
  use dd3_settings_until, only : until_displacement
  implicit none
  private
  public :: limit_increment

  abstract interface
    !> Return the bound that a limiter sets; a huge r if it sets none.
    function limiter_interface(model, state, stepper) result(limit)
      import :: limit_t, model_t, state_t, stepper_t
      type(model_t), intent(in) :: model
      !> The committed state.
      type(state_t), intent(in) :: state
      !> Holds the prediction, the contact and the tangents at the committed state, and the smallest
      !> bound so far: a limiter may skip what cannot fall below it.
      type(stepper_t), intent(in) :: stepper
      type(limit_t) :: limit
    end function limiter_interface
  end interface

  !> The largest modulus of a principal strain is at least this fraction of the norm of the tensor;
  !> 1/sqrt(3) less a margin for round-off.
  real(wp), parameter :: least_principal = 0.577_wp
  !> Largest part of what is left of a phase in an increment with viscous forces.
  real(wp), parameter :: largest_part = 0.5_wp
  !> Largest motion in an increment of a tool that is withdrawn, in thicknesses of the sheet.
  real(wp), parameter :: opening_step = 2.5_wp
  !> The first motion over the height of a contact layer, in the mixed formulation over the
  !> thickness of the sheet; two tools open by twice of it. A drawn strip snaps between tools that
  !> open; in runs with holder forces within 0.3 % its springback is 5.81 to 5.94 mm with 0.25, 5.91
  !> to 5.94 with 0.125, 5.94 to 5.97 with 0.0625, and 5.83 to 5.95 with 0.03, where increments fail
  !> in some.
  real(wp), parameter :: first = 0.0625_wp

contains

  !> Set the factor r of an increment, the smallest of all bounds, eq. (18), of equal ones the
  !> first: those that r_min overrides, then the bound by earlier increments, the end of the phase
  !> and the other limiters.
  subroutine limit_increment(model, state, stepper)
    type(model_t), intent(in) :: model
    !> The committed state.
    type(state_t), intent(in) :: state
    !> Gets the limit, and that of the contact forces alone.
    type(stepper_t), intent(inout) :: stepper

    integer :: t

    associate (attempt => stepper%attempt, limit => stepper%attempt%limit, &
        phase => model%phase(state%phase), limits => model%phase(state%phase)%limits)
      limit = limit_t(r=limits%r_max%value, limiter="r_max")
      if (state%open) limit%r = huge(1.0_wp)
      call apply("strain", strain_limit)
      call apply("rotation", rotation_limit)
      call apply("stress", stress_limit)
      call apply("force", force_limit, attempt%force_limit)
      if (limit%r < limits%r_min%value) then
        limit%r = limits%r_min%value
        limit%limiter = "r_min"
      end if
      call keep_smaller(limit, limit_t(r=state%r_cap, limiter="cutback"))
      call end_after("phase", 1.0_wp - state%progress)
      if (attempt%viscosity > 0.0_wp) call end_after("viscous", &
          largest_part*(1.0_wp - state%progress))
      call end_after("table", phase%next_kink(state%progress) - state%progress)
      call apply("gap", gap_limit)
      call apply("opening", opening_limit)
      call apply("until", until_limit)
      if (any([(abs(offset_rate(model, state, t)) > 0.0_wp, t=1, model%n_tool)])) then
        call end_after("layer", progress_left(state%progress))
      end if
      call end_after("output", next_output_progress(model%output, phase, state) - state%progress)
      if (model%part%divided) call copy_limit(0, limit)
    end associate

  contains

    !> Apply a limiter.
    subroutine apply(name, evaluate, bound)
      !> Of the limiter, unless it gives its own.
      character(len=*), intent(in) :: name
      procedure(limiter_interface) :: evaluate
      !> The bound that it sets.
      type(limit_t), intent(out), optional :: bound

      type(limit_t) :: limit

      limit = evaluate(model, state, stepper)
      if (limit%limiter == "") limit%limiter = name
      if (model%part%divided) call share_limit(limit)
      call keep_smaller(stepper%attempt%limit, limit)
      if (present(bound)) bound = limit
    end subroutine apply

    !> Let the increment end no later than after some progress of the phase.
    subroutine end_after(limiter, left)
      character(len=*), intent(in) :: limiter
      real(wp), intent(in) :: left

      if (left > 0.0_wp .and. left <= 1.0_wp) call keep_smaller(stepper%attempt%limit, &
          limit_t(r=left/stepper%prediction%progress, limiter=limiter))
    end subroutine end_after

  end subroutine limit_increment

  !> Give all ranks the smallest bound; of equal ones that of the element with the lowest number.
  subroutine share_limit(limit)
    type(limit_t), intent(inout) :: limit

    call copy_limit(rank_of_smallest(limit%r, limit%element), limit)
  end subroutine share_limit

  !> Give all ranks the bound of one.
  subroutine copy_limit(rank, limit)
    integer, intent(in) :: rank
    type(limit_t), intent(inout) :: limit

    integer, allocatable :: bits(:)

    bits = transfer(limit, [0])
    call broadcast_integers(rank, size(bits), bits)
    limit = transfer(bits, limit)
  end subroutine copy_limit

  !> Keep the smaller of two bounds, the first of equal ones.
  subroutine keep_smaller(limit, candidate)
    type(limit_t), intent(inout) :: limit
    type(limit_t), intent(in) :: candidate

    if (candidate%r < limit%r) limit = candidate
  end subroutine keep_smaller

  !> Limit the largest principal strain increment, eq. (9).
  function strain_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    real(wp) :: bound, largest(size(model%part%element))
    integer :: e, point(size(model%part%element))

    if (size(largest) == 0) return
    associate (allowed => model%phase(state%phase)%limits%strain)
      if (.not. allowed%active) return
      bound = max(allowed%value/stepper%attempt%limit%r, &
          least_principal*sqrt(maxval(sum(stepper%prediction%strain**2, dim=1))))
      !$omp parallel do num_threads(model%element_threads()) private(e)
      do e = 1, size(largest)
        call largest_strain(stepper%prediction%strain(:, :, e), bound, largest(e), point(e))
      end do
      !$omp end parallel do
      e = maxloc(largest, dim=1)
      if (largest(e) > bound) then
        limit = limit_t(r=allowed%value/largest(e), element=model%part%element(e), point=point(e))
      end if
    end associate
  end function strain_limit

  !> Find the largest modulus of a principal strain above a bound at the points of an element.
  pure subroutine largest_strain(strain, bound, largest, point)
    !> Kelvin, `(6, n_point)`.
    real(wp), intent(in) :: strain(:, :)
    real(wp), intent(in) :: bound
    !> The bound if no strain is above it; the point is 0 then.
    real(wp), intent(out) :: largest
    integer, intent(out) :: point

    real(wp) :: values(3), vectors(3, 3)
    integer :: p

    largest = bound
    point = 0
    do p = 1, size(strain, 2)
      if (norm2(strain(:, p)) <= largest) cycle
      call symmetric_eigen(tensor_from_kelvin(strain(:, p)), values, vectors)
      if (maxval(abs(values)) <= largest) cycle
      largest = maxval(abs(values))
      point = p
    end do
  end subroutine largest_strain

  !> Limit the largest rotation increment, eq. (10).
  function rotation_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    integer :: place(2)

    associate (allowed => model%phase(state%phase)%limits%rotation)
      if (.not. allowed%active) return
      if (size(stepper%prediction%rotation) == 0) return
      place = maxloc(stepper%prediction%rotation)
      associate (largest => stepper%prediction%rotation(place(1), place(2)))
        if (largest <= 0.0_wp) return
        limit = limit_t(r=allowed%value*pi/180.0_wp/largest, &
            element=model%part%element(place(2)), point=place(1))
      end associate
    end associate
  end function rotation_limit

  !> Limit the stress increments normal and tangential to the yield surface, eq. (11). The modulus
  !> of cos(theta) is taken: in unloading its negative value would raise the bound.
  function stress_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    real(wp) :: inverse(2), bound(size(model%part%element))
    integer :: e, point(size(model%part%element))

    if (size(bound) == 0) return
    associate (limits => model%phase(state%phase)%limits)
      if (.not. (limits%stress_tangential%active .or. limits%stress_normal%active)) return
      inverse = 0.0_wp
      if (limits%stress_tangential%active) inverse(1) = 1.0_wp/limits%stress_tangential%value
      if (limits%stress_normal%active) inverse(2) = 1.0_wp/limits%stress_normal%value
    end associate
    !$omp parallel do num_threads(model%element_threads()) private(e)
    do e = 1, size(bound)
      call smallest_stress_bound(model, state, stepper, e, inverse, bound(e), point(e))
    end do
    !$omp end parallel do
    e = minloc(bound, dim=1)
    if (point(e) > 0) then
      limit = limit_t(r=bound(e), element=model%part%element(e), point=point(e))
    end if
  end function stress_limit

  !> Find the smallest bound by the stress at the points of an element.
  subroutine smallest_stress_bound(model, state, stepper, e, inverse, smallest, point)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    !> Number in the part.
    integer, intent(in) :: e
    !> Inverse limits, tangential and normal; 0 for none.
    real(wp), intent(in) :: inverse(2)
    !> Huge if no stress changes; the point is 0 then.
    real(wp), intent(out) :: smallest
    integer, intent(out) :: point

    real(wp) :: change(6), direction(6), magnitude, normal, tangential, bound
    integer :: p

    smallest = huge(1.0_wp)
    point = 0
    associate (material => model%material(model%material_of(model%part%element(e))))
      do p = 1, model%element%n_point
        change = matmul(stepper%system%tangent(:, :, p, e), stepper%prediction%strain(:, p, e))
        magnitude = norm2(change)
        if (magnitude <= 0.0_wp .or. norm2(state%sheet%stress(:, p, e)) <= 0.0_wp) cycle
        direction = material%plastic_direction(state%sheet%stress(:, p, e), &
            state%sheet%internal_variables(:, p, e))
        normal = min(1.0_wp, abs(dot_product(direction, change))/(norm2(direction)*magnitude))
        tangential = sqrt(1.0_wp - normal**2)
        bound = material%flow_stress(state%sheet%internal_variables(:, p, e)) &
            /(magnitude*(normal*inverse(2) + tangential*inverse(1)))
        if (bound >= smallest) cycle
        smallest = bound
        point = p
      end do
    end associate
  end subroutine smallest_stress_bound

  !> Limit the increment of the contact forces to an ellipsoid, eqs (15)-(17). The size B of the
  !> force has a lower bound, a fraction of the mean contact force: with eq. (16) as printed a node
  !> that has just come into contact would stop the increment.
  function force_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    real(wp) :: b, total(1), mean, ellipsoid
    integer :: c, n

    n = count_over_ranks(count(state%contact%status /= status_gap))
    associate (limits => model%phase(state%phase)%limits, contact => stepper%system%contact)
      if (.not. limits%force(1)%active .or. n == 0) return
      total = sum(norm2(state%contact%lambda, dim=1), mask=state%contact%status /= status_gap)
      call sum_over_ranks(1, total)
      mean = total(1)/real(n, wp)
      do c = 1, model%n_contact
        if (state%contact%status(c) == status_gap .or. contact%status(c) == status_gap) cycle
        b = max(norm2(state%contact%lambda(:, c)), limits%force_floor%value*mean)
        ellipsoid = ellipsoid_norm(stepper%prediction%step%lambda(:, c), contact%normal(:, c), &
            limits%force%value)
        if (ellipsoid <= 0.0_wp) cycle
        if (b/ellipsoid < limit%r) limit = limit_t(r=b/ellipsoid, node=model%contact_node(c), &
            tool=contact%tool(c), force_size=b)
      end do
    end associate
  end function force_limit

  !> Return the norm of a force increment in the ellipsoid, eq. (15). The first tangent is the
  !> projection of the x axis, or of y if the normal is close to x.
  pure real(wp) function ellipsoid_norm(force, normal, axes)
    !> Force increment, normal of the tool, axes c, d, e of the ellipsoid.
    real(wp), intent(in) :: force(3), normal(3), axes(3)

    real(wp) :: tangent(3), f_normal, f_first, f_second

    tangent = [1.0_wp, 0.0_wp, 0.0_wp]
    if (abs(normal(1)) > 0.9_wp) tangent = [0.0_wp, 1.0_wp, 0.0_wp]
    tangent = tangent - dot_product(tangent, normal)*normal
    tangent = tangent/norm2(tangent)
    f_normal = dot_product(force, normal)
    f_first = dot_product(force, tangent)
    f_second = norm2(force - f_normal*normal - f_first*tangent)
    ellipsoid_norm = sqrt((f_normal/axes(1))**2 + (f_first/axes(2))**2 + (f_second/axes(3))**2)
  end function ellipsoid_norm

  !> Limit the approach of candidates and tools. A tool without contact advances to contact and no
  !> further, because the predictor ignores the resistance behind a gap. Below a tool in contact the
  !> predicted depth of the candidates that close is bounded.
  function gap_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    type(surface_point_t) :: point
    real(wp) :: approach, depth, bound
    logical :: touching(model%n_tool)
    integer :: c, node, tool

    touching = .false.
    associate (contact => stepper%system%contact, step => stepper%prediction%step, &
        allowed => model%phase(state%phase)%limits%depth)
      do c = 1, model%n_contact
        if (contact%status(c) /= status_gap) touching(contact%tool(c)) = .true.
      end do
      touching = [(any_rank(touching(tool)), tool=1, model%n_tool)]
      do c = 1, model%n_contact
        tool = contact%tool(c)
        if (tool == 0 .or. contact%status(c) /= status_gap) cycle
        if (.not. model%phase(state%phase)%active(tool)) cycle
        node = model%contact_node(c)
        point = model%contact_point(c)%at_place(contact%place(c))
        approach = dot_product(motion_at(state%tools, tool, point%position(state%x), &
            step%tool(:, tool), step%tilt(:, tool)) &
            + stepper%prediction%progress*contact%turning(:, c) &
            - point%change(state%x, step%x), contact%normal(:, c))
        if (approach <= 0.0_wp) cycle
        if (touching(tool) .and. .not. allowed%active) cycle
        depth = merge(allowed%value*model%thickness, 0.5_wp*model%tolerance%touch, touching(tool))
        bound = (max(contact%distance(c), 0.0_wp) + depth)/approach
        if (bound < limit%r) limit = limit_t(r=bound, node=node, tool=tool, &
            limiter=merge("gap          ", "first contact", touching(tool)))
      end do
    end associate
  end function gap_limit

  !> Limit the motion of the tools that are withdrawn while they, or their draw-beads, press: the
  !> forces of the forming end within the height of the contact layers, and the sheet slides over
  !> radii later.
  function opening_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    real(wp) :: motion, bound
    integer :: tool

    associate (phase => model%phase(state%phase))
      do tool = 1, model%n_tool
        if (.not. phase%withdrawn(tool)) cycle
        motion = norm2(stepper%prediction%step%tool(:, tool))
        if (.not. motion > 0.0_wp) cycle
        if (.not. (state%tools%touches(tool) .or. presses_by_bead(model, state, tool))) cycle
        bound = min(opening_step*model%thickness, &
            phase%opened(tool, state%progress) &
            + first*merge(1.0_wp, phase%layer, phase%mixed)*model%thickness)
        if (bound/motion < limit%r) limit = limit_t(r=bound/motion, tool=tool)
      end do
    end associate
  end function opening_limit

  !> Return the bound at the early end of the phase, extrapolated linearly. The value is met with
  !> either sign: that of its rate or, from above, the opposite one.
  function until_limit(model, state, stepper) result(limit)
    type(model_t), intent(in) :: model
    type(state_t), intent(in) :: state
    type(stepper_t), intent(in) :: stepper
    type(limit_t) :: limit

    real(wp) :: left, rate(1), line(3), target
    integer :: tool, c

    associate (phase => model%phase(state%phase))
      tool = phase%until%tool
      if (tool == 0) return
      line = phase%direction(:, tool)
      if (phase%until%kind == until_displacement) then
        rate = dot_product(line, stepper%prediction%step%tool(:, tool))
      else
        rate = 0.0_wp
        do c = 1, model%n_contact
          if (state%contact%tool(c) == tool) then
            rate = rate + dot_product(line, stepper%prediction%step%lambda(:, c))
          end if
        end do
        call sum_over_ranks(1, rate)
      end if
      target = merge(1.0_wp, -1.0_wp, state%start%until_from_below)*phase%until%value
      left = target - sign(1.0_wp, rate(1))*until_value(phase, state)
    end associate
    if (left > 0.0_wp .and. abs(rate(1)) > 0.0_wp) limit%r = left/abs(rate(1))
  end function until_limit

end module dd3_process_limiters
