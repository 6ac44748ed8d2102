# SPDX-License-Identifier: GPL-3.0-or-later
# Configure the project without PACKAGE: it must stop and name the Debian package.
file(REMOVE_RECURSE "${WORK}")
execute_process(COMMAND "${CMAKE_COMMAND}" -S "${ROOT}" -B "${WORK}" -G "${GENERATOR}"
  "-DCMAKE_Fortran_COMPILER=${COMPILER}" -DCMAKE_DISABLE_FIND_PACKAGE_${PACKAGE}=ON
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "was not found" OR NOT output MATCHES "apt-get[ \n]+install[ \n]+${DEBIAN}")
  message(FATAL_ERROR "unexpected message\n${output}")
endif()
