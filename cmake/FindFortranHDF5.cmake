# HDF5::Fortran: the Fortran interface of serial HDF5.
#
# Debian's archives are preferred to its shared libraries: these drag in some thirty others (curl,
# Kerberos, LDAP for HDF5's remote files), which cost 7 ms of processor time at every start.

find_path(FortranHDF5_INCLUDE_DIR hdf5.mod PATH_SUFFIXES hdf5/serial hdf5)
find_library(FortranHDF5_FORTRAN_LIBRARY NAMES libhdf5_fortran.a hdf5_fortran PATH_SUFFIXES hdf5/serial)
find_library(FortranHDF5_C_LIBRARY NAMES libhdf5.a hdf5 PATH_SUFFIXES hdf5/serial)
find_library(FortranHDF5_SZIP_LIBRARY sz)
find_library(FortranHDF5_ZLIB_LIBRARY z)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(FortranHDF5 REQUIRED_VARS
   FortranHDF5_FORTRAN_LIBRARY FortranHDF5_C_LIBRARY FortranHDF5_SZIP_LIBRARY
   FortranHDF5_ZLIB_LIBRARY FortranHDF5_INCLUDE_DIR)
if(FortranHDF5_FOUND AND NOT TARGET HDF5::Fortran)
   add_library(HDF5::Fortran INTERFACE IMPORTED)
   set_target_properties(HDF5::Fortran PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES "${FortranHDF5_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${FortranHDF5_FORTRAN_LIBRARY};${FortranHDF5_C_LIBRARY};\
${FortranHDF5_SZIP_LIBRARY};${FortranHDF5_ZLIB_LIBRARY};${CMAKE_DL_LIBS};m")
endif()
mark_as_advanced(FortranHDF5_INCLUDE_DIR FortranHDF5_FORTRAN_LIBRARY FortranHDF5_C_LIBRARY
   FortranHDF5_SZIP_LIBRARY FortranHDF5_ZLIB_LIBRARY)
