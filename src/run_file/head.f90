! SPDX-License-Identifier: GPL-3.0-or-later
!> Part of run.json: format, program, machine, call.
module dd3_run_file_head
  use, intrinsic :: iso_fortran_env, only : compiler_version
  use dd3_base_environment, only : host_name, local_time, working_directory
  use dd3_base_json, only : json_t
  use dd3_base_kinds, only : wp
  use dd3_base_machine_memory, only : available_memory
  use dd3_base_ranks, only : n_ranks
  use dd3_base_text, only : newline, text_t
  use dd3_base_threads, only : processors
  use dd3_base_version, only : program_name, program_version
  use dd3_linalg_solver_registry, only : missing_package, solver_names
  use dd3_run_file_build, only : build_flags, build_type, library_name, library_version
  use dd3_run_file_commit, only : source_commit
  implicit none
  private
  public :: command_t, add_head, is_whole

  !> Mark and version of the format, as in docs/run.schema.json. The version grows when a member is
  !> removed or changes its meaning.
  character(len=*), parameter :: mark = "dd3imp run"
  integer, parameter :: format_version = 2

  !> Call of the program.
  type :: command_t
    !> Input file and folder of the results as given; restart file, empty for none.
    character(len=:), allocatable :: file, directory, restart
    !> Parameters given as `name=value`.
    type(text_t), allocatable :: settings(:)
    integer :: threads = 1
    !> The input is only checked.
    logical :: check = .false.
  end type command_t

contains

  !> Begin the outermost object: format, program, machine, call and time of the start.
  subroutine add_head(json, command)
    type(json_t), intent(inout) :: json
    type(command_t), intent(in) :: command

    call json%begin_object("")
    call json%add("format", mark)
    call json%add("format_version", format_version)
    call json%begin_object("program", flat=.true.)
    call json%add("name", program_name)
    call json%add("version", program_version)
    call json%add_optional("commit", source_commit)
    call json%end_object()
    call add_build(json)
    call add_machine(json, command%threads)
    call add_command(json, command)
    call json%add("started", local_time())
  end subroutine add_head

  !> Add how the program was built.
  subroutine add_build(json)
    type(json_t), intent(inout) :: json

    character(len=16), allocatable :: solver(:)
    integer :: i

    call json%begin_object("build")
    call json%add("compiler", compiler_version())
    call json%add("flags", build_flags)
    call json%add("type", build_type)
    call json%begin_array("libraries", flat=.true.)
    do i = 1, size(library_name)
      call json%begin_object("")
      call json%add("name", trim(library_name(i)))
      call json%add_optional("version", trim(library_version(i)))
      call json%end_object()
    end do
    call json%end_array()
    solver = solver_names()
    call json%begin_array("solvers", flat=.true.)
    do i = 1, size(solver)
      if (missing_package(solver(i)) == "") call json%add("", trim(solver(i)))
    end do
    call json%end_array()
    call json%end_object()
  end subroutine add_build

  !> Add the machine.
  subroutine add_machine(json, threads)
    type(json_t), intent(inout) :: json
    integer, intent(in) :: threads

    real(wp) :: memory

    memory = available_memory()
    call json%begin_object("machine", flat=.true.)
    call json%add_optional("host", host_name())
    call json%add("processors", processors())
    if (memory > 0.0_wp) call json%add("memory", memory)
    if (.not. memory > 0.0_wp) call json%add_null("memory")
    call json%add("threads", threads)
    call json%add("processes", n_ranks())
    call json%end_object()
  end subroutine add_machine

  !> Add the call of the program.
  subroutine add_command(json, command)
    type(json_t), intent(inout) :: json
    type(command_t), intent(in) :: command

    integer :: i

    call json%begin_object("command")
    call json%add("file", command%file)
    call json%add_optional("working_directory", working_directory())
    call json%add("directory", command%directory)
    call json%begin_array("settings", flat=.true.)
    do i = 1, size(command%settings)
      call json%add("", command%settings(i)%s)
    end do
    call json%end_array()
    call json%add_optional("restart", command%restart)
    call json%add("check", command%check)
    call json%end_object()
  end subroutine add_command

  !> Whether a text is a run.json of the same format, by its start and its end.
  logical function is_whole(text)
    character(len=*), intent(in) :: text

    type(json_t) :: json
    character(len=:), allocatable :: start
    character(len=*), parameter :: end = newline//"}"//newline

    call json%begin_object("")
    call json%add("format", mark)
    call json%add("format_version", format_version)
    start = json%text()//","
    is_whole = len(text) > len(start) + len(end) .and. index(text, start) == 1
    if (is_whole) is_whole = text(len(text) - len(end) + 1:) == end
  end function is_whole

end module dd3_run_file_head
