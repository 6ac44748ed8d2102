# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` copies for other programs, see docs/laws_library.md. Not in a build with PETSc.
#
#   <libdir>/libdd3laws.so          constitutive laws for C, and UMAT: the target dd3imp::laws
#   <includedir>/dd3laws.h          its header
#   <libdir>/libdd3imp.a            all folders of src but those of the program and of the shared library: the target
#                                   dd3imp::modules
#   <includedir>/dd3imp             their module files, for the compiler that wrote them
#   <libdir>/cmake/dd3imp           package config
if(NOT TARGET dd3laws)
  return()
endif()
include(CMakePackageConfigHelpers)
set(package "${CMAKE_INSTALL_LIBDIR}/cmake/dd3imp")
set(module_folder "${CMAKE_INSTALL_INCLUDEDIR}/dd3imp")

add_library(dd3imp_modules STATIC)
set_target_properties(dd3imp_modules PROPERTIES OUTPUT_NAME dd3imp EXPORT_NAME modules LINKER_LANGUAGE Fortran)
target_include_directories(dd3imp_modules INTERFACE "$<INSTALL_INTERFACE:${module_folder}>")
get_property(folders GLOBAL PROPERTY DD3_FOLDERS)
list(REMOVE_ITEM folders app library)
foreach(folder IN LISTS folders)
  target_sources(dd3imp_modules PRIVATE "$<TARGET_OBJECTS:dd3_${folder}>")
  install(DIRECTORY "${CMAKE_BINARY_DIR}/modules/${folder}/" DESTINATION "${module_folder}"
    COMPONENT development FILES_MATCHING PATTERN "*.mod")
endforeach()

install(FILES src/library/dd3laws.h DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT laws)
install(TARGETS dd3laws EXPORT dd3imp-laws COMPONENT laws)
install(TARGETS dd3imp_modules EXPORT dd3imp-modules COMPONENT development)
foreach(target IN ITEMS laws modules)
  install(EXPORT dd3imp-${target} NAMESPACE dd3imp:: DESTINATION "${package}" COMPONENT development)
endforeach()

configure_package_config_file(cmake/dd3imp-config.cmake.in "${CMAKE_BINARY_DIR}/dd3imp-config.cmake"
  INSTALL_DESTINATION "${package}")
write_basic_package_version_file("${CMAKE_BINARY_DIR}/dd3imp-config-version.cmake" COMPATIBILITY SameMajorVersion)
install(FILES "${CMAKE_BINARY_DIR}/dd3imp-config.cmake" "${CMAKE_BINARY_DIR}/dd3imp-config-version.cmake"
  cmake/FindSuiteSparse.cmake cmake/FindMUMPS.cmake cmake/FindMETIS.cmake DESTINATION "${package}"
  COMPONENT development)
