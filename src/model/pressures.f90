!> Pressure on faces of the sheet. It acts along the inward normal of the deformed faces, bilinear
!> quadrilaterals integrated by 2 x 2 Gauss points; its stiffness is unsymmetric.
!> Source: Schweizerhof and Ramm, Comput. Struct. 18 (1984) 1099-1114.
module dd3_model_pressures
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  implicit none
  private
  public :: pressure_set_t, add_pressure_forces, face_force, face_stiffness

  !> Set of faces that carries a pressure in some phase.
  type :: pressure_set_t
    character(len=:), allocatable :: name
    !> Corners of the faces, counter-clockwise seen from outside, `(4, n)`.
    integer, allocatable :: corner(:, :)
  end type pressure_set_t

  real(wp), parameter :: g = 1.0_wp/sqrt(3.0_wp)
  !> Natural coordinates of the corners; the Gauss points lie towards them.
  real(wp), parameter :: natural(2, 4) = reshape([-1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp, 1.0_wp, &
      1.0_wp, -1.0_wp, 1.0_wp], [2, 4])

contains

  !> Add the nodal forces of the pressures.
  pure subroutine add_pressure_forces(set, pressure, x, force)
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
      do f = 1, size(set(s)%corner, 2)
        associate (corner => set(s)%corner(:, f))
          force(:, corner) = force(:, corner) + pressure(s)*face_force(x(:, corner))
        end associate
      end do
    end do
  end subroutine add_pressure_forces

  !> Return the nodal forces of a unit pressure on a face, mm2.
  pure function face_force(x) result(force)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: force(3, 4)

    real(wp) :: shape(4), slope(4, 2), area(3)
    integer :: p, a

    force = 0.0_wp
    do p = 1, 4
      call shape_functions(g*natural(:, p), shape, slope)
      area = cross(matmul(x, slope(:, 1)), matmul(x, slope(:, 2)))
      do a = 1, 4
        force(:, a) = force(:, a) - shape(a)*area
      end do
    end do
  end function face_force

  !> Return the derivatives of the nodal forces of a unit pressure in the positions of the corners,
  !> mm: component of the force, of the position, node of the force, of the position.
  pure function face_stiffness(x) result(stiffness)
    !> Corners, mm.
    real(wp), intent(in) :: x(3, 4)
    real(wp) :: stiffness(3, 3, 4, 4)

    real(wp) :: shape(4), slope(4, 2), along(3, 2), unit(3)
    integer :: p, a, b, i

    stiffness = 0.0_wp
    do p = 1, 4
      call shape_functions(g*natural(:, p), shape, slope)
      along = matmul(x, slope)
      do b = 1, 4
        do i = 1, 3
          unit = 0.0_wp
          unit(i) = 1.0_wp
          unit = slope(b, 1)*cross(unit, along(:, 2)) + slope(b, 2)*cross(along(:, 1), unit)
          do a = 1, 4
            stiffness(:, i, a, b) = stiffness(:, i, a, b) - shape(a)*unit
          end do
        end do
      end do
    end do
  end function face_stiffness

  !> Evaluate the bilinear shape functions and their derivatives.
  pure subroutine shape_functions(at, shape, slope)
    !> Natural coordinates.
    real(wp), intent(in) :: at(2)
    real(wp), intent(out) :: shape(4), slope(4, 2)

    shape = 0.25_wp*(1.0_wp + at(1)*natural(1, :))*(1.0_wp + at(2)*natural(2, :))
    slope(:, 1) = 0.25_wp*natural(1, :)*(1.0_wp + at(2)*natural(2, :))
    slope(:, 2) = 0.25_wp*natural(2, :)*(1.0_wp + at(1)*natural(1, :))
  end subroutine shape_functions

end module dd3_model_pressures
