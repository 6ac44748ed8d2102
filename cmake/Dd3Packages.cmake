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

# Optional; without it the fronts are ordered by minimum degree.
#
#   metis_linalg, metis_packages   as for MUMPS
option(DD3_METIS "Use METIS if it is installed" ON)
set(metis_packages "")
set(metis_linalg cmake/absent/metis_library.f90)
if(DD3_METIS)
  find_package(METIS QUIET)
  if(METIS_FOUND)
    set(metis_packages METIS::metis)
    set(metis_linalg src/external/metis_library.f90)
    message(STATUS "METIS ${METIS_VERSION}")
  else()
    message(STATUS "METIS with integers of 4 bytes was not found; large sheets take longer without it. "
      "On Debian or Ubuntu: apt-get install libmetis-dev")
  endif()
endif()

# The number of threads of OpenBLAS is set by its own call; other libraries have other settings.
#
#   blas_linalg   source of linalg
include(CheckFunctionExists)
set(CMAKE_REQUIRED_LIBRARIES LAPACK::LAPACK)
check_function_exists(openblas_set_num_threads DD3_OPENBLAS)
unset(CMAKE_REQUIRED_LIBRARIES)
set(blas_linalg cmake/absent/blas.f90)
if(DD3_OPENBLAS)
  set(blas_linalg src/external/blas.f90)
endif()

# GNU ld, gold, lld and mold can replace a function by another; the linker of macOS cannot.
#
#   malloc_app       source of app: allocations that end the program if they fail
#   malloc_options   options of the linker for it
include(CheckLinkerFlag)
check_linker_flag(Fortran LINKER:--wrap=malloc,--wrap=realloc DD3_WRAP)
set(malloc_app "")
set(malloc_options "")
if(DD3_WRAP)
  set(malloc_app src/external/checked_malloc.f90)
  set(malloc_options LINKER:--wrap=malloc,--wrap=realloc)
endif()

# Names and versions of the libraries, for run.json.
set(libraries LAPACK none SuiteSparse "${SuiteSparse_VERSION}" HDF5 "${HDF5_VERSION}")
if(metis_packages)
  list(APPEND libraries METIS "${METIS_VERSION}")
endif()
if(mumps_packages)
  list(APPEND libraries MUMPS none)
endif()

message(STATUS "LAPACK ${LAPACK_LIBRARIES}")
message(STATUS "SuiteSparse ${SuiteSparse_VERSION}")
message(STATUS "HDF5 ${HDF5_VERSION}")
