! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact points of the sheet. In the mixed formulation they are the nodes of the contact faces; in
!> the compliant one each face is divided, and the corners of the parts are the points, those on an
!> edge common to its faces.
module dd3_model_contact_points
  use dd3_base_kinds, only : wp
  use dd3_sheet_surface_point, only : surface_point_t, crossing_point, edge_point, &
      face_point, node_point
  use dd3_model_contact_areas, only : point_areas
  use dd3_model_contact_data, only : all_faces, rim_faces, side_faces
  use dd3_model_model, only : model_t
  use dd3_model_part, only : of_points
  implicit none
  private
  public :: set_contact_points, set_point_owners, keep_own_points, points_of_face

  !> Length over the thickness beyond which an edge of the mesh has contact with borders of its own.
  !> The nodes of shorter ones follow the rounding of the border, whose radius is half a thickness.
  real(wp), parameter :: long_edge = 2.0_wp

  !> Points of a list, each once.
  type :: point_list_t
    integer :: n = 0
    type(surface_point_t), allocatable :: point(:)
    !> First point of each node as lower end of an edge, and the next one of the same node.
    integer, allocatable :: first(:), next(:)
    !> Elements of the points that move.
    integer, allocatable :: element(:)
  end type point_list_t

contains

  !> Set the contact faces, whose nodes are all candidates of the same tool, and the contact points
  !> with their areas, stiffnesses and tools.
  subroutine set_contact_points(model, divisions, crossings)
    !> Has the candidates of the tools.
    type(model_t), intent(inout) :: model
    !> Number of parts of an edge of a face with four nodes.
    integer, intent(in) :: divisions
    !> Whether edges of the mesh touch borders of tools; not by default.
    logical, intent(in), optional :: crossings

    type(point_list_t) :: list
    integer :: i, c, f, most

    model%contact_face = pack([(f, f=1, model%face%n)], &
        [(any(all(model%member(:, model%face%node(:, f)), dim=2)), f=1, model%face%n)])
    call set_touched_faces(model)
    most = model%n_node + max(4, (divisions - 1)*(divisions + 3))*size(model%contact_face)
    allocate (list%point(most))
    allocate (list%next(most), list%first(model%n_node), source=0)
    allocate (model%candidate_of(model%n_node), source=0)
    call set_opposites(model)
    do i = 1, model%n_node
      if (.not. any(model%member(:, i))) cycle
      call add_point(list, node_point(i))
      model%candidate_of(i) = list%n
    end do
    model%n_contact_node = list%n
    allocate (model%face_point(max((divisions + 1)**2, model%element%n_face_node), &
        size(model%contact_face)))
    do f = 1, size(model%contact_face)
      call add_face(list, model, model%contact_face(f), divisions, model%face_point(:, f))
    end do
    model%n_contact_fixed = list%n
    if (present(crossings)) then
      if (crossings .and. divisions == 1) call add_crossings(list, model)
    end if
    model%n_contact = list%n
    model%contact_point = list%point(:list%n)
    model%contact_node = model%contact_point%node(1)
    allocate (model%candidate(model%n_tool, list%n))
    do c = 1, list%n
      associate (point => model%contact_point(c))
        model%candidate(:, c) = all(model%member(:, point%node(:point%n_surface)), dim=2)
      end associate
    end do
    ! A point lies on the first of its faces.
    do f = size(model%contact_face), 1, -1
      associate (element => model%face%element(model%contact_face(f)))
        model%contact_point(model%face_point(:, f))%element = element
      end associate
    end do
    do c = model%n_contact_fixed + 1, model%n_contact
      model%contact_point(c)%element = list%element(c)
    end do
    call set_stiffness(model)
    call set_elements(model)
    model%n_candidate = count(model%candidate, dim=2)
    model%part%n_point = model%n_contact
    call set_point_owners(model)
  end subroutine set_contact_points

  !> Set which contact faces are of the rim of the sheet, those along its thickness, and the faces
  !> that each tool touches.
  pure subroutine set_touched_faces(model)
    type(model_t), intent(inout) :: model

    logical :: own(size(model%contact_face))
    integer :: f, t

    model%is_rim_face = [(is_along_thickness(model, model%contact_face(f)), &
        f=1, size(model%contact_face))]
    model%touched_faces = spread(side_faces, 1, model%n_tool)
    do t = 1, model%n_tool
      own = [(all(model%member(t, model%face%node(:, model%contact_face(f)))), &
          f=1, size(model%contact_face))]
      if (.not. any(own .and. model%is_rim_face)) cycle
      model%touched_faces(t) = merge(rim_faces, all_faces, all(model%is_rim_face .or. .not. own))
    end do
  end subroutine set_touched_faces

  !> Whether a face has both nodes of a pair through the thickness of its element.
  pure logical function is_along_thickness(model, f)
    type(model_t), intent(in) :: model
    integer, intent(in) :: f

    integer :: p

    is_along_thickness = .false.
    associate (node => model%face%node(:, f), element => model%face%element(f))
      do p = 1, model%element%n_pair
        associate (pair => model%connectivity(model%element%pair(:, p), element))
          is_along_thickness = is_along_thickness .or. any(node == pair(1)) .and. &
              any(node == pair(2))
        end associate
      end do
    end associate
  end function is_along_thickness

  !> Set the rank of each contact point: that of its node, whose row the mixed formulation needs, or
  !> for a point between nodes that of its element.
  subroutine set_point_owners(model)
    type(model_t), intent(inout) :: model

    integer :: c

    model%part%point_owner = [(merge(model%part%node_owner(model%contact_node(c)), &
        model%part%owner(model%contact_point(c)%element), c <= model%n_contact_node), &
        c=1, model%n_contact)]
  end subroutine set_point_owners

  !> Keep the contact points of this rank alone, and number them.
  subroutine keep_own_points(model)
    type(model_t), intent(inout) :: model

    integer, allocatable :: kept(:), number(:)
    integer :: c

    if (.not. model%part%divided) return
    kept = model%part%own(of_points)
    allocate (number(0:model%n_contact), source=0)
    number(kept) = [(c, c=1, size(kept))]
    model%contact_point = model%contact_point(kept)
    model%contact_node = model%contact_node(kept)
    model%candidate = model%candidate(:, kept)
    model%contact_stiffness = model%contact_stiffness(kept, :)
    model%contact_area = model%contact_area(kept, :)
    model%candidate_of = number(model%candidate_of)
    do c = 1, size(model%face_point, 2)
      model%face_point(:, c) = number(model%face_point(:, c))
    end do
    model%n_contact_node = count(kept <= model%n_contact_node)
    model%n_contact_fixed = count(kept <= model%n_contact_fixed)
    model%n_contact = size(kept)
  end subroutine keep_own_points

  !> Return the contact points of a face with four nodes, also those of another rank, row by row,
  !> mm.
  pure function points_of_face(model, x, k) result(points)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Number among the contact faces.
    integer, intent(in) :: k
    real(wp) :: points(3, size(model%face_point, 1))

    type(surface_point_t) :: point
    integer :: divisions, i, j

    divisions = nint(sqrt(real(size(model%face_point, 1), wp))) - 1
    associate (corner => model%face%corner(:, model%contact_face(k)))
      do j = 0, divisions
        do i = 0, divisions
          point = face_point(corner, model%opposite(corner), real(i, wp)/real(divisions, wp), &
              real(j, wp)/real(divisions, wp))
          points(:, 1 + i + (divisions + 1)*j) = point%position(x)
        end do
      end do
    end associate
  end function points_of_face

  !> Set the places of the nodes of each point in its element. A node that belongs to no face gets
  !> an element at it.
  subroutine set_elements(model)
    type(model_t), intent(inout) :: model

    integer :: at_node(model%n_node), c, e, i

    do e = 1, model%n_element
      at_node(model%connectivity(:, e)) = e
    end do
    do c = 1, model%n_contact
      associate (point => model%contact_point(c))
        if (point%element == 0) point%element = at_node(point%node(1))
        do i = 1, point%n_node
          point%local(i) = findloc(model%connectivity(:, point%element), point%node(i), dim=1)
        end do
      end associate
    end do
  end subroutine set_elements

  !> Add a point to the list.
  pure subroutine add_point(list, point)
    type(point_list_t), intent(inout) :: list
    type(surface_point_t), intent(in) :: point

    list%n = list%n + 1
    list%point(list%n) = point
  end subroutine add_point

  !> Add the points of a face that are not in the list yet.
  subroutine add_face(list, model, f, divisions, face_point_number)
    type(point_list_t), intent(inout) :: list
    type(model_t), intent(in) :: model
    integer, intent(in) :: f, divisions
    !> Numbers of the points.
    integer, intent(out) :: face_point_number(:)

    integer :: i, j, number(0:divisions, 0:divisions)

    associate (corner => model%face%corner(:, f), node => model%face%node(:, f))
      if (size(node) > 4) then
        face_point_number = model%candidate_of(node)
        return
      end if
      number(0, 0) = model%candidate_of(corner(1))
      number(divisions, 0) = model%candidate_of(corner(2))
      number(divisions, divisions) = model%candidate_of(corner(3))
      number(0, divisions) = model%candidate_of(corner(4))
      if (divisions > 1) then
        call add_edge(1, 2, number(1:divisions - 1, 0))
        call add_edge(2, 3, number(divisions, 1:divisions - 1))
        call add_edge(4, 3, number(1:divisions - 1, divisions))
        call add_edge(1, 4, number(0, 1:divisions - 1))
        do j = 1, divisions - 1
          do i = 1, divisions - 1
            call add_point(list, face_point(corner, model%opposite(corner), place_on_edge(i), &
                place_on_edge(j)))
            number(i, j) = list%n
          end do
        end do
      end if
      face_point_number = reshape(number, [size(number)])
    end associate

  contains

    !> Return the place of a point on an edge.
    pure real(wp) function place_on_edge(i)
      integer, intent(in) :: i

      place_on_edge = real(i, wp)/real(divisions, wp)
    end function place_on_edge

    !> Add the inner points of an edge, or find those of another face.
    subroutine add_edge(a, b, number)
      !> Corners at its ends.
      integer, intent(in) :: a, b
      !> Numbers of the points from a to b.
      integer, intent(out) :: number(:)

      integer :: low, high, p, i

      associate (corner => model%face%corner(:, f))
        low = merge(a, b, corner(a) < corner(b))
        high = a + b - low
        p = list%first(corner(low))
        do while (p > 0)
          if (list%point(p)%node(2) == corner(high)) exit
          p = list%next(p)
        end do
        if (p == 0) then
          do i = 1, size(number)
            call add_point(list, edge_point(corner([low, high]), &
                model%opposite(corner([low, high])), place_on_edge(i)))
            if (i == 1) p = list%n
          end do
          list%next(p) = list%first(corner(low))
          list%first(corner(low)) = p
        end if
        number = [(p + i - 1, i=1, size(number))]
        if (low == b) number = number(size(number):1:-1)
      end associate
    end subroutine add_edge

  end subroutine add_face

  !> Add the long edges of the contact faces, which may cross the border of a tool.
  subroutine add_crossings(list, model)
    type(point_list_t), intent(inout) :: list
    type(model_t), intent(in) :: model

    integer, parameter :: next(4) = [2, 3, 4, 1]
    integer :: f, i, p, ends(2)

    allocate (list%element(size(list%point)), source=0)
    if (size(model%face%node, 1) > 4) return
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)))
        do i = 1, 4
          ends = [min(corner(i), corner(next(i))), max(corner(i), corner(next(i)))]
          p = list%first(ends(1))
          do while (p > 0)
            if (list%point(p)%node(2) == ends(2)) exit
            p = list%next(p)
          end do
          if (p > 0) cycle
          if (norm2(model%x0(:, ends(2)) - model%x0(:, ends(1))) &
              <= long_edge*model%thickness_at(ends(1))) cycle
          call add_point(list, crossing_point(ends))
          list%element(list%n) = model%face%element(model%contact_face(f))
          list%next(list%n) = list%first(ends(1))
          list%first(ends(1)) = list%n
        end do
      end associate
    end do
  end subroutine add_crossings

  !> Set the nodes opposite to those of the contact faces, across their elements.
  subroutine set_opposites(model)
    type(model_t), intent(inout) :: model

    real(wp) :: distance(model%element%n_node)
    integer :: f, i, k

    allocate (model%opposite(model%n_node), source=0)
    if (model%element%n_node /= 8) return
    do f = 1, size(model%contact_face)
      associate (corner => model%face%corner(:, model%contact_face(f)), &
          node => model%connectivity(:, model%face%element(model%contact_face(f))), &
          place => model%element%node)
        do i = 1, 4
          k = findloc(node, corner(i), dim=1)
          distance = sum(abs(place - spread(place(:, k), 2, 8)), dim=1)
          model%opposite(corner(i)) = node(minloc(distance, dim=1, &
              mask=[(all(node(k) /= corner), k=1, 8)]))
        end do
      end associate
    end do
  end subroutine set_opposites

  !> Set the area A of each point and the stiffness E A/t of the sheet through its thickness, with
  !> the thickness there, and Young's modulus of the element. A node that belongs to no face gets
  !> the mean area, and the modulus of an element that has it.
  subroutine set_stiffness(model)
    type(model_t), intent(inout) :: model

    real(wp) :: area(model%n_contact), mean
    integer :: element(model%n_contact), at_node(model%n_node), c, e, kind

    do e = 1, model%n_element
      at_node(model%connectivity(:, e)) = e
    end do
    element = [(model%contact_point(c)%element, c=1, model%n_contact)]
    where (element == 0) element = at_node(model%contact_node(:model%n_contact))
    model%contact_area = spread(spread(0.0_wp, 1, model%n_contact), 2, all_faces)
    model%contact_stiffness = model%contact_area
    do kind = side_faces, all_faces
      area = point_areas(model, model%x0, kind)
      mean = model%thickness**2
      if (any(area > 0.0_wp)) mean = sum(area)/real(count(area > 0.0_wp), wp)
      model%contact_area(:, kind) = merge(area, mean, area > 0.0_wp)
      model%contact_stiffness(:, kind) = [(model%material(model%material_of(element(c)))%young &
          *model%contact_area(c, kind)/model%thickness_at(model%contact_node(c)), &
          c=1, model%n_contact)]
    end do
  end subroutine set_stiffness

end module dd3_model_contact_points
