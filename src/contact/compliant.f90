! SPDX-License-Identifier: GPL-3.0-or-later
!> Contact of a point with a rigid tool in the compliant formulation. The tool's surface carries a
!> layer of height h, in which the pressure p depends on the gap g that is left of it:
!>     p = p_0 (h/g - 2 + g/h) for g < h,    p = 0 for g >= h.
!> Pressure and slope -dp/dg = p_0/h (h^2/g^2 - 1) are zero at the onset of contact; the slope grows
!> with the square of the pressure. Contact opens and closes without a step of its stiffness, and is
!> rigid where the sheet is pinched, as no pressure closes the gap.
!>
!> With the contact force lambda as unknown beside g, the force of the law is taken where the line
!> of slope s through the point (g, -lambda.n) meets the curve p A (the resolvent of a monotone
!> operator). It exists for any g, also a negative one, and Newton's method converges where it does
!> not for p(g). The solution does not depend on s; the normal law of the mixed formulation is the
!> limit h -> 0 with the penalty s.
!>
!> An elastic tool deflects by c p along its normal, with its area compliance c: a spring in series
!> with the layer. The gap to the surface of its file is g - c p, and the slope of the pressure in
!> it that of the layer over 1 + c times that. The line in g is (1 + s c/A) p A, so that the root
!> of the rigid tool stands with (1 + s c/A) p_0. Friction and slip are those of the rigid tool.
!>
!> Friction sticks elastically: T lambda = tau + k T w with the tangential force tau of the
!> committed state, rotated with the normal, the slip w since then, and k = (p_0 + p) A/h with p of
!> the committed state: the elastic slip is below mu h. The force whose tangential part is compared
!> with the friction is
!>     v = lambda + s_t [w - (lambda - tau)/k],    s_t = min(s, k).
!> Source: Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898 (resolvent); Wriggers,
!> Computational Contact Mechanics, 2nd ed. (2006), chapters 5 and 10 (barrier, elastic stick).
module dd3_contact_compliant
  use dd3_base_kinds, only : wp
  use dd3_contact_friction, only : friction_limit_t, friction_t, sliding_t
  use dd3_contact_operator, only : coulomb_operator, no_direction, normal_force_t, status_gap, &
      status_slip, status_stick, tangential_length, traction_t
  implicit none
  private
  public :: layer_t, new_layer, fraction_of, layer_gap, gap_under_force, place_under_force
  public :: layer_energy
  public :: compliant_operator, rotated

  !> Pressure p_0 over Young's modulus; half of the height is left at p_0/2. A holder's pressure is
  !> of this order, pressures of bending over a radius and of ironing are far above.
  real(wp), parameter :: reference_pressure = 1.0e-5_wp
  !> Scale s over the stiffness E A/t of the sheet through its thickness.
  real(wp), parameter :: scale_fraction = 1.0e-3_wp

  !> Contact layer at a node.
  type :: layer_t
    !> Height h, mm.
    real(wp) :: height = 0.0_wp
    !> Force p_0 A, N.
    real(wp) :: reference_force = 0.0_wp
    !> Scale s, N/mm.
    real(wp) :: scale = 0.0_wp
    !> Compliance c/A of the tool in series, mm/N; 0 for a rigid one.
    real(wp) :: compliance = 0.0_wp
  end type layer_t

