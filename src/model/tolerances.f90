!> Tolerances of lengths and directions, and search distances.
module dd3_model_tolerances
  use dd3_base_kinds, only : wp
  implicit none
  private
  public :: start_depth, start_search, wrong_side_depth, touch, closed, hysteresis, tool_search, &
      tangential

  !> Depth inside the sheet at which a tool may start, mm.
  real(wp), parameter :: start_depth = 1.0e-3_wp
  !> Distance up to which a tool is looked for at the start, mm.
  real(wp), parameter :: start_search = 1.0e4_wp
  !> Depth up to which a start inside the sheet is reported, divided by the thickness: a node deeper
  !> behind a surface can lie beyond its border.
  real(wp), parameter :: wrong_side_depth = 10.0_wp
  !> Gap up to which a tool without contact counts as touching, mm.
  real(wp), parameter :: touch = 1.0e-4_wp
  !> Gap that counts as closed when a pressed tool approaches the sheet, mm.
  real(wp), parameter :: closed = 1.0e-9_wp
  !> A candidate stays with its tool unless another one is nearer by this, mm.
  real(wp), parameter :: hysteresis = 1.0e-6_wp
  !> Distance up to which the predictor and a pressed tool look for contact, mm.
  real(wp), parameter :: tool_search = 1.0e3_wp
  !> Below this |n.f|, of two unit vectors, a force f counts as tangential to the surface.
  real(wp), parameter :: tangential = 1.0e-6_wp

end module dd3_model_tolerances
