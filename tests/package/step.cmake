# Runs a command; stops with what it printed where it fails.
function(step)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        string(JOIN " " command ${ARGN})
        message(FATAL_ERROR "${command}\nfailed with ${result}:\n${output}")
    endif()
    set(last_output "${output}" PARENT_SCOPE)
endfunction()
