# Stand-in for pFUnit's CMake function of the same name, with the arguments that are used here:
#
#    add_pfunit_ctest(name TEST_SOURCES a.pf ... [OTHER_SOURCES ...] [LINK_LIBRARIES ...]
#                     [LABELS ...] [WORKING_DIRECTORY folder])

find_package(Python3 REQUIRED COMPONENTS Interpreter)

set(FUNIT_STANDIN_DIR "${CMAKE_CURRENT_LIST_DIR}")
add_library(funit_standin STATIC
   "${FUNIT_STANDIN_DIR}/funit.f90"
   "${FUNIT_STANDIN_DIR}/funit_integers.f90"
   "${FUNIT_STANDIN_DIR}/funit_messages.f90"
   "${FUNIT_STANDIN_DIR}/funit_reals.f90"
   "${FUNIT_STANDIN_DIR}/funit_results.f90")
set_target_properties(funit_standin PROPERTIES
   Fortran_PREPROCESS OFF
   Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/funit_modules")
target_include_directories(funit_standin PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/funit_modules")
target_link_libraries(funit_standin PRIVATE thercon_language thercon_checks)

function(add_pfunit_ctest name)
   cmake_parse_arguments(PARSE_ARGV 1 arg "" "WORKING_DIRECTORY"
      "TEST_SOURCES;OTHER_SOURCES;LINK_LIBRARIES;LABELS")
   if(arg_UNPARSED_ARGUMENTS)
      message(FATAL_ERROR "add_pfunit_ctest(${name}): not known here: ${arg_UNPARSED_ARGUMENTS}")
   endif()

   set(folder "${CMAKE_CURRENT_BINARY_DIR}/${name}.dir")
   set(sources "")
   set(calls "")
   set(test_sources "")
   foreach(test_source IN LISTS arg_TEST_SOURCES)
      cmake_path(ABSOLUTE_PATH test_source BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}")
      cmake_path(GET test_source STEM module)
      list(APPEND test_sources "${test_source}")
      list(APPEND sources "${folder}/${module}.f90")
      string(APPEND calls "   call ${module}_suite()\n")
   endforeach()
   # One process for all: starting Python takes longer than its work.
   add_custom_command(OUTPUT ${sources}
      COMMAND "${Python3_EXECUTABLE}" -B "${FUNIT_STANDIN_DIR}/funitproc.py"
         "${folder}" ${test_sources}
      DEPENDS ${test_sources} "${FUNIT_STANDIN_DIR}/funitproc.py"
      VERBATIM)
   string(CONCAT driver
      "program ${name}_driver\n   use funit, only: end_tests\n   implicit none\n\n"
      "${calls}   call end_tests()\nend program ${name}_driver\n")
   file(CONFIGURE OUTPUT "${folder}/${name}_driver.f90"
      CONTENT "${driver}" @ONLY)

   add_executable(${name} ${sources} ${arg_OTHER_SOURCES}
      "${folder}/${name}_driver.f90")
   set_target_properties(${name} PROPERTIES
      Fortran_PREPROCESS OFF
      Fortran_MODULE_DIRECTORY "${folder}")
   target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
   target_link_libraries(${name} PRIVATE funit_standin ${arg_LINK_LIBRARIES})

   if(NOT arg_WORKING_DIRECTORY)
      set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
   endif()
   add_test(NAME ${name} COMMAND ${name} --verbose WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}")
   set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}")
endfunction()
