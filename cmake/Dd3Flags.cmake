# Flags of the build types. They become the first values of CMAKE_Fortran_FLAGS_<type>, so a user's own -D wins.
#
# -ffp-contract=off: a fused multiply-add would give other last bits with -march=native than without.
set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O3 -ffp-contract=off")
set(CMAKE_Fortran_FLAGS_DEBUG_INIT "-O0 -g -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow")
string(APPEND CMAKE_Fortran_FLAGS_DEBUG_INIT " -finit-real=snan -finit-derived -fbacktrace")

# Of the project's own code, not of what pFUnit generates. -Wmaybe-uninitialized is wrong about the bounds of allocatable
# arrays, -Wconversion-extra about the bounds of substrings: the first is off, the second never an error. -Winteger-division
# takes issue with every third of a whole number.
option(DD3_WARNINGS_ARE_ERRORS "Stop the build at the first warning" OFF)
set(DD3_WARNINGS -std=f2008 -pedantic -Wall -Wextra -Wimplicit-interface -Wimplicit-procedure -Wno-maybe-uninitialized
  -Wno-integer-division
  $<$<CONFIG:Debug>:-Wconversion-extra>)
if(DD3_WARNINGS_ARE_ERRORS)
  list(APPEND DD3_WARNINGS -Werror -Wno-error=conversion-extra)
endif()
