// Identifies the build of the headers: two builds that differ may lay out their rows differently.
#pragma once

#include <lostbits_build.hpp>

#include <glm/glm.hpp>

namespace lostbits::intersect::external {

#define LOSTBITS_QUOTED(x) LOSTBITS_QUOTED_OF(x)
#define LOSTBITS_QUOTED_OF(x) #x
#if defined(_GLIBCXX_RELEASE)
#define LOSTBITS_LIBRARY_WORDS "libstdc++ " LOSTBITS_QUOTED(_GLIBCXX_RELEASE)
#else
#define LOSTBITS_LIBRARY_WORDS "libc++ " LOSTBITS_QUOTED(_LIBCPP_VERSION)
#endif
inline constexpr const char* build_id =
    "lostbits " LOSTBITS_BUILD ", " LOSTBITS_LIBRARY_WORDS ", GLM " LOSTBITS_QUOTED(GLM_VERSION);
#undef LOSTBITS_LIBRARY_WORDS
#undef LOSTBITS_QUOTED_OF
#undef LOSTBITS_QUOTED

}  // namespace lostbits::intersect::external
