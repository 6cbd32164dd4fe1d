# LAPACK::Serial: LAPACK and BLAS on one core.
#
# OpenBLAS with threads starts one for every further core when it is loaded, and each of them spins
# for about 25 ms of processor time: more than a small problem takes as a whole. So Debian's serial
# build is taken by its path, where it is installed, whatever the machine's alternatives say. The run
# path is of the old kind, which holds for the libraries of libraries too: MUMPS uses the same one.
# Elsewhere it is whatever find_package(LAPACK) finds.

find_library(SerialLAPACK_BLAS openblas PATH_SUFFIXES openblas-serial NO_CACHE)
find_library(SerialLAPACK_LAPACK lapack PATH_SUFFIXES openblas-serial NO_CACHE)
if(SerialLAPACK_BLAS MATCHES "openblas-serial" AND SerialLAPACK_LAPACK MATCHES "openblas-serial")
   set(SerialLAPACK_LIBRARIES ${SerialLAPACK_LAPACK} ${SerialLAPACK_BLAS})
   set(SerialLAPACK_LINK_OPTIONS LINKER:--disable-new-dtags)
else()
   find_package(LAPACK QUIET)
   set(SerialLAPACK_LIBRARIES ${LAPACK_LIBRARIES})
   set(SerialLAPACK_LINK_OPTIONS "")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SerialLAPACK REQUIRED_VARS SerialLAPACK_LIBRARIES)
if(SerialLAPACK_FOUND AND NOT TARGET LAPACK::Serial)
   add_library(LAPACK::Serial INTERFACE IMPORTED)
   set_target_properties(LAPACK::Serial PROPERTIES
      INTERFACE_LINK_LIBRARIES "${SerialLAPACK_LIBRARIES}"
      INTERFACE_LINK_OPTIONS "${SerialLAPACK_LINK_OPTIONS}")
endif()
