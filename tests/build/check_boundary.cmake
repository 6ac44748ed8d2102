# SPDX-License-Identifier: GPL-3.0-or-later
# Build tests/build/boundary. It must compile; with FORBIDDEN it must fail, because the module of an undeclared folder
# is missing.
file(REMOVE_RECURSE "${WORK}")
execute_process(COMMAND "${CMAKE_COMMAND}" -S "${ROOT}/tests/build/boundary" -B "${WORK}" -G "${GENERATOR}"
  "-DCMAKE_Fortran_COMPILER=${COMPILER}" -DFORBIDDEN=${FORBIDDEN} RESULT_VARIABLE result OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "configuration fails\n${output}")
endif()
execute_process(COMMAND "${CMAKE_COMMAND}" --build "${WORK}" RESULT_VARIABLE result OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(NOT FORBIDDEN AND NOT result EQUAL 0)
  message(FATAL_ERROR "compilation fails\n${output}")
elseif(FORBIDDEN AND (result EQUAL 0 OR NOT output MATCHES "low[.]mod"))
  message(FATAL_ERROR "the use of an undeclared folder was not refused\n${output}")
endif()
