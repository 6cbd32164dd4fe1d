# What `cmake --install` copies. Decks, scripts and documents keep their relative places, so that
# links in the documents hold.

include(GNUInstallDirs)
# The libraries of the build, wherever they are: see FindSerialLAPACK.cmake. The program of the build
# has the same path: otherwise CMake pads it with an empty entry, which stands for the working folder.
set_target_properties(thercon PROPERTIES
   INSTALL_RPATH_USE_LINK_PATH TRUE
   BUILD_WITH_INSTALL_RPATH TRUE)
set(installed_folder "${CMAKE_INSTALL_DATADIR}/thercon")
install(TARGETS thercon RUNTIME)
install(DIRECTORY docs input post DESTINATION "${installed_folder}" USE_SOURCE_PERMISSIONS
   PATTERN "__pycache__" EXCLUDE)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION "${installed_folder}")
