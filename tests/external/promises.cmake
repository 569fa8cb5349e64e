# cmake -D LOSTBITS= -D PLUGIN= -D BROKEN="probe probe" -P promises.cmake
# `lostbits plugin check PLUGIN` breaks these probes and no others.
execute_process(COMMAND ${LOSTBITS} plugin check ${PLUGIN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
string(REGEX MATCHALL "BROKEN [a-z-]+" broken "${out}")
list(TRANSFORM broken REPLACE "BROKEN " "")
list(REMOVE_DUPLICATES broken)
list(SORT broken)
separate_arguments(expected UNIX_COMMAND "${BROKEN}")
list(SORT expected)
if(expected STREQUAL "")
    set(expected_code 0)
else()
    set(expected_code 1)
endif()
if(NOT code STREQUAL expected_code OR NOT broken STREQUAL expected)
    message(FATAL_ERROR "broken: \"${broken}\", expected: \"${expected}\"; exit ${code}, expected: ${expected_code}\n"
        "${out}\n${err}")
endif()
