! SPDX-License-Identifier: GPL-3.0-or-later
!> Lengths of the contact that count as zero, or as far, relative to the thickness and to the size
!> of the sheet. Only the depth of a start inside the sheet, part of the input format, is absolute.
module dd3_model_tolerances
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: tolerances_t, new_tolerances, notable_depth, start_depth, wrong_side_depth, tangential

  !> Depth inside the sheet at which a tool may start, mm.
  real(wp), parameter :: start_depth = 1.0e-3_wp
  !> Depth up to which a start inside the sheet is reported, in thicknesses: a node farther behind a
  !> surface may lie beyond its border.
  real(wp), parameter :: wrong_side_depth = 10.0_wp
  !> Depth of a tool between the contact points that is reported, in thicknesses, and for which an
  !> element is divided.
  real(wp), parameter :: notable_depth = 0.1_wp
  !> Below this |n.f|, of two unit vectors, a force f counts as tangential to the surface.
  real(wp), parameter :: tangential = 1.0e-6_wp

  !> Gap that counts as contact, gap of a pressed tool that counts as closed, advantage of another
  !> tool, and depth that an accepted increment may leave, over the thickness.
  real(wp), parameter :: touching = 1.0e-4_wp, closing = 1.0e-9_wp
  real(wp), parameter :: better = 1.0e-6_wp, remaining = 1.0e-3_wp
  !> Distances up to which a tool is looked for, and at the start, over the diagonal of the sheet.
  real(wp), parameter :: search = 100.0_wp, first_search = 1000.0_wp

  !> Lengths, mm.
  type :: tolerances_t
    !> Gap up to which a tool without contact counts as touching.
    real(wp) :: touch = 0.0_wp
    !> Gap that counts as closed when a pressed tool approaches the sheet.
    real(wp) :: closed = 0.0_wp
    !> A candidate stays with its tool unless another one is nearer by this.
    real(wp) :: hysteresis = 0.0_wp
    !> Distance up to which the predictor and a pressed tool look for contact.
    real(wp) :: tool_search = 0.0_wp
    !> Distance up to which a tool is looked for at the start.
    real(wp) :: start_search = 0.0_wp
    !> Depth inside a tool that an accepted increment may leave.
    real(wp) :: depth = 0.0_wp
    !> Depth down to which a candidate of a committed state is found.
    real(wp) :: committed_depth = 0.0_wp
  end type tolerances_t

contains

  !> Return the tolerances for a sheet.
  pure type(tolerances_t) function new_tolerances(thickness, x) result(self)
    !> Thickness of the sheet, mm.
    real(wp), intent(in) :: thickness
    !> Initial positions of its nodes, `(3, n_node)`, mm.
    real(wp), intent(in) :: x(:, :)

    real(wp) :: diagonal

    diagonal = norm2(maxval(x, dim=2) - minval(x, dim=2))
    self%touch = touching*thickness
    self%closed = closing*thickness
    self%hysteresis = better*thickness
    self%tool_search = search*diagonal
    self%start_search = first_search*diagonal
    self%depth = remaining*thickness
    self%committed_depth = 2.0_wp*max(start_depth, self%depth)
  end function new_tolerances

end module dd3_model_tolerances
