// Identifies the build of the headers. The layout of a table row may differ between builds, so a library and a program
// of different builds cannot share rows.
#pragma once

#include <lostbits_build.hpp>

#include <glm/glm.hpp>

namespace lostbits::intersect::external {

#define LOSTBITS_QUOTED(x) LOSTBITS_QUOTED_OF(x)
#define LOSTBITS_QUOTED_OF(x) #x
#if defined(_GLIBCXX_RELEASE)
#define LOSTBITS_LIBRARY_VERSION "libstdc++ " LOSTBITS_QUOTED(_GLIBCXX_RELEASE)
#else
#define LOSTBITS_LIBRARY_VERSION "libc++ " LOSTBITS_QUOTED(_LIBCPP_VERSION)
#endif
inline constexpr const char* build_id =
    "lostbits " LOSTBITS_BUILD ", " LOSTBITS_LIBRARY_VERSION ", GLM " LOSTBITS_QUOTED(GLM_VERSION);
#undef LOSTBITS_LIBRARY_VERSION
#undef LOSTBITS_QUOTED_OF
#undef LOSTBITS_QUOTED

}  // namespace lostbits::intersect::external
