# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D SOURCE=<folder> -D WRITTEN=<file> -P commit.cmake
#
# Write the commit of the source into a module; the file is left alone if nothing has changed.
set(COMMIT "")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND "${GIT}" rev-parse --show-toplevel WORKING_DIRECTORY "${SOURCE}"
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${SOURCE}" folder)
  # The source may be unpacked within another repository.
  if("${top}" STREQUAL "${folder}")
    execute_process(COMMAND "${GIT}" rev-parse --short=12 HEAD WORKING_DIRECTORY "${SOURCE}"
      OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND "${GIT}" --no-optional-locks status --porcelain --untracked-files=no
      WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE changes ERROR_QUIET)
    if(COMMIT AND changes)
      string(APPEND COMMIT "+")
    endif()
  endif()
endif()
configure_file("${SOURCE}/src/run_file/commit.f90.in" "${WRITTEN}" @ONLY)
