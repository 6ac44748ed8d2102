! SPDX-License-Identifier: GPL-3.0-or-later
!> Edges of the elements in the plane of the sheet.
module dd3_model_edge_length
  use dd3_base_kinds, only : wp
  use dd3_model_mesh_data, only : mesh_data_t
  implicit none
  private
  public :: edge_lengths, longest_edge, undivided_length

contains

  !> Return the mean edges of the elements in the plane of the sheet, `(n_element)`, mm.
  pure function edge_lengths(mesh, x) result(length)
    class(mesh_data_t), intent(in) :: mesh
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp) :: length(mesh%n_element)

    integer :: e, i

    do e = 1, mesh%n_element
      associate (node => mesh%connectivity(:4, e))
        length(e) = 0.25_wp*sum([(norm2(x(:, node(modulo(i, 4) + 1)) - x(:, node(i))), i=1, 4)])
      end associate
    end do
  end function edge_lengths

  !> Return the longest initial edge that an element had before it was divided, mm.
  pure real(wp) function longest_edge(mesh)
    class(mesh_data_t), intent(in) :: mesh

    real(wp) :: edge
    integer :: e, i

    longest_edge = 0.0_wp
    do e = 1, mesh%n_element
      associate (node => mesh%connectivity(:4, e))
        edge = maxval([(norm2(mesh%x0(:, node(modulo(i, 4) + 1)) - mesh%x0(:, node(i))), i=1, 4)])
      end associate
      if (allocated(mesh%level)) edge = edge*2.0_wp**mesh%level(e)
      longest_edge = max(longest_edge, edge)
    end do
  end function longest_edge

  !> Return the mean of the initial edges that the elements had before they were divided, mm.
  pure real(wp) function undivided_length(mesh)
    class(mesh_data_t), intent(in) :: mesh

    real(wp) :: length(mesh%n_element), share(mesh%n_element)

    length = edge_lengths(mesh, mesh%x0)
    share = 1.0_wp
    if (allocated(mesh%level)) then
      length = length*2.0_wp**mesh%level
      share = 0.25_wp**mesh%level
    end if
    undivided_length = sum(share*length)/sum(share)
  end function undivided_length

end module dd3_model_edge_length
