! SPDX-License-Identifier: GPL-3.0-or-later
!> External forces on the nodes: the loads of the input, each the total force on a node set, the
!> fading forces of lost constraints, and pressures on faces of the sheet. A pressure acts along the
!> inward normal of the deformed faces, integrated with the shape functions of the element; its
!> stiffness is unsymmetric.
!> Source of the pressures: Schweizerhof and Ramm, Comput. Struct. 18 (1984) 1099-1114.
module dd3_model_loads
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : cross
  use dd3_model_sheet_faces, only : face_area
  implicit none
  private
  public :: load_set_t, face_load_weights, nodal_forces, spring_stiffness
  public :: laying_factor, laying_rate
  public :: pressure_set_t, add_pressure_forces, face_force, face_stiffness

  !> Displacement at which the spring at a node of a free sheet carries its weight once more, in
  !> thicknesses of the sheet.
  real(wp), parameter :: spring_length = 0.25_wp
  !> Decades by which these forces fall over a phase before the rest is taken away, and that rest.
  real(wp), parameter :: decades = 6.0_wp, rest = 10.0_wp**(-decades)

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

  !> Return the stiffness of the spring at a node of a free sheet that is laid down, N/mm.
  pure real(wp) function spring_stiffness(force, thickness)
    !> Force that carries the node at the start, N.
    real(wp), intent(in) :: force(3)
    !> Of the sheet at the node, mm.
    real(wp), intent(in) :: thickness

    spring_stiffness = norm2(force)/(spring_length*thickness)
  end function spring_stiffness

  !> Return the fraction of the forces that lay a sheet down, and of their springs, that is left at a
  !> progress of the phase. It falls by the same factor in equal increments: the sheet is softer
  !> than the springs at first by four or more decades, and sags where they are alike.
  pure real(wp) function laying_factor(progress)
    real(wp), intent(in) :: progress

    laying_factor = (10.0_wp**(-decades*progress) - rest)/(1.0_wp - rest)
  end function laying_factor

  !> Return the negative derivative of `laying_factor`.
  pure real(wp) function laying_rate(progress)
    real(wp), intent(in) :: progress

    laying_rate = log(10.0_wp)*decades*10.0_wp**(-decades*progress)/(1.0_wp - rest)
  end function laying_rate

  !> Evaluate the external forces on the nodes.
  pure subroutine nodal_forces(set, load, fading, force)
    type(load_set_t), intent(in) :: set(:)
    !> Total force on each set, `(3, size(set))`, N.
    real(wp), intent(in) :: load(:, :)
    !> Forces of the nodes on lost constraints that are left, `(3, n_node)`, N.
    real(wp), intent(in) :: fading(:, :)
    !> Nodal forces, `(3, n_node)`, N.
    real(wp), intent(out) :: force(:, :)

    integer :: s, k

    force = -fading
    do s = 1, size(set)
      associate (node => set(s)%node)
        do k = 1, size(node)
          if (allocated(set(s)%weight)) then
            force(:, node(k)) = force(:, node(k)) + load(:, s)*set(s)%weight(k)
          else
            force(:, node(k)) = force(:, node(k)) + load(:, s)/real(size(node), wp)
          end if
        end do
      end associate
    end do
  end subroutine nodal_forces

  !> Add the nodal forces of the pressures.
  pure subroutine add_pressure_forces(element, set, pressure, x, force)
    type(element_t), intent(in) :: element
    type(pressure_set_t), intent(in) :: set(:)
    !> On each set, MPa.
    real(wp), intent(in) :: pressure(:)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> `(3, n_node)`, N.
    real(wp), intent(inout) :: force(:, :)

    integer :: s, f

    do s = 1, size(set)
      if (.not. abs(pressure(s)) > 0.0_wp) cycle
      do f = 1, size(set(s)%node, 2)
        associate (node => set(s)%node(:, f))
          force(:, node) = force(:, node) + pressure(s)*face_force(element, x(:, node))
        end associate
      end do
    end do
  end subroutine add_pressure_forces

  !> Return the nodal forces of a unit pressure on a face, mm2.
  pure function face_force(element, x) result(force)
    type(element_t), intent(in) :: element
    !> Nodes of the face, mm.
    real(wp), intent(in) :: x(3, element%n_face_node)
    real(wp) :: force(3, element%n_face_node)

    real(wp) :: along(3, 2), area(3)
    integer :: p, a

    force = 0.0_wp
    do p = 1, size(element%face_point_weight)
      along = matmul(x, element%face_slope(:, :, p))
      area = element%face_point_weight(p)*cross(along(:, 1), along(:, 2))
      do a = 1, element%n_face_node
        force(:, a) = force(:, a) - element%face_shape(a, p)*area
      end do
    end do
  end function face_force

  !> Return the derivatives of the nodal forces of a unit pressure in the positions of the nodes,
  !> mm: component of the force, of the position, node of the force, of the position.
  pure function face_stiffness(element, x) result(stiffness)
    type(element_t), intent(in) :: element
    !> Nodes of the face, mm.
    real(wp), intent(in) :: x(3, element%n_face_node)
    real(wp) :: stiffness(3, 3, element%n_face_node, element%n_face_node)

    real(wp) :: along(3, 2), unit(3)
    integer :: p, a, b, i

    stiffness = 0.0_wp
    do p = 1, size(element%face_point_weight)
      associate (slope => element%face_slope(:, :, p), weight => element%face_point_weight(p))
        along = matmul(x, slope)
        do b = 1, element%n_face_node
          do i = 1, 3
            unit = 0.0_wp
            unit(i) = weight
            unit = slope(b, 1)*cross(unit, along(:, 2)) + slope(b, 2)*cross(along(:, 1), unit)
            do a = 1, element%n_face_node
              stiffness(:, i, a, b) = stiffness(:, i, a, b) - element%face_shape(a, p)*unit
            end do
          end do
        end do
      end associate
    end do
  end function face_stiffness

end module dd3_model_loads
