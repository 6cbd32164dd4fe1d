# HDF5::Fortran: the Fortran interface of serial HDF5.
#
# Only the compiler that wrote a module file can read it. FortranHDF5_ROOT is the prefix of an HDF5
# that was built with the compiler in use.
#
# FortranHDF5_PREFER_ARCHIVES links the archives where the program can be linked with them: the shared
# libraries of Debian 12 bring thirty others, among them curl and Kerberos, and loading these takes as
# long as solving a small deck. An archive does not name the libraries that it needs, so this is tried.

option(FortranHDF5_PREFER_ARCHIVES "Link the archives of HDF5 where they need no more than zlib and szip" OFF)
find_path(FortranHDF5_INCLUDE_DIR hdf5.mod PATH_SUFFIXES hdf5/serial hdf5 NO_CACHE)
find_library(FortranHDF5_FORTRAN_LIBRARY hdf5_fortran PATH_SUFFIXES hdf5/serial NO_CACHE)
find_library(FortranHDF5_C_LIBRARY hdf5 PATH_SUFFIXES hdf5/serial NO_CACHE)
set(FortranHDF5_LIBRARIES ${FortranHDF5_FORTRAN_LIBRARY} ${FortranHDF5_C_LIBRARY})
if(FortranHDF5_PREFER_ARCHIVES)
   set(FortranHDF5_ARCHIVES ${CMAKE_DL_LIBS} m)
   foreach(name IN ITEMS z sz libhdf5.a libhdf5_fortran.a)
      find_library(FortranHDF5_${name}_FILE ${name} PATH_SUFFIXES hdf5/serial NO_CACHE)
      if(FortranHDF5_${name}_FILE)
         list(PREPEND FortranHDF5_ARCHIVES ${FortranHDF5_${name}_FILE})
      endif()
   endforeach()
endif()

if(FortranHDF5_INCLUDE_DIR)
   include(CheckFortranSourceCompiles)
   set(CMAKE_REQUIRED_INCLUDES "${FortranHDF5_INCLUDE_DIR}")
   set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)   # nothing is linked
   check_fortran_source_compiles("
      subroutine read_module()
         use hdf5, only: hid_t
      end subroutine read_module" FortranHDF5_MODULE_IS_READABLE SRC_EXT f90)
   unset(CMAKE_TRY_COMPILE_TARGET_TYPE)
   if(FortranHDF5_PREFER_ARCHIVES)
      set(CMAKE_REQUIRED_LIBRARIES ${FortranHDF5_ARCHIVES})
      check_fortran_source_compiles("
         program open_library
            use hdf5, only: h5open_f
            integer :: status
            call h5open_f(status)
         end program open_library" FortranHDF5_ARCHIVES_LINK SRC_EXT f90)
      unset(CMAKE_REQUIRED_LIBRARIES)
   endif()
   unset(CMAKE_REQUIRED_INCLUDES)
   if(NOT FortranHDF5_MODULE_IS_READABLE)
      unset(FortranHDF5_MODULE_IS_READABLE CACHE)   # the next configuration tries again
      set(FortranHDF5_REASON "${CMAKE_Fortran_COMPILER} cannot read \
${FortranHDF5_INCLUDE_DIR}/hdf5.mod. Set FortranHDF5_ROOT to an HDF5 that was built with this compiler.")
   endif()
endif()

if(FortranHDF5_PREFER_ARCHIVES AND FortranHDF5_ARCHIVES_LINK)
   set(FortranHDF5_LIBRARIES ${FortranHDF5_ARCHIVES})
elseif(FortranHDF5_PREFER_ARCHIVES)
   message(STATUS "The archives of HDF5 cannot be linked alone: its shared libraries are")
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
      INTERFACE_LINK_LIBRARIES "${FortranHDF5_LIBRARIES}")
endif()
