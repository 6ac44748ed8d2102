! SPDX-License-Identifier: GPL-3.0-or-later
!> Thickness direction of the elements of a sheet. A mesh of hexahedra is extruded in a direction if
!> that direction can be carried from element to element through all faces without contradiction;
!> a sheet is thin in one such direction.
module dd3_mesh_layers
  use dd3_base_kinds, only : wp
  use dd3_mesh_hexahedra, only : corner_natural, face_corner, neighbours_t
  implicit none
  private
  public :: layers_t, find_layers, turn_of, layers_found, layers_none, layers_ambiguous

  !> Outcome of the search.
  integer, parameter :: layers_found = 0, layers_none = 1, layers_ambiguous = 2
  !> A direction is the thickness if the body is at most this fraction as long along it as along any
  !> other direction of extrusion: a strip for plane strain may be narrower than it is thick.
  real(wp), parameter :: thin = 0.1_wp
  !> Components of the mean thickness vector over its length below which it is not upright.
  real(wp), parameter :: upright = 1.0e-6_wp

  !> Thickness directions.
  type :: layers_t
    !> One of the `layers_*` values.
    integer :: outcome = layers_found
    !> Element at which no direction is left, or of an ambiguous direction.
    integer :: element = 0
    !> Natural axis from bottom to top of each element, -3 to 3, `(n_element)`.
    integer, allocatable :: axis(:)
  end type layers_t

  !> A direction of extrusion of a connected part of the mesh.
  type :: candidate_t
    logical :: valid = .false.
    !> Element that contradicts it.
    integer :: conflict = 0
    !> Mean length of the part along it, mm.
    real(wp) :: length = 0.0_wp
    !> Axis of each element of the part, in the order of the part's list.
    integer, allocatable :: axis(:)
  end type candidate_t

