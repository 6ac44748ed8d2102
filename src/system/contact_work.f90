! SPDX-License-Identifier: GPL-3.0-or-later
!> Data of the contact of the candidates in one state, for the residuals and the reduced system.
module dd3_system_contact_work
  use dd3_base_kinds, only : wp
  use dd3_contact_friction, only : sliding_t
  use dd3_contact_operator, only : status_gap
  use dd3_model_contact_data, only : all_faces
  implicit none
  private
  public :: contact_work_t, new_contact_work, open_candidate

  !> Contact of the candidates.
  type :: contact_work_t
    !> One of the `status_*` values, `(n_contact)`.
    integer, allocatable :: status(:)
    !> Nearest tool, `(n_contact)`; 0 if none is within the search distance.
    integer, allocatable :: tool(:)
    !> Distance to the onset of contact, mm, `(n_contact)`; meaningful if there is a tool.
    real(wp), allocatable :: distance(:)
    !> Gap at the onset of contact, mm, `(n_contact)`: the height of the contact layer, or 0 in the
    !> mixed formulation.
    real(wp), allocatable :: onset(:)
    !> Outward normal of the tool, `(3, n_contact)`.
    real(wp), allocatable :: normal(:, :)
    !> Displacement along it relative to the tool since the committed state, mm, `(n_contact)`.
    real(wp), allocatable :: rise(:)
    !> Contact force F_equ by the contact law, N, `(3, n_contact)`.
    real(wp), allocatable :: force(:, :)
    !> D, N/mm, and E: `(3, 3, n_contact)`.
    real(wp), allocatable :: d(:, :, :), e(:, :, :)
    !> Places of the points that move, and their gradients in the displacements of the point and of
    !> one end less the other, `(3, 2, n_contact)`, 1/mm.
    real(wp), allocatable :: place(:), by_place(:, :, :)
    !> Derivative of the force of such a point in the displacement of one end less the other, N/mm,
    !> `(3, 3, n_contact)`.
    real(wp), allocatable :: by_edge(:, :, :)
    !> Whether a point that moves may come to a border in the increment, `(n_contact)`.
    logical, allocatable :: near(:)
    !> Contact in the committed state: tool, `(n_contact)`, its normal and the contact force, N,
    !> `(3, n_contact)`.
    integer, allocatable :: committed_tool(:)
    real(wp), allocatable :: committed_normal(:, :), committed_force(:, :)
    !> Turn of that normal beside the border of the tool, `(n_contact)`.
    real(wp), allocatable :: committed_turn(:)
    !> Whether the normals beside borders turn no farther than that.
    logical :: turn_limited = .false.
    !> Positions of the points in the committed state, and the part of its turn in the displacement
    !> of the tool's point there per progress of the phase, `(3, n_contact)`, mm.
    real(wp), allocatable :: committed_x(:, :), turning(:, :)
    !> Outward normals of the sheet in the committed state for the tools that touch each kind of
    !> faces, `(3, n_contact, all_faces)`, and its areas, `(n_contact, all_faces)`, mm2; not
    !> allocated if no friction depends on them.
    real(wp), allocatable :: outward(:, :, :), area(:, :)
    !> What friction depends on, in the committed state but for the area, `(n_contact)`.
    type(sliding_t), allocatable :: sliding(:)
    !> Distance up to which the tools are looked for, mm.
    real(wp) :: search_distance = 0.0_wp
  end type contact_work_t

contains

  !> Allocate the contact work.
  subroutine new_contact_work(self, n_contact)
    type(contact_work_t), intent(out) :: self
    integer, intent(in) :: n_contact

    allocate (self%status(n_contact), self%tool(n_contact), source=0)
    allocate (self%committed_tool(n_contact), source=0)
    allocate (self%committed_normal(3, n_contact), self%committed_force(3, n_contact), &
        source=0.0_wp)
    allocate (self%distance(n_contact), self%onset(n_contact), self%committed_turn(n_contact), &
        self%rise(n_contact), source=0.0_wp)
    allocate (self%normal(3, n_contact), self%force(3, n_contact), source=0.0_wp)
    allocate (self%place(n_contact), source=0.5_wp)
    allocate (self%by_place(3, 2, n_contact), self%by_edge(3, 3, n_contact), source=0.0_wp)
    allocate (self%near(n_contact), source=.false.)
    allocate (self%sliding(n_contact))
    allocate (self%d(3, 3, n_contact), self%e(3, 3, n_contact), source=0.0_wp)
    allocate (self%outward(3, n_contact, all_faces), self%committed_x(3, n_contact), &
        self%turning(3, n_contact), source=0.0_wp)
  end subroutine new_contact_work

  !> Set a candidate without a tool near it.
  subroutine open_candidate(self, c)
    type(contact_work_t), intent(inout) :: self
    integer, intent(in) :: c

    self%status(c) = status_gap
    self%distance(c) = huge(1.0_wp)
    self%normal(:, c) = 0.0_wp
    self%force(:, c) = 0.0_wp
    self%d(:, :, c) = 0.0_wp
    self%e(:, :, c) = 0.0_wp
    self%by_place(:, :, c) = 0.0_wp
    self%by_edge(:, :, c) = 0.0_wp
  end subroutine open_candidate

end module dd3_system_contact_work
