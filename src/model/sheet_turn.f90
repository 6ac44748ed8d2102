! SPDX-License-Identifier: GPL-3.0-or-later
!> Angles by which the sheet turns over the length of an element: those by which it is turned, and
!> those of the tools that it can meet in the next part of the travel.
!>
!> In the frame of a tool, a place of the sheet moves by at most the travel s of the tools and
!> slides by c s at right angles, so that it stays within s sqrt(1 + c^2). The largest turn of the
!> tool's normal within this distance of an element is the one that it may have to follow; where the
!> tool is curved in two directions to the same side it is the sum of both (turn_field.f90).
module dd3_model_sheet_turn
  use dd3_base_kinds, only : wp
  use dd3_base_ranks, only : largest_over_ranks, this_rank
  use dd3_base_threads, only : least_nodes, threads_for
  use dd3_linalg_tensor, only : cross
  use dd3_model_configuration, only : configuration_t
  use dd3_model_element_columns, only : element_columns_t, n_corner, new_element_columns
  use dd3_model_mesh_data, only : mesh_data_t
  use dd3_model_model, only : model_t
  use dd3_model_sheet_faces, only : face_normal
  use dd3_tools_placement, only : placement_t
  use dd3_tools_turn_field, only : turn_field_t, turn_over
  use dd3_tools_vector_tree, only : facing_t
  implicit none
  private
  public :: turn_of_sheet, turn_of_tools_ahead

  !> Sliding c over the travel of the tools.
  real(wp), parameter :: sliding = 0.5_wp
  !> Places of an element from which tools are looked for: a grid with so many parts of an edge, of
  !> which one is within half a diagonal of a part from each point of the element.
  integer, parameter :: n_part = 4
  !> Ratio of the edges up to which both directions have one length.
  real(wp), parameter :: square = 1.1_wp
  !> Faces that a thread takes at a time.
  integer, parameter :: chunk = 32

