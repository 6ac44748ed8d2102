! SPDX-License-Identifier: GPL-3.0-or-later
!> Rigid-body motions of the sheet that the supports leave free. A node held in a direction d
!> excludes the motions u = t + w x (x - c) with u . d /= 0. The free motions are the null space of
!> the sum of the dyadic products of all such conditions, found by elimination with diagonal pivots,
!> translations first. A part of the sheet are elements that are connected through common nodes.
module dd3_model_rigid_motion
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_base_text, only : axis_name, to_text
  use dd3_linalg_tensor, only : cross, identity
  implicit none
  private
  public :: rigid_motion_t, new_rigid_motion, new_supported_part
  public :: part_name, parts_of_nodes

  !> Pivots below this fraction of the trace are round-off.
  real(wp), parameter :: round_off = 1.0e-12_wp
  !> Components of a unit vector below this count as zero.
  real(wp), parameter :: aligned = 1.0e-4_wp

  !> Conditions that hold a body.
  type :: rigid_motion_t
    !> Mean position of the nodes, mm.
    real(wp) :: centre(3) = 0.0_wp
    !> Distance of the farthest node from the centre, mm.
    real(wp) :: size = 1.0_wp
    !> Sum of the dyadic products of the conditions on translation and rotation times size.
    real(wp) :: product(6, 6) = 0.0_wp
  contains
    procedure :: hold
    procedure :: share
    procedure :: hold_prescribed
    procedure :: free_motion
    procedure :: free_projector
    procedure :: condition
  end type rigid_motion_t

