# SPDX-License-Identifier: GPL-3.0-or-later
# add_pfunit_ctest(<name> TEST_SOURCES <x.pf>... [OTHER_SOURCES ...] [LINK_LIBRARIES ...] [LABELS ...]
#                  [WORKING_DIRECTORY <dir>])
#
# Add one executable and one test. They use pFUnit if it is installed (-DCMAKE_PREFIX_PATH=<prefix>) and
# DD3_FORCE_STANDIN is off, otherwise the stand-in in tests/standin/. The label `unit` is added to those given. By
# default each test runs in its own directory, so that parallel tests do not overwrite each other's files.
option(DD3_FORCE_STANDIN "Run the unit tests with the in-tree stand-in even where pFUnit is installed" OFF)

include(PfStandin)
set(DD3_PFUNIT OFF)
if(NOT DD3_FORCE_STANDIN)
  find_package(PFUNIT 4.0 QUIET)
  if(PFUNIT_FOUND)
    set(DD3_PFUNIT ON)
  endif()
endif()
if(DD3_PFUNIT)
  message(STATUS "Unit tests: pFUnit ${PFUNIT_VERSION}")
else()
  message(STATUS "Unit tests: the in-tree stand-in for pFUnit")
endif()

function(add_pfunit_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "WORKING_DIRECTORY" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES OR NOT arg_TEST_SOURCES)
    message(FATAL_ERROR "add_pfunit_ctest(${name}): TEST_SOURCES with OTHER_SOURCES, LINK_LIBRARIES, LABELS, "
      "WORKING_DIRECTORY; not understood: ${arg_UNPARSED_ARGUMENTS} ${arg_KEYWORDS_MISSING_VALUES}")
  endif()
  set(directory "")
  if(NOT arg_WORKING_DIRECTORY)
    set(directory WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}.work")
    file(MAKE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/${name}.work")
  endif()
  if(DD3_PFUNIT)
    _add_pfunit_ctest(${ARGV} ${directory})
  else()
    dd3_standin_ctest(${ARGV} ${directory})
  endif()
  set_property(TEST ${name} APPEND PROPERTY LABELS unit)
  set_property(TEST ${name} PROPERTY TIMEOUT 300)
endfunction()
