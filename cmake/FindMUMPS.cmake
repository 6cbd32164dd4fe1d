# MUMPS::MUMPS: the sequential build of MUMPS in double precision.

find_path(MUMPS_INCLUDE_DIR dmumps_struc.h PATH_SUFFIXES mumps_seq MUMPS)
find_library(MUMPS_LIBRARY dmumps_seq)
find_library(MUMPS_MPI_STUB_LIBRARY NAMES mpiseq_seq mpiseq)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS
   REQUIRED_VARS MUMPS_LIBRARY MUMPS_MPI_STUB_LIBRARY MUMPS_INCLUDE_DIR)
if(MUMPS_FOUND AND NOT TARGET MUMPS::MUMPS)
   add_library(MUMPS::MUMPS INTERFACE IMPORTED)
   # As an option and not as an include directory, because CMake drops /usr/include from these, and
   # gfortran does not look there by itself.
   set_target_properties(MUMPS::MUMPS PROPERTIES
      INTERFACE_COMPILE_OPTIONS "-I${MUMPS_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${MUMPS_LIBRARY};${MUMPS_MPI_STUB_LIBRARY}")
endif()
mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_LIBRARY MUMPS_MPI_STUB_LIBRARY)
