! SPDX-License-Identifier: GPL-3.0-or-later
!> Builds the mesh of a case: nodes and elements of the blank or of the mesh file, then the node
!> sets of the input; checks the prescribed displacements and the directions that are free again.
module dd3_mesh_build
  use dd3_base_kinds, only : wp
  use dd3_base_error, only : error_list_t, location_t
  use dd3_base_text, only : axis_name, text_t
  use dd3_input_block, only : deck_t
  use dd3_input_case, only : case_t, motion_spec_t, phase_spec_t
  use dd3_input_reference, only : check_references
  use dd3_input_table, only : block_table
  use dd3_mesh_blank, only : new_blank_mesh
  use dd3_mesh_inp_mesh, only : new_inp_mesh
  use dd3_mesh_mesh, only : mark_directions, mesh_t
  use dd3_mesh_regions, only : new_weld_lines, set_regions
  use dd3_mesh_round_blank, only : new_round_mesh
  use dd3_mesh_select, only : add_set
  use dd3_mesh_weld_line, only : weld_line_t
  implicit none
  private
  public :: new_mesh, add_sets

  character(len=*), parameter :: directions_led = &
      "directions that `displace` led in an earlier phase"

contains

  !> Build the mesh of the blank or of the mesh file. It is complete only if no error was added.
  subroutine new_mesh(mesh, case, natural, errors)
    type(mesh_t), intent(out) :: mesh
    !> Without errors.
    type(case_t), intent(in) :: case
    !> Natural coordinates of the element's nodes, `(3, n_element_node)`.
    real(wp), intent(in) :: natural(:, :)
    type(error_list_t), intent(inout) :: errors

    type(weld_line_t), allocatable :: line(:)
    integer :: before

    if (size(case%mesh) > 0) then
      call new_inp_mesh(mesh, case%mesh(1), natural, errors)
      return
    end if
    before = errors%count
    call new_weld_lines(line, case, errors)
    if (errors%count > before) return
    if (case%blank(1)%radius > 0.0_wp) then
      call new_round_mesh(mesh, case%blank(1), natural)
    else
      call new_blank_mesh(mesh, case%blank(1), natural, line)
    end if
    call set_regions(mesh, case, line, natural, errors)
  end subroutine new_mesh

  !> Add the node sets of the input to a mesh, and check what is prescribed for them.
  subroutine add_sets(mesh, case, errors)
    type(mesh_t), intent(inout) :: mesh
    !> Without errors.
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    logical, allocatable :: held(:, :), led(:, :)
    integer :: i, before

    before = errors%count
    if (size(case%blank) == 0) call check_sets(mesh, case, errors)
    if (errors%count > before) return
    do i = 1, size(case%set)
      call add_set(mesh, case%set(i), errors)
    end do
    if (errors%count > before) return
    allocate (held(3, mesh%n_node), led(3, mesh%n_node), source=.false.)
    do i = 1, size(case%boundary)
      call mark_directions(held, mesh%nodes_of(case%boundary(i)%set), case%boundary(i)%fix)
    end do
    do i = 1, size(case%phase)
      call check_freed(mesh, case%phase(i), held, led, errors)
      call check_displacements(mesh, case%phase(i), held, led, errors)
    end do
  end subroutine add_sets

  !> Check the names of sets in the input, now that those of the sheet are known.
  subroutine check_sets(mesh, case, errors)
    type(mesh_t), intent(in) :: mesh
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    type(deck_t) :: deck
    type(text_t) :: name(size(mesh%set))
    integer :: i

    do i = 1, size(name)
      name(i)%s = mesh%set(i)%name
    end do
    deck = case%deck
    call check_references(deck, block_table(), errors, name)
  end subroutine check_sets

  !> Report freed directions that no earlier phase displaced.
  subroutine check_freed(mesh, phase, held, led, errors)
    type(mesh_t), intent(in) :: mesh
    type(phase_spec_t), intent(in) :: phase
    !> Directions fixed by *BOUNDARY, `(3, n_node)`.
    logical, intent(in) :: held(:, :)
    !> Directions that an earlier phase displaced, `(3, n_node)`; gets those that stay so.
    logical, intent(inout) :: led(:, :)
    type(error_list_t), intent(inout) :: errors

    integer, allocatable :: node(:)
    integer :: i, axis

    do i = 1, size(phase%free)
      node = mesh%nodes_of(phase%free(i)%set)
      do axis = 1, 3
        if (.not. phase%free(i)%direction(axis)) cycle
        if (all(held(axis, node))) then
          call errors%push_input(phase%free(i)%at, "'"//phase%free(i)%set//"' is fixed along "// &
              axis_name(axis)//" in every phase by *BOUNDARY", directions_led, code="E145")
        else if (.not. any(led(axis, node))) then
          call errors%push_input(phase%free(i)%at, "no earlier phase displaces '"// &
              phase%free(i)%set//"' along "//axis_name(axis), directions_led, code="E145")
        end if
        led(axis, node) = .false.
      end do
    end do
  end subroutine check_freed

  !> Report motions of nodes that are fixed by a boundary condition, or that have two of them.
  subroutine check_displacements(mesh, phase, held, led, errors)
    type(mesh_t), intent(in) :: mesh
    type(phase_spec_t), intent(in) :: phase
    !> Directions fixed by *BOUNDARY, `(3, n_node)`.
    logical, intent(in) :: held(:, :)
    !> Directions that an earlier phase displaced, `(3, n_node)`; gets those of this phase.
    logical, intent(inout) :: led(:, :)
    type(error_list_t), intent(inout) :: errors

    logical :: moved(3, mesh%n_node)
    integer :: i, axis

    moved = .false.
    do i = 1, size(phase%displace)
      associate (this => phase%displace(i))
        call check_direction(mesh, this%set, this%at, this%axis, held .and. &
            (this%is_coordinate .or. abs(this%value) > 0.0_wp), moved, errors)
      end associate
    end do
    do i = 1, size(phase%motion)
      associate (this => phase%motion(i))
        do axis = 1, 3
          if (is_along(this%value(4:6), axis)) cycle
          call check_direction(mesh, this%set, this%at, axis, held, moved, errors)
        end do
        if (this%bends) call check_length(mesh, this, errors)
      end associate
    end do
    led = led .or. (moved .and. .not. held)
  end subroutine check_displacements

  !> Report a prescribed motion along an axis of nodes that are fixed, or that have another one.
  subroutine check_direction(mesh, set, at, axis, held, moved, errors)
    type(mesh_t), intent(in) :: mesh
    character(len=*), intent(in) :: set
    !> Where the motion is given.
    type(location_t), intent(in) :: at
    integer, intent(in) :: axis
    !> Directions fixed by *BOUNDARY, `(3, n_node)`.
    logical, intent(in) :: held(:, :)
    !> Directions that the phase displaces, `(3, n_node)`; gets those of this motion.
    logical, intent(inout) :: moved(:, :)
    type(error_list_t), intent(inout) :: errors

    integer, allocatable :: node(:)

    node = mesh%nodes_of(set)
    if (any(held(axis, node))) then
      call errors%push_input(at, "a node of '"//set//"' is fixed along "//axis_name(axis)// &
          " by *BOUNDARY", "nodes that are free in this direction", code="E145")
    else if (any(moved(axis, node))) then
      call errors%push_input(at, "a node of '"//set//"' is displaced twice along "// &
          axis_name(axis)//" in this phase", &
          "one of displace, place, rotate and bend for each node", code="E122")
    end if
    moved(axis, node) = .true.
  end subroutine check_direction

  !> Report a bar that is bent and has no length: its fixed end is at its end section.
  subroutine check_length(mesh, motion, errors)
    type(mesh_t), intent(in) :: mesh
    type(motion_spec_t), intent(in) :: motion
    type(error_list_t), intent(inout) :: errors

    real(wp) :: line(3), axis(3)
    integer, allocatable :: node(:)
    integer :: i

    if (.not. norm2(motion%value(4:6)) > 0.0_wp) return
    node = mesh%nodes_of(motion%set)
    axis = motion%value(4:6)/norm2(motion%value(4:6))
    line = [(sum(mesh%x(i, node)), i=1, 3)]/real(size(node), wp) - motion%value(:3)
    line = line - dot_product(line, axis)*axis
    if (norm2(line) > 1.0e-6_wp*mesh%model_size()) return
    call errors%push_input(motion%at, "the bar has no length across the axis, from the point "// &
        "to the mean position of '"//motion%set//"'", &
        "a point at the fixed end of the bar, or rotate to turn the set in its place", code="E135")
  end subroutine check_length

  !> Whether a vector is along a coordinate axis.
  pure logical function is_along(vector, axis)
    real(wp), intent(in) :: vector(3)
    integer, intent(in) :: axis

    is_along = norm2(vector) - abs(vector(axis)) <= 1.0e-12_wp*norm2(vector)
  end function is_along

end module dd3_mesh_build
