# HDF5::Fortran: the Fortran interface of serial HDF5.
#
# Only the compiler that wrote a module file can read it. FortranHDF5_ROOT is the prefix of an HDF5
# that was built with the compiler in use.

find_path(FortranHDF5_INCLUDE_DIR hdf5.mod PATH_SUFFIXES hdf5/serial hdf5 NO_CACHE)
find_library(FortranHDF5_FORTRAN_LIBRARY hdf5_fortran PATH_SUFFIXES hdf5/serial NO_CACHE)
find_library(FortranHDF5_C_LIBRARY hdf5 PATH_SUFFIXES hdf5/serial NO_CACHE)

if(FortranHDF5_INCLUDE_DIR)
   include(CheckFortranSourceCompiles)
   set(CMAKE_REQUIRED_INCLUDES "${FortranHDF5_INCLUDE_DIR}")
   set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)   # nothing is linked
   check_fortran_source_compiles("
      subroutine read_module()
         use hdf5, only: hid_t
      end subroutine read_module" FortranHDF5_MODULE_IS_READABLE SRC_EXT f90)
   unset(CMAKE_REQUIRED_INCLUDES)
   unset(CMAKE_TRY_COMPILE_TARGET_TYPE)
   if(NOT FortranHDF5_MODULE_IS_READABLE)
      unset(FortranHDF5_MODULE_IS_READABLE CACHE)   # the next configuration tries again
      set(FortranHDF5_REASON "${CMAKE_Fortran_COMPILER} cannot read \
${FortranHDF5_INCLUDE_DIR}/hdf5.mod. Set FortranHDF5_ROOT to an HDF5 that was built with this compiler.")
   endif()
endif()

# An archive does not name the libraries that it needs.
set(FortranHDF5_LIBRARIES ${FortranHDF5_FORTRAN_LIBRARY} ${FortranHDF5_C_LIBRARY})
if(FortranHDF5_C_LIBRARY MATCHES "\\.a$")
   foreach(name IN ITEMS sz z)
      find_library(FortranHDF5_${name}_LIBRARY ${name} NO_CACHE)
      if(FortranHDF5_${name}_LIBRARY)
         list(APPEND FortranHDF5_LIBRARIES ${FortranHDF5_${name}_LIBRARY})
      endif()
   endforeach()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(FortranHDF5
   REQUIRED_VARS FortranHDF5_FORTRAN_LIBRARY FortranHDF5_C_LIBRARY FortranHDF5_INCLUDE_DIR
      FortranHDF5_MODULE_IS_READABLE
   REASON_FAILURE_MESSAGE "${FortranHDF5_REASON}")
if(FortranHDF5_FOUND AND NOT TARGET HDF5::Fortran)
   add_library(HDF5::Fortran INTERFACE IMPORTED)
   set_target_properties(HDF5::Fortran PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES "${FortranHDF5_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${FortranHDF5_LIBRARIES};${CMAKE_DL_LIBS};m")
endif()
