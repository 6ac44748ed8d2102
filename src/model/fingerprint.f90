! SPDX-License-Identifier: GPL-3.0-or-later
!> Fingerprint of a model: a check sum for each part of it that a restart must find unchanged. What
!> may change between a run and its continuation (limits, tolerances, penalty, solver, output) does
!> not enter.
module dd3_model_fingerprint
  use dd3_base_digest, only : digest_t
  use dd3_base_kinds, only : wp
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  use dd3_model_terms_drawbead, only : drawbead_t
  implicit none
  private
  public :: fingerprint_t, model_fingerprint, changed_parts, sheet_digests, tool_digest

  !> Check sum of one part of a model.
  type :: fingerprint_t
    !> The part as messages call it: `the mesh`, `tool 'punch'`.
    character(len=80) :: part = ""
    integer :: digest = 0
  end type fingerprint_t

  !> Name of the first part. Those that refer to its nodes are not compared if it differs.
  character(len=*), parameter :: mesh_part = "the mesh or the place of the sheet"

contains

  !> Return the fingerprint of all parts that were in use up to a phase.
  function model_fingerprint(model, last_phase) result(fingerprint)
    type(model_t), intent(in) :: model
    !> Number of the last phase that counts.
    integer, intent(in) :: last_phase
    type(fingerprint_t), allocatable :: fingerprint(:)

    type(digest_t) :: supports
    integer :: i

    allocate (fingerprint(0))
    call add(fingerprint, mesh_part, mesh_digest(model))
    call supports%add(reshape(model%fixed, [size(model%fixed)]))
    call add(fingerprint, "the supports (*BOUNDARY)", supports%value())
    do i = 1, size(model%material)
      call add(fingerprint, "material '"//trim(model%material_name(i))//"'", &
          model%material_digest(i))
    end do
    do i = 1, model%n_tool
      call add(fingerprint, "tool '"//model%tool(i)%name//"'", model%tool_digest(i))
    end do
    do i = 1, n_first_set(model)
      call add(fingerprint, "set '"//model%set(i)%name//"'", model%first_digest(1 + i))
    end do
    do i = 1, size(model%drawbead)
      call add(fingerprint, "draw-bead '"//model%drawbead(i)%name//"'", &
          drawbead_digest(model%drawbead(i)))
    end do
    do i = 1, min(last_phase, size(model%phase))
      call add(fingerprint, "phase '"//model%phase(i)%name//"'", phase_digest(model, i))
    end do
  end function model_fingerprint

  !> Append the check sum of a part.
  subroutine add(fingerprint, part, digest)
    type(fingerprint_t), allocatable, intent(inout) :: fingerprint(:)
    character(len=*), intent(in) :: part
    integer, intent(in) :: digest

    fingerprint = [fingerprint, fingerprint_t(part, digest)]
  end subroutine add

  !> Return the parts that differ between two fingerprints, separated by commas; empty if none does.
  !> With different meshes only the materials are compared besides.
  function changed_parts(before, now) result(names)
    type(fingerprint_t), intent(in) :: before(:), now(:)
    character(len=:), allocatable :: names

    integer :: i, k
    logical :: same_mesh

    k = findloc(before%part, mesh_part, dim=1)
    same_mesh = .false.
    if (k > 0) same_mesh = before(k)%digest == now(1)%digest
    names = ""
    do i = 1, size(now)
      if (.not. same_mesh .and. refers_to_mesh(now(i)%part)) cycle
      k = findloc(before%part, now(i)%part, dim=1)
      if (k == 0) then
        names = names//", "//trim(now(i)%part)//" (new)"
      else if (before(k)%digest /= now(i)%digest) then
        names = names//", "//trim(now(i)%part)
      end if
    end do
    do i = 1, size(before)
      if (.not. same_mesh .and. refers_to_mesh(before(i)%part)) cycle
      if (any(now%part == before(i)%part)) cycle
      names = names//", "//trim(before(i)%part)//" (missing)"
    end do
    if (len(names) > 0) names = names(3:)
  end function changed_parts

  !> Whether a part has node numbers in it.
  pure logical function refers_to_mesh(part)
    character(len=*), intent(in) :: part

    refers_to_mesh = part /= mesh_part .and. index(part, "material ") /= 1
  end function refers_to_mesh

  !> Return the number of node sets whose nodes before the first refinement must be the same. A
  !> restart does not search their nodes anew on the refined sheet.
  pure integer function n_first_set(model)
    type(model_t), intent(in) :: model

    n_first_set = 0
    if (allocated(model%first_digest)) n_first_set = size(model%first_digest) - 1
  end function n_first_set

  !> Return the check sums of the mesh and of the node sets, `(1 + n_set)`.
  function sheet_digests(model) result(value)
    type(model_t), intent(in) :: model
    integer, allocatable :: value(:)

    type(digest_t) :: digest
    integer :: i

    value = [mesh_digest(model)]
    do i = 1, size(model%set)
      digest = digest_t()
      call digest%add(model%set(i)%node)
      value = [value, digest%value()]
    end do
  end function sheet_digests

  !> Return the check sum of nodes, elements, materials of the elements, material axes and of the
  !> place where the job begins; of a refined sheet also that of the mesh before.
  integer function mesh_digest(model)
    type(model_t), intent(in) :: model

    type(digest_t) :: digest

    call digest%add(trim(model%element%name))
    if (model%element%n_thickness_point > 0) call digest%add([model%element%n_thickness_point])
    call digest%add(reshape(model%x0, [size(model%x0)]))
    call digest%add(reshape(model%connectivity, [size(model%connectivity)]))
    call digest%add(model%material_of)
    call digest%add(reshape(model%axes, [size(model%axes)]))
    if (allocated(model%x_start)) then
      call digest%add(reshape(model%placement, [size(model%placement)]))
      call digest%add(reshape(model%x_start, [size(model%x_start)]))
    end if
    if (allocated(model%first_digest)) call digest%add(model%first_digest(:1))
    mesh_digest = digest%value()
  end function mesh_digest

  !> Return the check sum of a tool's surface, friction, position and candidates, of a model with
  !> the contact points of all ranks.
  integer function tool_digest(model, tool)
    type(model_t), intent(in) :: model
    integer, intent(in) :: tool

    type(digest_t) :: digest
    integer :: i

    associate (this => model%tool(tool))
      do i = 1, size(this%surface%patch)
        associate (patch => this%surface%patch(i))
          call digest%add(patch%degree)
          call digest%add(patch%centre)
          call digest%add(reshape(patch%homogeneous, [size(patch%homogeneous)]))
        end associate
      end do
      call digest%add([this%friction%numbers(), this%compliance, this%position])
    end associate
    call digest%add(pack(model%contact_node, model%candidate(tool, :)))
    tool_digest = digest%value()
  end function tool_digest

  !> Return the check sum of a draw-bead's line, law and tool.
  integer function drawbead_digest(bead)
    type(drawbead_t), intent(in) :: bead

    type(digest_t) :: digest

    call digest%add([bead%tool, bead%from])
    call digest%add([bead%normal, bead%stiffness])
    call digest%add(reshape(bead%table, [size(bead%table)]))
    call digest%add(reshape(bead%line, [size(bead%line)]))
    drawbead_digest = digest%value()
  end function drawbead_digest

  !> Return the check sum of what a phase does: motions, loads with their nodes, and early end. What
  !> it takes over from the model or from the phase before is left to their check sums.
  integer function phase_digest(model, number)
    type(model_t), intent(in) :: model
    integer, intent(in) :: number

    type(digest_t) :: digest
    logical, allocatable :: prescribed(:, :)
    integer :: s, tool

    associate (phase => model%phase(number))
      call digest%add([phase%control, phase%until%kind, phase%until%tool, &
          merge(1, 0, phase%unloaded)])
      call digest%add([phase%length, phase%duration, phase%until%value])
      do tool = 1, model%n_tool
        call add_tool(digest, phase, tool, model%tool(tool)%name)
      end do
      prescribed = phase%led() .and. .not. model%fixed
      call digest%add(reshape(prescribed, [size(prescribed)]))
      call digest%add(reshape(phase%displacement, [size(phase%displacement)]))
      do s = 1, size(model%load_set)
        if (phase%loads%keeps(s)) cycle
        call digest%add(phase%loads%final(:, s))
        call digest%add(model%load_set(s)%node)
      end do
      do s = 1, size(model%pressure_set)
        if (phase%pressures%keeps(s)) cycle
        call digest%add([phase%pressures%final(s)])
        call digest%add(reshape(model%pressure_set(s)%node, [size(model%pressure_set(s)%node)]))
      end do
      do s = 1, size(phase%motion)
        associate (motion => phase%motion(s))
          call digest%add([motion%bends, motion%places, motion%prescribes])
          call digest%add([motion%point, motion%axis, motion%before, motion%angle])
          call digest%add([motion%coordinate])
          call digest%add(motion%node)
        end associate
      end do
      call digest%add([phase%mixed])
      call digest%add([phase%layer])
      call add_table(digest, "table", phase%table)
      call add_table(digest, "move", phase%move_table)
      call add_table(digest, "turn", phase%turn_table)
      call add_table(digest, "press", phase%press_table)
    end associate
    phase_digest = digest%value()
  end function phase_digest

  !> Add a table, if there is one.
  subroutine add_table(digest, name, table)
    type(digest_t), intent(inout) :: digest
    character(len=*), intent(in) :: name
    real(wp), allocatable, intent(in) :: table(:, :)

    if (.not. allocated(table)) return
    call digest%add(name)
    call digest%add(reshape(table, [size(table)]))
  end subroutine add_table

  !> Add what a phase does with a tool, unless the tool is only held.
  subroutine add_tool(digest, phase, tool, name)
    type(digest_t), intent(inout) :: digest
    type(phase_t), intent(in) :: phase
    integer, intent(in) :: tool
    character(len=*), intent(in) :: name

    logical :: held
    integer :: k

    held = phase%active(tool) .and. .not. phase%pressed(tool)
    if (held .and. .not. phase%moves(tool)) return
    call digest%add(name)
    if (phase%turns(tool)) then
      call digest%add([phase%turn(tool)%centre, phase%turn(tool)%axis, phase%turn(tool)%angle])
    end if
    if (phase%tilts(tool)) call digest%add([phase%tilt(tool)%pivot, phase%tilt(tool)%stiffness])
    associate (cushion => phase%cushion(tool))
      if (allocated(cushion%share)) call digest%add([pack(cushion%place, .true.), cushion%share])
      if (allocated(cushion%table)) call digest%add(pack(cushion%table, .true.))
    end associate
    do k = 1, size(phase%spacer)
      associate (spacer => phase%spacer(k))
        if (spacer%tool == tool) call digest%add([real(spacer%other, wp), spacer%stiffness, &
            spacer%place, spacer%limit])
      end associate
    end do
    call digest%add([phase%pressed(tool), phase%active(tool), phase%withdrawn(tool), &
        phase%keeps_tool_load(tool)])
    call digest%add([phase%move(:, tool), phase%direction(:, tool)])
    if (phase%gap_other(tool) > 0) call digest%add([phase%gap_offset(tool)])
    if (.not. phase%keeps_tool_load(tool)) call digest%add(phase%tool_load_end(:, tool))
  end subroutine add_tool

end module dd3_model_fingerprint
