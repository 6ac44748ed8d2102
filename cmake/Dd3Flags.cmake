# Flags of the build types. They become the first values of CMAKE_Fortran_FLAGS_<type>, so a user's own -D wins.
#
# -ffp-contract=off: a fused multiply-add would give other last bits with -march=native than without.
set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3 -ffp-contract=off")
set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow")
string(APPEND CMAKE_Fortran_FLAGS_DEBUG_INIT " -finit-real=snan -finit-derived -fbacktrace")

# Of the project's own code, not of what pFUnit generates. Off are warnings that are wrong too often: about the bounds of
# allocatable arrays (with -O3 also as -Wuninitialized), about thirds of whole numbers, about subscripts behind an `if`
# (the checks of the debug build see the true ones).
option(DD3_WARNINGS_ARE_ERRORS "Stop the build at the first warning" OFF)
set(DD3_WARNINGS -std=f2008 -pedantic -Wall -Wextra -Wimplicit-interface -Wimplicit-procedure -Wno-maybe-uninitialized
  -Wno-integer-division -Wno-do-subscript
  $<IF:$<CONFIG:Debug>,-Wconversion-extra,-Wno-uninitialized>)
if(DD3_WARNINGS_ARE_ERRORS)
  list(APPEND DD3_WARNINGS -Werror)
endif()
