# SPDX-License-Identifier: GPL-3.0-or-later
# Several processes (MPI) and the linear solvers of PETSc: optional.
#
#   petsc_base, petsc_linalg   sources of base and linalg: of src/parallel/ and src/external/, or those in their place
#   petsc_packages             libraries to link
#
# Not together with the sequential MUMPS, which contains procedures with the names of MPI's.
option(DD3_PETSC "Build for several processes, with MPI and PETSc" OFF)
set(petsc_packages "")
set(petsc_base cmake/absent/ranks.f90)
set(petsc_linalg cmake/absent/petsc_solver.f90)
if(NOT DD3_PETSC)
  return()
endif()

find_package(MPI QUIET COMPONENTS C Fortran)
if(NOT MPI_FOUND)
  dd3_missing("MPI with its Fortran interface" "libopenmpi-dev")
endif()
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(PETSC QUIET PETSc)
endif()
if(NOT PETSC_FOUND)
  dd3_missing("PETSc (by pkg-config)" "libpetsc-real-dev")
endif()

# The interfaces of src/external/petsc.f90 declare these types.
include(CheckTypeSize)
function(dd3_check_petsc_type type size)
  set(CMAKE_REQUIRED_INCLUDES ${PETSC_INCLUDE_DIRS})
  set(CMAKE_REQUIRED_LIBRARIES MPI::MPI_C)
  set(CMAKE_EXTRA_INCLUDE_FILES petscsys.h)
  check_type_size(${type} DD3_SIZE_${type})
  if(NOT "${DD3_SIZE_${type}}" STREQUAL "${size}")
    message(FATAL_ERROR "PETSc: expected ${type} of ${size} bytes, got '${DD3_SIZE_${type}}': needed are Open MPI and "
      "PETSc with reals of 8 and integers of 4 bytes, as in Debian's libpetsc-real-dev")
  endif()
endfunction()
dd3_check_petsc_type(MPI_Comm 8)
dd3_check_petsc_type(PetscInt 4)
dd3_check_petsc_type(PetscScalar 8)

set(petsc_base src/parallel/ranks.f90)
set(petsc_linalg src/external/petsc.f90 src/parallel/petsc_options.f90
  src/parallel/petsc_solver.f90)
set(petsc_packages MPI::MPI_Fortran ${PETSC_LINK_LIBRARIES})
list(APPEND libraries MPI "${MPI_Fortran_VERSION}" PETSc "${PETSC_VERSION}")
message(STATUS "MPI ${MPI_Fortran_VERSION}")
message(STATUS "PETSc ${PETSC_VERSION}")
