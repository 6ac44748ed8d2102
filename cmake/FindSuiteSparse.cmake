# SPDX-License-Identifier: GPL-3.0-or-later
# Find UMFPACK and AMD of SuiteSparse.
#
#   SuiteSparse::umfpack   target to link
#   SuiteSparse_VERSION    such as 5.12.0
#
# SuiteSparse has config packages since version 7; older Debian packages have neither these nor pkg-config files.
find_package(UMFPACK CONFIG QUIET)
find_package(AMD CONFIG QUIET)
if(TARGET SuiteSparse::UMFPACK AND TARGET SuiteSparse::AMD)
  set(SuiteSparse_VERSION "${UMFPACK_VERSION}")
  find_package(SuiteSparse_config CONFIG QUIET)
  if(SuiteSparse_config_FOUND)
    set(SuiteSparse_VERSION "${SuiteSparse_config_VERSION}")
  endif()
  set(SuiteSparse_UMFPACK SuiteSparse::UMFPACK)
  set(SuiteSparse_libraries SuiteSparse::UMFPACK SuiteSparse::AMD)
else()
  find_path(SuiteSparse_INCLUDE_DIR umfpack.h PATH_SUFFIXES suitesparse)
  find_library(SuiteSparse_UMFPACK umfpack)
  find_library(SuiteSparse_AMD amd)
  find_library(SuiteSparse_CONFIG suitesparseconfig)
  set(SuiteSparse_libraries "${SuiteSparse_UMFPACK}" "${SuiteSparse_AMD}" "${SuiteSparse_CONFIG}")
  set(SuiteSparse_VERSION "")
  foreach(part IN ITEMS MAIN SUB SUBSUB)
    set(line "")
    if(EXISTS "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h")
      file(STRINGS "${SuiteSparse_INCLUDE_DIR}/SuiteSparse_config.h" line
        REGEX "^#define SUITESPARSE_${part}_VERSION +[0-9]+")
    endif()
    string(REGEX MATCH "[0-9]+$" number "${line}")
    list(APPEND SuiteSparse_VERSION ${number})
  endforeach()
  list(JOIN SuiteSparse_VERSION "." SuiteSparse_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparse REQUIRED_VARS SuiteSparse_UMFPACK SuiteSparse_libraries
  VERSION_VAR SuiteSparse_VERSION)
if(SuiteSparse_FOUND AND NOT TARGET SuiteSparse::umfpack)
  add_library(SuiteSparse::umfpack INTERFACE IMPORTED)
  target_link_libraries(SuiteSparse::umfpack INTERFACE ${SuiteSparse_libraries})
  if(SuiteSparse_INCLUDE_DIR)
    target_include_directories(SuiteSparse::umfpack INTERFACE "${SuiteSparse_INCLUDE_DIR}")
  endif()
endif()
mark_as_advanced(SuiteSparse_INCLUDE_DIR SuiteSparse_UMFPACK SuiteSparse_AMD SuiteSparse_CONFIG)
