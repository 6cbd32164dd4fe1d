# Copies the shared libraries that the program of an archive loads into the archive, but for those of
# the C library, which every system has and which must be the system's own.

set(of_the_c_library "^(ld-linux.*|lib(c|m|dl|rt|pthread|util|resolv|mvec))\\.so")
file(GLOB programs "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/bin/thercon"
   "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/bin/thercon")
list(GET programs 0 program)
file(GET_RUNTIME_DEPENDENCIES
   EXECUTABLES "${program}"
   PRE_EXCLUDE_REGEXES "${of_the_c_library}"
   RESOLVED_DEPENDENCIES_VAR libraries)
cmake_path(GET program PARENT_PATH folder)
foreach(library IN LISTS libraries)
   file(REAL_PATH "${library}" found)
   cmake_path(GET library FILENAME name)
   file(MAKE_DIRECTORY "${folder}/../${CPACK_ARCHIVE_LIBRARIES}")
   file(COPY_FILE "${found}" "${folder}/../${CPACK_ARCHIVE_LIBRARIES}/${name}")
endforeach()
