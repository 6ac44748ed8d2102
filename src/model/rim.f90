! SPDX-License-Identifier: GPL-3.0-or-later
!> Rim of the sheet, the boundary faces between its lower and upper face without those on planes of
!> symmetry, and the draw-in: displacement of the rim along its initial inward normal, without that
!> by which *START has brought the sheet to its place.
module dd3_model_rim
  use dd3_base_kinds, only : wp
  use dd3_mesh_mesh, only : placed
  use dd3_model_model, only : model_t
  use dd3_model_outward_normals, only : mean_normals
  use dd3_model_sheet_faces, only : area_vector
  implicit none
  private
  public :: set_rim, draw_in, mean_draw_in, is_on_symmetry_plane

  !> Least component of the normal of a face on a plane of symmetry, whose nodes are all held in
  !> that direction.
  real(wp), parameter :: along_axis = 0.999_wp

contains

  !> Set the normals of the rim at the nodes: the mean over the faces at a node, by area.
  pure subroutine set_rim(model)
    !> With faces, columns and supports; gets `rim_normal`.
    type(model_t), intent(inout) :: model

    logical :: on_rim(model%face%n)
    integer :: axis, f

    do f = 1, model%face%n
      on_rim(f) = is_side(model, f) .and. &
          .not. any([(is_on_symmetry_plane(model, f, axis), axis=1, 3)])
    end do
    model%rim_normal = -matmul(model%placement(:, :3), &
        mean_normals(model%face, pack([(f, f=1, size(on_rim))], on_rim), model%x0))
  end subroutine set_rim

  !> Whether a boundary face lies between the lower and the upper face of the sheet.
  pure logical function is_side(model, f)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f

    associate (bottom => model%column(1, model%face%corner(:, f)))
      is_side = any(bottom == cshift(bottom, 1))
    end associate
  end function is_side

  !> Whether a boundary face lies on a plane of symmetry normal to an axis: a side of the sheet
  !> whose nodes are held along it.
  pure logical function is_on_symmetry_plane(model, f, axis) result(is_on)
    !> With faces, columns and supports.
    type(model_t), intent(in) :: model
    !> Boundary face.
    integer, intent(in) :: f
    !> 1, 2, 3.
    integer, intent(in) :: axis

    real(wp) :: area(3)

    is_on = is_side(model, f)
    if (is_on) is_on = all(model%fixed(axis, model%face%node(:, f)))
    if (.not. is_on) return
    if (allocated(model%x_start)) then
      area = area_vector(model%x_start(:, model%face%corner(:, f)))
    else
      area = area_vector(model%x0(:, model%face%corner(:, f)))
    end if
    is_on = abs(area(axis)) > along_axis*norm2(area)
  end function is_on_symmetry_plane

  !> Return the draw-in of the nodes, `(n_node)`, mm; zero for a node that is not on the rim.
  pure function draw_in(model, x) result(value)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: value(:)

    value = sum((x - model%undeformed_positions())*model%rim_normal, dim=1)
  end function draw_in

  !> Return the mean draw-in of the nodes of a set that lie on the rim, mm.
  pure real(wp) function mean_draw_in(model, x, node)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node(:)

    real(wp) :: place(3, 1)
    integer :: i, n

    mean_draw_in = 0.0_wp
    n = 0
    do i = 1, size(node)
      associate (direction => model%rim_normal(:, node(i)))
        if (norm2(direction) <= 0.0_wp) cycle
        place = placed(model%placement, model%x0(:, node(i:i)))
        mean_draw_in = mean_draw_in + dot_product(direction, x(:, node(i)) - place(:, 1))
      end associate
      n = n + 1
    end do
    mean_draw_in = mean_draw_in/real(max(1, n), wp)
  end function mean_draw_in

end module dd3_model_rim
