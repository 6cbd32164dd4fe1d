# METIS::METIS: METIS 5, called through its C interface.

find_library(METIS_LIBRARY metis)
find_file(METIS_HEADER metis.h)
if(METIS_HEADER)
   # The library does not tell its version at run time.
   foreach(part MAJOR MINOR SUBMINOR)
      file(STRINGS "${METIS_HEADER}" line REGEX "define METIS_VER_${part} ")
      string(REGEX REPLACE "[^0-9]" "" number "${line}")
      list(APPEND METIS_VERSION "${number}")
   endforeach()
   list(JOIN METIS_VERSION "." METIS_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(METIS REQUIRED_VARS METIS_LIBRARY METIS_HEADER
   VERSION_VAR METIS_VERSION)
if(METIS_FOUND AND NOT TARGET METIS::METIS)
   add_library(METIS::METIS INTERFACE IMPORTED)
   set_target_properties(METIS::METIS PROPERTIES INTERFACE_LINK_LIBRARIES "${METIS_LIBRARY}")
endif()
mark_as_advanced(METIS_LIBRARY METIS_HEADER)
