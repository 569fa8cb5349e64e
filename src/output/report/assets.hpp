// The contents of src/output/report/script/*.js and *.css, which the build embeds in the program (cmake/embed.cmake).
#pragma once

#include <string_view>

namespace lostbits::output::report {

/// Text of an inline element, and its SHA-256 in hexadecimal digits.
struct Asset {
    std::string_view text, sha256;
};

extern const Asset page_style, page_script;

}  // namespace lostbits::output::report
