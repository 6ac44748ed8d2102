# Find the required libraries, or name the package to install.
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

message(STATUS "LAPACK ${LAPACK_LIBRARIES}")
message(STATUS "SuiteSparse ${SuiteSparse_VERSION}")
message(STATUS "HDF5 ${HDF5_VERSION}")
