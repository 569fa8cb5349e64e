# Flags that keep a compiler from changing arithmetic, for every object that computes.
# - -ffp-contract=off: contraction would turn the two roundings of a·b − c into one, at -march=haswell and above, even
#   in ISO mode.
# - -fno-tree-slp-vectorize: GCC 12.2 forgets to round if two adjacent doubles become floats and doubles again. At -O2,
#   the function `Pair f(double a, double b) { return {(float)a, (float)b}; }` for a struct of two doubles returns a and
#   b. The vectorizer of straight-line code makes one conversion of the two, and a later pass drops it. Once, after an
#   unrelated change of code, rays of binary32 therefore had 53 bits. `test_contraction` tests it.
set(LOSTBITS_ARITHMETIC_FLAGS -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)

# Flags of a release for code without slow loops: text, files, commands. It takes as long as at -O1, within 1 %, and the
# compiler takes two thirds of the time. These passes, which -Og leaves out, make the code a fifth smaller, mostly the
# tables for exceptions, and the compiler takes no longer, since later passes have less to do.
set(LOSTBITS_FAST_BUILD_FLAGS -Og)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND LOSTBITS_FAST_BUILD_FLAGS -finline-functions-called-once -ftree-sra -ftree-dse -fdse -fcrossjumping)
endif()

# Register widths. There is an object library for each. Its code must have names that no other object uses; the test
# `packed_symbols` checks that.
set(LOSTBITS_ISAS w128)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    list(APPEND LOSTBITS_ISAS w256 w512)
endif()

# Compiling the code over packs takes half a minute per width, and a run uses only one width. A build for this machine
# needs only the widest that it has. Packages and tests need all.
set(LOSTBITS_PACK_WIDTHS all CACHE STRING "Register widths of code over packs: all, or machine (the widest here)")
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
    message(FATAL_ERROR "LOSTBITS_PACK_WIDTHS is ${LOSTBITS_PACK_WIDTHS}; it must be all or machine")
endif()

# lostbits_isa_flags(TARGET ISA): adds the flags of a register width. Sources get the width from number/width.hpp.
function(lostbits_isa_flags name isa)
    string(SUBSTRING ${isa} 1 -1 bits)
    math(EXPR bytes "${bits} / 8")
    target_compile_definitions(${name} PRIVATE GLM_FORCE_XYZW_ONLY LOSTBITS_ISA=${isa} LOSTBITS_REGISTER_BYTES=${bytes})
    # Optimised in every configuration. Functions of the standard library's headers are then inlined and leave no symbol
    # that the linker could use for other objects. At -O2 the three axes of a box would stay a loop, with every pack in
    # memory.
    target_compile_options(${name} PRIVATE ${LOSTBITS_ARITHMETIC_FLAGS} -O3)
    # Not under sanitizers, since GCC needs minutes to instrument a kernel in which everything is inlined. Kernels see
    # only whole packs. The code that cuts batches into packs is instrumented like everything else.
    target_compile_options(${name} PRIVATE -fno-sanitize=all)
    if(isa STREQUAL "w256")
        target_compile_options(${name} PRIVATE -mavx2 -mfma)
    elseif(isa STREQUAL "w512")
        # BMI2, because libstdc++'s masks use it without a check.
        target_compile_options(${name} PRIVATE -mavx2 -mfma -mbmi2 -mavx512f -mavx512dq -mavx512vl)
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
            # GCC 12 warns of its own _mm512_undefined_ps (its bug 105593).
            target_compile_options(${name} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
        endif()
    endif()
endfunction()

# lostbits_isa_library(NAME ISA SOURCES…): adds an object library with the flags of one register width. Targets use its
# objects; they do not link with it.
function(lostbits_isa_library name isa)
    add_library(${name} OBJECT ${ARGN})
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_compile_features(${name} PRIVATE cxx_std_20)
    target_link_libraries(${name} PRIVATE glm::glm lostbits_warnings)
    lostbits_isa_flags(${name} ${isa})
endfunction()
