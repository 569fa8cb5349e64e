include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)
find_program(CCACHE ccache)
set(options -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" -DCMAKE_BUILD_TYPE=Release)
if(CCACHE)
    list(APPEND options -DCMAKE_CXX_COMPILER_LAUNCHER=${CCACHE})
endif()

file(REMOVE_RECURSE ${WORK_DIR})
step(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
step(${CMAKE_COMMAND} -S ${CONSUMER_DIR} -B ${WORK_DIR}/build -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
    ${options})
step(${CMAKE_COMMAND} --build ${WORK_DIR}/build --parallel)
step(${WORK_DIR}/build/consumer)
string(STRIP "${last_output}" last_output)
if(NOT last_output STREQUAL "t = 4, lost bits = 0")
    message(FATAL_ERROR "the consumer printed: ${last_output}")
endif()
# The installed program finds its data and its image module from where it stands.
step(${CMAKE_COMMAND} -E chdir ${WORK_DIR} ${WORK_DIR}/prefix/bin/lostbits map near-benign -i sphere.press -f f32
    --size 16x16 --exr -o ${WORK_DIR}/out)
foreach(file summary.csv contact.png near-benign.exr)
    if(NOT EXISTS ${WORK_DIR}/out/near-benign/${file})
        message(FATAL_ERROR "the installed program did not write ${file}")
    endif()
endforeach()

# A form in a project of its own, as docs/your-own-form.md has it: a library that carries every arithmetic.
step(${CMAKE_COMMAND} -S ${FORM_DIR} -B ${WORK_DIR}/form -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
    ${options})
step(${CMAKE_COMMAND} --build ${WORK_DIR}/form --parallel)
step(${WORK_DIR}/prefix/bin/lostbits plugin check ${WORK_DIR}/form/geometric.so)
step(${WORK_DIR}/prefix/bin/lostbits explain near-benign --pixel 128,128 -i example.geometric -f fp16
    --plugin ${WORK_DIR}/form/geometric.so)
if(NOT last_output MATCHES "tca")
    message(FATAL_ERROR "explain does not name the form's own intermediates:\n${last_output}")
endif()

# The same by one command line, without CMake. In the short tests the compiler goes as far as the headers: documents
# have it compile the same file with the flags of the build.
set(by_hand ${CXX} ${FORM_DIR}/geometric.cpp @${WORK_DIR}/prefix/lib/lostbits/form.flags)
if(NOT DEFINED ENV{LOSTBITS_LONG})
    step(${by_hand} -E -o ${WORK_DIR}/by_hand.i)
    return()
endif()
step(${by_hand} -shared -o ${WORK_DIR}/by_hand.so)
step(${WORK_DIR}/prefix/bin/lostbits plugin check ${WORK_DIR}/by_hand.so)
