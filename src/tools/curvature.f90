! SPDX-License-Identifier: GPL-3.0-or-later
!> Curvature of a surface.
!> Source: Farin, Curves and Surfaces for CAGD, 5th ed. (2002), chapter 19 (fundamental forms).
module dd3_tools_curvature
  use dd3_base_kinds, only : wp
  use dd3_tools_bezier, only : evaluate, n_sample, patch_t, unit_normal
  use dd3_tools_surface, only : surface_t
  implicit none
  private
  public :: smallest_radius

contains

  !> Return the smallest convex radius of curvature near a point, from a grid of points on each
  !> patch, mm; huge if the surface is not convex there.
  pure real(wp) function smallest_radius(surface, x, distance) result(radius)
    type(surface_t), intent(in) :: surface
    real(wp), intent(in) :: x(3)
    !> Distance from the point up to which the surface is examined, mm. A patch is examined at least
    !> at the spacing of its grid.
    real(wp), intent(in) :: distance

    real(wp) :: largest, range, point(3), curvature
    integer :: k, i, j

    largest = 0.0_wp
    do k = 1, size(surface%patch)
      associate (patch => surface%patch(k))
        if (patch%flat) cycle
        range = distance + patch%size/n_sample
        if (any(patch%lower > x + range .or. patch%upper < x - range)) cycle
        do j = 0, n_sample
          do i = 0, n_sample
            call convex_curvature(patch, real([i, j], wp)/n_sample, point, curvature)
            if (sum((point - x)**2) <= range**2) largest = max(largest, curvature)
          end do
        end do
      end associate
    end do
    radius = huge(1.0_wp)
    if (largest*surface%size > epsilon(1.0_wp)**0.5_wp) radius = 1.0_wp/largest
  end function smallest_radius

  !> Evaluate a point and its largest principal curvature, positive if convex, 1/mm; 0 at a pole.
  pure subroutine convex_curvature(patch, uv, point, curvature)
    type(patch_t), intent(in) :: patch
    real(wp), intent(in) :: uv(2)
    real(wp), intent(out) :: point(3), curvature

    real(wp) :: first(3, 2), second(3, 3), normal(3), a(3), b(3), determinant, mean, gauss
    logical :: regular

    curvature = 0.0_wp
    call evaluate(patch, uv(1), uv(2), point, first, second)
    call unit_normal(patch, first, normal, regular)
    if (.not. regular) return
    a = [sum(first(:, 1)**2), sum(first(:, 2)**2), dot_product(first(:, 1), first(:, 2))]
    b = -matmul(normal, second)
    determinant = a(1)*a(2) - a(3)**2
    mean = 0.5_wp*(a(1)*b(2) + a(2)*b(1) - 2.0_wp*a(3)*b(3))/determinant
    gauss = (b(1)*b(2) - b(3)**2)/determinant
    curvature = mean + sqrt(max(mean**2 - gauss, 0.0_wp))
  end subroutine convex_curvature

end module dd3_tools_curvature
