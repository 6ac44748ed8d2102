!> Pressure on faces of the sheet. It acts along the inward normal of the deformed faces, integrated
!> with the shape functions of the element; its stiffness is unsymmetric.
!> Source: Schweizerhof and Ramm, Comput. Struct. 18 (1984) 1099-1114.
module dd3_model_pressures
  use dd3_base_kinds, only : wp
  use dd3_element_table, only : element_t
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: pressure_set_t, add_pressure_forces, face_force, face_stiffness

  !> Set of faces that carries a pressure in some phase.
  type :: pressure_set_t
    character(len=:), allocatable :: name
    !> Nodes of the faces in the order of the element's table, `(n_face_node, n)`.
    integer, allocatable :: node(:, :)
  end type pressure_set_t

contains

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

end module dd3_model_pressures
