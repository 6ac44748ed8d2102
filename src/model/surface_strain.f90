! SPDX-License-Identifier: GPL-3.0-or-later
!> Logarithmic strains in the surface of the sheet at its lower face, middle and upper face, for any
!> element: principal values of the right stretch of the surface, whose positions are interpolated
!> between the columns' bottom and top nodes with the shape functions of the elements' lower faces.
!> Straight edges stand for circular arcs, which turn by the angle theta between the directors (from
!> the bottom to the top of the columns) at their ends: a chord is shorter than its arc by the
!> factor 2 sin(theta/2)/theta. At a node the strain tensors of the faces that share it are
!> averaged.
module dd3_model_surface_strain
  use dd3_base_kinds, only : wp
  use dd3_linalg_tensor, only : cross
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: surface_strains

  !> Relative difference of squared stretches below which they count as equal.
  real(wp), parameter :: equal_stretch = 1.0e-9_wp

  !> Corners of a face.
  integer, parameter :: n_corner = 4

  !> Sine of half the angle of an edge below which arc and chord are equal within round-off.
  real(wp), parameter :: straight = 1.0e-8_wp

contains

  !> Evaluate major and minor strain of a surface; a node has the value of its column, and zero if
  !> it is in none.
  pure subroutine surface_strains(model, x, height, strain)
    type(model_t), intent(in) :: model
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)
    !> 0 at the lower face, 1 at the upper one.
    real(wp), intent(in) :: height
    !> Major and minor strain, `(2, n_node)`.
    real(wp), intent(out) :: strain(:, :)

    real(wp), allocatable :: tensor(:, :, :), normal(:, :)
    real(wp), allocatable :: face_tensor(:, :, :), face_normal(:, :)
    integer, allocatable :: local(:)
    integer :: sharing(model%n_node), e, i

    local = pack([(i, i=1, model%element%n_node)], model%element%node(3, :) < -0.5_wp)
    allocate (tensor(3, 3, model%n_node), normal(3, model%n_node), source=0.0_wp)
    allocate (face_tensor(3, 3, size(local)), face_normal(3, size(local)))
    sharing = 0
    do e = 1, model%n_element
      associate (node => model%connectivity(local, e), column => model%column)
        if (any(column(1, node) /= node)) cycle
        call strain_of_face(model%element%node_slope(:2, local, local), &
            between(model%x0(:, node), model%x0(:, column(2, node))), &
            between(x(:, node), x(:, column(2, node))), &
            directors(model%x0(:, node), model%x0(:, column(2, node))), &
            directors(x(:, node), x(:, column(2, node))), face_tensor, face_normal)
        tensor(:, :, node) = tensor(:, :, node) + face_tensor
        normal(:, node) = normal(:, node) + face_normal
        sharing(node) = sharing(node) + 1
      end associate
    end do
    strain = 0.0_wp
    do i = 1, model%n_node
      associate (bottom => model%column(1, i))
        if (sharing(bottom) == 0) cycle
        strain(:, i) = principal_values(tensor(:, :, bottom)/real(sharing(bottom), wp), &
            normal(:, bottom))
      end associate
    end do

  contains

    !> Return points between the bottom and the top nodes.
    pure function between(bottom, top) result(point)
      real(wp), intent(in) :: bottom(:, :), top(:, :)
      real(wp) :: point(size(bottom, 1), size(bottom, 2))

      point = (1.0_wp - height)*bottom + height*top
    end function between

  end subroutine surface_strains

  !> Return the unit vectors from bottom nodes to top nodes.
  pure function directors(bottom, top) result(d)
    !> Positions, `(3, n)`, mm.
    real(wp), intent(in) :: bottom(:, :), top(:, :)
    real(wp) :: d(3, size(bottom, 2))

    integer :: a

    do a = 1, size(d, 2)
      d(:, a) = (top(:, a) - bottom(:, a))/norm2(top(:, a) - bottom(:, a))
    end do
  end function directors

  !> Evaluate the strain tensors and the initial unit normals of a face at its nodes.
  pure subroutine strain_of_face(slope, x0, x, d0, d, tensor, normal)
    !> Derivatives of the shape functions in the face, `(2, n, n)`: direction, function, place.
    real(wp), intent(in) :: slope(:, :, :)
    !> Initial and present positions, `(3, n)`, mm.
    real(wp), intent(in) :: x0(:, :), x(:, :)
    !> Initial and present directors, `(3, n)`.
    real(wp), intent(in) :: d0(:, :), d(:, :)
    !> `(3, 3, n)` and `(3, n)`.
    real(wp), intent(out) :: tensor(:, :, :), normal(:, :)

    real(wp) :: base(3, 2), inverse(2, 2), image(3, 2), log_stretch(2, 2)
    integer :: a

    do a = 1, size(x, 2)
      call orthonormal(tangents(slope(:, :, a), x0, d0), base, inverse)
      image = matmul(tangents(slope(:, :, a), x, d), inverse)
      log_stretch = half_log(matmul(transpose(image), image))
      tensor(:, :, a) = matmul(base, matmul(log_stretch, transpose(base)))
      normal(:, a) = cross(base(:, 1), base(:, 2))
    end do
  end subroutine strain_of_face

  !> Return the derivatives of the positions in a face at one of its nodes; those of straight edges
  !> are scaled to the length of the arc: with the chord c and the directors d at its ends, the sine
  !> of half the angle is s = c.(d2 - d1)/(2 |c|), and arc over chord asin(s)/s.
  pure function tangents(slope, x, d) result(tangent)
    !> Derivatives of the shape functions, `(2, n)`.
    real(wp), intent(in) :: slope(:, :)
    !> Positions, mm, and directors, `(3, n)`.
    real(wp), intent(in) :: x(:, :), d(:, :)
    real(wp) :: tangent(3, 2)

    real(wp) :: turn(3, 2), sine
    integer :: k

    tangent = matmul(x, transpose(slope))
    if (size(x, 2) > n_corner) return
    turn = matmul(d, transpose(slope))
    do k = 1, 2
      sine = abs(dot_product(tangent(:, k), turn(:, k)))/norm2(tangent(:, k))
      if (sine > straight) tangent(:, k) = tangent(:, k)*asin(min(1.0_wp, sine))/sine
    end do
  end function tangents

  !> Make an orthonormal base of a plane: tangent = base inverse^-1.
  pure subroutine orthonormal(tangent, base, inverse)
    !> Independent vectors.
    real(wp), intent(in) :: tangent(3, 2)
    real(wp), intent(out) :: base(3, 2)
    !> Upper triangular.
    real(wp), intent(out) :: inverse(2, 2)

    real(wp) :: r(3)

    r(1) = norm2(tangent(:, 1))
    base(:, 1) = tangent(:, 1)/r(1)
    r(2) = dot_product(base(:, 1), tangent(:, 2))
    base(:, 2) = tangent(:, 2) - r(2)*base(:, 1)
    r(3) = norm2(base(:, 2))
    base(:, 2) = base(:, 2)/r(3)
    inverse(:, 1) = [1.0_wp/r(1), 0.0_wp]
    inverse(:, 2) = [-r(2)/(r(1)*r(3)), 1.0_wp/r(3)]
  end subroutine orthonormal

  !> Return half the logarithm of a symmetric positive 2x2 tensor.
  pure function half_log(c) result(e)
    real(wp), intent(in) :: c(2, 2)
    real(wp) :: e(2, 2)

    real(wp) :: mean, radius, high, low, factor

    call mean_and_radius(c, mean, radius)
    high = mean + radius
    low = max(mean - radius, tiny(1.0_wp))
    if (radius <= equal_stretch*mean) then
      factor = 1.0_wp/mean
    else
      factor = log(high/low)/(high - low)
    end if
    e = factor*c
    e(1, 1) = e(1, 1) + log(low) - factor*low
    e(2, 2) = e(2, 2) + log(low) - factor*low
    e = 0.5_wp*e
  end function half_log

  !> Evaluate mean value and half difference of the principal values of a symmetric 2x2 tensor.
  pure subroutine mean_and_radius(c, mean, radius)
    real(wp), intent(in) :: c(2, 2)
    real(wp), intent(out) :: mean, radius

    mean = 0.5_wp*(c(1, 1) + c(2, 2))
    ! With hypot, the program would need the C library of 2022 (glibc 2.35).
    radius = norm2(0.5_wp*[c(1, 1) - c(2, 2), c(1, 2) + c(2, 1)])
  end subroutine mean_and_radius

  !> Return the principal values of a strain tensor in the plane of a normal, the major one first.
  pure function principal_values(tensor, normal) result(value)
    real(wp), intent(in) :: tensor(3, 3), normal(3)
    real(wp) :: value(2)

    real(wp) :: base(3, 2), inverse(2, 2), tangent(3, 2), mean, radius
    integer :: k

    k = minloc(abs(normal), dim=1)
    tangent = 0.0_wp
    tangent(k, 1) = 1.0_wp
    tangent(:, 1) = tangent(:, 1) - normal*normal(k)/dot_product(normal, normal)
    tangent(:, 2) = cross(normal, tangent(:, 1))
    call orthonormal(tangent, base, inverse)
    call mean_and_radius(matmul(transpose(base), matmul(tensor, base)), mean, radius)
    value = [mean + radius, mean - radius]
  end function principal_values

end module dd3_model_surface_strain
