!> Fingerprint of a model: a check sum for each part of it that a restart must find unchanged. What
!> may change between a run and its continuation (limits, tolerances, penalty, solver, output) does
!> not enter.
module dd3_model_fingerprint
  use dd3_base_digest, only : digest_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: fingerprint_t, model_fingerprint, changed_parts

  !> Check sum of one part of a model.
  type :: fingerprint_t
    !> The part as messages call it: `the mesh`, `tool 'punch'`.
    character(len=80) :: part = ""
    integer :: digest = 0
  end type fingerprint_t

contains

  !> Return the fingerprint of all parts that were in use up to a phase.
  function model_fingerprint(model, last_phase) result(fingerprint)
    type(model_t), intent(in) :: model
    !> Number of the last phase that counts.
    integer, intent(in) :: last_phase
    type(fingerprint_t), allocatable :: fingerprint(:)

    integer :: i

    allocate (fingerprint(0))
    call add(fingerprint, "the mesh", mesh_digest(model))
    call add(fingerprint, "the supports (*BOUNDARY)", supports_digest(model))
    do i = 1, size(model%material)
      call add(fingerprint, "material '"//trim(model%material_name(i))//"'", &
          model%material_digest(i))
    end do
    do i = 1, model%n_tool
      call add(fingerprint, "tool '"//model%tool(i)%name//"'", tool_digest(model, i))
    end do
    do i = 1, min(last_phase, size(model%phase))
      call add(fingerprint, "phase '"//model%phase(i)%name//"'", phase_digest(model%phase(i)))
    end do
  end function model_fingerprint

  !> Append the check sum of a part.
  subroutine add(fingerprint, part, digest)
    type(fingerprint_t), allocatable, intent(inout) :: fingerprint(:)
    character(len=*), intent(in) :: part
    integer, intent(in) :: digest

    type(fingerprint_t) :: item

    item%part = part
    item%digest = digest
    fingerprint = [fingerprint, item]
  end subroutine add

  !> Return the parts that differ between two fingerprints, separated by commas; empty if none does.
  function changed_parts(before, now) result(names)
    type(fingerprint_t), intent(in) :: before(:), now(:)
    character(len=:), allocatable :: names

    integer :: i, k

    names = ""
    do i = 1, size(now)
      k = findloc(before%part, now(i)%part, dim=1)
      if (k == 0) then
        names = names//", "//trim(now(i)%part)//" (new)"
      else if (before(k)%digest /= now(i)%digest) then
        names = names//", "//trim(now(i)%part)
      end if
    end do
    do i = 1, size(before)
      if (any(now%part == before(i)%part)) cycle
      names = names//", "//trim(before(i)%part)//" (missing)"
    end do
    if (len(names) > 0) names = names(3:)
  end function changed_parts

  !> Return the check sum of nodes, elements, materials of the elements and material axes.
  integer function mesh_digest(model)
    type(model_t), intent(in) :: model

    type(digest_t) :: digest

    call digest%add(trim(model%element%name))
    call digest%add(reshape(model%x0, [size(model%x0)]))
    call digest%add(reshape(model%connectivity, [size(model%connectivity)]))
    call digest%add(model%material_of)
    call digest%add(reshape(model%axes, [size(model%axes)]))
    mesh_digest = digest%value()
  end function mesh_digest

  !> Return the check sum of the supports that hold in every phase.
  integer function supports_digest(model)
    type(model_t), intent(in) :: model

    type(digest_t) :: digest

    call digest%add(reshape(model%fixed, [size(model%fixed)]))
    supports_digest = digest%value()
  end function supports_digest

  !> Return the check sum of a tool's surface, friction, position and candidates.
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
      call digest%add([this%friction, this%position])
    end associate
    call digest%add(pack(model%contact_node, model%candidate(tool, :)))
    tool_digest = digest%value()
  end function tool_digest

  !> Return the check sum of what a phase does: motions, loads and early end.
  integer function phase_digest(phase)
    type(phase_t), intent(in) :: phase

    type(digest_t) :: digest

    call digest%add([phase%control, phase%until%kind, phase%until%tool])
    call digest%add([phase%length, phase%until%value])
    call digest%add(reshape(phase%move, [size(phase%move)]))
    call digest%add(phase%pressed)
    call digest%add(phase%keeps_tool_load)
    call digest%add(reshape(phase%tool_load_end, [size(phase%tool_load_end)]))
    call digest%add(reshape(phase%direction, [size(phase%direction)]))
    call digest%add(phase%active)
    call digest%add(reshape(phase%prescribed, [size(phase%prescribed)]))
    call digest%add(reshape(phase%displacement, [size(phase%displacement)]))
    call digest%add(reshape(pack(phase%load_end, spread(.not. phase%keeps_load, 1, 3)), &
                            [3*count(.not. phase%keeps_load)]))
    phase_digest = digest%value()
  end function phase_digest

end module dd3_model_fingerprint
