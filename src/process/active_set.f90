!> Active set of the contact: remedy for contact status that cycles.
!>
!> The corrector evaluates the status in every iteration. Where nodes open and close, or stick and
!> slip, again and again while the criterion of convergence does not decrease, their status is held,
!> and the iterations converge on a smooth problem.
!> Then nodes that violate the contact law are released into their status by it, until none does:
!> the converged solution is that of the contact law.
!> Contacts without force behind a front of opening ones are held open in the same way.
!> Source: Hintermueller, Ito and Kunisch, SIAM J. Optim. 13 (2002) 865-888 (primal-dual active
!> set); Alart and Curnier 1991.
module dd3_process_active_set
  use dd3_base_kinds, only : wp
  use dd3_base_verdict, only : verdict_retry, verdict_t
  use dd3_contact_operator, only : status_gap, status_slip, status_stick
  use dd3_process_attempt, only : correction_t, status_memory
  use dd3_system_contact_work, only : contact_work_t, not_held
  implicit none
  private
  public :: record_status, update_active_set, open_unloaded, keeps_changing, unsettled

  !> Number of changes of a node's status after which it is held, and the iterations before which
  !> changes do not count.
  integer, parameter :: most_changes = 4, free_iterations = 10
  !> Violation, relative to the largest nodal contact force, that is round-off.
  real(wp), parameter :: negligible = 1.0e-6_wp
  !> The first times all violators are released, then those above this fraction of the largest.
  integer, parameter :: full_releases = 4
  real(wp), parameter :: released_fraction = 0.5_wp
  !> Iterations after which contacts without force are opened, each time, and the force, relative to
  !> the largest tension, that counts as none.
  integer, parameter :: opening_interval = 10
  real(wp), parameter :: slight_force = 2.0e-2_wp

