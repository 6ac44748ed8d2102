! SPDX-License-Identifier: GPL-3.0-or-later
!> Distance between the surfaces of two tools, and the displacement at which it has a given value.
!> The distance is the smallest one from the sample points of the patches of each tool to the other
!> surface: exact for plane faces.
module dd3_tools_separation
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : n_sample, normal_at, position_at
  use dd3_tools_closest, only : find_contact, hint_t, hit_t
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: offset_at_gap

  !> Largest number of displacements until the gap is met, and the fraction of it within which it
  !> is.
  integer, parameter :: iterations = 200
  real(wp), parameter :: met = 1.0e-9_wp
  !> Displacement that shows on which side the other surface is, mm.
  real(wp), parameter :: probing = 1.0e-6_wp
  !> Least component along z of the normal at a sample, and of the opposite normal along it.
  real(wp), parameter :: steepest = 0.5_wp
  !> Number of patches from which on every fourth line of samples is used.
  integer, parameter :: many_patches = 100

contains

  !> Find the displacement along z at which the gap between two surfaces that face each other has a
  !> given value.
  pure subroutine offset_at_gap(a, b, start, gap, offset, found)
    type(surface_t), intent(in) :: a, b
    !> Initial displacement of a relative to b, mm.
    real(wp), intent(in) :: start(3)
    !> mm.
    real(wp), intent(in) :: gap
    !> z of the displacement of a relative to b, mm.
    real(wp), intent(out) :: offset
    !> False if the surfaces do not face each other along z.
    logical, intent(out) :: found

    real(wp) :: place(3), distance, ahead, towards
    integer :: i

    offset = start(3)
    place = start
    distance = separation(a, b, place)
    ahead = separation(a, b, place + [0.0_wp, 0.0_wp, probing])
    towards = sign(1.0_wp, distance - ahead)
    do i = 1, iterations
      found = distance < huge(1.0_wp) .and. abs(distance - gap) <= met*gap
      if (found .or. distance >= huge(1.0_wp)) exit
      place(3) = place(3) + towards*(distance - gap)
      distance = separation(a, b, place)
    end do
    offset = place(3)
  end subroutine offset_at_gap

  !> Return the smallest distance between two surfaces, mm; a huge value if they do not face each
  !> other.
  pure real(wp) function separation(a, b, offset)
    type(surface_t), intent(in) :: a, b
    !> Displacement of a relative to b, mm.
    real(wp), intent(in) :: offset(3)

    separation = huge(1.0_wp)
    call probe(a, b, offset, separation)
    call probe(b, a, -offset, separation)
  end function separation

  !> Keep the smallest distance of the samples of a surface that faces another one along z.
  pure subroutine probe(from, to, offset, distance)
    type(surface_t), intent(in) :: from, to
    !> Displacement of the first relative to the second, mm.
    real(wp), intent(in) :: offset(3)
    real(wp), intent(inout) :: distance

    type(hint_t) :: hint
    type(hit_t) :: hit
    real(wp) :: normal(3), u, v, reach
    logical :: regular
    integer :: k, i, j, step

    reach = norm2(offset) + from%size + to%size
    step = merge(4, 1, size(from%patch) > many_patches)
    do k = 1, size(from%patch)
      do j = 0, n_sample, step
        do i = 0, n_sample, step
          u = real(i, wp)/n_sample
          v = real(j, wp)/n_sample
          call normal_at(from%patch(k), u, v, normal, regular)
          if (.not. regular .or. abs(normal(3)) < steepest) cycle
          hint = hint_t()
          call find_contact(to, position_at(from%patch(k), u, v) + offset, hint, reach, reach, &
              hit, normal)
          if (.not. hit%found) cycle
          if (dot_product(hit%normal, normal) > -steepest) cycle
          distance = min(distance, hit%distance)
        end do
      end do
    end do
  end subroutine probe

end module dd3_tools_separation
