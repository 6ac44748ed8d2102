! SPDX-License-Identifier: GPL-3.0-or-later
!> Shared by the element tests: random numbers, a smooth material law, patch meshes, evaluation.
module element_cases
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_t
  use dd3_base_verdict, only : verdict_t, verdict_converged
  use dd3_element_registry, only : new_element
  use dd3_element_table, only : element_t
  use dd3_element_work, only : element_work_t, new_element_work
  use dd3_linalg_tensor, only : kelvin_deviator
  implicit none
  private
  public :: law_t, patch_t
  public :: seed, random_number_in, random_rotation, rotation_about, elasticity, bent_law
  public :: identities, make_element, distorted, evaluate, evaluate_law, patch_mesh, patch_system
  public :: element_volume

  !> A smooth law: T = T0 + C e + kappa (a.e) B e, with an unsymmetric tangent; kappa = 0 is
  !> elastic, flow > 0 adds a radial return (Wilkins 1964).
  type :: law_t
    !> Elastic moduli, MPa.
    real(wp) :: c(6, 6) = 0.0_wp
    !> Matrix B.
    real(wp) :: b(6, 6) = 0.0_wp
    !> Vector a.
    real(wp) :: a(6) = 0.0_wp
    !> Factor kappa, MPa.
    real(wp) :: kappa = 0.0_wp
    !> Radial return, used if `flow > 0`: shear modulus, radius, its slope, MPa.
    real(wp) :: shear = 0.0_wp, flow = 0.0_wp, slope = 0.0_wp
  end type law_t

  !> A small mesh of the unit cube.
  type :: patch_t
    integer :: n_node = 0, n_element = 0
    !> Positions, mm: `x(3,n_node)`.
    real(wp), allocatable :: x(:, :)
    !> Nodes of the elements: `node(n_element_node,n_element)`.
    integer, allocatable :: node(:, :)
    !> True for nodes on the surface of the cube: `held(n_node)`.
    logical, allocatable :: held(:)
  end type patch_t

