!> Contact of a node with a rigid tool in the compliant formulation. The tool's surface carries a
!> layer of height h, in which the pressure p depends on the gap g that is left of it:
!>     p = p_h (h/g - 1) for g < h,    p = 0 for g >= h.
!> Half of the layer is left at the pressure p_h. The slope -dp/dg = (p + p_h)^2/(p_h h) is small at
!> the onset of contact and grows with the square of the pressure: contact is soft where it opens and
!> closes, and rigid where the sheet is pinched, as no pressure closes the gap.
!>
!> The law is the central path s g y = s h F_h of the condition g >= 0, y >= 0, g y = 0 for the
!> shifted nodal force y = F_h - lambda.n, F_h = p_h A. It is evaluated in the form
!>     y = [z + sqrt(z^2 + 4 s h F_h)]/2,    z = F_h - lambda.n - s g,
!> whose Newton steps converge from any g, also from a negative one: lambda is eliminated as in the
!> mixed formulation, whose normal law is the limit h -> 0 with the penalty s. The solution does not
!> depend on s.
!>
!> Friction sticks elastically: T lambda = tau + k T w with the tangential force tau of the committed
!> state, rotated with the normal, the slip w since then, and k = y/h with y of the committed state:
!> the elastic slip is below mu h. The force whose tangential part is compared with the friction is
!>     v = lambda + s_t [w - (lambda - tau)/k],    s_t = min(s, k).
!> Source: Chen and Harker, SIAM J. Matrix Anal. Appl. 14 (1993) 1168-1190; Kanzow, SIAM J. Matrix
!> Anal. Appl. 17 (1996) 851-868 (smoothing); Wriggers, Computational Contact Mechanics, 2nd ed.
!> (2006), chapters 5 and 10 (barrier, elastic stick).
module dd3_contact_compliant
  use dd3_base_kinds, only : wp
  use dd3_contact_operator, only : coulomb_operator, normal_force_t, status_gap, status_slip, &
      status_stick, traction_t
  implicit none
  private
  public :: layer_t, new_layer, layer_gap, layer_energy, compliant_operator, rotated

  !> Pressure p_h at half of the height over Young's modulus. Pressures of bending over a radius are
  !> of this order, those of ironing far above.
  real(wp), parameter :: half_pressure = 3.0e-5_wp
  !> Scale s over the stiffness E A/t of the sheet through its thickness.
  real(wp), parameter :: scale_fraction = 1.0e-3_wp
  !> |T v| up to this, relative to its parts, has no direction.
  real(wp), parameter :: no_direction = 1.0e-13_wp

  !> Contact layer at a node.
  type :: layer_t
    !> Height h, mm.
    real(wp) :: height = 0.0_wp
    !> Force F_h at which half of the height is left, N.
    real(wp) :: half_force = 0.0_wp
    !> Scale s, N/mm.
    real(wp) :: scale = 0.0_wp
  end type layer_t

contains

  !> Make the layer at a node.
  pure type(layer_t) function new_layer(height, thickness, stiffness) result(self)
    !> Height over the thickness of the sheet.
    real(wp), intent(in) :: height
    !> Thickness of the sheet, mm, and its stiffness E A/t under the node, N/mm.
    real(wp), intent(in) :: thickness, stiffness

    self%height = height*thickness
    self%half_force = half_pressure*stiffness*thickness
    self%scale = scale_fraction*stiffness
  end function new_layer

  !> Return the gap under a pressure over the height of the layer.
  pure real(wp) function layer_gap(pressure, young)
    !> Pressure and Young's modulus, MPa.
    real(wp), intent(in) :: pressure, young

    layer_gap = half_pressure*young/(pressure + half_pressure*young)
  end function layer_gap

  !> Return the energy stored in the layer under a normal force, mJ: F_h h (ln(1 + r) - r/(1 + r)),
  !> r the quotient of the force and F_h.
  pure real(wp) function layer_energy(layer, force)
    type(layer_t), intent(in) :: layer
    !> Positive in compression, N.
    real(wp), intent(in) :: force

    real(wp) :: r

    r = max(force, 0.0_wp)/layer%half_force
    layer_energy = layer%half_force*layer%height*(log(1.0_wp + r) - r/(1.0_wp + r))
  end function layer_energy

  !> Return a vector rotated with the normal, about the axis at right angles to both normals.
  pure function rotated(vector, from, to)
    real(wp), intent(in) :: vector(3)
    !> Unit normals, not opposite.
    real(wp), intent(in) :: from(3), to(3)
    real(wp) :: rotated(3)

    rotated = vector - dot_product(from + to, vector)/(1.0_wp + dot_product(from, to))*(from + to) &
        + 2.0_wp*dot_product(from, vector)*to
  end function rotated

  !> Kernel: evaluate status, force of the sheet on the tool, N, and its linearisation
  !> dF = D du + E dlambda.
  pure subroutine compliant_operator(layer, normal, gap, dnormal, lambda, committed, slip, &
      friction, status, force, d, e)
    type(layer_t), intent(in) :: layer
    !> Outward unit normal of the tool, gap, mm, and gradient of the normal, 1/mm.
    real(wp), intent(in) :: normal(3), gap, dnormal(3, 3)
    !> Contact force, that of the committed state, rotated with the normal, N; slip since then, mm.
    real(wp), intent(in) :: lambda(3), committed(3), slip(3)
    real(wp), intent(in) :: friction
    !> On entry a status that is kept if there is contact, or `status_gap` for the law's.
    integer, intent(inout) :: status
    real(wp), intent(out) :: force(3), d(3, 3), e(3, 3)

    type(normal_force_t) :: sigma_n
    type(traction_t) :: traction
    real(wp) :: z, root, weight, committed_normal, stick, scale, memory, tangential(3)

    force = 0.0_wp
    d = 0.0_wp
    e = 0.0_wp
    z = layer%half_force - dot_product(lambda, normal) - layer%scale*gap
    root = sqrt(z**2 + 4.0_wp*layer%scale*layer%height*layer%half_force)
    sigma_n%value = layer%half_force - 0.5_wp*(z + root)
    if (sigma_n%value > 0.0_wp) then
      status = status_gap
      return
    end if
    weight = 0.5_wp*(1.0_wp + z/root)
    sigma_n%by_u = weight*(layer%scale*normal + matmul(dnormal, lambda))
    sigma_n%by_lambda = weight
    committed_normal = dot_product(committed, normal)
    stick = (layer%half_force - min(0.0_wp, committed_normal))/layer%height
    scale = min(layer%scale, stick)
    memory = 1.0_wp - scale/stick
    traction%value = memory*lambda + (1.0_wp - memory)*(committed - committed_normal*normal) &
        + scale*slip
    traction%by_u = scale
    traction%by_lambda = memory
    traction%smallest = no_direction*(norm2(lambda) + norm2(committed) + scale*norm2(slip))
    if (status == status_gap) then
      tangential = traction%value - dot_product(normal, traction%value)*normal
      status = status_stick
      if (friction <= 0.0_wp .or. norm2(tangential) > -friction*sigma_n%value) status = status_slip
    end if
    call coulomb_operator(status, normal, dnormal, sigma_n, traction, friction, force, d, e)
  end subroutine compliant_operator

end module dd3_contact_compliant
