! SPDX-License-Identifier: GPL-3.0-or-later
!> Supports against the rigid motions that are left free: as few as there are free motions, so that
!> they carry no reaction if the forces on the sheet are in equilibrium. Each is chosen as the nodal
!> direction with the largest component in the free motions (pivoted Gram-Schmidt), and those
!> motions that it stops are removed.
module dd3_model_rigid_supports
  use dd3_base_kinds, only : wp
  use dd3_base_text, only : axis_name, to_text
  use dd3_linalg_tensor, only : identity
  use dd3_model_rigid_motion, only : new_rigid_motion, rigid_motion_t
  implicit none
  private
  public :: choose_supports, name_of_support

  !> Nodes with a support, such as those of a plane of symmetry, are taken, and supports of before
  !> kept, if their component is at least this fraction of the largest.
  real(wp), parameter :: sufficient = 0.1_wp
  !> Relative difference below which two components count as equal; the lower node number wins.
  real(wp), parameter :: equal = 1.0e-6_wp

contains

  !> Choose the supports.
  recursive subroutine choose_supports(x, prescribed, support, bound, weight, before)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Directions with a support already, `(3, n_node)`.
    logical, intent(in) :: prescribed(:, :)
    !> Node and axis of each support, `(2, n)`.
    integer, allocatable, intent(out) :: support(:, :)
    !> Nodes that are bound to others and cannot be supported.
    integer, intent(in), optional :: bound(:)
    !> Factors on the components in the choice, `(3, n_node)`; 1 by default.
    real(wp), intent(in), optional :: weight(:, :)
    !> Supports chosen at other positions, `(2, n)`: kept if all of them hold at these.
    integer, intent(in), optional :: before(:, :)

    real(wp) :: factor(3, size(x, 2))
    logical :: allowed(size(x, 2))
    type(rigid_motion_t) :: body
    real(wp) :: projector(6, 6), row(6), component, other
    integer :: n, k, place(2), near(2)

    call new_rigid_motion(body, x)
    call body%hold_prescribed(x, prescribed)
    call body%free_projector(projector, n)
    allocate (support(2, n))
    allowed = .true.
    if (present(bound)) allowed(bound) = .false.
    factor = 1.0_wp
    if (present(weight)) factor = weight
    do k = 1, n
      call find_largest(body, x, allowed, factor, projector, place, component)
      call find_largest(body, x, allowed .and. any(prescribed, dim=1), factor, projector, near, &
          other)
      if (other >= sufficient*component) place = near
      if (present(before)) then
        place = before(:, min(k, size(before, 2)))
        if (norm2(row_of(place)) < sufficient*component .or. n /= size(before, 2)) then
          call choose_supports(x, prescribed, support, bound, weight)
          return
        end if
      end if
      support(:, k) = place
      row = row_of(place)
      row = row/norm2(row)
      projector = projector - spread(row, 2, 6)*spread(row, 1, 6)
    end do

  contains

    !> Return the components of the free motions in a nodal direction.
    function row_of(place) result(row)
      !> Node and axis.
      integer, intent(in) :: place(2)
      real(wp) :: row(6)

      row = matmul(projector, body%condition(x(:, place(1)), identity(:, place(2))))
    end function row_of

  end subroutine choose_supports

  !> Find the nodal direction with the largest component in the free motions.
  subroutine find_largest(body, x, allowed, weight, projector, place, component)
    type(rigid_motion_t), intent(in) :: body
    real(wp), intent(in) :: x(:, :)
    !> Nodes to choose from.
    logical, intent(in) :: allowed(:)
    !> Factors on the components, `(3, n_node)`.
    real(wp), intent(in) :: weight(:, :)
    !> Projection onto the free motions.
    real(wp), intent(in) :: projector(6, 6)
    !> Node and axis.
    integer, intent(out) :: place(2)
    real(wp), intent(out) :: component

    real(wp) :: this
    integer :: node, axis

    place = 1
    component = 0.0_wp
    do node = 1, size(x, 2)
      if (.not. allowed(node)) cycle
      do axis = 1, 3
        this = weight(axis, node) &
            *norm2(matmul(projector, body%condition(x(:, node), identity(:, axis))))
        if (this <= component*(1.0_wp + equal)) cycle
        component = this
        place = [node, axis]
      end do
    end do
  end subroutine find_largest

  !> Return a support as text: `z of node 12`.
  pure function name_of_support(support) result(text)
    !> Node and axis.
    integer, intent(in) :: support(2)
    character(len=:), allocatable :: text

    text = axis_name(support(2))//" of node "//to_text(support(1))
  end function name_of_support

end module dd3_model_rigid_supports
