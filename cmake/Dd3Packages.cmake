# SPDX-License-Identifier: GPL-3.0-or-later
# Find the required libraries, or name the package to install; and the optional ones.
function(dd3_missing what package)
  message(FATAL_ERROR "${what} was not found. On Debian or Ubuntu: apt-get install ${package}")
endfunction()

find_package(LAPACK QUIET)
if(NOT LAPACK_FOUND)
  dd3_missing("LAPACK" "libopenblas-dev")
endif()

find_package(SuiteSparse QUIET)
if(NOT SuiteSparse_FOUND)
  dd3_missing("SuiteSparse (its parts UMFPACK and AMD)" "libsuitesparse-dev")
endif()

find_package(OpenMP QUIET COMPONENTS Fortran)
if(NOT OpenMP_Fortran_FOUND)
  dd3_missing("OpenMP of the Fortran compiler" "gfortran")
endif()

set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 QUIET COMPONENTS C Fortran HL)
if(NOT HDF5_FOUND)
  dd3_missing("HDF5 with its Fortran interface" "libhdf5-dev")
endif()

# Optional. The sequential MUMPS contains procedures with the names of MPI's.
#
#   mumps_linalg     source of linalg: that of src/external/, or the one in its place
#   mumps_packages   library to link
option(DD3_MUMPS "Use the sequential MUMPS if it is installed" ON)
set(mumps_packages "")
set(mumps_linalg cmake/absent/mumps_library.f90)
if(DD3_MUMPS AND DD3_PETSC)
  message(STATUS "MUMPS: not in a program with MPI, whose procedures the sequential library replaces")
elseif(DD3_MUMPS)
  find_package(MUMPS QUIET)
  if(MUMPS_FOUND)
    set(mumps_packages MUMPS::dmumps)
    set(mumps_linalg src/external/mumps_library.f90)
    set_source_files_properties(${mumps_linalg} PROPERTIES COMPILE_OPTIONS "-I${MUMPS_INCLUDE_DIR}")
    message(STATUS "MUMPS ${MUMPS_DMUMPS}")
  else()
    message(STATUS "MUMPS was not found; it is optional. On Debian or Ubuntu: apt-get install libmumps-seq-dev")
  endif()
endif()

# Names and versions of the libraries, for run.json.
set(libraries LAPACK none SuiteSparse "${SuiteSparse_VERSION}" HDF5 "${HDF5_VERSION}")
if(mumps_packages)
  list(APPEND libraries MUMPS none)
endif()

message(STATUS "LAPACK ${LAPACK_LIBRARIES}")
message(STATUS "SuiteSparse ${SuiteSparse_VERSION}")
message(STATUS "HDF5 ${HDF5_VERSION}")