contains

  !> Find the thickness direction of all elements, part by part.
  pure subroutine find_layers(self, neighbours, corner, x)
    type(layers_t), intent(out) :: self
    type(neighbours_t), intent(in) :: neighbours
    !> Nodes at the corners, `(8, n_element)`.
    integer, intent(in) :: corner(:, :)
    !> Coordinates, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    type(candidate_t) :: candidate(3)
    integer, allocatable :: part(:), place(:)
    integer :: seed, n, d, chosen

    allocate (self%axis(size(corner, 2)), place(size(corner, 2)), source=0)
    allocate (part(size(corner, 2)))
    do seed = 1, size(corner, 2)
      if (place(seed) > 0) cycle
      call list_part(neighbours, seed, part, place, n)
      do d = 1, 3
        call follow(candidate(d), neighbours, corner, part(:n), place, d)
        if (candidate(d)%valid) call measure(candidate(d), neighbours, corner, part(:n), x)
      end do
      call choose(self, candidate, part(:n), chosen)
      if (self%outcome /= layers_found) return
      self%axis(part(:n)) = candidate(chosen)%axis
      call set_upright(self%axis, corner, part(:n), x)
    end do
  end subroutine find_layers

  !> List the elements connected with one, nearest first.
  pure subroutine list_part(neighbours, seed, part, place, n)
    type(neighbours_t), intent(in) :: neighbours
    integer, intent(in) :: seed
    integer, intent(inout) :: part(:)
    !> Place of each element in the list of its part; 0 if it is in none yet.
    integer, intent(inout) :: place(:)
    integer, intent(out) :: n

    integer :: next, f, e

    n = 1
    part(1) = seed
    place(seed) = 1
    next = 1
    do while (next <= n)
      do f = 1, 6
        e = neighbours%element(f, part(next))
        if (e == 0) cycle
        if (place(e) > 0) cycle
        n = n + 1
        part(n) = e
        place(e) = n
      end do
      next = next + 1
    end do
  end subroutine list_part

  !> Carry a natural axis of the first element through a part.
  pure subroutine follow(self, neighbours, corner, part, place, axis)
    type(candidate_t), intent(out) :: self
    type(neighbours_t), intent(in) :: neighbours
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: part(:), place(:)
    !> 1, 2 or 3.
    integer, intent(in) :: axis

    integer :: i, f, e, carried

    allocate (self%axis(size(part)), source=0)
    self%axis(1) = axis
    do i = 1, size(part)
      do f = 1, 6
        e = neighbours%element(f, part(i))
        if (e == 0) cycle
        carried = carry(corner(:, part(i)), corner(:, e), self%axis(i), f, &
            neighbours%face(f, part(i)))
        if (self%axis(place(e)) == 0) self%axis(place(e)) = carried
        if (self%axis(place(e)) == carried) cycle
        self%conflict = e
        return
      end do
    end do
    self%valid = .true.
  end subroutine follow

  !> Return the axis of an element that continues an axis of its neighbour.
  pure integer function carry(from, to, axis, face_from, face_to) result(carried)
    !> Nodes at the corners.
    integer, intent(in) :: from(8), to(8)
    !> Axis of the first element, with its sign.
    integer, intent(in) :: axis
    !> Numbers of the common face in both.
    integer, intent(in) :: face_from, face_to

    integer :: a, b, k, difference(3)

    if ((face_from + 1)/2 == abs(axis)) then
      ! Out of one element through the face, into the other.
      carried = -sign((face_to + 1)/2, side(face_to)*side(face_from)*axis)
      return
    end if
    do k = 1, 4
      a = face_corner(k, face_from)
      if (corner_natural(abs(axis), a) == -1) exit
    end do
    do k = 1, 4
      b = face_corner(k, face_from)
      difference = corner_natural(:, b) - corner_natural(:, a)
      if (difference(abs(axis)) == 2 .and. sum(abs(difference)) == 2) exit
    end do
    difference = corner_natural(:, findloc(to, from(b), dim=1)) &
        - corner_natural(:, findloc(to, from(a), dim=1))
    carried = maxloc(abs(difference), dim=1)
    carried = sign(carried, difference(carried)*axis)
  end function carry

  !> Return -1 or 1 for a face on the negative or positive side of its axis.
  pure integer function side(face)
    integer, intent(in) :: face

    side = 1 - 2*modulo(face, 2)
  end function side

  !> Measure the mean length of a part along a direction; a ring, without ends, has none and is not
  !> a candidate.
  pure subroutine measure(self, neighbours, corner, part, x)
    type(candidate_t), intent(inout) :: self
    type(neighbours_t), intent(in) :: neighbours
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: part(:)
    real(wp), intent(in) :: x(:, :)

    integer :: i, n_column

    n_column = 0
    do i = 1, size(part)
      self%length = self%length + norm2(vector(x(:, corner(:, part(i))), self%axis(i)))
      if (neighbours%element(face_at(-self%axis(i)), part(i)) == 0) n_column = n_column + 1
    end do
    self%valid = n_column > 0
    if (self%valid) self%length = self%length/real(n_column, wp)
  end subroutine measure

  !> Return the face on the side of a signed axis.
  pure integer function face_at(axis)
    integer, intent(in) :: axis

    face_at = 2*abs(axis) - merge(0, 1, axis > 0)
  end function face_at

  !> Return the mean edge of an element along a signed axis, mm.
  pure function vector(x, axis)
    real(wp), intent(in) :: x(3, 8)
    integer, intent(in) :: axis
    real(wp) :: vector(3)

    integer :: a

    vector = 0.0_wp
    do a = 1, 8
      vector = vector + real(sign(corner_natural(abs(axis), a), &
          corner_natural(abs(axis), a)*axis), wp)*x(:, a)
    end do
    vector = 0.25_wp*vector
  end function vector

  !> Choose the thickness: the only direction, or the clearly shortest one, or else the zeta axis of
  !> the file if all elements have it along the same direction.
  pure subroutine choose(self, candidate, part, chosen)
    type(layers_t), intent(inout) :: self
    type(candidate_t), intent(in) :: candidate(3)
    integer, intent(in) :: part(:)
    integer, intent(out) :: chosen

    real(wp) :: length(3)

    length = huge(1.0_wp)
    where (candidate%valid) length = candidate%length
    chosen = minloc(length, dim=1)
    if (.not. any(candidate%valid)) then
      self%outcome = layers_none
      self%element = candidate(3)%conflict
      if (self%element == 0) self%element = part(1)
      return
    end if
    if (count(length <= length(chosen)/thin) == 1) return
    chosen = 3
    if (candidate(3)%valid) then
      if (all(abs(candidate(3)%axis) == 3)) return
      self%element = part(findloc(abs(candidate(3)%axis) == 3, .false., dim=1))
    else
      self%element = part(1)
    end if
    self%outcome = layers_ambiguous
  end subroutine choose

  !> Let the thickness of a part point to +z; if its mean does not, its sign is that of the file.
  pure subroutine set_upright(axis, corner, part, x)
    integer, intent(inout) :: axis(:)
    integer, intent(in) :: corner(:, :)
    integer, intent(in) :: part(:)
    real(wp), intent(in) :: x(:, :)

    real(wp) :: mean(3), this(3), length
    integer :: i

    mean = 0.0_wp
    length = 0.0_wp
    do i = 1, size(part)
      this = vector(x(:, corner(:, part(i))), axis(part(i)))
      mean = mean + this
      length = length + norm2(this)
    end do
    if (mean(3) < -upright*length) axis(part) = -axis(part)
  end subroutine set_upright

  !> Return the rotation of the natural axes that makes an axis the third one.
  pure function turn_of(axis) result(turn)
    !> -3 to 3.
    integer, intent(in) :: axis
    integer :: turn(3, 3)

    integer :: i, source(3)

    source = cshift([1, 2, 3], abs(axis))
    if (axis < 0) source(:2) = source([2, 1])
    turn = 0
    do i = 1, 3
      turn(i, source(i)) = 1
    end do
    if (axis < 0) turn(3, :) = -turn(3, :)
  end function turn_of

end module dd3_mesh_layers
