! SPDX-License-Identifier: GPL-3.0-or-later
!> Refinements of the mesh in the course of a run, for its reports.
module dd3_model_mesh_change
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : to_text
  use dd3_settings_adaptive, only : most_levels
  implicit none
  private
  public :: mesh_change_t, n_integer, n_real, levels_text, count_levels
  public :: packed_integers, packed_reals, unpacked

  !> Integers and reals of a refinement in a restart file.
  integer, parameter :: n_integer = most_levels + 6, n_real = 3

  !> A refinement.
  type :: mesh_change_t
    !> Phase, and last accepted increment before it.
    integer :: phase = 0, increment = 0
    !> Progress in the phase, 0 to 1, and travel since the start of the job, mm.
    real(wp) :: progress = 0.0_wp, travel = 0.0_wp
    !> Numbers of elements before and after it; those of each level after it.
    integer :: before = 0, after = 0, of_level(0:most_levels) = 0
    !> Norm of the forces out of balance over that of the internal forces.
    real(wp) :: imbalance = 0.0_wp
    !> Whether the next increment had converged on the mesh before, and is made again.
    logical :: repeats = .false.
  contains
    procedure :: report
    procedure :: top_level
  end type mesh_change_t

contains

  !> Return the numbers of elements of the levels.
  pure function count_levels(level) result(number)
    !> `(n_element)`.
    integer, intent(in) :: level(:)
    integer :: number(0:most_levels)

    integer :: l

    number = [(count(level == l), l=0, most_levels)]
  end function count_levels

  !> Return the numbers of elements by level, up to the highest level that has some.
  pure function levels_text(of_level) result(text)
    integer, intent(in) :: of_level(0:)
    character(len=:), allocatable :: text

    integer :: l

    text = ""
    do l = 0, ubound(of_level, 1)
      if (sum(of_level(l:)) == 0) exit
      if (l > 0) text = text//" + "
      text = text//to_text(of_level(l))
    end do
  end function levels_text

  !> Return the line of the log.
  pure function report(self, phase, by_tool) result(text)
    class(mesh_change_t), intent(in) :: self
    !> Name of its phase, and whether a tool controls that, so that its travel tells the place.
    character(len=*), intent(in) :: phase
    logical, intent(in) :: by_tool
    character(len=:), allocatable :: text

    text = "refined in phase '"//phase//"' after increment "//to_text(self%increment)//" at "
    if (by_tool) then
      text = text//to_text(self%travel, 4)//" mm"
    else
      text = text//to_text(100.0_wp*self%progress, 3)//" %"
    end if
    if (self%repeats) text = text//", the next one is made again"
    text = text//": "//to_text(self%before)//" to "//to_text(self%after)//" elements ("// &
        levels_text(self%of_level)//" of levels 0 to "//to_text(self%top_level())//"); "// &
        to_text(100.0_wp*self%imbalance, 2)//" % of the internal forces out of balance"
  end function report

  !> Return the highest level that has elements.
  pure integer function top_level(self)
    class(mesh_change_t), intent(in) :: self

    do top_level = most_levels, 1, -1
      if (self%of_level(top_level) > 0) return
    end do
  end function top_level

  !> Return the integers of refinements, for a restart file.
  pure function packed_integers(change) result(number)
    type(mesh_change_t), intent(in) :: change(:)
    integer :: number(n_integer, size(change))

    integer :: i

    do i = 1, size(change)
      associate (c => change(i))
        number(:, i) = [c%phase, c%increment, c%before, c%after, merge(1, 0, c%repeats), c%of_level]
      end associate
    end do
  end function packed_integers

  !> Return the real numbers of refinements, for a restart file.
  pure function packed_reals(change) result(value)
    type(mesh_change_t), intent(in) :: change(:)
    real(wp) :: value(n_real, size(change))

    integer :: i

    do i = 1, size(change)
      value(:, i) = [change(i)%progress, change(i)%travel, change(i)%imbalance]
    end do
  end function packed_reals

  !> Return the refinements of a restart file.
  pure function unpacked(number, value) result(change)
    !> As `packed_integers` and `packed_reals` return them.
    integer, intent(in) :: number(:, :)
    real(wp), intent(in) :: value(:, :)
    type(mesh_change_t) :: change(size(number, 2))

    integer :: i

    do i = 1, size(change)
      associate (n => number(:, i), v => value(:, i))
        change(i) = mesh_change_t(n(1), n(2), v(1), v(2), n(3), n(4), n(6:), v(3), n(5) == 1)
      end associate
    end do
  end function unpacked

end module dd3_model_mesh_change