contains

  !> Find the largest angle by which the sheet is turned over each element: between the directions
  !> of the columns at the ends of an edge, and between the normals of neighbouring elements. All
  !> elements of a column have the same one.
  pure subroutine turn_of_sheet(mesh, x, turn)
    class(mesh_data_t), intent(in) :: mesh
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(n_element)`, rad.
    real(wp), intent(out) :: turn(:)

    type(element_columns_t) :: quad
    real(wp), allocatable :: normal(:, :), of_quad(:)
    integer :: k, i

    call new_element_columns(quad, mesh)
    allocate (normal(3, quad%n), of_quad(quad%n))
    do k = 1, quad%n
      associate (bottom => quad%corner(:, k))
        normal(:, k) = face_normal(0.5_wp*(x(:, bottom) + x(:, mesh%column(2, bottom))))
      end associate
    end do
    do k = 1, quad%n
      associate (bottom => quad%corner(:, k), across => quad%neighbour(:, k))
        of_quad(k) = largest_angle(x(:, mesh%column(2, bottom)) - x(:, bottom))
        do i = 1, n_corner
          if (across(i) == 0) cycle
          of_quad(k) = max(of_quad(k), angle_between(normal(:, k), normal(:, across(i))))
        end do
      end associate
    end do
    turn = of_quad(quad%of_element)
  end subroutine turn_of_sheet

  !> Return the largest angle between the directions of neighbouring columns, rad.
  pure real(wp) function largest_angle(column) result(angle)
    !> From bottom to top, `(3, 4)`.
    real(wp), intent(in) :: column(3, n_corner)

    integer :: i

    angle = maxval([(angle_between(column(:, i), column(:, modulo(i, n_corner) + 1)), &
        i=1, n_corner)])
  end function largest_angle

  !> Return the angle between two vectors, rad.
  pure real(wp) function angle_between(a, b) result(angle)
    real(wp), intent(in) :: a(3), b(3)

    angle = 0.0_wp
    if (norm2(a) > 0.0_wp .and. norm2(b) > 0.0_wp) then
      angle = atan2(norm2(cross(a, b)), dot_product(a, b))
    end if
  end function angle_between

  !> Find the largest angle by which the tools that each of some elements can meet on either face
  !> turn over its length, until they have moved on. All elements of a column have the same one. Of
  !> several ranks each looks from its elements.
  subroutine turn_of_tools_ahead(model, state, field, wanted, ahead, rotation, turn)
    type(model_t), intent(in) :: model
    class(configuration_t), intent(in) :: state
    !> Of the tools, `(n_tool)`.
    type(turn_field_t), intent(in) :: field(:)
    !> Whether an element is looked at, `(n_element)`.
    logical, intent(in) :: wanted(:)
    !> Travel of the tools over the length of each element.
    real(wp), intent(in) :: ahead
    !> Angle by which the sheet can rotate meanwhile, rad: what of a tool has other normals counts
    !> later.
    real(wp), intent(in) :: rotation
    !> `(n_element)`, rad; 0 for the others.
    real(wp), intent(out) :: turn(:)

    type(element_columns_t) :: quad
    real(wp), allocatable :: of_quad(:)
    real(wp) :: of_face(size(model%contact_face))
    integer :: f, tool, rank

    rank = this_rank()
    call new_element_columns(quad, model)
    allocate (of_quad(quad%n), source=0.0_wp)
    of_face = 0.0_wp
    do tool = 1, model%n_tool
      if (.not. model%phase(state%phase)%acts(tool)) cycle
      !$omp parallel do num_threads(threads_for(size(of_face), least_nodes)) &
      !$omp& schedule(dynamic, chunk)
      do f = 1, size(of_face)
        associate (face => model%contact_face(f))
          if (.not. wanted(model%face%element(face))) cycle
          if (.not. all(model%member(tool, model%face%node(:, face)))) cycle
          if (model%part%divided) then
            if (model%part%owner(model%face%element(face)) /= rank) cycle
          end if
          call raise_turn(of_face(f), field(tool), state%placement(tool), &
              state%x(:, model%face%corner(:, face)), ahead*sqrt(1.0_wp + sliding**2), rotation)
        end associate
      end do
      !$omp end parallel do
    end do
    do f = 1, size(of_face)
      associate (largest => of_quad(quad%of_element(model%face%element(model%contact_face(f)))))
        largest = max(largest, of_face(f))
      end associate
    end do
    call largest_over_ranks(size(of_quad), of_quad)
    turn = merge(of_quad(quad%of_element), 0.0_wp, wanted)
  end subroutine turn_of_tools_ahead

  !> Raise the largest turn of an element to that of a tool within a distance.
  pure subroutine raise_turn(largest, field, placement, x, relative_distance, rotation)
    real(wp), intent(inout) :: largest
    type(turn_field_t), intent(in) :: field
    type(placement_t), intent(in) :: placement
    !> Corners of the face, mm, and the distance from it over its longer edge.
    real(wp), intent(in) :: x(3, n_corner), relative_distance
    !> Angle from the opposite of its normal within which those of the tool count, rad.
    real(wp), intent(in) :: rotation

    type(facing_t) :: facing
    real(wp) :: corner(3, n_corner), centre(3), diagonal, length(2), frame(3, 3), distance, reach
    integer :: i, j

    do i = 1, n_corner
      corner(:, i) = placement%to_tool(x(:, i))
    end do
    centre = 0.25_wp*sum(corner, dim=2)
    diagonal = max(norm2(corner(:, 3) - corner(:, 1)), norm2(corner(:, 4) - corner(:, 2)))
    call measure(corner, length, frame)
    distance = relative_distance*maxval(length)
    ! Most elements have nothing near, and no more than a neighbour: one search from the centre.
    facing = facing_t(-face_normal(corner), cos(rotation))
    if (turn_over(field, centre, distance + 0.5_wp*diagonal, maxval(length), &
        facing) <= largest) return
    reach = distance + 0.5_wp*diagonal/real(n_part, wp)
    do j = 0, n_part
      do i = 0, n_part
        associate (place => matmul(corner, shape_at(real([i, j], wp)/real(n_part, wp))))
          if (maxval(length) <= square*minval(length)) then
            largest = max(largest, turn_over(field, place, reach, 0.5_wp*sum(length), facing))
          else
            largest = max(largest, turn_over(field, place, reach, minval(length), facing), &
                turn_over(field, place, reach, maxval(length), facing, frame))
          end if
        end associate
      end do
    end do
  end subroutine raise_turn

  !> Return the bilinear shape functions of the corners of a face.
  pure function shape_at(place) result(shape)
    !> 0 to 1.
    real(wp), intent(in) :: place(2)
    real(wp) :: shape(n_corner)

    associate (u => place(1), v => place(2))
      shape = [(1.0_wp - u)*(1.0_wp - v), u*(1.0_wp - v), u*v, (1.0_wp - u)*v]
    end associate
  end function shape_at

  !> Measure the mean edges of a face.
  pure subroutine measure(corner, length, frame)
    !> mm.
    real(wp), intent(in) :: corner(3, n_corner)
    !> Their lengths, mm.
    real(wp), intent(out) :: length(2)
    !> Vectors of which 1/max(|e.g_1|, |e.g_2|) is the length of the face along e over the longer
    !> edge, and the unit normal.
    real(wp), intent(out) :: frame(3, 3)

    real(wp) :: edge(3, 2), normal(3), area

    edge(:, 1) = 0.5_wp*(corner(:, 2) - corner(:, 1) + corner(:, 3) - corner(:, 4))
    edge(:, 2) = 0.5_wp*(corner(:, 4) - corner(:, 1) + corner(:, 3) - corner(:, 2))
    length = norm2(edge, dim=1)
    normal = cross(edge(:, 1), edge(:, 2))
    area = max(norm2(normal), tiny(1.0_wp))
    normal = normal/area
    frame(:, 1) = maxval(length)/area*cross(edge(:, 2), normal)
    frame(:, 2) = maxval(length)/area*cross(normal, edge(:, 1))
    frame(:, 3) = normal
  end subroutine measure

end module dd3_model_sheet_turn
