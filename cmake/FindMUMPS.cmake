# SPDX-License-Identifier: GPL-3.0-or-later
# Find the sequential double-precision library MUMPS.
#
#   MUMPS::dmumps        target to link
#   MUMPS_INCLUDE_DIR    folder of dmumps_struc.h
find_path(MUMPS_INCLUDE_DIR dmumps_struc.h)
find_library(MUMPS_DMUMPS dmumps_seq)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS REQUIRED_VARS MUMPS_DMUMPS MUMPS_INCLUDE_DIR)
if(MUMPS_FOUND AND NOT TARGET MUMPS::dmumps)
  add_library(MUMPS::dmumps INTERFACE IMPORTED)
  target_link_libraries(MUMPS::dmumps INTERFACE "${MUMPS_DMUMPS}")
endif()
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_DMUMPS)
