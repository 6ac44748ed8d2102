# SuiteSparse of Debian 12 has neither CMake config nor pkg-config files.
find_path(SuiteSparse_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
find_library(SuiteSparse_UMFPACK umfpack)
find_library(SuiteSparse_AMD amd)
find_library(SuiteSparse_CONFIG suitesparseconfig)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse
  REQUIRED_VARS SuiteSparse_UMFPACK SuiteSparse_AMD SuiteSparse_CONFIG SuiteSparse_INCLUDE_DIR)
if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::umfpack)
  add_library(SuiteSparse::umfpack INTERFACE IMPORTED)
  target_link_libraries(SuiteSparse::umfpack INTERFACE
    "${SuiteSparse_UMFPACK}" "${SuiteSparse_AMD}" "${SuiteSparse_CONFIG}")
  target_include_directories(SuiteSparse::umfpack INTERFACE "${SuiteSparse_INCLUDE_DIR}")
endif()
