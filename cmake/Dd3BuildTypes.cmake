# SPDX-License-Identifier: GPL-3.0-or-later
# Flags of the build types, by compiler. CMake includes this file (CMAKE_USER_MAKE_RULES_OVERRIDE_Fortran) once the
# compiler is known and before CMAKE_Fortran_FLAGS_<type> take their initial values: a user's -D has precedence.
#
# No fused multiply-adds (-ffp-contract=off, -no-fma): with them the last bits would depend on -march=native.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  # no-recursion: two threads in one procedure look like a recursion to the check.
  set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3 -ffp-contract=off")
  set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g -fcheck=all,no-array-temps,no-recursion")
  string(APPEND CMAKE_Fortran_FLAGS_DEBUG_INIT " -ffpe-trap=invalid,zero,overflow")
  string(APPEND CMAKE_Fortran_FLAGS_DEBUG_INIT " -finit-real=snan -finit-derived -fbacktrace")
elseif(CMAKE_Fortran_COMPILER_ID STREQUAL "LLVMFlang")
  # flang 19 has neither checks of bounds nor traps. It does not compile the program: array elements in `depend` of a
  # task (front_factor.f90) and `declare reduction` of a type (tool_depth.f90) are not implemented, and it crashes in
  # tool_report.f90. libhdf5_fortran has to be compiled with it too.
  set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3 -ffp-contract=off")
  set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g")
  # Unknown to CMake before 3.28: the prefix of options of the linker, and code for shared libraries.
  if(NOT DEFINED CMAKE_Fortran_LINKER_WRAPPER_FLAG)
    set(CMAKE_Fortran_LINKER_WRAPPER_FLAG "-Wl,")
    set(CMAKE_Fortran_LINKER_WRAPPER_FLAG_SEP ",")
  endif()
  if(NOT DEFINED CMAKE_Fortran_COMPILE_OPTIONS_PIC)
    set(CMAKE_Fortran_COMPILE_OPTIONS_PIC -fPIC)
  endif()
elseif(CMAKE_Fortran_COMPILER_ID STREQUAL "IntelLLVM")
  # Not run; from the manual of ifx as far as it could be looked up. -fp-model=precise: the default model changes the
  # order of operations and assumes that there is no NaN. -standard-semantics: among others the logicals of C; the names
  # of module procedures stay those with which libraries are compiled. -fpe0: traps for invalid, zero, overflow.
  # noarg_temp_created: a copied argument is no mistake; nouninit: libraries would have to be compiled with it too.
  set(ifx "-fp-model=precise -standard-semantics -assume nostd_mod_proc_name")
  set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3 -no-fma ${ifx}")
  set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g ${ifx} -check all,noarg_temp_created,nouninit -fpe0")
  string(APPEND CMAKE_Fortran_FLAGS_DEBUG_INIT " -init=snan,arrays -traceback")
else()
  message(WARNING "${CMAKE_Fortran_COMPILER_ID}: the project knows no flags of this compiler, and takes -O2 for a "
    "release. Give those that keep the order of operations and NaNs as CMAKE_Fortran_FLAGS_RELEASE.")
  set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O2")
  set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g")
endif()
