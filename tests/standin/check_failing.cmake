# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DPROGRAM=<executable> -DEXIT_CODE=<n> [-DEXPECTED=<file>] -P check_failing.cmake
#
# Run a suite that must fail: with this exit code, stopping at a failed assert, and with output that matches each line
# (a regular expression) of the file.
execute_process(COMMAND "${PROGRAM}" --verbose RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE errors)
if(NOT result STREQUAL EXIT_CODE)
  message(FATAL_ERROR "exit code ${result}, expected ${EXIT_CODE}\n${output}${errors}")
endif()
if(output MATCHES "NOT REACHED")
  message(FATAL_ERROR "code after a failed assert was executed\n${output}")
endif()
if(EXPECTED)
  # CMake would take square brackets and semicolons in the lines as list syntax.
  file(READ "${EXPECTED}" lines)
  string(REPLACE "[" "<open>" lines "${lines}")
  string(REPLACE "]" "<close>" lines "${lines}")
  string(REPLACE "\n" ";" lines "${lines}")
  foreach(line IN LISTS lines)
    string(REPLACE "<open>" "[" line "${line}")
    string(REPLACE "<close>" "]" line "${line}")
    string(REPLACE "\\n" "\n" line "${line}")
    if(NOT "${output}${errors}" MATCHES "${line}")
      message(FATAL_ERROR "nothing matches:\n${line}\nin\n${output}${errors}")
    endif()
  endforeach()
endif()
