! SPDX-License-Identifier: GPL-3.0-or-later
!> Draw-bead: a line in plan that restrains the sheet which slides across it, without the shape of
!> the bead. The restraining force per length follows a regularised friction law: it grows with an
!> elastic slip up to a limit, which depends on the path that the sheet has slid so far.
!> Line beads with a force per length: LS-DYNA Keyword User's Manual, *CONTACT_DRAWBEAD.
module dd3_model_terms_drawbead
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: drawbead_t, elastic_slip, new_drawbead, phase_beads_t

  !> Slip at which a bead reaches its largest force, in thicknesses of the sheet.
  real(wp), parameter :: elastic_slip = 0.01_wp
  !> Fraction of the limit from which on a restraining force is at it.
  real(wp), parameter :: at_limit = 1.0_wp - 1.0e-6_wp

  !> A draw-bead.
  type :: drawbead_t
    character(len=:), allocatable :: name
    !> Tool that carries it; 0 for none.
    integer :: tool = 0
    !> Number of the phase from which it acts.
    integer :: from = 1
    !> Force on the sheet along z, N/mm.
    real(wp) :: normal = 0.0_wp
    !> Slip path, mm, and limit of the restraining force there, N/mm, `(2, n)`: linear in between,
    !> and constant after the last one.
    real(wp), allocatable :: table(:, :)
    !> Ends of its intervals in plan, `(2, 2, n)`: coordinate, end, interval, mm. Each interval has
    !> one restraining force and one slip path.
    real(wp), allocatable :: line(:, :, :)
    !> Its bounds in plan, mm.
    real(wp) :: lower(2) = 0.0_wp, upper(2) = 0.0_wp
    !> Number of the intervals of the beads before it.
    integer :: offset = 0
    !> Restraining force per length over the elastic slip, N/mm2.
    real(wp) :: stiffness = 0.0_wp
  contains
    procedure :: move
    procedure :: length
    procedure :: means
    procedure :: restrain
    procedure :: sliding_stiffness
  end type drawbead_t

  !> Draw-beads in a phase: those that act, those that did not in the phase before, and those that
  !> leave with the withdrawn tools, `(n_bead)`.
  type :: phase_beads_t
    logical, allocatable :: active(:), new(:), leaves(:)
  end type phase_beads_t

