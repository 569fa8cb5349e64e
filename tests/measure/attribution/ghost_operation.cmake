# cmake -DCOMPILER=… -DSOURCE=… -DFOLDER=… -P ghost_operation.cmake: an operation of the tape does not
# compile until its struct and its texts are there.
file(READ ${SOURCE}/src/number/tape.hpp tape)
string(REGEX REPLACE "(row\\(any,[^)]*\\))" "\\1 row(ghost, \"ghost\", rounded, 2)" with_ghost "${tape}")
if(with_ghost STREQUAL tape)
    message(FATAL_ERROR "number/tape.hpp has no row(any, …) to put another one after")
endif()
file(WRITE ${FOLDER}/number/tape.hpp "${with_ghost}")

# A pattern of what the compiler says; nothing: it compiles.
function(expect says)
    execute_process(
        COMMAND ${COMPILER} -std=c++20 -fsyntax-only ${ARGN} -I${FOLDER} -I${SOURCE}/src
                ${SOURCE}/tests/measure/attribution/ghost_operation.cpp
        RESULT_VARIABLE code ERROR_VARIABLE said)
    if(says STREQUAL "" AND NOT code EQUAL 0)
        message(FATAL_ERROR "a complete operation does not compile:\n${said}")
    elseif(NOT says STREQUAL "" AND (code EQUAL 0 OR NOT said MATCHES "${says}"))
        message(FATAL_ERROR "expected an error that says \"${says}\", got:\n${said}")
    endif()
endfunction()
expect("Operation<lostbits::TapeOp::ghost>|Operation<TapeOp::ghost>")
expect("Pattern" -DGHOST_IS_DESCRIBED)
expect("" -DGHOST_IS_DESCRIBED -DGHOST_HAS_ALL_TEXTS)
