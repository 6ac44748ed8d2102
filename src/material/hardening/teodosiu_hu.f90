! SPDX-License-Identifier: GPL-3.0-or-later
!> The law of C. Teodosiu and Z. Hu (1995, 1998), in the form of H. Haddadi, S. Bouvier, M. Banu,
!> C. Maier and C. Teodosiu (2006): isotropic hardening R, a back-stress X, the strength S of
!> persistent dislocation structures (a fourth-order tensor), their polarity P. With N = V/|V|, the
!> direction of flow, S_D = N:S:N and S_L = S - S_D N (x) N,
!>
!>     Y = Y0 + R + f |S|,   dR = CR (Rsat - R) dp,   dP = CP (N - P) dp,
!>     dX = CX (Xsat N' - X) dp,  N' = dev(T - X)/sb,  Xsat = X0 + (1 - f) sqrt(S_D^2 + r |S_L|^2),
!>     dS_D = CSD (g (Ssat - S_D) - h S_D) dp,   dS_L = -CSL (|S_L|/Ssat)^nL S_L dp,
!>     h = (1 - X:V/Xsat)/2,   P_D = P:N,   a = CP/(CSD + CP),
!>     g = 1 - a |S_D/Ssat - P_D| for P_D >= 0, else (1 + P_D)^nP (1 - a S_D/Ssat).
!>
!> X:V is X:N over N':N of the papers. Over an increment N and Xsat are those of its end; R, P, X
!> and S_L are integrated exactly, S_D by backward Euler with the mean of h. From its value at the
!> start in the new direction, limited to [0, 1], h decays by exp(-CX dp), the exact solution for
!> constant N and Xsat. All derivatives are exact.
module dd3_material_hardening_teodosiu_hu
  use dd3_base_kinds, only : wp
  use dd3_base_parameter, only : law_value_t, row, kind_real
  use dd3_linalg_tensor, only : kelvin_deviator
  use dd3_material_backstress_relaxation, only : longest_decay, relax, relax_back_stress
  use dd3_material_description, only : description_t, internal_variable_t, value_of
  use dd3_material_flow, only : flow_direction_t, flow_response_t, back_response_t
  use dd3_material_hardening_law, only : hardening_t
  implicit none
  private
  public :: teodosiu_hu_t

  !> Number of own internal variables: P, X, then the upper triangle of S column by column.
  integer, parameter :: n_own = 33
  !> Largest number of iterations for S_D.
  integer, parameter :: iteration_limit = 60
  !> Strength over its saturation that counts as zero; change that ends the iteration.
  real(wp), parameter :: negligible = 1.0e-14_wp

  type, extends(hardening_t) :: teodosiu_hu_t
    private
    !> Initial flow stress, MPa; rate and saturation (MPa) of R.
    real(wp) :: y0 = 0.0_wp, c_r = 0.0_wp, r_sat = 0.0_wp
    !> Rate of X and its initial saturation, MPa.
    real(wp) :: c_x = 0.0_wp, x0 = 0.0_wp
    !> Saturation of S, MPa; rates of S_D and S_L; exponent of the latter.
    real(wp) :: s_sat = 1.0_wp, c_sd = 0.0_wp, c_sl = 0.0_wp, n_l = 0.0_wp
    !> Rate of P and its exponent in g.
    real(wp) :: c_p = 0.0_wp, n_p = 0.0_wp
    !> Fraction of S in the flow stress; weight of S_L in the back-stress.
    real(wp) :: f = 0.0_wp, r = 0.0_wp
  contains
    procedure, nopass :: describe
    procedure, nopass :: describe_internal_variables
    procedure :: set
    procedure :: flow_stress
    procedure :: back_stress
    procedure :: evolve
  end type teodosiu_hu_t

  !> A scalar at the end of an increment with its derivatives in the plastic increment (slope), in N
  !> and, in addition to that through N, in V.
  type :: scalar_t
    real(wp) :: value, slope, by_n(6), by_v(6)
  end type scalar_t

  !> The structures at the end of an increment.
  type :: structure_t
    !> Direction N and the length of V; both zero for V = 0.
    real(wp) :: n(6), length
    !> S at the start and its S_D in the new direction, MPa.
    real(wp) :: strength_start(6, 6), directed_start
    !> |S_L| over its value at the start.
    real(wp) :: kept
    !> exp(-CP dp).
    real(wp) :: decay
    !> S_D, and the squares of |S_L|.
    type(scalar_t) :: directed, latent
  end type structure_t

contains

  subroutine describe(description)
    type(description_t), intent(out) :: description

    description%name = "teodosiu_hu"
    description%title = "Y = Y0 + R + f |S|, follows changes of the strain path; owns a back-stress"
    description%source = "C. Teodosiu, Z. Hu (1998), 19th Riso Symposium; H. Haddadi et al., "// &
        "Int. J. Plasticity 22 (2006) 2226-2271"
    allocate (description%rows, source=[ &
      row("Y0", kind_real, "MPa", "", "initial flow stress", 0.0_wp, lower_open=.true.), &
      row("CR", kind_real, "", "", "rate of R", 0.0_wp), &
      row("Rsat", kind_real, "MPa", "", "saturation of R", 0.0_wp), &
      row("CX", kind_real, "", "", "rate of the back-stress", 0.0_wp), &
      row("X0", kind_real, "MPa", "", "saturation of the back-stress without structures", 0.0_wp), &
      row("Ssat", kind_real, "MPa", "", "saturation of the structures' strength S", 0.0_wp, &
          lower_open=.true.), &
      row("CSD", kind_real, "", "", "rate of the structures that flow forms", 0.0_wp), &
      row("CSL", kind_real, "", "", "rate at which latent structures vanish", 0.0_wp), &
      row("nL", kind_real, "", "", "exponent of the latent structures", 0.0_wp, 100.0_wp), &
      row("CP", kind_real, "", "", "rate of the polarity", 0.0_wp), &
      row("nP", kind_real, "", "", "exponent of the polarity after a reversal", 0.0_wp, &
          1000.0_wp), &
      row("f", kind_real, "", "", "part of S in the flow stress, the rest in the back-stress", &
          0.0_wp, 1.0_wp), &
      row("r", kind_real, "", "", "weight of the latent structures in the back-stress", 0.0_wp)])
    allocate (description%example, source=[ &
      law_value_t("Y0", 120.0_wp), law_value_t("CR", 28.0_wp), law_value_t("Rsat", 80.0_wp), &
      law_value_t("CX", 200.0_wp), law_value_t("X0", 10.0_wp), law_value_t("Ssat", 240.0_wp), &
      law_value_t("CSD", 4.0_wp), law_value_t("CSL", 1.5_wp), law_value_t("nL", 0.5_wp), &
      law_value_t("CP", 2.2_wp), law_value_t("nP", 25.0_wp), law_value_t("f", 0.8_wp), &
      law_value_t("r", 1.0_wp)])
  end subroutine describe

  pure subroutine describe_internal_variables(rows)
    type(internal_variable_t), allocatable, intent(out) :: rows(:)

    allocate (rows(3))
    rows(1) = internal_variable_t("polarity", "", "polarity P of the dislocation structures, "// &
        "Kelvin vector", 6)
    rows(2) = internal_variable_t("back_stress", "MPa", "back-stress X, Kelvin vector", 6)
    rows(3) = internal_variable_t("strength", "MPa", "strength S of the structures, upper "// &
        "triangle of a 6x6 Kelvin matrix by columns", 21)
  end subroutine describe_internal_variables

  subroutine set(self, values)
    class(teodosiu_hu_t), intent(inout) :: self
    type(law_value_t), intent(in) :: values(:)

    self%n_internal = n_own
    self%owns_back_stress = .true.
    self%path_dependent = .true.
    self%y0 = value_of(values, "Y0")
    self%c_r = value_of(values, "CR")
    self%r_sat = value_of(values, "Rsat")
    self%c_x = value_of(values, "CX")
    self%x0 = value_of(values, "X0")
    self%s_sat = value_of(values, "Ssat")
    self%c_sd = value_of(values, "CSD")
    self%c_sl = value_of(values, "CSL")
    self%n_l = value_of(values, "nL")
    self%c_p = value_of(values, "CP")
    self%n_p = value_of(values, "nP")
    self%f = value_of(values, "f")
    self%r = value_of(values, "r")
  end subroutine set

  !> Evaluate the flow stress at the end of a plastic increment.
  pure subroutine flow_stress(self, plastic_strain, start, increment, direction, flow)
    class(teodosiu_hu_t), intent(in) :: self
    real(wp), intent(in) :: plastic_strain, start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(flow_response_t), intent(out) :: flow

    type(structure_t) :: structure
    type(scalar_t) :: strength
    real(wp) :: missing

    call evolve_structure(self, start, increment, direction, structure)
    strength = root_of(structure, 1.0_wp, self%s_sat)
    missing = self%r_sat*exp(-min(self%c_r*(plastic_strain + increment), longest_decay))
    flow%value = self%y0 + self%r_sat - missing + self%f*strength%value
    flow%slope = self%c_r*missing + self%f*strength%slope
    flow%gradient = self%f*gradient_of(strength, structure, direction)
  end subroutine flow_stress

  !> Evaluate the law's own back-stress at the end of a plastic increment.
  pure subroutine back_stress(self, start, increment, direction, back)
    class(teodosiu_hu_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    type(back_response_t), intent(out) :: back

    type(structure_t) :: structure
    type(scalar_t) :: strength
    real(wp) :: normal(6), gradient(6), kept, weight
    integer :: j

    call evolve_structure(self, start, increment, direction, structure)
    strength = root_of(structure, self%r, self%s_sat)
    call relax_back_stress(self%c_x*(self%x0 + (1 - self%f)*strength%value), self%c_x, &
        start(7:12), increment, direction, back)
    if (.not. direction%equivalent > 0.0_wp) return
    call relax(self%c_x, increment, kept, weight)
    normal = weight*self%c_x*(1 - self%f)*kelvin_deviator(direction%stress)/direction%equivalent
    gradient = gradient_of(strength, structure, direction)
    back%slope = back%slope + strength%slope*normal
    do j = 1, 6
      back%gradient(:, j) = back%gradient(:, j) + gradient(j)*normal
    end do
  end subroutine back_stress

  !> Evolve the law's own internal variables over a plastic increment.
  pure subroutine evolve(self, start, increment, direction, evolved)
    class(teodosiu_hu_t), intent(in) :: self
    real(wp), intent(in) :: start(self%n_internal), increment
    type(flow_direction_t), intent(in) :: direction
    real(wp), intent(out) :: evolved(self%n_internal)

    type(structure_t) :: structure
    type(back_response_t) :: back
    real(wp) :: change
    integer :: i, j, k

    call evolve_structure(self, start, increment, direction, structure)
    call self%back_stress(start, increment, direction, back)
    evolved(1:6) = structure%n - (structure%n - start(1:6))*structure%decay
    evolved(7:12) = back%value
    change = structure%directed%value - structure%kept*structure%directed_start
    k = 12
    do j = 1, 6
      do i = 1, j
        k = k + 1
        evolved(k) = structure%kept*start(k) + change*structure%n(i)*structure%n(j)
      end do
    end do
  end subroutine evolve

  !> Evolve the structures over an increment.
  pure subroutine evolve_structure(self, start, increment, direction, structure)
    class(teodosiu_hu_t), intent(in) :: self
    real(wp), intent(in) :: start(n_own), increment
    type(flow_direction_t), intent(in) :: direction
    type(structure_t), intent(out) :: structure

    type(scalar_t) :: directed, polarity, release
    real(wp) :: square

    structure%length = norm2(direction%gradient)
    structure%n = 0.0_wp
    if (structure%length > 0.0_wp) structure%n = direction%gradient/structure%length
    call unpack_strength(start(13:n_own), structure%strength_start)
    square = sum(structure%strength_start**2)
    directed%by_n = matmul(structure%strength_start, structure%n)
    directed%value = dot_product(directed%by_n, structure%n)
    directed%by_n = 2*directed%by_n
    directed%slope = 0.0_wp
    directed%by_v = 0.0_wp
    structure%directed_start = directed%value
    structure%decay = exp(-min(self%c_p*increment, longest_decay))
    polarity%value = 1 - (1 - dot_product(start(1:6), structure%n))*structure%decay
    polarity%slope = self%c_p*(1 - polarity%value)
    polarity%by_n = structure%decay*start(1:6)
    polarity%by_v = 0.0_wp
    release = release_of(self, start(7:12), square, directed, direction%gradient)
    call average_release(self, increment, release)
    square = max(0.0_wp, square - directed%value**2)
    call evolve_latent(self, square, directed, increment, structure)
    call evolve_directed(self, directed, polarity, release, increment, structure%directed)
  end subroutine evolve_structure

  !> Unpack S from its upper triangle, stored by columns.
  pure subroutine unpack_strength(packed, strength)
    real(wp), intent(in) :: packed(21)
    real(wp), intent(out) :: strength(6, 6)

    integer :: i, j, k

    k = 0
    do j = 1, 6
      do i = 1, j
        k = k + 1
        strength(i, j) = packed(k)
        strength(j, i) = packed(k)
      end do
    end do
  end subroutine unpack_strength

  !> Return h of the start in the new direction.
  pure type(scalar_t) function release_of(self, back, square, directed, gradient) result(release)
    class(teodosiu_hu_t), intent(in) :: self
    !> Back-stress X at the start, MPa.
    real(wp), intent(in) :: back(6)
    !> |S|^2 at the start.
    real(wp), intent(in) :: square
    !> S_D at the start.
    type(scalar_t), intent(in) :: directed
    !> V.
    real(wp), intent(in) :: gradient(6)

    real(wp) :: root, saturation, projection

    release = scalar_t(0.5_wp, 0.0_wp, 0.0_wp, 0.0_wp)
    root = sqrt(max(0.0_wp, directed%value**2 + self%r*(square - directed%value**2)))
    saturation = self%x0 + (1 - self%f)*root
    projection = dot_product(back, gradient)
    if (.not. saturation > negligible*self%s_sat) return
    release%value = min(1.0_wp, max(0.0_wp, 0.5_wp*(1 - projection/saturation)))
    if (abs(projection) >= saturation) return
    release%by_v = -0.5_wp*back/saturation
    if (root > negligible*self%s_sat) release%by_n = 0.5_wp*projection/saturation**2*(1 - self%f) &
        *(1 - self%r)*directed%value/root*directed%by_n
  end function release_of

  !> Average h over the increment.
  pure subroutine average_release(self, increment, release)
    class(teodosiu_hu_t), intent(in) :: self
    real(wp), intent(in) :: increment
    !> h of the start, then its mean.
    type(scalar_t), intent(inout) :: release

    real(wp) :: kept, weight, fraction

    release%slope = -0.5_wp*self%c_x*release%value
    if (.not. increment > 0.0_wp) return
    call relax(self%c_x, increment, kept, weight)
    fraction = weight/increment
    release%slope = release%value*(kept - fraction)/increment
    release%value = fraction*release%value
    release%by_n = fraction*release%by_n
    release%by_v = fraction*release%by_v
  end subroutine average_release

  !> Evolve |S_L|^2 over an increment.
  pure subroutine evolve_latent(self, square, directed, increment, structure)
    class(teodosiu_hu_t), intent(in) :: self
    !> |S_L|^2 at the start.
    real(wp), intent(in) :: square
    !> S_D at the start.
    type(scalar_t), intent(in) :: directed
    real(wp), intent(in) :: increment
    !> `latent` and `kept` are set.
    type(structure_t), intent(inout) :: structure

    real(wp) :: length

    length = sqrt(square)/self%s_sat
    if (self%n_l > 0.0_wp) then
      structure%kept = (1 + self%n_l*self%c_sl*increment*length**self%n_l)**(-1/self%n_l)
    else
      structure%kept = exp(-min(self%c_sl*increment, longest_decay))
    end if
    structure%latent%value = structure%kept**2*square
    structure%latent%slope = -2*self%c_sl*(structure%kept*length)**self%n_l*structure%latent%value
    structure%latent%by_n = -2*structure%kept**(self%n_l + 2)*directed%value*directed%by_n
    structure%latent%by_v = 0.0_wp
  end subroutine evolve_latent

  !> Evolve S_D over an increment: Newton's method on s - s_n = CSD dp (g (1 - s) - h s) with
  !> s = S_D/Ssat.
  pure subroutine evolve_directed(self, start, polarity, release, increment, directed)
    class(teodosiu_hu_t), intent(in) :: self
    !> S_D at the start, P_D at the end, h.
    type(scalar_t), intent(in) :: start, polarity, release
    real(wp), intent(in) :: increment
    !> S_D at the end.
    type(scalar_t), intent(out) :: directed

    real(wp) :: s, s_start, change, step, g, by_s, by_p, slope
    integer :: iteration

    s_start = start%value/self%s_sat
    step = self%c_sd*increment
    s = s_start
    do iteration = 1, iteration_limit
      call growth_factor(self, s, polarity%value, g, by_s, by_p)
      slope = 1 - step*(by_s*(1 - s) - g - release%value)
      if (.not. slope > 0.0_wp) slope = 1 + step*(abs(g) + release%value)
      change = -(s - s_start - step*(g*(1 - s) - release%value*s))/slope
      s = min(1.0_wp, max(-1.0_wp, s + change))
      if (abs(change) <= negligible) exit
    end do
    call growth_factor(self, s, polarity%value, g, by_s, by_p)
    slope = self%s_sat/(1 - step*(by_s*(1 - s) - g - release%value))
    directed%value = self%s_sat*s
    directed%slope = slope*(self%c_sd*(g*(1 - s) - release%value*s) &
        + step*(by_p*(1 - s)*polarity%slope - s*release%slope))
    directed%by_n = slope*(start%by_n/self%s_sat + step*by_p*(1 - s)*polarity%by_n &
        - step*s*release%by_n)
    directed%by_v = -slope*step*s*release%by_v
  end subroutine evolve_directed

  !> Evaluate g and its derivatives.
  pure subroutine growth_factor(self, s, polarity, g, by_s, by_p)
    class(teodosiu_hu_t), intent(in) :: self
    !> S_D/Ssat; P_D.
    real(wp), intent(in) :: s, polarity
    !> g, its derivatives in s and in P_D.
    real(wp), intent(out) :: g, by_s, by_p

    real(wp) :: a, power, base

    a = 0.0_wp
    if (self%c_p > 0.0_wp) a = self%c_p/(self%c_sd + self%c_p)
    if (polarity >= 0.0_wp) then
      g = 1 - a*abs(s - polarity)
      by_s = -sign(a, s - polarity)
      by_p = -by_s
    else
      base = max(negligible, 1 + polarity)
      power = base**self%n_p
      g = power*(1 - a*s)
      by_s = -a*power
      by_p = self%n_p*g/base
    end if
  end subroutine growth_factor

  !> Return the square root of S_D^2 + w |S_L|^2.
  pure type(scalar_t) function root_of(structure, weight, saturation) result(root)
    type(structure_t), intent(in) :: structure
    !> The weight w; saturation of S, MPa.
    real(wp), intent(in) :: weight, saturation

    associate (directed => structure%directed, latent => structure%latent)
      root%value = sqrt(directed%value**2 + weight*latent%value)
      if (root%value > negligible*saturation) then
        root%slope = (directed%value*directed%slope + 0.5_wp*weight*latent%slope)/root%value
        root%by_n = (directed%value*directed%by_n + 0.5_wp*weight*latent%by_n)/root%value
        root%by_v = directed%value*directed%by_v/root%value
      else
        root%slope = abs(directed%slope)
        root%by_n = 0.0_wp
        root%by_v = 0.0_wp
      end if
    end associate
  end function root_of

  !> Return the derivative of a scalar in the effective stress.
  pure function gradient_of(scalar, structure, direction) result(gradient)
    type(scalar_t), intent(in) :: scalar
    type(structure_t), intent(in) :: structure
    type(flow_direction_t), intent(in) :: direction
    real(wp) :: gradient(6)

    gradient = scalar%by_v
    if (structure%length > 0.0_wp) gradient = gradient &
        + (scalar%by_n - dot_product(scalar%by_n, structure%n)*structure%n)/structure%length
    gradient = matmul(direction%second, gradient)
  end function gradient_of

end module dd3_material_hardening_teodosiu_hu
