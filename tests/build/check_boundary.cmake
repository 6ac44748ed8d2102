# Builds tests/build/boundary: it must compile, or with FORBIDDEN it must not, for want of the module that is not declared.
file(REMOVE_RECURSE "${WORK}")
execute_process(COMMAND "${CMAKE_COMMAND}" -S "${ROOT}/tests/build/boundary" -B "${WORK}" -G "${GENERATOR}"
  "-DCMAKE_Fortran_COMPILER=${COMPILER}" -DFORBIDDEN=${FORBIDDEN} RESULT_VARIABLE result OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "it does not configure\n${output}")
endif()
execute_process(COMMAND "${CMAKE_COMMAND}" --build "${WORK}" RESULT_VARIABLE result OUTPUT_VARIABLE output
  ERROR_VARIABLE output)
if(NOT FORBIDDEN AND NOT result EQUAL 0)
  message(FATAL_ERROR "it does not compile\n${output}")
elseif(FORBIDDEN AND (result EQUAL 0 OR NOT output MATCHES "low[.]mod"))
  message(FATAL_ERROR "the use of a folder that is not declared was not refused\n${output}")
endif()
