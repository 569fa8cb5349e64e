# What a compiler must not do to arithmetic, in every object that computes.
# - Contraction would turn a·b − c into one rounding where a formula says two, at -march=haswell and above, even in ISO
#   mode.
# - GCC 12.2 forgets to round where two doubles side by side become floats and doubles again: at -O2, the function
#   `Pair f(double a, double b) { return {(float)a, (float)b}; }` of a struct of two doubles returns a and b. Its
#   vectorizer of straight-line code makes one conversion of the two, which a later pass takes for nothing. (Rays of
#   binary32 had 53 bits so, once a change of unrelated code had made the compiler look there.) `test_contraction` tries it.
set(LOSTBITS_ARITHMETIC_FLAGS -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)

# Object libraries for one register width each. What is compiled here must have names that nothing else has: the test
# `packed_symbols` holds the objects to that.
set(LOSTBITS_ISAS w128)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    list(APPEND LOSTBITS_ISAS w256 w512)
endif()

# The forms over packs take a minute of compiling a width, and a run uses one: a build for this machine alone needs only
# the widest that it has. A package and the tests have all.
set(LOSTBITS_PACK_WIDTHS all CACHE STRING "Register widths of the forms over packs: all, or machine (the widest here)")
set(LOSTBITS_PACK_ISAS ${LOSTBITS_ISAS})
if(LOSTBITS_PACK_WIDTHS STREQUAL "machine" AND EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
    set(LOSTBITS_PACK_ISAS w128)
    if(flags MATCHES " avx2 " AND flags MATCHES " fma ")
        set(LOSTBITS_PACK_ISAS w256)
        if(flags MATCHES " bmi2 " AND flags MATCHES " avx512f " AND flags MATCHES " avx512dq " AND flags MATCHES " avx512vl ")
            set(LOSTBITS_PACK_ISAS w512)
        endif()
    endif()
elseif(NOT LOSTBITS_PACK_WIDTHS MATCHES "^(all|machine)$")
    message(FATAL_ERROR "LOSTBITS_PACK_WIDTHS is all or machine, not ${LOSTBITS_PACK_WIDTHS}")
endif()

# lostbits_isa_flags(TARGET ISA): the flags of that width; sources learn it from number/width.hpp.
function(lostbits_isa_flags name isa)
    string(SUBSTRING ${isa} 1 -1 bits)
    math(EXPR bytes "${bits} / 8")
    target_compile_definitions(${name} PRIVATE GLM_FORCE_XYZW_ONLY LOSTBITS_ISA=${isa} LOSTBITS_REGISTER_BYTES=${bytes})
    # Optimised in every configuration: what the library's headers define is inlined then, and leaves no function behind
    # that the linker could give to others. At -O2 the three axes of a box stay a loop, with every pack in memory.
    target_compile_options(${name} PRIVATE ${LOSTBITS_ARITHMETIC_FLAGS} -O3)
    # GCC needs minutes to instrument a kernel in which everything is inlined. The kernels see whole packs only; the
    # code that cuts batches into them is instrumented like everything else.
    target_compile_options(${name} PRIVATE -fno-sanitize=all)
    if(isa STREQUAL "w256")
        target_compile_options(${name} PRIVATE -mavx2 -mfma)
    elseif(isa STREQUAL "w512")
        # BMI2 because libstdc++'s masks use it without asking.
        target_compile_options(${name} PRIVATE -mavx2 -mfma -mbmi2 -mavx512f -mavx512dq -mavx512vl)
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
            # GCC 12 warns of its own _mm512_undefined_ps (its bug 105593).
            target_compile_options(${name} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
        endif()
    endif()
endfunction()

# lostbits_isa_library(NAME ISA SOURCES…): an object library with the flags of that width and of no other. It links
# nothing: it is used through its objects.
function(lostbits_isa_library name isa)
    add_library(${name} OBJECT ${ARGN})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_compile_features(${name} PRIVATE cxx_std_20)
    target_link_libraries(${name} PRIVATE glm::glm lostbits_warnings)
    lostbits_isa_flags(${name} ${isa})
endfunction()
