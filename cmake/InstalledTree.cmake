# What `cmake --install` copies, the Debian package of `cpack` and the archive of `cpack -G TGZ`. Decks,
# scripts and documents keep their relative places, so that links in the documents hold.

include(GNUInstallDirs)
# The libraries that an archive has beside the program, then those of the build, wherever they are: see
# FindSerialLAPACK.cmake. The program of the build has the same path: otherwise CMake pads it with an
# empty entry, which stands for the working folder.
set(archive_libraries "lib/thercon")
set_target_properties(thercon PROPERTIES
   INSTALL_RPATH "$ORIGIN/../${archive_libraries}"
   INSTALL_RPATH_USE_LINK_PATH TRUE
   BUILD_WITH_INSTALL_RPATH TRUE)
# Of the old kind, which holds for the libraries of libraries too.
target_link_options(thercon PRIVATE LINKER:--disable-new-dtags)
set(installed_folder "${CMAKE_INSTALL_DATADIR}/thercon")
# In a wheel of Python the program is one of the scripts; scikit-build-core copies the package.
if(SKBUILD)
   install(TARGETS thercon RUNTIME DESTINATION "${SKBUILD_SCRIPTS_DIR}" COMPONENT program)
   return()
endif()
install(TARGETS thercon RUNTIME)
install(DIRECTORY docs input post python DESTINATION "${installed_folder}" USE_SOURCE_PERMISSIONS
   PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md CITATION.cff LICENSE DESTINATION "${installed_folder}")
file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/links")
foreach(name IN ITEMS plot report compare)
   file(CREATE_LINK "../${installed_folder}/post/${name}"
      "${PROJECT_BINARY_DIR}/links/thercon-${name}" SYMBOLIC)
   install(FILES "${PROJECT_BINARY_DIR}/links/thercon-${name}" TYPE BIN)
endforeach()

add_custom_command(TARGET thercon POST_BUILD
   COMMAND "${CMAKE_COMMAND}" -DPROGRAM=$<TARGET_FILE:thercon> -DVERSION=${PROJECT_VERSION}
      "-DDESCRIPTION=${PROJECT_DESCRIPTION}" "-DPAGE=${PROJECT_BINARY_DIR}/thercon.1"
      -P "${PROJECT_SOURCE_DIR}/cmake/ManualPage.cmake")
install(FILES "${PROJECT_BINARY_DIR}/thercon.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
install(FILES cmake/completion.bash RENAME thercon
   DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "thercon developers")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# dpkg-shlibdeps finds the libraries; of BLAS it names any, and the run path the serial one alone.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libopenblas0-serial, python3, python3-h5py, python3-matplotlib")
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/cmake/ArchiveOptions.cmake")
set(CPACK_ARCHIVE_LIBRARIES "${archive_libraries}")
string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" CPACK_ARCHIVE_MACHINE)
include(CPack)
