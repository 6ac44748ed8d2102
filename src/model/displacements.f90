!> Prescribed displacements of the phases. A direction that a phase displaces stays prescribed in
!> later phases, with no further displacement, until one frees it.
module dd3_model_displacements
  use dd3_input_case, only : case_t
  use dd3_mesh_mesh, only : mark_directions, mesh_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: set_displacements

  character(len=1), parameter :: axis_name(3) = ["x", "y", "z"]

contains

  !> Set the prescribed displacements of a phase: directions freed, then directions displaced, which
  !> may be among those freed.
  subroutine set_displacements(case, i, mesh, led, phase)
    type(case_t), intent(in) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    type(mesh_t), intent(in) :: mesh
    !> Directions that *BOUNDARY and earlier phases prescribe, `(3, n_node)`; gets those of this
    !> phase.
    logical, intent(inout) :: led(:, :)
    type(phase_t), intent(inout) :: phase

    logical :: fixed(3, mesh%n_node), displaced(3, mesh%n_node)
    integer, allocatable :: node(:)
    integer :: k

    fixed = .false.
    do k = 1, size(case%boundary)
      call mark_directions(fixed, mesh%nodes_of(case%boundary(k)%set), case%boundary(k)%fix)
    end do
    displaced = .false.
    associate (spec => case%phase(i))
      do k = 1, size(spec%free)
        call mark_directions(displaced, mesh%nodes_of(spec%free(k)%set), spec%free(k)%direction)
      end do
      led = led .and. (fixed .or. .not. displaced)
      displaced = .false.
      do k = 1, size(spec%displace)
        node = mesh%nodes_of(spec%displace(k)%set)
        displaced(spec%displace(k)%axis, node) = .true.
        phase%displacement(spec%displace(k)%axis, node) = spec%displace(k)%value
      end do
    end associate
    led = led .or. displaced
    call list_kept(case, i, mesh, led .and. .not. (fixed .or. displaced), phase%kept_displacements)
  end subroutine set_displacements

  !> List the directions that earlier phases displaced and a phase holds.
  subroutine list_kept(case, i, mesh, kept, text)
    type(case_t), intent(in) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    type(mesh_t), intent(in) :: mesh
    !> `(3, n_node)`.
    logical, intent(in) :: kept(:, :)
    character(len=:), allocatable, intent(out) :: text

    character(len=:), allocatable :: item
    integer :: j, k

    text = ""
    do j = 1, i - 1
      do k = 1, size(case%phase(j)%displace)
        associate (displace => case%phase(j)%displace(k))
          if (.not. any(kept(displace%axis, mesh%nodes_of(displace%set)))) cycle
          item = axis_name(displace%axis)//" of '"//displace%set//"'"
          if (index(text, item) > 0) cycle
          if (len(text) > 0) text = text//", "
          text = text//item
        end associate
      end do
    end do
  end subroutine list_kept

end module dd3_model_displacements
