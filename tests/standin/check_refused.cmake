# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DPREPROCESSOR=<command> -DCOMPILER=<gfortran> -DMODULES=<folders> -DSOURCE=<x.pf> -DWORK=<folder>
# [-DGENUINE=ON]
#       -P check_refused.cmake
#
# Preprocess and compile a test file that must be refused. Its first line says by whom and why:
#   ! refused by both: <message>                  pFUnit refuses it too
#   ! refused by the stand-in alone: <message>    pFUnit accepts it, with a meaning that is easily misread
# The message `compiler` means that the file passes the preprocessor and does not compile.
file(STRINGS "${SOURCE}" first LIMIT_COUNT 1)
if(NOT first MATCHES "^! refused by (both|the stand-in alone): (.*)$")
  message(FATAL_ERROR "the first line does not say by whom the file is refused")
endif()
set(expected "${CMAKE_MATCH_2}")
get_filename_component(name "${SOURCE}" NAME_WE)
file(MAKE_DIRECTORY "${WORK}")
file(REMOVE "${WORK}/${name}.F90")
execute_process(COMMAND ${PREPROCESSOR} "${SOURCE}" "${WORK}/${name}.F90" RESULT_VARIABLE result ERROR_VARIABLE errors)
if(result EQUAL 0)
  set(includes "")
  foreach(folder IN LISTS MODULES)
    list(APPEND includes "-I${folder}")
  endforeach()
  execute_process(COMMAND "${COMPILER}" -fsyntax-only -fopenmp ${includes} "${WORK}/${name}.F90"
    WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE compiled ERROR_VARIABLE errors)
  if(compiled EQUAL 0)
    message(FATAL_ERROR "it was not refused")
  endif()
  if(NOT GENUINE AND NOT expected STREQUAL "compiler")
    message(FATAL_ERROR "only the compiler refused it\n${errors}")
  endif()
  if(errors MATCHES "module file .funit[.]mod")
    message(FATAL_ERROR "the file was not compiled\n${errors}")
  endif()
elseif(NOT GENUINE)
  string(FIND "${errors}" "${expected}" place)
  if(place EQUAL -1 OR NOT errors MATCHES "${name}.pf:[0-9]+: error: ")
    message(FATAL_ERROR "unexpected message\n${errors}")
  endif()
  if(EXISTS "${WORK}/${name}.F90")
    message(FATAL_ERROR "an incomplete result was not removed")
  endif()
endif()
