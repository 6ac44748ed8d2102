! SPDX-License-Identifier: GPL-3.0-or-later
!> Length of the elements that tools bend. hex8 with one mean dilatation is too stiff in bending if
!> it is long compared with the thickness of the sheet, whatever the number of layers: its edges
!> stay straight.
!> Source of the numbers: moment of a strip bent to radii of 13 and 64 thicknesses, compared with
!> the exact one (tests/bending_moment).
module dd3_model_element_length
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  implicit none
  private
  public :: element_length_t, measure_elements, excess_moment, longest_known

  !> Moment over the exact one, less 1, of elements of these lengths, in thicknesses.
  integer, parameter :: n_known = 5
  real(wp), parameter :: known_length(n_known) = [0.0_wp, 0.5_wp, 1.0_wp, 2.0_wp, 4.0_wp]
  real(wp), parameter :: known_excess(n_known) = [0.0_wp, 0.03_wp, 0.17_wp, 0.65_wp, 1.8_wp]

  !> Tolerance of the ratio of a length that is the thickness.
  real(wp), parameter :: round_off = 1.0e-9_wp
  !> Length up to which the excess is known, in thicknesses.
  real(wp), parameter :: longest_known = known_length(n_known)

  !> Lengths of the elements at the faces of the sheet that tools can touch.
  type :: element_length_t
    !> Number of elements longer than the thickness.
    integer :: n_long = 0
    !> In thicknesses; 0 without faces.
    real(wp) :: shortest = 0.0_wp, longest = 0.0_wp
  end type element_length_t

contains

  !> Measure the elements, each in the shorter direction of its contact face: a strip is often
  !> meshed finely only in the direction in which it is bent.
  pure function measure_elements(model) result(self)
    type(model_t), intent(in) :: model
    type(element_length_t) :: self

    real(wp) :: edge(3, 4), length(4), ratio
    integer :: f

    if (model%n_tool == 0) return
    if (all(model%is_rim_face)) return
    self%shortest = huge(1.0_wp)
    do f = 1, size(model%contact_face)
      if (model%is_rim_face(f)) cycle
      associate (corner => model%face%corner(:, model%contact_face(f)))
        edge = model%x0(:, corner) - model%x0(:, cshift(corner, 1))
        length = norm2(edge, dim=1)
        ratio = min(length(1) + length(3), length(2) + length(4)) &
            /(2.0_wp*model%thickness_at(corner(1)))
      end associate
      if (ratio > 1.0_wp + round_off) self%n_long = self%n_long + 1
      self%shortest = min(self%shortest, ratio)
      self%longest = max(self%longest, ratio)
    end do
  end function measure_elements

  !> Return the moment over the exact one, less 1, of elements of a length in thicknesses; the last
  !> known value beyond it.
  pure real(wp) function excess_moment(ratio) result(excess)
    real(wp), intent(in) :: ratio

    integer :: i

    excess = known_excess(n_known)
    do i = n_known, 2, -1
      if (ratio < known_length(i)) excess = known_excess(i - 1) &
          + (ratio - known_length(i - 1))/(known_length(i) - known_length(i - 1)) &
          *(known_excess(i) - known_excess(i - 1))
    end do
  end function excess_moment

end module dd3_model_element_length
