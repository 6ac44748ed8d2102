! SPDX-License-Identifier: GPL-3.0-or-later
!> Checks of the case that need the model, or the solvers of this build.
module dd3_setup_checks
  use dd3_base_error, only : error_list_t
  use dd3_base_ranks, only : n_ranks
  use dd3_base_text, only : to_text
  use dd3_input_case, only : case_t
  use dd3_input_known_name, only : check_known_name
  use dd3_linalg_solver_registry, only : missing_package, solver_names
  use dd3_model_contact_results, only : candidate_hits
  use dd3_model_model, only : model_t
  use dd3_model_rigid_motion, only : new_supported_part, part_name, parts_of_nodes, rigid_motion_t
  use dd3_model_tolerances, only : start_depth, wrong_side_depth
  use dd3_tools_closest, only : hit_t
  use dd3_tools_placement, only : placement_t
  implicit none
  private
  public :: check_solver, check_start, check_supports

contains

  !> Report a linear solver that is not in the registry or not in this build, and one that cannot
  !> keep its factors on the disk.
  subroutine check_solver(case, errors)
    type(case_t), intent(in) :: case
    type(error_list_t), intent(inout) :: errors

    character(len=:), allocatable :: package
    integer :: position, ranks

    if (case%solver%method == "") return
    call check_known_name(case%solver%method, case%solver%method_at, "linear solver", &
        solver_names(), position, errors)
    package = missing_package(case%solver%method)
    if (package /= "") call errors%push_input(case%solver%method_at, "the program was built "// &
        "without the linear solver '"//case%solver%method//"'", "another one, or a program "// &
        "built with the package "//package, code="E116")
    if (case%solver%factors /= "disk" .or. index(case%solver%method, "mumps") > 0) return
    ranks = n_ranks()
    ! On several ranks this is petsc_mumps.
    if (ranks > 1 .and. case%solver%method == "auto") return
    call errors%push_input(case%solver%factors_at, "the linear solver '"//case%solver%method// &
        "' keeps its factors in the memory", "method = mumps or petsc_mumps", code="E148")
  end subroutine check_solver

  !> Report a tool that starts inside the sheet, and one whose normals all point away from it.
  subroutine check_start(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(hit_t), allocatable :: hit(:)
    integer :: c, t, nearest, worst

    do t = 1, model%n_tool
      associate (distance => model%tolerance%start_search)
        hit = candidate_hits(model, t, placement_t(translation=model%tool(t)%position), &
            model%start_positions(), &
            distance, distance)
      end associate
      nearest = minloc(abs(hit%distance), dim=1, mask=hit%found)
      worst = minloc(hit%distance, dim=1, mask=hit%found .and. hit%distance < -start_depth &
          .and. hit%distance >= [(-wrong_side_depth*model%thickness_at(model%contact_node(c)), &
          c=1, model%n_contact)])
      if (worst == 0) then
        if (nearest == 0) cycle
        if (hit(nearest)%distance >= -start_depth) cycle
        call errors%push_input(case%tool(t)%source%opened, "tool '" &
            //case%tool(t)%source%called()//"' turns away from the sheet, "// &
            to_text(-hit(nearest)%distance, 4)//" mm off", &
            "patches whose normals (the cross product of their u and v) point to the sheet", &
            code="E142")
        cycle
      end if
      call errors%push_input(case%tool(t)%source%opened, "tool '"//case%tool(t)%source%called()// &
          "' starts inside the sheet: node "//to_text(model%contact_node(worst))//" is "// &
          to_text(-hit(worst)%distance, 4)//" mm deep in it", &
          "a start no deeper than 0.001 mm (see position), normals that point to the sheet", &
          code="E142")
    end do
  end subroutine check_start

  !> Report the first phase in which the sheet, or a part of it, is free to move as a rigid body and
  !> no tool is active.
  subroutine check_supports(model, case, errors)
    type(model_t), intent(in) :: model
    type(case_t), intent(in) :: case
    !> Errors found are added.
    type(error_list_t), intent(inout) :: errors

    type(rigid_motion_t) :: body
    character(len=:), allocatable :: motion
    integer :: part(model%n_node), i, k

    part = parts_of_nodes(model%connectivity, model%n_node)
    do i = 1, size(model%phase)
      if (any(model%phase(i)%active .and. .not. model%phase(i)%withdrawn)) cycle
      do k = 1, maxval(part)
        call new_supported_part(body, model%start_positions(), model%phase(i)%held(), part == k)
        motion = body%free_motion()
        if (len(motion) == 0) cycle
        call errors%push_input(case%phase(i)%source%opened, "nothing holds "// &
            part_name(part, k)//" in phase '"//case%phase(i)%source%called()// &
            "': it is free to "//motion, &
            "supports by *BOUNDARY or displace, a tool that is not released, or unload = on", &
            code="E143")
        return
      end do
    end do
  end subroutine check_supports

end module dd3_setup_checks
