# SPDX-License-Identifier: GPL-3.0-or-later
# Find METIS with integers of 4 bytes.
#
#   METIS::metis      target to link
#   METIS_VERSION     such as 5.1.0
find_path(METIS_INCLUDE_DIR metis.h)
find_library(METIS_LIBRARY metis)
set(METIS_INTEGERS "")
set(METIS_VERSION "")
if(METIS_INCLUDE_DIR)
  file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" METIS_INTEGERS REGEX "^ *# *define +IDXTYPEWIDTH +32")
  foreach(part IN ITEMS MAJOR MINOR SUBMINOR)
    file(STRINGS "${METIS_INCLUDE_DIR}/metis.h" line REGEX "^ *# *define +METIS_VER_${part} +[0-9]+")
    string(REGEX MATCH "[0-9]+$" number "${line}")
    list(APPEND METIS_VERSION ${number})
  endforeach()
  list(JOIN METIS_VERSION "." METIS_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(METIS REQUIRED_VARS METIS_LIBRARY METIS_INCLUDE_DIR METIS_INTEGERS
  VERSION_VAR METIS_VERSION)
if(METIS_FOUND AND NOT TARGET METIS::metis)
  add_library(METIS::metis INTERFACE IMPORTED)
  target_link_libraries(METIS::metis INTERFACE "${METIS_LIBRARY}")
endif()
mark_as_advanced(METIS_INCLUDE_DIR METIS_LIBRARY)
