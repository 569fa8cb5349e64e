# Arb as FLINT 3 has it, headers and library in one, and beside FLINT 2: in each the right one is found, and a program
# compiles against it, links and runs. A made-up prefix has FLINT 3's layout: the installed headers below
# flint/, and one library that pulls in the installed ones.
include(${CMAKE_CURRENT_LIST_DIR}/step.cmake)

# Configures, builds and runs in WORK_DIR/name; `with` is found in what the finder chose, `without` is not.
function(use_arb name with without)
    step(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/arb -B ${WORK_DIR}/${name} -DLOSTBITS=${SOURCE_DIR}
        -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Debug ${ARGN})
    string(REGEX MATCH "chosen: [^\n]*" found "${last_output}")
    if(NOT found MATCHES "${with}" OR (without AND found MATCHES "${without}"))
        message(FATAL_ERROR "${name}: ${found} should have ${with}, and not ${without}")
    endif()
    step(${CMAKE_COMMAND} --build ${WORK_DIR}/${name})
    step(${WORK_DIR}/${name}/ball)
    string(STRIP "${last_output}" last_output)
    if(NOT last_output STREQUAL "root = 4")
        message(FATAL_ERROR "${name}: printed ${last_output}")
    endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
set(prefix ${WORK_DIR}/flint3)
file(MAKE_DIRECTORY ${prefix}/include/flint ${prefix}/lib ${WORK_DIR}/flint2/include)
file(GLOB headers ${INCLUDE_DIR}/flint/*.h)
set(libraries ${FLINT})
if(NOT EXISTS ${INCLUDE_DIR}/flint/arb.h)
    list(APPEND libraries ${ARB})
    foreach(name arb arf mag acb fmpr)  # all that arb.h includes, and more
        if(EXISTS ${INCLUDE_DIR}/${name}.h)
            list(APPEND headers ${INCLUDE_DIR}/${name}.h)
        endif()
    endforeach()
endif()
foreach(header IN LISTS headers)
    get_filename_component(name ${header} NAME)
    file(CREATE_LINK ${header} ${prefix}/include/flint/${name} SYMBOLIC)
endforeach()
list(JOIN libraries " " libraries)
file(WRITE ${prefix}/lib/libflint.so "INPUT(${libraries})\n")

# Beside an installed Arb of the other kind, it is FLINT 3's that counts where it comes first.
use_arb(in_flint "${prefix}/include .*${prefix}/lib/libflint.so" "arb[.]so" -DCMAKE_PREFIX_PATH=${prefix})
# By its headers alone: the library that lies beside them, not another.
use_arb(by_headers "${prefix}/include .*${prefix}/lib/libflint.so" "arb[.]so"
    -DARB_INCLUDE_DIR=${prefix}/include)

if(ARB)
    use_arb(beside_flint "${ARB};${FLINT}" "flint3")
    # The compiler may know of another flint/arb.h: it is the finder that says which is meant.
    file(WRITE ${WORK_DIR}/flint2/include/flint/arb.h "#error the header of another FLINT\n")
    set(ENV{CPATH} ${WORK_DIR}/flint2/include)
    use_arb(beside_another "${ARB};${FLINT}" "flint3")
endif()
