!> The phases with all names resolved. What a phase does not name stays as it is: tools held, forces
!> and loads kept.
module dd3_model_phases
  use dd3_base_kinds, only : wp
  use dd3_input_case, only : case_t, phase_spec_t, until_never
  use dd3_mesh_mesh, only : mesh_t
  use dd3_model_loads, only : load_set_t
  use dd3_model_model, only : model_t
  use dd3_model_phase, only : phase_t
  implicit none
  private
  public :: new_phases

contains

  !> Resolves all phases.
  subroutine new_phases(model, case, mesh)
    !> The model with its tools, candidates and supports.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh

    type(phase_t) :: before
    integer :: i

    call new_load_sets(model, case, mesh)
    call new_phase(before, model)
    allocate (model%phase(size(case%phase)))
    do i = 1, size(case%phase)
      call follow(model%phase(i), before)
      call take_settings(model, case%phase(i), model%phase(i))
      call take_tools(case%phase(i), model%phase(i))
      call take_displacements(case%phase(i), mesh, model%phase(i))
      call take_loads(case%phase(i), model, model%phase(i))
      before = model%phase(i)
    end do
  end subroutine new_phases

  !> A phase in which nothing has happened yet.
  subroutine new_phase(phase, model)
    !> The phase.
    type(phase_t), intent(out) :: phase
    !> The model.
    type(model_t), intent(in) :: model

    integer :: n_tool, n_node

    n_tool = model%n_tool
    n_node = model%n_node
    phase%name = ""
    allocate (phase%move(3, n_tool), phase%press_start(3, n_tool), phase%press_end(3, n_tool), &
        source=0.0_wp)
    allocate (phase%tool_start(3, n_tool), phase%direction(3, n_tool), source=0.0_wp)
    allocate (phase%pressed(n_tool), source=.false.)
    allocate (phase%active(n_tool), phase%keeps_press(n_tool), source=.true.)
    allocate (phase%displacement(3, n_node), phase%fading(3, model%n_contact), source=0.0_wp)
    allocate (phase%load_start(3, size(model%load_set)), phase%load_end(3, size(model%load_set)), &
        source=0.0_wp)
    allocate (phase%keeps_load(size(model%load_set)), source=.true.)
    phase%prescribed = model%fixed
  end subroutine new_phase

  !> A phase that goes on where the one before ends.
  subroutine follow(phase, before)
    !> The phase.
    type(phase_t), intent(out) :: phase
    !> The one before.
    type(phase_t), intent(in) :: before

    phase = before
    phase%move = 0.0_wp
    phase%displacement = 0.0_wp
    phase%keeps_press = .true.
    phase%keeps_load = .true.
  end subroutine follow

  !> Takes name, control and limits.
  subroutine take_settings(model, from, phase)
    !> The model.
    type(model_t), intent(in) :: model
    !> The phase of the case.
    type(phase_spec_t), intent(in) :: from
    !> The phase.
    type(phase_t), intent(inout) :: phase

    phase%name = from%name
    phase%control = from%control
    phase%limits = from%limits
    phase%newton = from%newton
    phase%until = from%until
    if (from%until%kind == until_never) phase%until%tool = 0
    phase%penalty = from%contact%penalty
    phase%search_distance = from%contact%search_distance
    if (phase%search_distance <= 0.0_wp) phase%search_distance = model%thickness
  end subroutine take_settings

  !> Takes what the tools do, and the trial increment as a share of the phase.
  subroutine take_tools(from, phase)
    !> The phase of the case.
    type(phase_spec_t), intent(in) :: from
    !> The phase.
    type(phase_t), intent(inout) :: phase

    integer :: i, t

    do i = 1, size(from%hold)
      t = from%hold(i)%tool
      call stop_pressing(phase, t)
    end do
    do i = 1, size(from%move)
      t = from%move(i)%tool
      call stop_pressing(phase, t)
      phase%move(:, t) = from%move(i)%vector
      if (norm2(from%move(i)%vector) > 0.0_wp) phase%direction(:, t) = unit(from%move(i)%vector)
    end do
    do i = 1, size(from%press)
      call press(phase, from%press(i)%tool, from%press(i)%vector)
    end do
    do i = 1, size(from%release)
      t = from%release(i)%tool
      phase%active(t) = .false.
      call stop_pressing(phase, t)
    end do
    phase%trial = from%trial
    phase%length = 0.0_wp
    if (from%control == 0) return
    phase%length = norm2(phase%move(:, from%control))
    if (phase%length > 0.0_wp) phase%trial = from%trial/phase%length
  end subroutine take_tools

  !> A tool that is held or moved carries no prescribed force.
  subroutine stop_pressing(phase, tool)
    !> The phase.
    type(phase_t), intent(inout) :: phase
    !> The tool.
    integer, intent(in) :: tool

    phase%pressed(tool) = .false.
    phase%press_end(:, tool) = 0.0_wp
  end subroutine stop_pressing

  !> Puts a force on a tool; one of zero leaves a pressed tool its line.
  subroutine press(phase, tool, force)
    !> The phase.
    type(phase_t), intent(inout) :: phase
    !> The tool.
    integer, intent(in) :: tool
    !> The force, N.
    real(wp), intent(in) :: force(3)

    if (norm2(force) > 0.0_wp) phase%direction(:, tool) = unit(force)
    phase%pressed(tool) = .true.
    phase%keeps_press(tool) = .false.
    phase%press_end(:, tool) = force
  end subroutine press

  !> Takes prescribed displacements.
  subroutine take_displacements(from, mesh, phase)
    !> The phase of the case.
    type(phase_spec_t), intent(in) :: from
    !> The mesh.
    type(mesh_t), intent(in) :: mesh
    !> The phase.
    type(phase_t), intent(inout) :: phase

    integer, allocatable :: node(:)
    integer :: i

    do i = 1, size(from%displace)
      node = mesh%nodes_of(from%displace(i)%set)
      phase%prescribed(from%displace(i)%axis, node) = .true.
      phase%displacement(from%displace(i)%axis, node) = from%displace(i)%value
    end do
  end subroutine take_displacements

  !> Takes loads: a set that is named gets another force, the others keep theirs.
  subroutine take_loads(from, model, phase)
    !> The phase of the case.
    type(phase_spec_t), intent(in) :: from
    !> The model with its sets.
    type(model_t), intent(in) :: model
    !> The phase.
    type(phase_t), intent(inout) :: phase

    integer :: i, s

    do i = 1, size(from%load)
      s = find_load_set(model%load_set, from%load(i)%set)
      phase%load_end(:, s) = from%load(i)%force
      phase%keeps_load(s) = .false.
    end do
  end subroutine take_loads

  !> Lists the sets that carry a load in some phase.
  subroutine new_load_sets(model, case, mesh)
    !> Gets the sets.
    type(model_t), intent(inout) :: model
    !> The case.
    type(case_t), intent(in) :: case
    !> The mesh.
    type(mesh_t), intent(in) :: mesh

    type(load_set_t), allocatable :: set(:)
    integer :: i, j, n

    allocate (set(sum([(size(case%phase(i)%load), i=1, size(case%phase))])))
    n = 0
    do i = 1, size(case%phase)
      do j = 1, size(case%phase(i)%load)
        associate (name => case%phase(i)%load(j)%set)
          if (find_load_set(set(:n), name) > 0) cycle
          n = n + 1
          set(n)%name = name
          set(n)%node = mesh%nodes_of(name)
        end associate
      end do
    end do
    model%load_set = set(:n)
  end subroutine new_load_sets

  !> Position of a set; 0 where it is not among them.
  pure integer function find_load_set(set, name) result(s)
    !> The sets.
    type(load_set_t), intent(in) :: set(:)
    !> The name looked for.
    character(len=*), intent(in) :: name

    do s = size(set), 1, -1
      if (set(s)%name == name) return
    end do
  end function find_load_set

  !> The vector with length one.
  pure function unit(vector)
    !> The vector, not zero.
    real(wp), intent(in) :: vector(3)
    real(wp) :: unit(3)

    unit = vector/norm2(vector)
  end function unit

end module dd3_model_phases
