! SPDX-License-Identifier: GPL-3.0-or-later
!> Measure each increment of a run: the difference of the predicted and the corrected state, which
!> may estimate its error, and the error, the difference of the state after the same increment in
!> equal parts, without other limits, and the corrected state.
!>
!>     benchmark_increment_error <parts> <stride> <held> <input file> [name=value ...]
!>
!> The error is measured of every <stride>-th increment in which a tool controls the phase; without
!> parts (0) only the estimates are evaluated. A controller holds the estimate (`linear`, root mean
!> square of the sheet) at the value <held>, 0 for none, within the limits of the input. Prints a
!> row of values, separated by commas, for each accepted increment, -1 for none:
!> - `linear`: the predicted stress is that at the start and the rates there times the size,
!> - `updated`: it is integrated for the predicted displacements,
!> - `error`: the increment in parts.
!>
!> Differences of the stress at a point are over its flow stress, of displacements over those of the
!> increment, of contact forces over the latter, of the force on the controlling tool over that
!> force. The root mean square (`rms`) and the 95th percentile (`p95`) of the stress are weighted by
!> the volume of all points (`sheet`), of those in elements at whose contact points no status has
!> changed (`quiet`), and of those among them that were plastic before and after or neither
!> (`steady`). `places` is the rank correlation of `linear` with `error` over the points,
!> `tool_force` the force on the controlling tool along its motion.
!> Source: G. Soederlind, ACM Trans. Math. Softw. 29 (2003) 1-26 (the controller H211b).
program benchmark_increment_error
  use dd3_base_error, only : error_t
  use dd3_base_kinds, only : wp, pi
  use dd3_base_sorting, only : ascending
  use dd3_base_threads, only : set_threads
  use dd3_base_verdict, only : verdict_converged, verdict_t
  use dd3_element_kinematics, only : point_volumes
  use dd3_linalg_solver, only : solver_options_t
  use dd3_model_model, only : model_t
  use dd3_model_state, only : new_state, state_t
  use dd3_process_increment, only : accept_increment, prepare_increment, try_increment
  use dd3_process_phase_end, only : phase_is_over
  use dd3_process_phase_start, only : begin_phase, return_tools
  use dd3_process_predictor, only : new_prediction
  use dd3_process_step_control, only : cut_back, stepper_t
  use dd3_system_internal, only : update_material
  use dd3_system_system, only : new_system
  use run_samples, only : argument, read_model, usual_options
  implicit none

  !> Fraction of the volume below a percentile.
  real(wp), parameter :: percentile = 0.95_wp
  !> Sets of points.
  character(len=6), parameter :: set_name(3) = [character(len=6) :: "sheet", "quiet", "steady"]
  integer, parameter :: n_set = size(set_name)
  !> Largest number of parts that are made, where some are cut back, over their number.
  integer, parameter :: most_parts = 20

  !> Values of a state that are compared.
  type :: values_t
    real(wp), allocatable :: stress(:, :, :), x(:, :), lambda(:, :)
    !> On the controlling tool.
    real(wp) :: force(3) = 0.0_wp
  end type values_t

  !> What differences in an increment are measured by.
  type :: scale_t
    !> Flow stress and volume of each point, `(n_point, n_element)`.
    real(wp), allocatable :: flow(:, :), volume(:, :)
    !> Points of each set, `(n_point, n_element, n_set)`.
    logical, allocatable :: in_set(:, :, :)
    !> Number of contact points whose status has changed.
    integer :: changed = 0
    !> Norms of displacements and contact forces.
    real(wp) :: displacement = 0.0_wp, contact = 0.0_wp, force = 0.0_wp
  end type scale_t

  !> Difference of two states; -1 for none.
  type :: difference_t
    real(wp) :: rms(n_set) = -1.0_wp, p95(n_set) = -1.0_wp
    real(wp) :: displacement = -1.0_wp, contact = -1.0_wp, force = -1.0_wp
  end type difference_t

  !> Controller of the size of the increments: next size, as progress of the phase; size and
  !> estimate of the last increment that it has judged.
  type :: controller_t
    real(wp) :: next = 0.0_wp, size = 0.0_wp, estimate = 0.0_wp
  end type controller_t

  !> Digital filter H211b: divisor in the exponent of the estimates, which is b times their order,
  !> 2; b; bounds of the ratio of two sizes.
  real(wp), parameter :: divisor = 8.0_wp, b = 4.0_wp, least_ratio = 0.2_wp, most_ratio = 2.0_wp
  !> First size over the trial increment; smallest size over the intended one that is judged.
  real(wp), parameter :: first_size = 0.25_wp, judged = 0.7_wp

  type(model_t) :: model
  type(controller_t) :: controller
  real(wp) :: held
  integer :: parts, stride
  character(len=:), allocatable :: text

  if (command_argument_count() < 4) error stop &
      "benchmark_increment_error <parts> <stride> <held> <input file> [name=value ...]"
  text = argument(1)
  read (text, *) parts
  text = argument(2)
  read (text, *) stride
  text = argument(3)
  read (text, *) held
  call set_threads(1)
  call read_model(model, 4)
  print '(a)', "phase,increment,travel,progress,size,r,limiter,attempts,iterations,rotation,"// &
      "strain,changed,quiet_share,steady_share,tool_force"//columns("linear")// &
      columns("updated")//columns("error")//",places"
  call run()

