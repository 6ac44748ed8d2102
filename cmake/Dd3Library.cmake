# SPDX-License-Identifier: GPL-3.0-or-later
# dd3_library(<folder> [USES <folder>...] [PACKAGES <target>...] [GENERATED <file>...])
#
# Declare src/<folder>/ as the library dd3_<folder>. Its module files are written to a separate directory, visible only
# to the libraries that name it in USES: a `use` of an undeclared folder does not compile. The sources are every .f90
# below the folder except a main program (see dd3_program), and the GENERATED files. The global property DD3_FOLDERS
# lists the folders that have sources. Compilers other than gfortran read, with a module, the files of the modules that
# it uses: there the directories are inherited, and the build does not refuse a use that is not declared.
function(dd3_library folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "USES;PACKAGES;GENERATED")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/src/${folder}/*.f90")
  list(FILTER sources EXCLUDE REGEX "/src/${folder}/${PROJECT_NAME}\\.f90$")
  list(APPEND sources ${arg_GENERATED})
  set(library dd3_${folder})
  if(NOT sources)
    add_library(${library} INTERFACE)
    return()
  endif()
  set(modules "${CMAKE_BINARY_DIR}/modules/${folder}")
  add_library(${library} STATIC ${sources})
  set_target_properties(${library} PROPERTIES Fortran_MODULE_DIRECTORY "${modules}" LINKER_LANGUAGE Fortran)
  target_include_directories(${library} INTERFACE "${modules}")
  target_compile_options(${library} PRIVATE "$<$<COMPILE_LANGUAGE:Fortran>:${DD3_WARNINGS}>")
  foreach(used IN LISTS arg_USES)
    target_link_libraries(${library} PRIVATE dd3_${used})
    if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
      target_include_directories(${library} INTERFACE "$<TARGET_PROPERTY:dd3_${used},INTERFACE_INCLUDE_DIRECTORIES>")
    endif()
  endforeach()
  target_link_libraries(${library} PRIVATE ${arg_PACKAGES})
  set_property(GLOBAL APPEND PROPERTY DD3_FOLDERS ${folder})
endfunction()

# dd3_program(<name> <folder>)
#
# Declare the executable <name> with its main program src/<folder>/<name>.f90, which may use the folders that <folder>
# uses.
function(dd3_program name folder)
  set(source "${CMAKE_SOURCE_DIR}/src/${folder}/${name}.f90")
  if(NOT EXISTS "${source}")
    message(WARNING "src/${folder}/${name}.f90 is missing: the program ${name} is not built")
    return()
  endif()
  add_executable(${name} "${source}")
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${CMAKE_BINARY_DIR}/modules/${name}"
    LINKER_LANGUAGE Fortran RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
  target_compile_options(${name} PRIVATE "$<$<COMPILE_LANGUAGE:Fortran>:${DD3_WARNINGS}>")
  target_link_libraries(${name} PRIVATE dd3_${folder})
  get_target_property(type dd3_${folder} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    get_target_property(used dd3_${folder} LINK_LIBRARIES)
    target_link_libraries(${name} PRIVATE ${used})
  endif()
  install(TARGETS ${name} COMPONENT program)
endfunction()
