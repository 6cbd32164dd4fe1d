# Fails where THERCON_PYTHON names no Python that can run the tests, and says what to do about it.

execute_process(
   COMMAND "${THERCON_PYTHON}" "${CMAKE_CURRENT_LIST_DIR}/missing_packages.py" ${REQUIREMENTS}
   RESULT_VARIABLE status ERROR_VARIABLE said)
if(NOT status EQUAL 0)
   # Without such a program the status is the system's message.
   if(NOT status MATCHES "^[0-9]+$")
      set(said "${status}")
   endif()
   string(STRIP "${said}" said)
   list(JOIN REQUIREMENTS "\n  " files)
   message(FATAL_ERROR "The tests in Python need Python 3.11 or later with the packages of\n"
      "  ${files}\n"
      "THERCON_PYTHON names\n  ${THERCON_PYTHON}\n  ${said}\n"
      "Configure with -DTHERCON_PYTHON=PATH of such a Python, or let ./setup.sh lint prepare one.")
endif()
