# SPDX-License-Identifier: GPL-3.0-or-later
# The constitutive laws as the shared library dd3laws, for C and as Abaqus' UMAT: src/library/ and what it uses. It needs
# no other library than those of the compiler, and shows no other names than those of dd3laws.h and umat_.
foreach(folder IN ITEMS base linalg input material laws library)
  set_target_properties(dd3_${folder} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  # Calls within a file stay calls of that file's own procedures, as in a program.
  target_compile_options(dd3_${folder} PRIVATE ${DD3_OWN_CALLS})
endforeach()

find_package(Threads REQUIRED)
set(exported "${CMAKE_SOURCE_DIR}/src/library/exported.map")
add_library(dd3laws SHARED src/library/umat.c)
add_library(dd3imp::laws ALIAS dd3laws)
set_target_properties(dd3laws PROPERTIES LINKER_LANGUAGE Fortran EXPORT_NAME laws LINK_DEPENDS "${exported}"
  C_STANDARD 99 LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
if(NOT SKBUILD)  # a wheel has no links: each would be a copy
  set_target_properties(dd3laws PROPERTIES VERSION "${PROJECT_VERSION}" SOVERSION "${PROJECT_VERSION_MAJOR}")
endif()
target_compile_options(dd3laws PRIVATE -Wall -Wextra -pedantic)
target_link_options(dd3laws PRIVATE LINKER:--as-needed "LINKER:--version-script=${exported}")
target_link_libraries(dd3laws PRIVATE "$<LINK_LIBRARY:WHOLE_ARCHIVE,dd3_library>" Threads::Threads)
target_include_directories(dd3laws INTERFACE "$<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src/library>"
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
