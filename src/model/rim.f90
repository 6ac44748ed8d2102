!> Rim of the sheet, the boundary faces between its lower and upper face without those on planes of
!> symmetry, and the draw-in: displacement of the rim along its initial inward normal.
module dd3_model_rim
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: set_rim, draw_in, mean_draw_in

  !> Least component of the normal of a face on a plane of symmetry, whose nodes are all held in
  !> that direction.
  real(wp), parameter :: along_axis = 0.999_wp

contains

  !> Set the normals of the rim at the nodes: the mean over the faces at a node, by area.
  pure subroutine set_rim(model)
    !> With faces, columns and supports; gets `rim_normal`.
    type(model_t), intent(inout) :: model

    real(wp), allocatable :: normal(:, :)
    real(wp) :: area(3)
    integer :: f, i

    allocate (normal(3, model%n_node), source=0.0_wp)
    do f = 1, model%face%n
      associate (corner => model%face%corner(:, f), node => model%face%node(:, f))
        if (.not. shares_column(model%column(1, corner))) cycle
        associate (x => model%x0(:, corner))
          area = cross(x(:, 3) - x(:, 1), x(:, 4) - x(:, 2))
        end associate
        if (on_symmetry_plane(area, model%fixed(:, node))) cycle
        do i = 1, size(node)
          normal(:, node(i)) = normal(:, node(i)) - area
        end do
      end associate
    end do
    do i = 1, model%n_node
      normal(:, i) = normal(:, i)/max(norm2(normal(:, i)), tiny(1.0_wp))
    end do
    call move_alloc(normal, model%rim_normal)
  end subroutine set_rim

  !> Whether corners of a face lie over one another.
  pure logical function shares_column(bottom)
    !> Bottom nodes of the columns of the corners, in the order of the face.
    integer, intent(in) :: bottom(4)

    shares_column = any(bottom == cshift(bottom, 1))
  end function shares_column

  !> Whether a face is held in the direction of its normal, which is an axis.
  pure logical function on_symmetry_plane(area, fixed)
    !> Normal of any length.
    real(wp), intent(in) :: area(3)
    !> `(3, n)`.
    logical, intent(in) :: fixed(:, :)

    on_symmetry_plane = any(all(fixed, dim=2) .and. abs(area) > along_axis*norm2(area))
  end function on_symmetry_plane

  !> Return the draw-in of the nodes, `(n_node)`, mm; zero for a node that is not on the rim.
  pure function draw_in(model, x) result(value)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: value(:)

    value = sum((x - model%x0)*model%rim_normal, dim=1)
  end function draw_in

  !> Return the mean draw-in of the nodes of a set that lie on the rim, mm.
  pure real(wp) function mean_draw_in(model, x, node)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: node(:)

    integer :: i, n

    mean_draw_in = 0.0_wp
    n = 0
    do i = 1, size(node)
      associate (direction => model%rim_normal(:, node(i)))
        if (norm2(direction) <= 0.0_wp) cycle
        mean_draw_in = mean_draw_in + dot_product(direction, x(:, node(i)) - model%x0(:, node(i)))
      end associate
      n = n + 1
    end do
    mean_draw_in = mean_draw_in/real(max(1, n), wp)
  end function mean_draw_in

end module dd3_model_rim