contains

  !> Seed the random numbers.
  subroutine seed(number)
    integer, intent(in) :: number

    integer, allocatable :: values(:)
    integer :: i, n

    call random_seed(size=n)
    values = [(number + 37*i, i=1, n)]
    call random_seed(put=values)
  end subroutine seed

  !> Return a random number between two bounds.
  real(wp) function random_number_in(lower, upper) result(r)
    real(wp), intent(in) :: lower, upper

    call random_number(r)
    r = lower + (upper - lower)*r
  end function random_number_in

  !> Return the rotation about an axis (Rodrigues).
  pure function rotation_about(axis, angle) result(q)
    !> Axis, of any length.
    real(wp), intent(in) :: axis(3)
    !> Angle, rad.
    real(wp), intent(in) :: angle
    real(wp) :: q(3, 3)

    real(wp) :: n(3), w(3, 3)
    integer :: i

    n = axis/norm2(axis)
    w = reshape([0.0_wp, n(3), -n(2), -n(3), 0.0_wp, n(1), n(2), -n(1), 0.0_wp], [3, 3])
    q = sin(angle)*w + (1.0_wp - cos(angle))*matmul(w, w)
    do i = 1, 3
      q(i, i) = q(i, i) + 1.0_wp
    end do
  end function rotation_about

  !> Return a random rotation.
  function random_rotation() result(q)
    real(wp) :: q(3, 3)

    real(wp) :: axis(3)
    integer :: i

    do i = 1, 3
      axis(i) = random_number_in(-1.0_wp, 1.0_wp)
    end do
    q = rotation_about(axis, random_number_in(-3.0_wp, 3.0_wp))
  end function random_rotation

  !> Return n identity matrices.
  pure function identities(n) result(q)
    integer, intent(in) :: n
    real(wp) :: q(3, 3, n)

    integer :: i

    q = 0.0_wp
    do i = 1, 3
      q(i, i, :) = 1.0_wp
    end do
  end function identities

  !> Return isotropic elastic moduli, Kelvin.
  pure function elasticity(young, poisson) result(c)
    !> Young's modulus, MPa, and Poisson's ratio.
    real(wp), intent(in) :: young, poisson
    real(wp) :: c(6, 6)

    real(wp) :: shear
    integer :: i

    shear = young/(2.0_wp*(1.0_wp + poisson))
    c = 0.0_wp
    c(1:3, 1:3) = young*poisson/((1.0_wp + poisson)*(1.0_wp - 2.0_wp*poisson))
    do i = 1, 6
      c(i, i) = c(i, i) + 2.0_wp*shear
    end do
  end function elasticity

  !> Return a law with an unsymmetric tangent that depends on the strain.
  function bent_law() result(law)
    type(law_t) :: law

    integer :: i, j

    law%c = elasticity(2.0e5_wp, 0.3_wp)
    law%kappa = 1.0e6_wp
    do j = 1, 6
      law%a(j) = random_number_in(-1.0_wp, 1.0_wp)
      do i = 1, 6
        law%b(i, j) = random_number_in(-1.0_wp, 1.0_wp)
      end do
    end do
  end function bent_law

  !> Evaluate the stress and tangent of a law.
  pure subroutine evaluate_law(law, start, strain, stress, tangent)
    type(law_t), intent(in) :: law
    !> Committed stress, MPa, and strain increment, Kelvin.
    real(wp), intent(in) :: start(6), strain(6)
    !> Stress, MPa, Kelvin.
    real(wp), intent(out) :: stress(6)
    !> d stress/d strain, MPa.
    real(wp), intent(out) :: tangent(6, 6)

    real(wp) :: s(6), n(6), bent(6), size, ratio
    integer :: j

    bent = matmul(law%b, strain)
    stress = start + matmul(law%c, strain) + law%kappa*dot_product(law%a, strain)*bent
    tangent = law%c + law%kappa*dot_product(law%a, strain)*law%b
    do j = 1, 6
      tangent(:, j) = tangent(:, j) + law%kappa*law%a(j)*bent
    end do
    if (.not. law%flow > 0.0_wp) return
    s = kelvin_deviator(stress)
    size = norm2(s)
    if (size <= law%flow) return
    ! Radial return with linear hardening of the radius.
    n = s/size
    ratio = (size - law%flow)/(2.0_wp*law%shear + law%slope)
    stress = stress - 2.0_wp*law%shear*ratio*n
    do j = 1, 6
      tangent(:, j) = tangent(:, j) - (2.0_wp*law%shear)**2*n*n(j) &
          *(1.0_wp/(2.0_wp*law%shear + law%slope) - ratio/size)
      tangent(j, j) = tangent(j, j) - (2.0_wp*law%shear)**2*ratio/size
      if (j <= 3) tangent(1:3, j) = tangent(1:3, j) + (2.0_wp*law%shear)**2*ratio/size/3.0_wp
    end do
  end subroutine evaluate_law

  !> Make an element of the registry and its workspace.
  subroutine make_element(name, element, work)
    character(len=*), intent(in) :: name
    type(element_t), intent(out) :: element
    type(element_work_t), intent(out) :: work

    type(error_t), allocatable :: error

    call new_element(element, trim(name), error)
    call new_element_work(work, element%n_node, element%n_point, element%n_group, &
        element%n_enhanced)
  end subroutine make_element

  !> Return the nodes of an element, moved at random.
  function distorted(element, amount) result(x)
    type(element_t), intent(in) :: element
    !> Largest displacement in each direction, mm; the element is 2 mm wide.
    real(wp), intent(in) :: amount
    real(wp) :: x(3, element%n_node)

    integer :: a, i

    x = element%node
    do a = 1, element%n_node
      do i = 1, 3
        x(i, a) = x(i, a) + random_number_in(-amount, amount)
      end do
    end do
  end function distorted

  !> Evaluate the deformation, with the enhanced parameters of the workspace, the law at every
  !> point, forces and stiffness.
  subroutine evaluate(element, law, x_committed, x_trial, rotation_committed, start, work, ok)
    type(element_t), intent(in) :: element
    type(law_t), intent(in) :: law
    !> Committed and trial positions, mm.
    real(wp), intent(in) :: x_committed(:, :), x_trial(:, :)
    !> Committed material axes.
    real(wp), contiguous, intent(in) :: rotation_committed(:, :, :)
    !> Committed stresses, MPa, Kelvin, material frame.
    real(wp), intent(in) :: start(:, :)
    type(element_work_t), intent(inout) :: work
    !> False if a Jacobian determinant is not positive.
    logical, intent(out) :: ok

    type(verdict_t) :: verdict
    integer :: p

    work%x_committed(:, :) = x_committed
    work%x_trial(:, :) = x_trial
    work%x_initial(:, :) = x_committed
    call element%deform(element, rotation_committed, work, verdict)
    ok = verdict%outcome == verdict_converged
    if (.not. ok) return
    do p = 1, element%n_point
      call evaluate_law(law, start(:, p), work%strain(:, p), work%stress(:, p), &
          work%tangent(:, :, p))
    end do
    call element%set_stress(element, work)
    call element%evaluate_force(element, work)
    call element%evaluate_stiffness(element, work)
  end subroutine evaluate

  !> Make the unit cube of seven distorted elements (MacNeal & Harder 1985).
  subroutine patch_mesh(element, patch)
    type(element_t), intent(in) :: element
    type(patch_t), intent(out) :: patch

    integer, parameter :: corners(8, 7) = reshape([ &
        9, 10, 11, 12, 13, 14, 15, 16, 9, 12, 11, 10, 1, 4, 3, 2, &
        13, 14, 15, 16, 5, 6, 7, 8, 9, 10, 14, 13, 1, 2, 6, 5, &
        10, 11, 15, 14, 2, 3, 7, 6, 11, 12, 16, 15, 3, 4, 8, 7, &
        12, 9, 13, 16, 4, 1, 5, 8], [8, 7])
    real(wp) :: vertex(3, 16), x(3)
    integer :: a, b, e

    vertex(:, 1:8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
        0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
    vertex(:, 9:16) = reshape([0.249_wp, 0.342_wp, 0.192_wp, 0.826_wp, 0.288_wp, 0.288_wp, &
        0.850_wp, 0.649_wp, 0.263_wp, 0.273_wp, 0.750_wp, 0.230_wp, &
        0.320_wp, 0.186_wp, 0.643_wp, 0.677_wp, 0.305_wp, 0.683_wp, &
        0.788_wp, 0.693_wp, 0.644_wp, 0.165_wp, 0.745_wp, 0.702_wp], [3, 8])
    patch%n_element = 7
    allocate (patch%x(3, 7*element%n_node), patch%node(element%n_node, 7))
    do e = 1, 7
      do a = 1, element%n_node
        x = trilinear(element%node(:, a), vertex(:, corners(:, e)))
        do b = 1, patch%n_node
          if (norm2(x - patch%x(:, b)) < 1.0e-9_wp) exit
        end do
        patch%n_node = max(patch%n_node, b)
        patch%x(:, b) = x
        patch%node(a, e) = b
      end do
    end do
    patch%x = patch%x(:, 1:patch%n_node)
    patch%held = any(patch%x < 1.0e-9_wp .or. patch%x > 1.0_wp - 1.0e-9_wp, dim=1)
  end subroutine patch_mesh

  !> Return the position of a point in a hexahedron with straight edges.
  pure function trilinear(natural, corner) result(x)
    real(wp), intent(in) :: natural(3), corner(3, 8)
    real(wp) :: x(3)

    real(wp), parameter :: side(3, 8) = real(reshape([ &
        -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
        -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8]), wp)
    integer :: a

    x = 0.0_wp
    do a = 1, 8
      x = x + product(1.0_wp + natural*side(:, a))/8.0_wp*corner(:, a)
    end do
  end function trilinear

  !> Evaluate the forces and the dense stiffness of a mesh; material and global axes agree.
  subroutine patch_system(element, work, law, patch, x, start, force, stiffness, stress)
    type(element_t), intent(in) :: element
    type(element_work_t), intent(inout) :: work
    type(law_t), intent(in) :: law
    !> Mesh with the committed positions.
    type(patch_t), intent(in) :: patch
    !> Trial positions, mm.
    real(wp), intent(in) :: x(:, :)
    !> Committed stress, uniform, MPa, Kelvin.
    real(wp), intent(in) :: start(6)
    !> Forces, N.
    real(wp), intent(out) :: force(:, :)
    !> Stiffness, N/mm: `stiffness(3*n_node,3*n_node)`.
    real(wp), intent(out) :: stiffness(:, :)
    !> Stresses, MPa, material frame: `stress(6,n_point,n_element)`.
    real(wp), intent(out) :: stress(:, :, :)

    integer :: a, b, e, i, j
    logical :: ok

    force = 0.0_wp
    stiffness = 0.0_wp
    do e = 1, patch%n_element
      associate (node => patch%node(:, e))
        call evaluate(element, law, patch%x(:, node), x(:, node), identities(element%n_point), &
            spread(start, 2, element%n_point), work, ok)
        stress(:, :, e) = work%stress
        do a = 1, element%n_node
          i = 3*node(a)
          force(:, node(a)) = force(:, node(a)) + work%force(:, a)
          do b = 1, element%n_node
            j = 3*node(b)
            stiffness(i - 2:i, j - 2:j) = stiffness(i - 2:i, j - 2:j) + work%stiffness(:, :, b, a)
          end do
        end do
      end associate
    end do
  end subroutine patch_system

  !> Return the volume, mm3.
  pure real(wp) function element_volume(element, x) result(volume)
    type(element_t), intent(in) :: element
    !> Positions, mm: `x(3,n_node)`.
    real(wp), intent(in) :: x(3, element%n_node)

    real(wp) :: j(3, 3)
    integer :: p

    volume = 0.0_wp
    do p = 1, element%n_point
      j = matmul(x, transpose(element%dshape(:, :, p)))
      volume = volume + element%weight(p)*( &
          j(1, 1)*(j(2, 2)*j(3, 3) - j(2, 3)*j(3, 2)) &
          + j(1, 2)*(j(2, 3)*j(3, 1) - j(2, 1)*j(3, 3)) &
          + j(1, 3)*(j(2, 1)*j(3, 2) - j(2, 2)*j(3, 1)))
    end do
  end function element_volume

end module element_cases
