!> Outward normals of the sheet at the contact candidates. A tool touches the sheet where their
!> normals are opposite; this tells the side of the tool's surface on which a candidate belongs.
module dd3_model_outward_normals
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: find_contact_faces, outward_normals

contains

  !> Find the faces of the sheet whose nodes are all candidates of the same tool.
  subroutine find_contact_faces(model)
    type(model_t), intent(inout) :: model

    logical, allocatable :: touches(:)
    integer :: f

    allocate (touches(model%face%n), source=.false.)
    do f = 1, model%face%n
      associate (candidate => model%candidate_of(model%face%node(:, f)))
        if (all(candidate > 0)) touches(f) = any(all(model%candidate(:, candidate), dim=2))
      end associate
    end do
    model%contact_face = pack([(f, f=1, model%face%n)], touches)
  end subroutine find_contact_faces

  !> Return the outward unit normals at the candidates, `(3, n_contact)`: the mean over the contact
  !> faces at a node, by area; zero for a candidate without faces.
  pure function outward_normals(model, x) result(normal)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: normal(:, :)

    real(wp) :: area(3), length
    integer :: f, i, c

    allocate (normal(3, model%n_contact), source=0.0_wp)
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)), &
          node => model%face%node(:, model%contact_face(f)))
        area = cross(x(:, corner(3)) - x(:, corner(1)), x(:, corner(4)) - x(:, corner(2)))
        do i = 1, size(node)
          c = model%candidate_of(node(i))
          normal(:, c) = normal(:, c) + area
        end do
      end associate
    end do
    do c = 1, model%n_contact
      length = norm2(normal(:, c))
      if (length > 0.0_wp) normal(:, c) = normal(:, c)/length
    end do
  end function outward_normals

end module dd3_model_outward_normals
