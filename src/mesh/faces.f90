!> Faces of the elements on the boundary of the sheet.
module dd3_mesh_faces
  implicit none
  private
  public :: boundary_faces

contains

  !> Return the nodes of the faces that belong to one element only, `(size(face, 1), n)`, ordered as
  !> in the element. Faces are compared with those that have the same lowest node.
  pure function boundary_faces(face, connectivity) result(boundary)
    !> Nodes of the faces of an element, corners first.
    integer, intent(in) :: face(:, :)
    !> Nodes of the elements, `(n_element_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    integer, allocatable :: boundary(:, :)

    integer, allocatable :: all_faces(:, :), first(:), next(:)
    logical, allocatable :: single(:)
    integer :: e, f, k, other, lowest

    allocate (all_faces(size(face, 1), size(face, 2)*size(connectivity, 2)))
    allocate (first(maxval(connectivity)), next(size(all_faces, 2)), source=0)
    allocate (single(size(all_faces, 2)), source=.true.)
    k = 0
    do e = 1, size(connectivity, 2)
      do f = 1, size(face, 2)
        k = k + 1
        all_faces(:, k) = connectivity(face(:, f), e)
        lowest = minval(all_faces(:, k))
        other = first(lowest)
        do while (other > 0)
          if (same_nodes(all_faces(:, k), all_faces(:, other))) then
            single([k, other]) = .false.
            exit
          end if
          other = next(other)
        end do
        next(k) = first(lowest)
        first(lowest) = k
      end do
    end do
    boundary = all_faces(:, pack([(k, k=1, size(single))], single))
  end function boundary_faces

  !> Whether two faces have the same nodes, in any order.
  pure logical function same_nodes(a, b)
    integer, intent(in) :: a(:), b(:)

    integer :: i

    same_nodes = .true.
    do i = 1, size(a)
      same_nodes = same_nodes .and. any(b == a(i))
    end do
  end function same_nodes

end module dd3_mesh_faces
