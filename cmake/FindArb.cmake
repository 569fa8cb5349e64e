# Finds Arb. With FLINT 2 it is a separate library (flint-arb in Debian, arb elsewhere); from FLINT 3 on it is a part of
# FLINT. ARB_IN_FLINT says which of the two was found. CMake uses it, and so do the sources, since the compiler may also
# find another arb.h.
find_path(ARB_INCLUDE_DIR NAMES flint/arb.h arb.h)
find_library(FLINT_LIBRARY flint HINTS ${ARB_INCLUDE_DIR}/../lib)
find_library(ARB_LIBRARY NAMES flint-arb arb HINTS ${ARB_INCLUDE_DIR}/../lib)
if(ARB_INCLUDE_DIR AND EXISTS ${ARB_INCLUDE_DIR}/flint/arb.h)
    set(ARB_IN_FLINT 1)
    set(ARB_LIBRARIES ${FLINT_LIBRARY})
elseif(ARB_LIBRARY)
    set(ARB_IN_FLINT 0)
    set(ARB_LIBRARIES ${ARB_LIBRARY} ${FLINT_LIBRARY})
endif()
find_package(MPFR QUIET)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Arb REQUIRED_VARS ARB_LIBRARIES FLINT_LIBRARY ARB_INCLUDE_DIR MPFR_FOUND)
if(Arb_FOUND AND NOT TARGET Arb::Arb)
    add_library(Arb::Arb INTERFACE IMPORTED)
    set_target_properties(Arb::Arb PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${ARB_INCLUDE_DIR}
                                              INTERFACE_COMPILE_DEFINITIONS ARB_IN_FLINT=${ARB_IN_FLINT}
                                              INTERFACE_LINK_LIBRARIES "${ARB_LIBRARIES};MPFR::MPFR")
endif()
