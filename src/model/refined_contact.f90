! SPDX-License-Identifier: GPL-3.0-or-later
!> State of the contact on a refined sheet: a new contact point takes pressure and friction stress,
!> the tool, the status, the slip path and the closest points of the old points around it on the
!> same face. Those of edges that cross the border of a tool are kept where the edge is the same.
module dd3_model_refined_contact
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : status_gap
  use dd3_model_configuration, only : configuration_t, no_offset
  use dd3_model_contact_state, only : new_contact_state
  use dd3_model_model, only : model_t
  use dd3_sheet_location, only : corner_sign
  use dd3_sheet_refinement, only : refinement_t
  implicit none
  private
  public :: carry_contact

  !> Face of the sheet whose contact points are a grid.
  type :: face_grid_t
    !> Position in `contact_face`; 0 for none.
    integer :: face = 0
    !> In the natural plane of the element: first corner, and edges to the second and the last.
    real(wp) :: origin(2) = 0.0_wp, edge(2, 2) = 0.0_wp
  end type face_grid_t

contains

  !> Set the state of the contact points.
  subroutine carry_contact(old_model, old, model, origin, new)
    type(model_t), intent(in) :: old_model
    class(configuration_t), intent(in) :: old
    !> On the refined sheet.
    type(model_t), intent(in) :: model
    type(refinement_t), intent(in) :: origin
    !> Gets its contact, and what the phase has fixed at the points at its start.
    class(configuration_t), intent(inout) :: new

    type(face_grid_t) :: old_grid(2, old_model%n_element), grid
    integer :: f, g, i, n

    call new_contact_state(new%contact, model%n_tool, model%n_contact)
    if (allocated(new%start%held_offset)) deallocate (new%start%held_offset)
    allocate (new%start%held_offset(model%n_contact), source=no_offset)
    do f = 1, size(old_model%contact_face)
      grid = grid_of(old_model, f)
      old_grid(side_of(old_model, f), old_model%face%element(old_model%contact_face(f))) = grid
    end do
    n = nint(sqrt(real(size(model%face_point, 1), wp)))
    do f = 1, size(model%contact_face)
      associate (e => model%face%element(model%contact_face(f)))
        g = old_grid(side_of(model, f), origin%element(e))%face
        if (g == 0) cycle
        grid = grid_of(model, f)
        do i = 1, size(model%face_point, 1)
          call carry_point(model%face_point(i, f), natural_at(grid, place_in_grid(i, n), &
              origin%quadrant(e)), old_grid(side_of(model, f), origin%element(e)))
        end do
      end associate
    end do
    call carry_crossings(old_model, old, model, new)

  contains

    !> Set the state of a point from the points around a place on an old face.
    subroutine carry_point(c, natural, from)
      integer, intent(in) :: c
      !> In the old element.
      real(wp), intent(in) :: natural(2)
      type(face_grid_t), intent(in) :: from

      real(wp) :: place(2), weight(4), stress(3), nearest_weight
      integer :: corner(4), nearest, k, low(2)

      place = real(n - 1, wp)*matmul(natural - from%origin, from%edge) &
          /sum(from%edge**2, dim=1)
      low = max(0, min(n - 2, floor(place)))
      place = min(1.0_wp, max(0.0_wp, place - real(low, wp)))
      weight = [(1.0_wp - place(1))*(1.0_wp - place(2)), place(1)*(1.0_wp - place(2)), &
          (1.0_wp - place(1))*place(2), place(1)*place(2)]
      corner = old_model%face_point(1 + low(1) + n*low(2) + [0, 1, n, n + 1], from%face)
      nearest_weight = 0.0_wp
      nearest = 0
      do k = 1, 4
        if (weight(k) <= nearest_weight .or. corner(k) == 0) cycle
        nearest_weight = weight(k)
        nearest = corner(k)
      end do
      if (nearest == 0) return
      associate (to => new%contact, before => old%contact)
        to%tool(c) = before%tool(nearest)
        to%status(c) = before%status(nearest)
        to%hint(:, c) = before%hint(:, nearest)
        to%slip_path(c) = before%slip_path(nearest)
        to%slip_speed(c) = before%slip_speed(nearest)
        new%start%held_offset(c) = old%start%held_offset(nearest)
        if (to%status(c) == status_gap) return
        stress = 0.0_wp
        do k = 1, 4
          if (corner(k) == 0) cycle
          if (before%tool(corner(k)) /= to%tool(c)) cycle
          stress = stress + weight(k)*before%lambda(:, corner(k)) &
              /old_model%contact_stiffness(corner(k), model%touched_faces(to%tool(c)))
        end do
        to%lambda(:, c) = model%contact_stiffness(c, model%touched_faces(to%tool(c)))*stress
      end associate
    end subroutine carry_point

  end subroutine carry_contact

  !> Return the side of a contact face: 1 for the lower, 2 for the upper face of the sheet.
  pure integer function side_of(model, f) result(side)
    type(model_t), intent(in) :: model
    !> Position in `contact_face`.
    integer, intent(in) :: f

    associate (corner => model%face%corner(1, model%contact_face(f)))
      side = merge(1, 2, model%column(1, corner) == corner)
    end associate
  end function side_of

  !> Return the grid of the contact points of a face.
  pure type(face_grid_t) function grid_of(model, f) result(grid)
    type(model_t), intent(in) :: model
    !> Position in `contact_face`.
    integer, intent(in) :: f

    real(wp) :: natural(2, 4)
    integer :: i

    associate (face => model%contact_face(f))
      associate (node => model%connectivity(:, model%face%element(face)))
        do i = 1, 4
          natural(:, i) = model%element%node(:2, findloc(node, model%face%corner(i, face), dim=1))
        end do
      end associate
    end associate
    grid = face_grid_t(f, natural(:, 1), reshape([natural(:, 2) - natural(:, 1), natural(:, 4) &
        - natural(:, 1)], [2, 2]))
  end function grid_of

  !> Return the place of a point in a grid, 0 to 1.
  pure function place_in_grid(i, n) result(place)
    !> Number of the point, row by row, and of the points in a row.
    integer, intent(in) :: i, n
    real(wp) :: place(2)

    place = real([modulo(i - 1, n), (i - 1)/n], wp)/real(n - 1, wp)
  end function place_in_grid

  !> Return the natural coordinates of a place on a face in the old element.
  pure function natural_at(grid, place, quadrant) result(natural)
    type(face_grid_t), intent(in) :: grid
    !> 0 to 1.
    real(wp), intent(in) :: place(2)
    !> Of the old element; 0 for the whole.
    integer, intent(in) :: quadrant
    real(wp) :: natural(2)

    natural = grid%origin + matmul(grid%edge, place)
    if (quadrant > 0) natural = 0.5_wp*(corner_sign(:, quadrant) + natural)
  end function natural_at

  !> Carry the state of the edges that may cross borders of tools.
  subroutine carry_crossings(old_model, old, model, new)
    type(model_t), intent(in) :: old_model, model
    class(configuration_t), intent(in) :: old
    class(configuration_t), intent(inout) :: new

    integer :: first(model%n_node), next(old_model%n_contact), b, c

    first = 0
    do b = old_model%n_contact_fixed + 1, old_model%n_contact
      next(b) = first(old_model%contact_node(b))
      first(old_model%contact_node(b)) = b
    end do
    do c = model%n_contact_fixed + 1, model%n_contact
      b = first(model%contact_node(c))
      do while (b > 0)
        if (old_model%contact_point(b)%node(2) == model%contact_point(c)%node(2)) exit
        b = next(b)
      end do
      if (b == 0) cycle
      associate (to => new%contact, from => old%contact)
        to%tool(c) = from%tool(b)
        to%status(c) = from%status(b)
        to%hint(:, c) = from%hint(:, b)
        to%place(c) = from%place(b)
        to%slip_path(c) = from%slip_path(b)
        to%slip_speed(c) = from%slip_speed(b)
        to%lambda(:, c) = from%lambda(:, b)
      end associate
    end do
  end subroutine carry_crossings

end module dd3_model_refined_contact
