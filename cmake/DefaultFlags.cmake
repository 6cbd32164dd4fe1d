# The flags of a build type unless CMAKE_Fortran_FLAGS_<TYPE> is set; CMake reads this file before it
# stores its own defaults.

# Results must be the same wherever the program is built: no -march=native, no -ffast-math, no
# contraction of products and sums to fused operations.
if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
   set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-Og -ffrontend-optimize -g1 -ffp-contract=off")
endif()
