!> Parts of the sheet: elements that are connected through common nodes.
module dd3_model_sheet_parts
  use dd3_base_text, only : to_text
  implicit none
  private
  public :: part_name, parts_of_nodes

contains

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

end module dd3_model_sheet_parts