contains

  !> Make the intervals and the law of a bead.
  pure subroutine new_drawbead(self, vertex, table, spacing, thickness)
    !> Name, tool and normal force are left to the caller.
    type(drawbead_t), intent(out) :: self
    !> Vertices of the line in plan, `(2, n)`, mm; different from one another.
    real(wp), intent(in) :: vertex(:, :)
    !> As the component.
    real(wp), intent(in) :: table(:, :)
    !> Largest length of an interval, and thickness of the sheet, mm.
    real(wp), intent(in) :: spacing, thickness

    integer :: n(size(vertex, 2) - 1), i, j, k

    self%table = table
    self%lower = minval(vertex, dim=2)
    self%upper = maxval(vertex, dim=2)
    self%stiffness = maxval(table(2, :))/(elastic_slip*thickness)
    n = [(max(1, ceiling(norm2(vertex(:, i + 1) - vertex(:, i))/spacing)), i=1, size(n))]
    allocate (self%line(2, 2, sum(n)))
    k = 0
    do i = 1, size(n)
      do j = 1, n(i)
        k = k + 1
        self%line(:, 1, k) = division(vertex(:, i:i + 1), j - 1, n(i))
        self%line(:, 2, k) = division(vertex(:, i:i + 1), j, n(i))
      end do
    end do
  end subroutine new_drawbead

  !> Move the line in plan.
  pure subroutine move(self, by)
    class(drawbead_t), intent(inout) :: self
    !> mm.
    real(wp), intent(in) :: by(2)

    self%line = self%line + spread(spread(by, 2, 2), 3, size(self%line, 3))
    self%lower = self%lower + by
    self%upper = self%upper + by
  end subroutine move

  !> Return point j, 0 to n, of a segment in n equal parts; its ends exactly.
  pure function division(segment, j, n) result(point)
    real(wp), intent(in) :: segment(2, 2)
    integer, intent(in) :: j, n
    real(wp) :: point(2)

    point = segment(:, 1) + real(j, wp)/real(n, wp)*(segment(:, 2) - segment(:, 1))
    if (j == n) point = segment(:, 2)
  end function division

  !> Return the length of the line, mm.
  pure real(wp) function length(self)
    class(drawbead_t), intent(in) :: self

    length = sum(norm2(self%line(:, 2, :) - self%line(:, 1, :), dim=1))
  end function length

  !> Return the means over the intervals of values that are constant in those of the same line with
  !> others.
  pure function means(self, other, values)
    class(drawbead_t), intent(in) :: self
    type(drawbead_t), intent(in) :: other
    !> Of the intervals of `other`.
    real(wp), intent(in) :: values(:)
    real(wp) :: means(size(self%line, 3))

    ! Both lines are divided at their vertices: the lengths to the ends of the intervals are places
    ! of one line.
    real(wp) :: from(size(self%line, 3) + 1), other_from(size(values) + 1)
    integer :: i

    from = lengths_to(self)
    other_from = lengths_to(other)
    do i = 1, size(means)
      means(i) = sum(values*max(0.0_wp, min(from(i + 1), other_from(2:)) &
          - max(from(i), other_from(:size(values)))))/(from(i + 1) - from(i))
    end do
  end function means

  !> Return the lengths of the line up to the start of each interval, and the whole, mm.
  pure function lengths_to(self) result(place)
    class(drawbead_t), intent(in) :: self
    real(wp) :: place(size(self%line, 3) + 1)

    integer :: i

    place(1) = 0.0_wp
    do i = 1, size(self%line, 3)
      place(i + 1) = place(i) + norm2(self%line(:, 2, i) - self%line(:, 1, i))
    end do
  end function lengths_to

  !> Evaluate the restraining force after a slip. Beyond the elastic slip, trial force less
  !> stiffness times sliding is the limit at the new path: linear in each interval of the table.
  pure subroutine restrain(self, start_force, start_path, slip, force, path, stiffness)
    class(drawbead_t), intent(in) :: self
    !> Force per length, N/mm, and slip path, mm, before the slip.
    real(wp), intent(in) :: start_force, start_path
    !> Displacement of the sheet across the bead, mm.
    real(wp), intent(in) :: slip
    !> Restraining force per length against a positive slip, N/mm, slip path, mm, and derivative of
    !> the force in the slip, N/mm2.
    real(wp), intent(out) :: force, path, stiffness

    real(wp) :: trial, limit, slope, next, slide

    force = start_force + self%stiffness*slip
    path = start_path
    stiffness = self%stiffness
    trial = abs(force)
    do
      call limit_at(self, path, limit, slope, next)
      if (.not. trial > limit) return  ! of no number too
      slide = (trial - limit)/(self%stiffness + slope)
      stiffness = self%stiffness*slope/(self%stiffness + slope)
      if (path + slide <= next) exit
      trial = trial - self%stiffness*(next - path)
      path = next
    end do
    path = path + slide
    force = sign(trial - self%stiffness*slide, force)
  end subroutine restrain

  !> Return the derivative of the restraining force in a slip that continues: of the limit if the
  !> force is at it, the elastic one otherwise; N/mm2.
  pure real(wp) function sliding_stiffness(self, force, path) result(stiffness)
    class(drawbead_t), intent(in) :: self
    !> N/mm and mm.
    real(wp), intent(in) :: force, path

    real(wp) :: limit, slope, next

    call limit_at(self, path, limit, slope, next)
    stiffness = self%stiffness
    if (stiffness > 0.0_wp .and. abs(force) >= at_limit*limit) then
      stiffness = stiffness*slope/(stiffness + slope)
    end if
  end function sliding_stiffness

  !> Evaluate the limit of the restraining force.
  pure subroutine limit_at(self, path, limit, slope, next)
    class(drawbead_t), intent(in) :: self
    real(wp), intent(in) :: path
    !> N/mm; its derivative behind the path, N/mm2; and the path up to which that holds, mm.
    real(wp), intent(out) :: limit, slope, next

    integer :: i, n

    n = size(self%table, 2)
    limit = self%table(2, n)
    slope = 0.0_wp
    next = huge(1.0_wp)
    do i = 1, n - 1
      associate (from => self%table(:, i), to => self%table(:, i + 1))
        if (path >= to(1)) cycle
        slope = (to(2) - from(2))/(to(1) - from(1))
        limit = from(2) + slope*(path - from(1))
        next = to(1)
        return
      end associate
    end do
  end subroutine limit_at

end module dd3_model_terms_drawbead