contains

  !> Make a body without supports.
  pure subroutine new_rigid_motion(self, x)
    type(rigid_motion_t), intent(out) :: self
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    integer :: n

    self%centre = sum(x, dim=2)/real(max(1, size(x, 2)), wp)
    self%size = maxval([(norm2(x(:, n) - self%centre), n=1, size(x, 2))])
  end subroutine new_rigid_motion

  !> Make a body of some nodes with their supports.
  pure subroutine new_supported_part(self, x, prescribed, member)
    type(rigid_motion_t), intent(out) :: self
    !> Positions of all nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Components with a prescribed displacement, `(3, n_node)`.
    logical, intent(in) :: prescribed(:, :)
    !> Nodes of the body, `(n_node)`.
    logical, intent(in) :: member(:)

    integer :: node(count(member)), n

    node = pack([(n, n=1, size(member))], member)
    call new_rigid_motion(self, x(:, node))
    call self%hold_prescribed(x(:, node), prescribed(:, node))
  end subroutine new_supported_part

  !> Hold a point in a direction.
  pure subroutine hold(self, x, direction)
    class(rigid_motion_t), intent(inout) :: self
    !> Position of the point, mm.
    real(wp), intent(in) :: x(3)
    real(wp), intent(in) :: direction(3)

    real(wp) :: row(6)

    row = self%condition(x, direction)
    self%product = self%product + spread(row, 2, 6)*spread(row, 1, 6)
  end subroutine hold

  !> Hold the body by the conditions of all ranks as well. Those that all ranks have count more,
  !> which does not change the free motions.
  subroutine share(self)
    class(rigid_motion_t), intent(inout) :: self

    call sum_over_ranks(size(self%product), self%product)
  end subroutine share

  !> Return the condition of a point held in a direction on translation and rotation times size. It
  !> is also the resultant and the moment over size of a force there.
  pure function condition(self, x, direction) result(row)
    class(rigid_motion_t), intent(in) :: self
    !> Position of the point, mm.
    real(wp), intent(in) :: x(3)
    real(wp), intent(in) :: direction(3)
    real(wp) :: row(6)

    row(:3) = direction
    row(4:) = cross((x - self%centre)/self%size, direction)
  end function condition

  !> Hold the nodes at which a displacement is prescribed.
  pure subroutine hold_prescribed(self, x, prescribed)
    class(rigid_motion_t), intent(inout) :: self
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Components with a prescribed displacement, `(3, n_node)`.
    logical, intent(in) :: prescribed(:, :)

    integer :: n, d

    do n = 1, size(x, 2)
      do d = 1, 3
        if (prescribed(d, n)) call self%hold(x(:, n), identity(:, d))
      end do
    end do
  end subroutine hold_prescribed

  !> Return the free motions as text, `move along y, turn about x`; empty if there are none.
  pure function free_motion(self) result(text)
    class(rigid_motion_t), intent(in) :: self
    character(len=:), allocatable :: text

    character(len=:), allocatable :: turns
    real(wp) :: motion(6, 6)
    integer :: n, k

    call null_space(self%product, motion, n)
    text = ""
    turns = ""
    do k = 1, n
      if (norm2(motion(4:, k)) < aligned*norm2(motion(:, k))) then
        call add(text, "move along "//name_of(motion(:3, k)))
      else
        call add(turns, "turn about "//name_of(motion(4:, k)))
      end if
    end do
    if (len(turns) > 0) call add(text, turns)
  end function free_motion

  !> Return the orthogonal projection onto the free motions, and their number.
  pure subroutine free_projector(self, projector, n)
    class(rigid_motion_t), intent(in) :: self
    real(wp), intent(out) :: projector(6, 6)
    integer, intent(out) :: n

    real(wp) :: motion(6, 6), unit(6)
    integer :: k

    call null_space(self%product, motion, n)
    projector = 0.0_wp
    do k = 1, n
      unit = motion(:, k) - matmul(projector, motion(:, k))
      unit = unit/norm2(unit)
      projector = projector + spread(unit, 2, 6)*spread(unit, 1, 6)
    end do
  end subroutine free_projector

  !> Append words to a list separated by commas.
  pure subroutine add(text, words)
    character(len=:), allocatable, intent(inout) :: text
    character(len=*), intent(in) :: words

    if (len(text) > 0) text = text//", "
    text = text//words
  end subroutine add

  !> Return a direction as text: the axis, or the components.
  pure function name_of(direction) result(name)
    real(wp), intent(in) :: direction(3)
    character(len=:), allocatable :: name

    real(wp) :: unit(3)
    integer :: k

    unit = direction/norm2(direction)
    k = maxloc(abs(unit), dim=1)
    name = axis_name(k)
    if (norm2(unit) - abs(unit(k)) < aligned**2) return
    where (abs(unit) < aligned) unit = 0.0_wp
    name = "("//to_text(unit(1), 3)//" "//to_text(unit(2), 3)//" "//to_text(unit(3), 3)//")"
  end function name_of

  !> Find the null space of a symmetric positive semi-definite matrix by Gauss-Jordan elimination.
  pure subroutine null_space(matrix, motion, n)
    real(wp), intent(in) :: matrix(6, 6)
    !> Vectors that span the null space, `motion(:, 1:n)`.
    real(wp), intent(out) :: motion(6, 6)
    !> Dimension of the null space.
    integer, intent(out) :: n

    real(wp) :: a(6, 6), smallest
    logical :: eliminated(6)
    integer :: step, last, k, i

    a = matrix
    smallest = round_off*sum([(a(i, i), i=1, 6)])
    eliminated = .false.
    last = 3
    do step = 1, 7
      k = maxloc([(a(i, i), i=1, last)], dim=1, mask=.not. eliminated(:last))
      if (k > 0) then
        if (a(k, k) <= smallest) k = 0
      end if
      if (k == 0 .and. last == 6) exit
      last = merge(6, last, k == 0)
      if (k == 0) cycle
      eliminated(k) = .true.
      a(k, :) = a(k, :)/a(k, k)
      do i = 1, 6
        if (i /= k) a(i, :) = a(i, :) - a(i, k)*a(k, :)
      end do
    end do
    n = 0
    motion = 0.0_wp
    do k = 1, 6
      if (eliminated(k)) cycle
      n = n + 1
      where (eliminated) motion(:, n) = -a(:, k)
      motion(k, n) = 1.0_wp
    end do
  end subroutine null_space

  !> Return the part of each node, from 1 in the order of their lowest nodes.
  pure function parts_of_nodes(connectivity, n_node) result(part)
    !> `(n_element_node, n_element)`; every node belongs to an element.
    integer, intent(in) :: connectivity(:, :)
    integer, intent(in) :: n_node
    integer :: part(n_node)

    integer :: parent(n_node), e, i, a, b

    parent = [(i, i=1, n_node)]
    do e = 1, size(connectivity, 2)
      a = root(parent, connectivity(1, e))
      do i = 2, size(connectivity, 1)
        b = root(parent, connectivity(i, e))
        parent(max(a, b)) = min(a, b)
        a = min(a, b)
      end do
      parent(connectivity(:, e)) = a
    end do
    b = 0
    do i = 1, n_node
      a = root(parent, i)
      if (a == i) b = b + 1
      part(i) = b
      if (a < i) part(i) = part(a)
    end do
  end function parts_of_nodes

  !> Return the lowest node known to be connected with a node.
  pure integer function root(parent, node)
    !> A connected node that is lower, or the node itself, `(n_node)`.
    integer, intent(in) :: parent(:)
    integer, intent(in) :: node

    root = node
    do while (parent(root) /= root)
      root = parent(root)
    end do
  end function root

  !> Return what a part is called in a message: the sheet, if it is all of it.
  function part_name(part, number) result(name)
    !> Part of each node.
    integer, intent(in) :: part(:)
    integer, intent(in) :: number
    character(len=:), allocatable :: name

    name = "the sheet"
    if (any(part /= number)) name = "the part of the sheet with node "// &
        to_text(findloc(part, number, dim=1))
  end function part_name

end module dd3_model_rigid_motion
