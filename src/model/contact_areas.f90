! SPDX-License-Identifier: GPL-3.0-or-later
!> Areas of the contact points of the sheet: the integral of the hat function of the part of a face
!> at the point, so that a uniform pressure gives the consistent forces on the nodes.
module dd3_model_contact_areas
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : sum_over_ranks
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: contact_areas, nodal_areas, point_areas

contains

  !> Return the integrals of the hat functions of the parts of a face, mm2, row by row, exact for a
  !> plane face.
  pure function areas_of_parts(divisions, x) result(area)
    integer, intent(in) :: divisions
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: area((divisions + 1)**2)

    real(wp) :: jacobian(0:divisions, 0:divisions), grid(0:divisions, 0:divisions)
    integer :: i, j

    jacobian = jacobians(divisions, x)
    grid = 0.0_wp
    do j = 0, divisions - 1
      do i = 0, divisions - 1
        call add_part(jacobian(i:i + 1, j:j + 1), grid(i:i + 1, j:j + 1))
      end do
    end do
    area = reshape(grid, [size(grid)])

  contains

    pure subroutine add_part(jacobian, area)
      real(wp), intent(in) :: jacobian(2, 2)
      real(wp), intent(inout) :: area(2, 2)

      integer :: a, b

      do b = 1, 2
        do a = 1, 2
          area(a, b) = area(a, b) + (4.0_wp*jacobian(a, b) + 2.0_wp*jacobian(3 - a, b) &
              + 2.0_wp*jacobian(a, 3 - b) + jacobian(3 - a, 3 - b)) &
              /(36.0_wp*real(divisions, wp)**2)
        end do
      end do
    end subroutine add_part

  end function areas_of_parts

  !> Return the ratio of area to that of the unit square on a grid of points of a face, mm2.
  pure function jacobians(divisions, x) result(jacobian)
    integer, intent(in) :: divisions
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: jacobian(0:divisions, 0:divisions)

    real(wp) :: xi, eta
    integer :: i, j

    do j = 0, divisions
      eta = real(j, wp)/real(divisions, wp)
      do i = 0, divisions
        xi = real(i, wp)/real(divisions, wp)
        jacobian(i, j) = norm2(cross( &
            (1.0_wp - eta)*(x(:, 2) - x(:, 1)) + eta*(x(:, 3) - x(:, 4)), &
            (1.0_wp - xi)*(x(:, 4) - x(:, 1)) + xi*(x(:, 3) - x(:, 2))))
      end do
    end do
  end function jacobians

  !> Return the areas of the contact points of this rank for the tools that touch a kind of faces,
  !> `(n_contact)`, mm2: over these faces, or over the others at a point without one; zero for a
  !> node without contact faces.
  pure function point_areas(model, x, kind) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kind
    real(wp), allocatable :: area(:)

    logical :: chosen(size(model%contact_face))

    chosen = model%faces_of_kind(kind)
    area = areas_over(model, x, chosen)
    if (any(.not. chosen)) area = merge(area, areas_over(model, x, .not. chosen), area > 0.0_wp)
  end function point_areas

  !> Return the areas of the contact points of this rank over some contact faces, `(n_contact)`,
  !> mm2.
  pure function areas_over(model, x, chosen) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    logical, intent(in) :: chosen(:)
    real(wp) :: area(model%n_contact)

    real(wp) :: of_face(size(model%face_point, 1))
    integer :: f, i, divisions

    area = 0.0_wp
    divisions = nint(sqrt(real(size(model%face_point, 1), wp))) - 1
    do f = 1, size(model%contact_face)
      if (.not. chosen(f) .or. all(model%face_point(:, f) == 0)) cycle
      of_face = areas_of_face(model, x, f, divisions)
      do i = 1, size(of_face)
        associate (point => model%face_point(i, f))
          if (point > 0) area(point) = area(point) + of_face(i)
        end associate
      end do
    end do
  end function areas_over

  !> Return the areas over which the forces of the contact points of this rank act by the tools that
  !> touch a kind of faces, `(n_contact)`, mm2: a point without contact faces has the mean area.
  function contact_areas(model, x, kind) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kind
    real(wp), allocatable :: area(:)

    real(wp) :: sums(2)

    area = point_areas(model, x, kind)
    sums = [sum(area), real(count(area > 0.0_wp), wp)]
    call sum_over_ranks(2, sums)
    if (sums(2) < 1.0_wp) sums = [model%thickness**2, 1.0_wp]
    where (.not. area > 0.0_wp) area = sums(1)/sums(2)
  end function contact_areas

  !> Return the areas of a kind of contact faces that belong to their nodes, `(n_node)`, mm2.
  pure function nodal_areas(model, x, kind) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kind
    real(wp), allocatable :: area(:)

    logical :: chosen(size(model%contact_face))
    integer :: f

    allocate (area(model%n_node), source=0.0_wp)
    chosen = model%faces_of_kind(kind)
    do f = 1, size(model%contact_face)
      if (.not. chosen(f)) cycle
      associate (node => model%face%node(:, model%contact_face(f)))
        if (size(node) > 4) then
          area(node) = area(node) + areas_of_face(model, x, f, 1)
        else
          area(node([1, 2, 4, 3])) = area(node([1, 2, 4, 3])) + areas_of_face(model, x, f, 1)
        end if
      end associate
    end do
  end function nodal_areas

  !> Return the areas of the points of a contact face, in the order of `face_point`, mm2: those of a
  !> face with eight or nine nodes are their weights, times the Jacobian there.
  pure function areas_of_face(model, x, f, divisions) result(area)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Number among the contact faces.
    integer, intent(in) :: f
    !> Number of parts of an edge of a face with four nodes.
    integer, intent(in) :: divisions
    real(wp), allocatable :: area(:)

    integer, parameter :: column(9) = [0, 2, 2, 0, 1, 2, 1, 0, 1]
    integer, parameter :: row(9) = [0, 0, 2, 2, 0, 1, 2, 1, 1]
    real(wp) :: jacobian(0:2, 0:2)
    integer :: i

    associate (corner => x(:, model%face%corner(:, model%contact_face(f))))
      if (model%element%n_face_node > 4) then
        jacobian = jacobians(2, corner)
        area = model%element%face_weight &
            *[(jacobian(column(i), row(i)), i=1, model%element%n_face_node)]
      else
        area = areas_of_parts(divisions, corner)
      end if
    end associate
  end function areas_of_face

end module dd3_model_contact_areas