contains

  !> Return the names of the columns of a difference.
  function columns(name) result(text)
    character(len=*), intent(in) :: name
    character(len=:), allocatable :: text

    integer :: s

    text = ""
    do s = 1, n_set
      text = text//","//name//"_rms_"//trim(set_name(s))
    end do
    do s = 1, n_set
      text = text//","//name//"_p95_"//trim(set_name(s))
    end do
    text = text//","//name//"_displacement,"//name//"_contact,"//name//"_force"
  end function columns

  !> Run all phases.
  subroutine run()
    type(stepper_t) :: stepper
    type(state_t) :: committed, trial
    type(error_t), allocatable :: error
    type(solver_options_t) :: options
    integer :: number

    call new_state(committed, model)
    call new_state(trial, model)
    options = usual_options("auto")
    options%ordering = "auto"
    call new_system(stepper%system, model, options, error)
    if (allocated(error)) error stop 1
    call new_prediction(stepper%prediction, model)
    do number = 1, size(model%phase)
      call return_tools(model, number, committed)
      call begin_phase(model, number, committed)
      controller = controller_t(next=first_size*model%phase(number)%trial)
      do while (.not. phase_is_over(model, committed))
        call measure_increment(stepper, committed, trial)
      end do
    end do
  end subroutine run

  !> Make an increment of the run and print its row.
  subroutine measure_increment(stepper, committed, trial)
    type(stepper_t), intent(inout) :: stepper
    type(state_t), intent(inout) :: committed, trial

    type(state_t) :: before, divided
    type(values_t) :: corrected, predicted, exact
    type(difference_t) :: linear, updated, error
    type(scale_t) :: scale
    real(wp), allocatable :: rate(:, :, :)
    real(wp) :: rotation, strain, places
    integer :: iterations
    logical :: done

    call prepare_increment(model, committed, stepper)
    if (stepper%attempt%verdict%outcome /= verdict_converged) error stop "no prediction"
    if (controls(committed)) stepper%attempt%limit%r = min(stepper%attempt%limit%r, &
        controller%next/stepper%prediction%progress)
    rate = stress_rate(stepper)
    iterations = 0
    call correct(stepper, committed, trial, iterations, done)
    if (.not. done) error stop "an increment has failed"
    before = committed
    corrected = values_of(trial)
    scale = scale_of(before, trial)
    associate (r => stepper%attempt%limit%r, prediction => stepper%prediction)
      rotation = r*maxval(prediction%rotation)*180.0_wp/pi
      strain = r*sqrt(maxval(sum(prediction%strain**2, dim=1)))
      predicted%x = before%x + r*prediction%step%x
      predicted%lambda = before%contact%lambda + r*prediction%step%lambda
      predicted%force = force_of(predicted%lambda, before)
      rate = before%sheet%stress + r*rate
      predicted%stress = rate
      linear = difference(predicted, corrected, scale)
      call update_predicted(stepper, before, r, predicted%stress, done)
      if (done) updated = difference(predicted, corrected, scale)
    end associate
    call accept_increment(model, trial, stepper, committed)
    if (controls(committed)) then
      call judge(controller, committed%progress - before%progress, linear%rms(1))
    end if
    associate (attempt => stepper%attempt)
      write (*, '(a, ",", i0, ",", 2(es15.8, ","), 2(es11.4, ","), a, ",", 2(i0, ","), ' // &
          '2(es11.4, ","), i0, ",", 2(f6.4, ","), es14.7)', advance="no") &
          model%phase(committed%phase)%name, committed%increment, committed%travel, &
          committed%progress, committed%progress - before%progress, attempt%limit%r, &
          trim(attempt%limit%limiter), attempt%number, iterations, rotation, strain, &
          scale%changed, sum(scale%volume, mask=scale%in_set(:, :, 2))/sum(scale%volume), &
          sum(scale%volume, mask=scale%in_set(:, :, 3))/sum(scale%volume), pressing(committed)
    end associate
    places = -1.0_wp
    if (parts > 0 .and. modulo(committed%increment, stride) == 0 &
        .and. model%phase(committed%phase)%control > 0) then
      divided = before
      call make_parts(stepper, divided, trial, committed%progress, done)
      if (done) then
        exact = values_of(divided)
        error = difference(exact, corrected, scale)
        places = rank_correlation(distance(rate, corrected%stress, scale), &
            distance(exact%stress, corrected%stress, scale))
      end if
    end if
    print '(28(",", es11.4))', linear, updated, error, places
  end subroutine measure_increment

  !> Whether the controller sets the size of the increments in the phase of a state.
  logical function controls(state)
    type(state_t), intent(in) :: state

    controls = held > 0.0_wp .and. model%phase(state%phase)%control > 0
  end function controls

  !> Set the next size from the estimate of an increment. One that ended early, at an output or
  !> where a tool met the sheet, is judged only if its estimate is too large.
  subroutine judge(self, size, estimate)
    type(controller_t), intent(inout) :: self
    !> Progress of the phase in the increment.
    real(wp), intent(in) :: size
    real(wp), intent(in) :: estimate

    real(wp) :: ratio

    if (size < judged*self%next .and. estimate <= held) return
    ratio = sqrt(held/estimate)
    if (self%size > 0.0_wp) ratio = (held/estimate*held/self%estimate)**(1.0_wp/divisor) &
        *(size/self%size)**(-1.0_wp/b)
    self = controller_t(min(max(ratio, least_ratio), most_ratio)*size, size, estimate)
  end subroutine judge

  !> Return the force with which the controlling tool presses the sheet, N; 0 without one.
  real(wp) function pressing(state)
    type(state_t), intent(in) :: state

    pressing = 0.0_wp
    associate (phase => model%phase(state%phase))
      if (phase%control > 0) pressing = abs(dot_product(phase%direction(:, phase%control), &
          force_of(state%contact%lambda, state)))
    end associate
  end function pressing

  !> Return the change of the stress in the trial increment with the tangents of the predictor.
  function stress_rate(stepper) result(rate)
    type(stepper_t), intent(in) :: stepper
    real(wp), allocatable :: rate(:, :, :)

    integer :: e, p

    allocate (rate, mold=stepper%prediction%strain)
    do e = 1, size(rate, 3)
      do p = 1, size(rate, 2)
        rate(:, p, e) = matmul(stepper%system%tangent(:, :, p, e), &
            stepper%prediction%strain(:, p, e))
      end do
    end do
  end function stress_rate

  !> Correct a prediction, with smaller r if need be.
  subroutine correct(stepper, committed, trial, iterations, done)
    type(stepper_t), intent(inout) :: stepper
    type(state_t), intent(in) :: committed
    type(state_t), intent(inout) :: trial
    !> Raised by those of all attempts.
    integer, intent(inout) :: iterations
    logical, intent(out) :: done

    logical :: again

    do
      call try_increment(model, committed, trial, stepper)
      iterations = iterations + stepper%attempt%course%iterations
      done = stepper%attempt%verdict%outcome == verdict_converged
      if (done) return
      call cut_back(stepper%attempt, again)
      if (.not. again) return
    end do
  end subroutine correct

  !> Make an increment in equal parts.
  subroutine make_parts(stepper, state, trial, progress, done)
    type(stepper_t), intent(inout) :: stepper
    !> State at the start; gets that at the end.
    type(state_t), intent(inout) :: state
    !> Work space.
    type(state_t), intent(inout) :: trial
    !> Of the phase at the end.
    real(wp), intent(in) :: progress
    !> False if a part fails.
    logical, intent(out) :: done

    real(wp) :: part
    integer :: iterations, made

    part = (progress - state%progress)/real(parts, wp)
    iterations = 0
    made = 0
    do while (progress - state%progress > 1.0e-6_wp*part)
      done = .false.
      made = made + 1
      if (made > most_parts*parts) return
      call prepare_increment(model, state, stepper)
      if (stepper%attempt%verdict%outcome /= verdict_converged) return
      stepper%attempt%limit%r = min(part, progress - state%progress)/stepper%prediction%progress
      call correct(stepper, state, trial, iterations, done)
      if (.not. done) return
      call accept_increment(model, trial, stepper, state)
    end do
  end subroutine make_parts

  !> Integrate the stress for the displacements of the prediction.
  subroutine update_predicted(stepper, before, r, stress, done)
    type(stepper_t), intent(inout) :: stepper
    type(state_t), intent(in) :: before
    real(wp), intent(in) :: r
    real(wp), intent(inout) :: stress(:, :, :)
    !> False if an element is inverted, or a return mapping fails.
    logical, intent(out) :: done

    type(state_t) :: state
    type(verdict_t) :: verdict

    state = before
    state%x = before%x + r*stepper%prediction%step%x
    state%sheet%enhanced = r*stepper%prediction%step%enhanced
    call update_material(stepper%system, model, before, state, .false., verdict)
    done = verdict%outcome == verdict_converged
    stress = state%sheet%stress
  end subroutine update_predicted

  !> Return the values of a state that are compared.
  type(values_t) function values_of(state) result(values)
    type(state_t), intent(in) :: state

    values%stress = state%sheet%stress
    values%x = state%x
    values%lambda = state%contact%lambda
    values%force = force_of(state%contact%lambda, state)
  end function values_of

  !> Return the force of the sheet on the controlling tool, N.
  function force_of(lambda, state) result(force)
    real(wp), intent(in) :: lambda(:, :)
    !> With the tools of the contact points.
    type(state_t), intent(in) :: state
    real(wp) :: force(3)

    integer :: k

    associate (control => model%phase(state%phase)%control)
      force = [(sum(lambda(k, :), mask=state%contact%tool == control .and. control > 0), k=1, 3)]
    end associate
  end function force_of

  !> Return what the differences in an increment are measured by.
  type(scale_t) function scale_of(before, after) result(scale)
    type(state_t), intent(in) :: before, after

    logical, allocatable :: changed(:)
    integer :: e, f, p

    associate (n_point => model%element%n_point, n => size(model%part%element))
      allocate (scale%flow(n_point, n), scale%volume(n_point, n))
      allocate (scale%in_set(n_point, n, n_set), source=.true.)
      do e = 1, n
        call point_volumes(model%element, before%x(:, model%connectivity(:, e)), &
            scale%volume(:, e))
        do p = 1, n_point
          scale%flow(p, e) = model%material(model%material_of(e))%flow_stress( &
              after%sheet%internal_variables(:, p, e))
        end do
      end do
    end associate
    changed = before%contact%status /= after%contact%status
    scale%changed = count(changed)
    do f = 1, size(model%contact_face)
      if (any(changed(model%face_point(:, f)))) then
        scale%in_set(:, model%face%element(model%contact_face(f)), 2:) = .false.
      end if
    end do
    scale%in_set(:, :, 3) = scale%in_set(:, :, 3) &
        .and. (before%sheet%plastic .eqv. after%sheet%plastic)
    scale%displacement = norm2(after%x - before%x)
    scale%contact = norm2(after%contact%lambda)
    scale%force = norm2(force_of(after%contact%lambda, after))
  end function scale_of

  !> Return the difference of two states.
  type(difference_t) function difference(a, b, scale)
    type(values_t), intent(in) :: a, b
    type(scale_t), intent(in) :: scale

    integer :: s

    do s = 1, n_set
      associate (mask => reshape(scale%in_set(:, :, s), [size(scale%flow)]))
        associate (value => pack(distance(a%stress, b%stress, scale), mask), &
            volume => pack(scale%volume, scale%in_set(:, :, s)))
          if (size(value) == 0) cycle
          difference%rms(s) = sqrt(sum(volume*value**2)/sum(volume))
          difference%p95(s) = percentile_of(value, volume)
        end associate
      end associate
    end do
    if (scale%displacement > 0.0_wp) difference%displacement = norm2(a%x - b%x)/scale%displacement
    if (scale%contact > 0.0_wp) difference%contact = norm2(a%lambda - b%lambda)/scale%contact
    if (scale%force > 0.0_wp) difference%force = norm2(a%force - b%force)/scale%force
  end function difference

  !> Return the norm of the difference of the stresses at the points over the flow stress.
  function distance(a, b, scale)
    real(wp), intent(in) :: a(:, :, :), b(:, :, :)
    type(scale_t), intent(in) :: scale
    real(wp), allocatable :: distance(:)

    distance = reshape(norm2(a - b, dim=1)/scale%flow, [size(scale%flow)])
  end function distance

  !> Return the correlation of the ranks of two lists.
  pure real(wp) function rank_correlation(a, b) result(correlation)
    real(wp), intent(in) :: a(:), b(:)

    real(wp) :: rank_a(size(a)), rank_b(size(a))
    integer :: i

    rank_a(ascending(a)) = [(real(i, wp), i=1, size(a))]
    rank_b(ascending(b)) = [(real(i, wp), i=1, size(a))]
    rank_a = rank_a - 0.5_wp*real(size(a) + 1, wp)
    rank_b = rank_b - 0.5_wp*real(size(a) + 1, wp)
    correlation = sum(rank_a*rank_b)/sum(rank_a**2)
  end function rank_correlation

  !> Return the value below which a fraction of the volume lies.
  pure real(wp) function percentile_of(value, volume) result(found)
    real(wp), intent(in) :: value(:), volume(:)

    real(wp) :: above
    integer :: order(size(value)), k

    order = ascending(value)
    above = (1.0_wp - percentile)*sum(volume)
    do k = size(order), 1, -1
      found = value(order(k))
      above = above - volume(order(k))
      if (above < 0.0_wp) return
    end do
  end function percentile_of

end program benchmark_increment_error
