# How our own code is compiled. thercon_language: the standard and what the compiler has to say;
# thercon_checks: what is checked at run time, in tests too; thercon_sanitizers: what is checked in the
# program alone, since it makes the compiler three times as slow.

option(THERCON_WARNINGS "Compiler warnings; each stops the build" OFF)
option(THERCON_CHECKS "Run-time checks; floating-point exceptions stop the program" OFF)
set(THERCON_SANITIZERS "" CACHE STRING "Sanitizers, as for -fsanitize; address finds leaks, too")
option(THERCON_COVERAGE "Executed lines are counted for gcov" OFF)

if(NOT CMAKE_BUILD_TYPE)
   set(CMAKE_BUILD_TYPE Release)
endif()
if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
   message(WARNING "thercon is tested with gfortran only, and this compiler is "
      "${CMAKE_Fortran_COMPILER_ID}: run the tests, and set CMAKE_Fortran_FLAGS_RELEASE so that "
      "the compiler does not contract or reorder floating-point operations.")
   if(THERCON_WARNINGS OR THERCON_CHECKS OR THERCON_SANITIZERS)
      message(FATAL_ERROR "THERCON_WARNINGS, THERCON_CHECKS and THERCON_SANITIZERS need gfortran.")
   endif()
endif()

# gfortran 12 takes the bounds of an allocatable array for unset where the array is allocated by an
# assignment, hence -Wno-uninitialized; memory that is never set is looked for at run time.
add_library(thercon_language INTERFACE)
target_compile_options(thercon_language INTERFACE
   $<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-std=f2008>
   $<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-fimplicit-none>
   $<$<COMPILE_LANGUAGE:C>:-std=c11> $<$<COMPILE_LANGUAGE:C>:-Wall> $<$<COMPILE_LANGUAGE:C>:-Wextra>)
if(THERCON_WARNINGS)
   target_compile_options(thercon_language INTERFACE
      -Werror -pedantic -Wall -Wextra -Wconversion)
   foreach(option IN ITEMS -Wimplicit-interface -Wimplicit-procedure -Wcharacter-truncation
      -Wuse-without-only -Wundefined-do-loop -Wno-uninitialized -Wno-maybe-uninitialized)
      target_compile_options(thercon_language INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:${option}>)
   endforeach()
endif()

add_library(thercon_checks INTERFACE)
if(THERCON_CHECKS)
   foreach(option IN ITEMS -fcheck=all,no-array-temps -fbacktrace
      -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived)
      target_compile_options(thercon_checks INTERFACE $<$<COMPILE_LANGUAGE:Fortran>:${option}>)
   endforeach()
endif()
add_library(thercon_sanitizers INTERFACE)
if(THERCON_SANITIZERS)
   # gfortran 12 works out the size of an array that is not allocated when its holder is copied:
   # harmless, but an overflow.
   target_compile_options(thercon_sanitizers INTERFACE
      -fsanitize=${THERCON_SANITIZERS} -fno-sanitize=signed-integer-overflow -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
   # A call for every check takes the compiler two thirds of the time of checks that are written out, and
   # the program longer: the kernels have the compiler's own limit.
   set(called_checks --param=asan-instrumentation-with-call-threshold=)
   target_compile_options(thercon_sanitizers INTERFACE ${called_checks}0)
   target_link_options(thercon_checks INTERFACE -fsanitize=${THERCON_SANITIZERS})
endif()
if(THERCON_COVERAGE)
   # Programs that run side by side count in the same files.
   target_compile_options(thercon_checks INTERFACE --coverage -fprofile-update=atomic)
   target_link_options(thercon_checks INTERFACE --coverage)
endif()