contains

  !> Make the layer of a rigid tool at a node.
  pure type(layer_t) function new_layer(height, thickness, stiffness) result(self)
    !> Height over the thickness of the sheet.
    real(wp), intent(in) :: height
    !> Thickness of the sheet, mm, and its stiffness E A/t under the node, N/mm.
    real(wp), intent(in) :: thickness, stiffness

    self%height = height*thickness
    self%reference_force = reference_pressure*stiffness*thickness
    self%scale = scale_fraction*stiffness
  end function new_layer

  !> Return a layer of a fraction of the area, positive, with the same scale.
  pure type(layer_t) function fraction_of(layer, fraction) result(self)
    type(layer_t), intent(in) :: layer
    real(wp), intent(in) :: fraction

    self = layer
    self%reference_force = fraction*layer%reference_force
    self%compliance = layer%compliance/max(fraction, tiny(1.0_wp))
  end function fraction_of

  !> Return the gap under a pressure over the height of the layer.
  pure real(wp) function layer_gap(pressure, young)
    !> Pressure and Young's modulus, MPa.
    real(wp), intent(in) :: pressure, young

    layer_gap = part_left(pressure/(reference_pressure*young))
  end function layer_gap

  !> Return the gap that a normal force leaves in the layer, mm.
  pure real(wp) function gap_under_force(layer, force)
    type(layer_t), intent(in) :: layer
    !> Positive in compression, N.
    real(wp), intent(in) :: force

    gap_under_force = layer%height*part_left(force/layer%reference_force)
  end function gap_under_force

  !> Return the gap to the surface of the tool without force at which the normal force acts, mm;
  !> negative where the tool deflects by more than the layer leaves.
  pure real(wp) function place_under_force(layer, force)
    type(layer_t), intent(in) :: layer
    !> Positive in compression, N.
    real(wp), intent(in) :: force

    place_under_force = gap_under_force(layer, force) - layer%compliance*force
  end function place_under_force

  !> Return the part of the layer that is left at a pressure over p_0, the smaller root of
  !> x^2 - (2 + p) x + 1.
  pure real(wp) function part_left(pressure)
    real(wp), intent(in) :: pressure

    part_left = 2.0_wp/(2.0_wp + pressure + sqrt(pressure*(pressure + 4.0_wp)))
  end function part_left

  !> Return the energy stored in the layer and in the tool under a normal force, mJ.
  pure real(wp) function layer_energy(layer, force)
    type(layer_t), intent(in) :: layer
    !> Positive in compression, N.
    real(wp), intent(in) :: force

    real(wp) :: left

    left = part_left(max(force, 0.0_wp)/layer%reference_force)
    layer_energy = layer%reference_force*layer%height &
        *(0.5_wp*(1.0_wp - left)*(left - 3.0_wp) - log(left)) &
        + 0.5_wp*layer%compliance*max(force, 0.0_wp)**2
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
      friction, sliding, status, force, d, e, gap_gradient)
    type(layer_t), intent(in) :: layer
    !> Outward unit normal of the tool, gap to its surface without force, mm, and gradient of the
    !> normal, 1/mm.
    real(wp), intent(in) :: normal(3), gap, dnormal(3, 3)
    !> Contact force, that of the committed state, rotated with the normal, N; slip since then, mm.
    real(wp), intent(in) :: lambda(3), committed(3), slip(3)
    type(friction_t), intent(in) :: friction
    type(sliding_t), intent(in) :: sliding
    !> On entry a status that is kept if there is contact, or `status_gap` for the law's.
    integer, intent(inout) :: status
    real(wp), intent(out) :: force(3), d(3, 3), e(3, 3)
    !> Gradient of the gap; the normal by default.
    real(wp), intent(in), optional :: gap_gradient(3)

    type(normal_force_t) :: sigma_n
    type(traction_t) :: traction
    type(friction_limit_t) :: limit
    real(wp) :: gradient(3)
    real(wp) :: line, left, softened, slope, weight, committed_normal, stick, scale, memory
    real(wp) :: tangential(3)

    force = 0.0_wp
    d = 0.0_wp
    e = 0.0_wp
    associate (f => layer%reference_force, s_h => layer%scale*layer%height)
      line = layer%scale*gap + dot_product(lambda, normal)
      if (line >= s_h) then
        status = status_gap
        return
      end if
      ! The part of the layer that is left at the intersection: the root below 1 of
      ! (f - s h) x^2 - (2 f - line) x + f, with (1 + s c/A) f in place of f.
      softened = (1.0_wp + layer%scale*layer%compliance)*f
      left = 2.0_wp*softened/(2.0_wp*softened - line &
          + sqrt((2.0_wp*softened - line)**2 - 4.0_wp*softened*(softened - s_h)))
      sigma_n%value = -f*(1.0_wp - left)**2/left
      slope = f/layer%height*(1.0_wp/left**2 - 1.0_wp)
      slope = slope/(1.0_wp + layer%compliance*slope)
    end associate
    gradient = normal
    if (present(gap_gradient)) gradient = gap_gradient
    weight = slope/(slope + layer%scale)
    sigma_n%by_u = weight*(layer%scale*gradient + matmul(dnormal, lambda))
    sigma_n%by_lambda = weight
    committed_normal = dot_product(committed, normal)
    stick = (layer%reference_force - min(0.0_wp, committed_normal))/layer%height
    scale = min(layer%scale, stick)
    memory = 1.0_wp - scale/stick
    traction%value = memory*lambda + (1.0_wp - memory)*(committed - committed_normal*normal) &
        + scale*slip
    traction%by_u = scale
    traction%by_lambda = memory
    traction%smallest = no_direction*(norm2(lambda) + norm2(committed) + scale*norm2(slip))
    limit = friction%limit(-sigma_n%value, sliding, tangential_length(normal, slip))
    if (status == status_gap) then
      tangential = traction%value - dot_product(normal, traction%value)*normal
      status = status_stick
      if (friction%coefficient <= 0.0_wp .or. norm2(tangential) > limit%value) then
        status = status_slip
      end if
    end if
    call coulomb_operator(status, normal, dnormal, sigma_n, traction, slip, limit, force, d, e)
  end subroutine compliant_operator

end module dd3_contact_compliant