contains

  !> Record the status of the candidates in an iteration and count its changes. A slip whose
  !> direction reverses counts as a change.
  subroutine record_status(correction, contact, iteration)
    type(correction_t), intent(inout) :: correction
    type(contact_work_t), intent(in) :: contact
    integer, intent(in) :: iteration

    real(wp) :: tangential(3)
    integer :: c

    correction%status(:, 2:) = correction%status(:, :status_memory - 1)
    correction%status(:, 1) = contact%status
    correction%reversed = .false.
    do c = 1, size(contact%status)
      tangential = contact%force(:, c) &
          - dot_product(contact%force(:, c), contact%normal(:, c))*contact%normal(:, c)
      if (all(correction%status(c, :2) == status_slip)) &
          correction%reversed(c) = dot_product(tangential, correction%tangential(:, c)) < 0.0_wp
      correction%tangential(:, c) = tangential
    end do
    if (iteration <= free_iterations) return
    where (correction%reversed .or. correction%status(:, 1) /= correction%status(:, 2)) &
        correction%changes = correction%changes + 1
  end subroutine record_status

  !> Hold candidates whose status cycles, or release them once the iterations have converged.
  !> Changes of status count from the last minimum of the criterion on: while it decreases, none is
  !> held.
  subroutine update_active_set(correction, contact, tolerance, verdict, changed)
    type(correction_t), intent(inout) :: correction
    type(contact_work_t), intent(inout) :: contact
    !> Of the criterion of convergence.
    real(wp), intent(in) :: tolerance
    !> Of the convergence check; a retry if held candidates violate the contact law.
    type(verdict_t), intent(inout) :: verdict
    !> Whether the contact must be evaluated again.
    logical, intent(out) :: changed

    if (correction%held == 0 .and. minloc(correction%criterion, dim=1) == verdict%iterations) &
        correction%changes = 0
    if (verdict%norm < tolerance) then
      call release_violators(correction, contact, changed)
      if (changed) verdict%outcome = verdict_retry
    else
      call hold_cycling(correction, contact, changed)
    end if
  end subroutine update_active_set

  !> Open the contacts without force of a tool that carried none in the committed state, where
  !> others of its contacts are under tension. Where a flat tool has met the sheet all over and the
  !> sheet bulges away from it, the contacts would otherwise open from the edge of the tool to its
  !> middle by one row of nodes in an iteration, as the next row resists. A force that has only
  !> appeared in this iteration is therefore no resistance, and contacts within `touch` that are
  !> open at present are held open too.
  subroutine open_unloaded(correction, contact, committed, touch, changed)
    !> Gets the number of candidates held.
    type(correction_t), intent(inout) :: correction
    !> Gets the status held.
    type(contact_work_t), intent(inout) :: contact
    !> Contact forces in the committed state, `(3, n_contact)`, N.
    real(wp), intent(in) :: committed(:, :)
    !> mm.
    real(wp), intent(in) :: touch
    !> Set if the contact must be evaluated again.
    logical, intent(inout) :: changed

    real(wp), allocatable :: tension(:)
    logical, allocatable :: mine(:), opened(:)
    real(wp) :: largest
    integer :: tool

    if (mod(size(correction%criterion), opening_interval) /= 0) return
    tension = merge(sum(contact%lambda*contact%normal, dim=1), 0.0_wp, contact%status == status_gap)
    do tool = 1, maxval(contact%tool)
      mine = contact%tool == tool
      largest = maxval(tension, mask=mine)
      if (.not. any(mine .and. tension > 0.0_wp)) cycle
      if (any(mine .and. norm2(committed, dim=1) > slight_force*largest)) cycle
      opened = mine .and. contact%held == not_held .and. contact%distance < touch &
          .and. norm2(contact%force, dim=1) < largest &
          .and. norm2(contact%lambda - correction%lambda_increment, dim=1) < slight_force*largest
      where (opened) contact%held = status_gap
      where (opened) correction%opened = .true.
      correction%held = correction%held + count(opened)
      changed = changed .or. any(opened)
    end do
  end subroutine open_unloaded

  !> Whether candidates changed their status in each of the last two iterations.
  pure logical function keeps_changing(correction)
    type(correction_t), intent(in) :: correction

    associate (status => correction%status)
      keeps_changing = any(status(:, 1) /= status(:, 2)) .and. any(status(:, 2) /= status(:, 3)) &
          .and. all(status(:, 3) >= 0)
    end associate
  end function keeps_changing

  !> Whether the status of each candidate changed in the last iterations.
  pure function unsettled(correction) result(changing)
    type(correction_t), intent(in) :: correction
    logical :: changing(size(correction%status, 1))

    associate (status => correction%status)
      changing = any(status >= 0 .and. status /= spread(status(:, 1), 2, status_memory), dim=2)
    end associate
  end function unsettled

  !> Hold the candidates whose status cycles: in their present status, or sticking where the
  !> direction of slip reverses.
  subroutine hold_cycling(correction, contact, changed)
    type(correction_t), intent(inout) :: correction
    !> Gets the status held.
    type(contact_work_t), intent(inout) :: contact
    !> Whether the contact must be evaluated again.
    logical, intent(out) :: changed

    integer :: c

    changed = .false.
    do c = 1, size(contact%status)
      if (correction%changes(c) < most_changes) cycle
      if (contact%held(c) == not_held) then
        contact%held(c) = contact%status(c)
        correction%held = correction%held + 1
      end if
      if (correction%reversed(c)) then
        contact%held(c) = status_stick
        changed = .true.
      end if
    end do
  end subroutine hold_cycling

  !> Release held candidates that violate the contact law into their status by it: all of them, or,
  !> if that does not settle, those with the largest violations.
  subroutine release_violators(correction, contact, released)
    type(correction_t), intent(inout) :: correction
    !> Evaluated; gets the status held.
    type(contact_work_t), intent(inout) :: contact
    !> Whether any was released.
    logical, intent(out) :: released

    real(wp) :: largest, smallest
    integer :: c

    largest = maxval(contact%violation, mask=contact%held /= not_held)
    released = largest > negligible*maxval(norm2(contact%force, dim=1))
    if (.not. released) return
    correction%releases = correction%releases + 1
    correction%last_release = size(correction%criterion)
    smallest = released_fraction*largest
    if (correction%releases <= full_releases) smallest = tiny(smallest)
    do c = 1, size(contact%status)
      if (contact%held(c) == not_held) cycle
      if (contact%violation(c) < smallest) cycle
      contact%held(c) = contact%natural(c)
      if (correction%opened(c)) contact%held(c) = not_held
      correction%released = correction%released + 1
    end do
  end subroutine release_violators

end module dd3_process_active_set
