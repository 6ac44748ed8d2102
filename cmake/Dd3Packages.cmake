find_package(LAPACK REQUIRED)
find_package(SuiteSparse REQUIRED)
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 REQUIRED COMPONENTS Fortran HL)
