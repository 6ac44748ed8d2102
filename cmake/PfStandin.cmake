# SPDX-License-Identifier: GPL-3.0-or-later
# A small stand-in for pFUnit if it is not installed: the same .pf files, the same asserts.
#
#   pf_preprocess   converts x.pf to x.F90
#   pf_standin      the asserts and the runner
#   dd3_standin_ctest(<name> TEST_SOURCES ... [OTHER_SOURCES ...] [LINK_LIBRARIES ...] [LABELS ...]
#     [WORKING_DIRECTORY <dir>])
set(DD3_STANDIN_SOURCE "${CMAKE_SOURCE_DIR}/tests/standin")
set(DD3_STANDIN_BINARY "${CMAKE_BINARY_DIR}/standin")

# Append one specific procedure of funit.f90.in to the lists of the calling scope.
function(dd3_standin_compare generics expected expected_rank actual actual_rank tolerance)
  set(type_sp "real(sp)")
  set(type_dp "real(dp)")
  set(type_i4 "integer(i4)")
  set(type_i8 "integer(i8)")
  set(type_lk "logical")
  set(colons_0 "")
  set(colons_1 "(:)")
  set(colons_2 "(:, :)")
  set(colons_3 "(:, :, :)")
  set(colons_4 "(:, :, :, :)")
  set(colons_5 "(:, :, :, :, :)")
  set(name "compare_${expected}${expected_rank}_${actual}${actual_rank}_${tolerance}")
  set(more_arguments "")
  set(declaration "")
  set(value ", 0.0_dp")
  if(NOT tolerance STREQUAL "no")
    set(more_arguments ", tolerance")
    set(declaration "    ${type_${tolerance}}, intent(in) :: tolerance\n")
    set(value ", real(tolerance, dp)")
  endif()
  if(actual MATCHES "^[sd]p$")
    set(family "reals")
    set(left "real(real(expected, ${actual}), dp)")
    set(right "real(actual, dp)")
  elseif(actual STREQUAL "lk")
    set(family "logicals")
    set(left "expected")
    set(right "actual")
    set(value "")
  else()
    set(family "integers")
    set(left "int(expected, i8)")
    set(right "int(actual, i8)")
    set(value "")
  endif()
  string(APPEND procedures
    "  subroutine ${name}(operation, expected, actual${more_arguments}, message, location)\n"
    "    integer, intent(in) :: operation\n"
    "    ${type_${expected}}, intent(in) :: expected${colons_${expected_rank}}\n"
    "    ${type_${actual}}, intent(in) :: actual${colons_${actual_rank}}\n"
    "${declaration}"
    "    character(len=*), intent(in), optional :: message\n"
    "    type(SourceLocation), intent(in) :: location\n\n"
    "    call compare_${family}(operation, [${left}], shape(expected), [${right}], &\n"
    "      shape(actual)${value}, message, location)\n"
    "  end subroutine ${name}\n\n")
  set(procedures "${procedures}" PARENT_SCOPE)
  foreach(generic IN LISTS generics)
    set(${generic}_names "${${generic}_names}    module procedure :: ${name}\n" PARENT_SCOPE)
  endforeach()
endfunction()

# Write funit.f90: `actual` determines kind and rank, `expected` has that rank or is a scalar.
function(dd3_standin_write_asserts)
  foreach(rank RANGE 5)
    set(expected_ranks 0)
    if(rank GREATER 0)
      list(APPEND expected_ranks ${rank})
    endif()
    foreach(expected_rank IN LISTS expected_ranks)
      foreach(pair IN ITEMS i4_sp sp_sp i4_dp sp_dp dp_dp i4_i4 i4_i8 i8_i8 lk_lk)
        string(SUBSTRING ${pair} 0 2 expected)
        string(SUBSTRING ${pair} 3 2 actual)
        set(generics equality order)
        if(actual STREQUAL "lk")
          set(generics equality)
        endif()
        dd3_standin_compare("${generics}" ${expected} ${expected_rank} ${actual} ${rank} no)
        if(actual MATCHES "^[sd]p$")
          dd3_standin_compare("${generics}" ${expected} ${expected_rank} ${actual} ${rank} sp)
        endif()
        if(actual STREQUAL "dp")
          dd3_standin_compare("${generics}" ${expected} ${expected_rank} ${actual} ${rank} dp)
        endif()
      endforeach()
    endforeach()
  endforeach()
  configure_file("${DD3_STANDIN_SOURCE}/funit.f90.in" "${DD3_STANDIN_BINARY}/funit.f90" @ONLY)
endfunction()

find_package(OpenMP REQUIRED COMPONENTS Fortran)
dd3_standin_write_asserts()
add_executable(pf_preprocess "${DD3_STANDIN_SOURCE}/pf_preprocess.f90")
add_library(pf_standin STATIC
  "${DD3_STANDIN_SOURCE}/pf_failure.f90"
  "${DD3_STANDIN_SOURCE}/pf_compare.f90"
  "${DD3_STANDIN_SOURCE}/pf_runner.f90"
  "${DD3_STANDIN_BINARY}/funit.f90")
set_target_properties(pf_standin PROPERTIES Fortran_MODULE_DIRECTORY "${DD3_STANDIN_BINARY}/modules")
target_include_directories(pf_standin INTERFACE "${DD3_STANDIN_BINARY}/modules")
target_link_libraries(pf_standin PUBLIC OpenMP::OpenMP_Fortran)

# Add the executable without the test: TEST_SOURCES, OTHER_SOURCES, LINK_LIBRARIES.
function(dd3_standin_executable name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES")
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/${name}.dir")
  file(MAKE_DIRECTORY "${folder}")
  set(sources "")
  set(uses "")
  set(calls "")
  foreach(source IN LISTS arg_TEST_SOURCES)
    get_filename_component(suite "${source}" NAME_WE)
    get_filename_component(source "${source}" ABSOLUTE)
    add_custom_command(OUTPUT "${folder}/${suite}.F90"
      COMMAND pf_preprocess "${source}" "${folder}/${suite}.F90"
      DEPENDS "${source}" pf_preprocess VERBATIM)
    list(APPEND sources "${folder}/${suite}.F90")
    string(APPEND uses "  use ${suite}_suite, only : run_${suite} => run_suite\n")
    string(APPEND calls "  call run_${suite}(run)\n")
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/${name}_driver.f90" CONTENT
"program ${name}_driver
  use pf_runner, only : run_t
${uses}  implicit none
  type(run_t) :: run

  call run%start()
${calls}  call run%finish()
end program ${name}_driver
")
  add_executable(${name} ${sources} ${arg_OTHER_SOURCES} "${folder}/${name}_driver.f90")
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY "${folder}/modules")
  target_include_directories(${name} PRIVATE "${folder}/modules" "${CMAKE_CURRENT_SOURCE_DIR}")
  target_link_libraries(${name} pf_standin ${arg_LINK_LIBRARIES})
endfunction()

function(dd3_standin_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "WORKING_DIRECTORY" "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
  dd3_standin_executable(${name} TEST_SOURCES ${arg_TEST_SOURCES} OTHER_SOURCES ${arg_OTHER_SOURCES}
    LINK_LIBRARIES ${arg_LINK_LIBRARIES})
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  add_test(NAME ${name} COMMAND ${name} --verbose WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}")
  if(arg_LABELS)
    set_property(TEST ${name} PROPERTY LABELS ${arg_LABELS})
  endif()
endfunction()
