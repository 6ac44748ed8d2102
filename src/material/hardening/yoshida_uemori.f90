! SPDX-License-Identifier: GPL-3.0-or-later
!> The two-surface law of F. Yoshida and T. Uemori (2002): a yield surface of constant size Y moves
!> within a bounding surface that hardens isotropically (R) and kinematically (beta); a third
!> surface, of centre q and radius r in the space of beta, makes the isotropic hardening stagnate
!> after a reversal. With N' = dev(T - X)/sb, a = B + R - Y,
!>
!>     X = alpha + beta,   dalpha = C (a N' - sqrt(a/|alpha|) alpha) dp,
!>     dbeta = m (b N' - beta) dp,   dR = m (Rsat - R) dp,
!>     dr = h dG,   dq = (1 - h) dG (beta - q)/r
!>
!> where dG, the rate of |beta - q|, is positive and |beta - q| = r; otherwise R, r and q are
!> constant. |beta - q| is von Mises' norm; |alpha| is the length of alpha in units of that of N',
!> which for von Mises' criterion is the same: for any criterion the yield surface then stays within
!> the bounding one in proportional loading and after its reversal.
!>
!> Over an increment N' is that of its end, and a the mean of its start and end. beta, R and the
!> increment at which beta meets the third surface are then exact, r and q where beta moves along
!> the radius. alpha is integrated by Strang's splitting in `n_panel` equal parts: the relaxation,
!> in which sqrt|alpha| falls linearly, and the translation by C a N' dp are both exact. All
!> derivatives are exact, but for the switch of the third surface.
module dd3_material_hardening_yoshida_uemori
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_linalg_tensor, only : kelvin_deviator, kelvin_deviator_projector
  use dd3_material_backstress_relaxation, only : longest_decay
  use dd3_material_description, only : description_t, internal_variable_t, problem_t, add_problem, &
      position_of, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: yoshida_uemori_t

  !> Number of own internal variables: alpha, beta, q, r and R; positions of the last two.
  integer, parameter :: n_own = 20, at_radius = 19, at_hardening = 20
  !> Parts of an increment in which alpha is integrated.
  integer, parameter :: n_panel = 16
  !> C dp beyond which alpha is saturated.
  real(wp), parameter :: saturated = 50.0_wp
  !> Square of |alpha|/a that counts as zero.
  real(wp), parameter :: negligible = 1.0e-200_wp

  type, extends(hardening_t) :: yoshida_uemori_t
    private
    !> Radius of the yield surface and initial radius of the bounding surface, MPa.
    real(wp) :: y = 1.0_wp, b0 = 2.0_wp
    !> Rate of alpha; rate of beta and R.
    real(wp) :: c = 0.0_wp, m = 0.0_wp
    !> Saturation of beta and of R, MPa.
    real(wp) :: b = 0.0_wp, r_sat = 0.0_wp
    !> Part of the motion of beta by which the third surface grows; the rest moves it.
    real(wp) :: h = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: describe_internal_variables
    procedure, nopass :: check
    procedure :: set
    procedure :: flow_stress
    procedure :: back_stress
    procedure :: evolve
  end type yoshida_uemori_t

  !> The bounding surface at the end of an increment.
  type :: bounding_t
    !> N' and exp(-m dp).
    real(wp) :: normal(6), decay
    !> beta; R with its derivatives in the increment and in N'; all MPa.
    real(wp) :: centre(6), hardening, slope, gradient(6)
  end type bounding_t

  !> alpha = A alpha_start + a B N', with the derivatives of A and B in C dp, in W and in c of
  !> `evolve_panels`.
  type :: combination_t
    real(wp) :: a, b, a_by(3), b_by(3)
  end type combination_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "yoshida_uemori"
    description%title = "two surfaces, hardening stagnates after reversals; owns a back-stress"
    description%source = "F. Yoshida, T. Uemori, Int. J. Plasticity 18 (2002) 661-686"
    allocate (description%rows, source=[ &
      row("Y", kind_real, "MPa", "", "radius of the yield surface, constant", 0.0_wp, &
          lower_open=.true.), &
      row("B", kind_real, "MPa", "", "initial radius of the bounding surface, above Y", 0.0_wp, &
          lower_open=.true.), &
      row("C", kind_real, "", "", "rate at which the yield surface approaches the bounding one", &
          0.0_wp), &
      row("m", kind_real, "", "", "rate of the bounding surface", 0.0_wp), &
      row("b_sat", kind_real, "MPa", "", "saturation of the bounding surface's centre, b of "// &
          "the paper", 0.0_wp), &
      row("Rsat", kind_real, "MPa", "", "saturation of the bounding surface's growth", 0.0_wp), &
      row("h", kind_real, "", "", "extent of the stagnation; 0: none", 0.0_wp, 1.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y", 124.0_wp), law_value_t("B", 168.0_wp), law_value_t("C", 500.0_wp), &
      law_value_t("m", 12.0_wp), law_value_t("b_sat", 9.0_wp), law_value_t("Rsat", 190.0_wp), &
      law_value_t("h", 0.5_wp)])
  end subroutine describe

  pure subroutine describe_internal_variables(rows)
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    allocate (rows(5))
    rows(1) = internal_variable_t("relative_back_stress", "MPa", "centre of the yield surface "// &
        "less that of the bounding one, Kelvin vector", 6)
    rows(2) = internal_variable_t("bounding_back_stress", "MPa", "centre of the bounding "// &
        "surface, Kelvin vector", 6)
    rows(3) = internal_variable_t("stagnation_centre", "MPa", "centre of the stagnation "// &
        "surface, Kelvin vector", 6)
    rows(4) = internal_variable_t("stagnation_radius", "MPa", "radius of the stagnation surface", 1)
    rows(5) = internal_variable_t("bounding_hardening", "MPa", "growth R of the bounding surface", &
        1)
  end subroutine describe_internal_variables

  !> Require a bounding surface larger than the yield surface.
  subroutine check(values, problems)
    type(law_value_t), intent(in) :: values(:)
    type(problem_t), allocatable, intent(inout) :: problems(:)

    if (size(problems) > 0) return
    if (.not. value_of(values, "B") > value_of(values, "Y")) call add_problem(problems, &
        position_of(values, "B"), "B is not larger than Y", "a bounding surface outside the "// &
        "yield surface")
  end subroutine check

  subroutine set(self, values)
    class(yoshida_uemori_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%n_internal = n_own
    self%owns_back_stress = .true.
    self%y = value_of(values, "Y")
    self%b0 = value_of(values, "B")
    self%c = value_of(values, "C")
    self%m = value_of(values, "m")
    self%b = value_of(values, "b_sat")
    self%r_sat = value_of(values, "Rsat")
    self%h = value_of(values, "h")
  end subroutine set

  !> Evaluate the flow stress, the constant radius of the yield surface.
  pure subroutine flow_stress(self, plastic_strain, start, increment, direction, flow)
    class(yoshida_uemori_t), intent(in) :: self
    real(wp), intent(in) :: plastic_strain, start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(flow_response_t), intent(out) :: flow

    flow%value = self%y
    flow%slope = 0.0_wp
    flow%gradient = 0.0_wp
    associate (no_strain => plastic_strain, no_state => start, no_increment => increment, &
        no_direction => direction)
    end associate
  end subroutine flow_stress

  !> Evaluate the law's own back-stress at the end of a plastic increment.
  pure subroutine back_stress(self, start, increment, direction, back)
    class(yoshida_uemori_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    type(bounding_t) :: bounding
    real(wp) :: by_normal(6, 6), factor
    integer :: j

    call evolve_bounding(self, start, increment, direction, bounding)
    call evolve_relative(self, start, increment, bounding, back%value, back%slope, by_normal)
    back%value = back%value + bounding%centre
    back%slope = back%slope + self%m*(self%b*bounding%normal - bounding%centre)
    back%gradient = 0.0_wp
    if (.not. direction%equivalent > 0.0_wp) return
    do j = 1, 6
      by_normal(j, j) = by_normal(j, j) + (1 - bounding%decay)*self%b
    end do
    factor = 1/direction%equivalent
    do j = 1, 6
      back%gradient(:, j) = factor*matmul(by_normal, kelvin_deviator_projector(:, j) &
          - direction%gradient(j)*bounding%normal)
    end do
  end subroutine back_stress

  !> Evolve the law's own internal variables over a plastic increment.
  pure subroutine evolve(self, start, increment, direction, evolved)
    class(yoshida_uemori_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    real(wp), intent(out) :: evolved(self%n_internal)

    type(bounding_t) :: bounding
    real(wp) :: slope(6), by_normal(6, 6), radius(6), length, excess

    call evolve_bounding(self, start, increment, direction, bounding)
    call evolve_relative(self, start, increment, bounding, evolved(1:6), slope, by_normal)
    evolved(7:12) = bounding%centre
    evolved(13:at_radius) = start(13:at_radius)
    evolved(at_hardening) = bounding%hardening
    radius = bounding%centre - start(13:18)
    length = mises(radius)
    excess = length - start(at_radius)
    if (.not. excess > 0.0_wp) return
    evolved(13:18) = start(13:18) + (1 - self%h)*excess/length*radius
    evolved(at_radius) = start(at_radius) + self%h*excess
  end subroutine evolve

  !> Return von Mises' norm of a deviator.
  pure real(wp) function mises(deviator)
    real(wp), intent(in) :: deviator(6)

    mises = sqrt(1.5_wp)*norm2(deviator)
  end function mises

  !> Evolve the bounding surface over an increment. beta moves straight towards b N'; R grows from
  !> the part of this motion at which beta leaves the stagnation surface.
  pure subroutine evolve_bounding(self, start, increment, direction, bounding)
    class(yoshida_uemori_t), intent(in) :: self
    real(wp), intent(in) :: start(n_own), increment
    type(flow_direction_t), intent(in) :: direction
    type(bounding_t), intent(out) :: bounding

    real(wp) :: motion(6), radius(6), part, missing, inward

    bounding%normal = 0.0_wp
    if (direction%equivalent > 0.0_wp) then
      bounding%normal = kelvin_deviator(direction%stress)/direction%equivalent
    end if
    bounding%decay = exp(-min(self%m*increment, longest_decay))
    motion = self%b*bounding%normal - start(7:12)
    bounding%centre = start(7:12) + (1 - bounding%decay)*motion
    bounding%hardening = start(at_hardening)
    bounding%slope = 0.0_wp
    bounding%gradient = 0.0_wp
    part = part_within(start(7:12) - start(13:18), motion, start(at_radius))
    if (part > 1 - bounding%decay .or. .not. norm2(motion) > 0.0_wp) return
    missing = (self%r_sat - start(at_hardening))*bounding%decay/(1 - part)
    bounding%hardening = self%r_sat - missing
    bounding%slope = self%m*missing
    if (.not. part > 0.0_wp) return
    radius = start(7:12) - start(13:18) + part*motion
    inward = dot_product(radius, motion)
    if (inward > 0.0_wp) bounding%gradient = missing/(1 - part)*part*self%b/inward*radius
  end subroutine evolve_bounding

  !> Return the part of a straight motion that lies within the stagnation surface, 0 if it leads
  !> outwards from its start.
  pure real(wp) function part_within(start, motion, radius)
    !> Start from the centre, and motion, MPa.
    real(wp), intent(in) :: start(6), motion(6)
    !> Radius in von Mises' norm, MPa.
    real(wp), intent(in) :: radius

    real(wp) :: square, product, gap

    square = dot_product(motion, motion)
    product = dot_product(start, motion)
    gap = radius**2/1.5_wp - dot_product(start, start)
    part_within = 0.0_wp
    if (square > 0.0_wp) part_within = &
        max(0.0_wp, (sqrt(max(0.0_wp, product**2 + square*gap)) - product)/square)
  end function part_within

  !> Evolve alpha over an increment.
  pure subroutine evolve_relative(self, start, increment, bounding, relative, slope, by_normal)
    class(yoshida_uemori_t), intent(in) :: self
    real(wp), intent(in) :: start(n_own), increment
    type(bounding_t), intent(in) :: bounding
    !> alpha at the end and its derivatives in the increment and in N', MPa.
    real(wp), intent(out) :: relative(6), slope(6), by_normal(6, 6)

    type(combination_t) :: combined
    real(wp) :: distance, square, projection, ratio, time, by_distance(6), a_by(6), b_by(6)
    integer :: j

    relative = start(1:6)
    slope = 0.0_wp
    by_normal = 0.0_wp
    square = dot_product(bounding%normal, bounding%normal)
    if (.not. square > 0.0_wp) return
    distance = self%b0 - self%y + 0.5_wp*(start(at_hardening) + bounding%hardening)
    ratio = dot_product(start(1:6), start(1:6))/(distance**2*square)
    projection = dot_product(start(1:6), bounding%normal)/(distance*square)
    time = self%c*increment
    call evolve_panels(min(time, saturated), ratio, projection, combined)
    if (time > saturated) then
      combined%a_by(1) = 0.0_wp
      combined%b_by(1) = 0.0_wp
    end if
    relative = combined%a*start(1:6) + distance*combined%b*bounding%normal
    by_distance = combined%b*bounding%normal &
        - (2*ratio*combined%a_by(2) + projection*combined%a_by(3))/distance*start(1:6) &
        - (2*ratio*combined%b_by(2) + projection*combined%b_by(3))*bounding%normal
    slope = self%c*(combined%a_by(1)*start(1:6) + distance*combined%b_by(1)*bounding%normal) &
        + 0.5_wp*bounding%slope*by_distance
    a_by = gradient(combined%a_by)
    b_by = distance*gradient(combined%b_by)
    do j = 1, 6
      by_normal(:, j) = a_by(j)*start(1:6) + b_by(j)*bounding%normal &
          + 0.5_wp*bounding%gradient(j)*by_distance
      by_normal(j, j) = by_normal(j, j) + distance*combined%b
    end do

  contains

    !> Return the derivative in N' from those in W and in c.
    pure function gradient(by)
      real(wp), intent(in) :: by(3)
      real(wp) :: gradient(6)

      gradient = (by(3)/(distance*square))*start(1:6) &
          - 2*(by(2)*ratio + by(3)*projection)/square*bounding%normal
    end function gradient

  end subroutine evolve_relative

  !> Integrate alpha/a = A alpha_start/a + B N' by Strang's splitting: half a relaxation, a
  !> translation, whole relaxations and translations, half a relaxation.
  pure subroutine evolve_panels(time, ratio, projection, combined)
    !> C dp.
    real(wp), intent(in) :: time
    !> W = |alpha_start|^2 and c = alpha_start : N', both in units of a and of the length of N'.
    real(wp), intent(in) :: ratio, projection
    type(combination_t), intent(out) :: combined

    integer :: i

    combined%a = 1.0_wp
    combined%b = 0.0_wp
    combined%a_by = 0.0_wp
    combined%b_by = 0.0_wp
    call relax_panel(0.5_wp/n_panel, time, ratio, projection, combined)
    do i = 1, n_panel
      combined%b = combined%b + time/n_panel
      combined%b_by(1) = combined%b_by(1) + 1.0_wp/n_panel
      call relax_panel(merge(1.0_wp, 0.5_wp, i < n_panel)/n_panel, time, ratio, projection, &
          combined)
    end do
  end subroutine evolve_panels

  !> Relax alpha alone, dalpha = -C sqrt(a/|alpha|) alpha dp, over a part of the increment: the
  !> square root of |alpha|/a falls by half of C dp, to zero at most.
  pure subroutine relax_panel(part, time, ratio, projection, combined)
    !> Part of the increment; C dp, W and c as above.
    real(wp), intent(in) :: part, time, ratio, projection
    type(combination_t), intent(inout) :: combined

    real(wp) :: square, root, kept, square_by(3), kept_by(3)

    associate (a => combined%a, b => combined%b, a_by => combined%a_by, b_by => combined%b_by)
      square = a**2*ratio + 2*a*b*projection + b**2
      if (.not. square > negligible) return
      root = sqrt(sqrt(square))
      kept = 1 - 0.5_wp*part*time/root
      if (.not. kept > 0.0_wp) then
        combined = combination_t(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
        return
      end if
      square_by = 2*((a*ratio + b*projection)*a_by + (a*projection + b)*b_by)
      square_by(2) = square_by(2) + a**2
      square_by(3) = square_by(3) + 2*a*b
      kept_by = 0.125_wp*part*time/(root*square)*square_by
      kept_by(1) = kept_by(1) - 0.5_wp*part/root
      a_by = kept*(kept*a_by + 2*a*kept_by)
      b_by = kept*(kept*b_by + 2*b*kept_by)
      a = kept**2*a
      b = kept**2*b
    end associate
  end subroutine relax_panel

end module dd3_material_hardening_yoshida_uemori
