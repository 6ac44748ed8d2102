! SPDX-License-Identifier: GPL-3.0-or-later
!> The sheet before the first phase: its mesh, and the state that an earlier run has left in it.
module dd3_sheet_sheet
  use dd3_base_kinds, only : pi, wp
  use dd3_base_message, only : message_list_t
  use dd3_base_text, only : text_t
  use dd3_linalg_tensor, only : rotation_about
  use dd3_mesh_mesh, only : mesh_t
  implicit none
  private
  public :: sheet_t, new_flat_sheet

  real(wp), parameter :: degree = pi/180.0_wp

  !> A sheet. Its mesh has the initial coordinates; the materials of its elements are positions in
  !> `material`.
  type :: sheet_t
    type(mesh_t) :: mesh
    !> Element type, and integration points through its thickness, 0 if they are fixed.
    character(len=:), allocatable :: element
    integer :: thickness_points = 0
    !> Names of the materials, and the check sums of their parameters.
    type(text_t), allocatable :: material(:)
    integer, allocatable :: digest(:)
    !> Their axes as in `model_t`, `(3, 3, :)`; not allocated if unknown.
    real(wp), allocatable :: axes(:, :, :)
    !> Positions of the nodes, `(3, n_node)`, mm.
    real(wp), allocatable :: x(:, :)
    !> Their positions at other times, `(3, n_node, :)`, mm; not allocated without.
    real(wp), allocatable :: earlier(:, :, :)
    !> Whether the sheet has the state below; it is unstressed otherwise.
    logical :: has_state = .false.
    !> As in `state_t`: Cauchy stress and internal variables in the material frame,
    !> `(6, n_point, n_element)`, MPa, and `(n_internal, n_point, n_element)`; orthotropy axes,
    !> `(3, 3, n_point, n_element)`.
    real(wp), allocatable :: stress(:, :, :), internal_variables(:, :, :), orientation(:, :, :, :)
    !> What has been done to it, for the log, a line each.
    character(len=:), allocatable :: report
    !> Of its cuts.
    type(message_list_t) :: warnings
  contains
    procedure :: place
  end type sheet_t

contains

  !> Make an unstressed sheet of a mesh, whose materials are those of the case.
  pure subroutine new_flat_sheet(self, mesh)
    type(sheet_t), intent(out) :: self
    type(mesh_t), intent(in) :: mesh

    self%mesh = mesh
    self%x = mesh%x
    allocate (self%material(0), self%digest(0))
    self%element = ""
    self%report = ""
    if (allocated(mesh%report)) self%report = mesh%report
  end subroutine new_flat_sheet

  !> Move the sheet as a rigid body: turns one after another, then a displacement.
  pure subroutine place(self, turn, move)
    class(sheet_t), intent(inout) :: self
    !> Point and direction of the axis, mm, and angle, degrees, `(7, n)`.
    real(wp), intent(in) :: turn(:, :)
    !> mm.
    real(wp), intent(in) :: move(3)

    real(wp) :: rotation(3, 3), centre(3)
    integer :: e, i, p

    do i = 1, size(turn, 2)
      ! A turn about no axis is an error of the input.
      if (.not. norm2(turn(4:6, i)) > 0.0_wp) cycle
      centre = turn(:3, i)
      rotation = rotation_about(turn(4:6, i)/norm2(turn(4:6, i)), degree*turn(7, i))
      self%x = spread(centre, 2, size(self%x, 2)) &
          + matmul(rotation, self%x - spread(centre, 2, size(self%x, 2)))
      associate (placement => self%mesh%placement)
        placement(:, 4) = placement(:, 4) - centre
        placement = matmul(rotation, placement)
        placement(:, 4) = placement(:, 4) + centre
      end associate
      if (.not. self%has_state) cycle
      do e = 1, size(self%orientation, 4)
        do p = 1, size(self%orientation, 3)
          self%orientation(:, :, p, e) = matmul(rotation, self%orientation(:, :, p, e))
        end do
      end do
    end do
    self%x = self%x + spread(move, 2, size(self%x, 2))
    self%mesh%placement(:, 4) = self%mesh%placement(:, 4) + move
  end subroutine place

end module dd3_sheet_sheet
