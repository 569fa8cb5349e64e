// Identifies the build of the headers: two builds that differ may lay out their rows differently.
#pragma once

#include <lostbits_build.hpp>

#include <glm/glm.hpp>

namespace lostbits::intersect::external {

#define LOSTBITS_WORDS(x) LOSTBITS_WORDS_OF(x)
#define LOSTBITS_WORDS_OF(x) #x
#if defined(_GLIBCXX_RELEASE)
#define LOSTBITS_LIBRARY_WORDS "libstdc++ " LOSTBITS_WORDS(_GLIBCXX_RELEASE)
#else
#define LOSTBITS_LIBRARY_WORDS "libc++ " LOSTBITS_WORDS(_LIBCPP_VERSION)
#endif
inline constexpr const char* build_words =
    "lostbits " LOSTBITS_BUILD ", " LOSTBITS_LIBRARY_WORDS ", GLM " LOSTBITS_WORDS(GLM_VERSION);
#undef LOSTBITS_LIBRARY_WORDS
#undef LOSTBITS_WORDS_OF
#undef LOSTBITS_WORDS

}  // namespace lostbits::intersect::external
