! SPDX-License-Identifier: GPL-3.0-or-later
!> Prescribed displacements of the phases. A direction that a phase displaces stays prescribed in
!> later phases, with no further displacement, until one frees it.
module dd3_setup_displacements
  use dd3_base_kinds, only : wp, pi
  use dd3_base_text, only : axis_name
  use dd3_input_case, only : case_t
  use dd3_mesh_mesh, only : mark_directions, mesh_t, placed
  use dd3_model_motions, only : motion_t, new_motion, new_placement
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: set_displacements

contains

  !> Set the prescribed displacements of a phase: directions freed, then directions displaced, which
  !> may be among those freed.
  subroutine set_displacements(case, i, mesh, fixed, led, phase)
    type(case_t), intent(in) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    type(mesh_t), intent(in) :: mesh
    !> Directions that *BOUNDARY prescribes, and those that earlier phases prescribe too,
    !> `(3, n_node)`; gets those of this phase.
    logical, intent(in) :: fixed(:, :)
    logical, intent(inout) :: led(:, :)
    type(phase_t), intent(inout) :: phase

    type(motion_t), allocatable :: motion(:)
    logical :: displaced(3, mesh%n_node)
    integer, allocatable :: node(:), first(:)
    integer :: k, n

    displaced = .false.
    associate (spec => case%phase(i))
      do k = 1, size(spec%free)
        call mark_directions(displaced, mesh%nodes_of(spec%free(k)%set), spec%free(k)%direction)
      end do
      led = led .and. (fixed .or. .not. displaced)
      displaced = .false.
      n = size(spec%motion)
      allocate (motion(n + count(spec%displace%is_coordinate)))
      do k = 1, size(spec%displace)
        associate (axis => spec%displace(k)%axis, value => spec%displace(k)%value)
          node = mesh%nodes_of(spec%displace(k)%set)
          displaced(axis, node) = .true.
          if (spec%displace(k)%is_coordinate) then
            n = n + 1
            call new_placement(motion(n), node, axis, value)
          else
            phase%displacement(axis, node) = value
          end if
        end associate
      end do
      do k = 1, size(spec%motion)
        node = mesh%nodes_of(spec%motion(k)%set)
        first = pack(node, node <= mesh%n_first_node .or. mesh%mesh_number == 0)
        if (size(first) == 0) first = node
        call new_motion(motion(k), node, first, placed(mesh%placement, mesh%x), &
            spec%motion(k)%bends, spec%motion(k)%value, bend_before(case, i, spec%motion(k)%set))
        call mark_directions(displaced, node, motion(k)%prescribes)
      end do
      call move_alloc(motion, phase%motion)
    end associate
    led = led .or. displaced
    call list_kept(case, i, mesh, led .and. .not. (fixed .or. displaced), phase%kept_displacements)
  end subroutine set_displacements

  !> Return the angle to which earlier phases bend a set, rad, unless they end early.
  pure real(wp) function bend_before(case, i, set) result(angle)
    type(case_t), intent(in) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    character(len=*), intent(in) :: set

    integer :: j, k

    angle = 0.0_wp
    do j = 1, i - 1
      do k = 1, size(case%phase(j)%motion)
        associate (motion => case%phase(j)%motion(k), table => case%phase(j)%table)
          if (.not. motion%bends .or. motion%set /= set) cycle
          ! The table may end the phase at a fraction of its motion.
          if (size(table) > 0) then
            angle = angle + table(size(table))*(pi/180.0_wp*motion%value(7) - angle)
          else
            angle = pi/180.0_wp*motion%value(7)
          end if
        end associate
      end do
    end do
  end function bend_before

  !> List the directions that earlier phases displaced and a phase holds.
  subroutine list_kept(case, i, mesh, kept, text)
    type(case_t), intent(in) :: case
    !> Number of the phase.
    integer, intent(in) :: i
    type(mesh_t), intent(in) :: mesh
    !> `(3, n_node)`.
    logical, intent(in) :: kept(:, :)
    character(len=:), allocatable, intent(out) :: text

    integer :: j, k, axis

    text = ""
    do j = 1, i - 1
      associate (spec => case%phase(j))
        do k = 1, size(spec%displace)
          call add(spec%displace(k)%axis, spec%displace(k)%set)
        end do
        do k = 1, size(spec%motion)
          do axis = 1, 3
            call add(axis, spec%motion(k)%set)
          end do
        end do
      end associate
    end do

  contains

    !> Add a direction of a set if it is held, and new in the list.
    subroutine add(axis, set)
      integer, intent(in) :: axis
      character(len=*), intent(in) :: set

      character(len=:), allocatable :: item

      if (.not. any(kept(axis, mesh%nodes_of(set)))) return
      item = axis_name(axis)//" of '"//set//"'"
      if (index(text, item) > 0) return
      if (len(text) > 0) text = text//", "
      text = text//item
    end subroutine add

  end subroutine list_kept

end module dd3_setup_displacements
