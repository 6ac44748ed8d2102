! SPDX-License-Identifier: GPL-3.0-or-later
!> Sets of nodes that carry a load in some phase, and sets of faces that carry a pressure.
module dd3_model_terms_load_sets
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_model_sheet_faces, only : face_area
  implicit none
  private
  public :: load_set_t, pressure_set_t, phase_loads_t, phase_pressures_t, face_load_weights

  !> Node set that carries a load in some phase.
  type :: load_set_t
    character(len=:), allocatable :: name
    integer, allocatable :: node(:)
    !> Fraction of the load on each node; not allocated for equal fractions.
    real(wp), allocatable :: weight(:)
    !> Factor from the value of the input to the total force: 1, or the mass for a weight, t.
    real(wp) :: scale = 1.0_wp
  end type load_set_t

  !> Set of faces that carries a pressure in some phase.
  type :: pressure_set_t
    character(len=:), allocatable :: name
    !> Nodes of the faces in the order of the element's table, `(n_face_node, n)`.
    integer, allocatable :: node(:, :)
  end type pressure_set_t

  !> Loads in a phase.
  type :: phase_loads_t
    !> Total forces on the sets at the end of the phase, `(3, n_load)`, N; without meaning for those
    !> whose load the phase leaves unchanged, `(n_load)`.
    real(wp), allocatable :: final(:, :)
    logical, allocatable :: keeps(:)
  end type phase_loads_t

  !> Pressures in a phase.
  type :: phase_pressures_t
    !> Pressures at the end of the phase, `(n_pressure)`, MPa; without meaning for those that the
    !> phase leaves unchanged, `(n_pressure)`.
    real(wp), allocatable :: final(:)
    logical, allocatable :: keeps(:)
  end type phase_pressures_t

contains

  !> Evaluate the fractions of a uniform load on the faces with all nodes in a set: face area times
  !> the element's face weights. They are not allocated, for equal fractions, if the face weights
  !> are equal, or if the set is not a surface: it contains all nodes of an element, or a node
  !> outside these faces.
  pure subroutine face_load_weights(element, connectivity, x, node, weight)
    type(element_t), intent(in) :: element
    !> `(element%n_node, n_element)`.
    integer, intent(in) :: connectivity(:, :)
    !> Coordinates, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> Nodes of the set.
    integer, intent(in) :: node(:)
    !> Fractions, `(size(node))`, with the sum 1.
    real(wp), allocatable, intent(out) :: weight(:)

    real(wp) :: force(size(x, 2))
    logical :: member(size(x, 2)), on_face(size(x, 2))
    integer :: e, f

    if (all(abs(element%face_weight - element%face_weight(1)) < epsilon(1.0_wp))) return
    member = .false.
    member(node) = .true.
    on_face = .false.
    force = 0.0_wp
    do e = 1, size(connectivity, 2)
      if (all(member(connectivity(:, e)))) return
      do f = 1, element%n_face
        associate (face => connectivity(element%face(:, f), e))
          if (.not. all(member(face))) cycle
          on_face(face) = .true.
          force(face) = force(face) + face_area(x(:, face(:4)))*element%face_weight
        end associate
      end do
    end do
    if (all(on_face(node))) weight = force(node)/sum(force(node))
  end subroutine face_load_weights

end module dd3_model_terms_load_sets
