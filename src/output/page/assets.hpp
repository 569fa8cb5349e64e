// What src/output/page/script/*.js and *.css hold, put into the program by the build (cmake/embed.cmake).
#pragma once

#include <string_view>

namespace lostbits::output::page {

/// The text of an inline element and its SHA-256, in hexadecimal digits.
struct Asset {
    std::string_view text, sha256;
};

extern const Asset page_style, page_script;
/// uPlot, where node_modules had it when the program was configured; otherwise empty.
extern const Asset plot_style, plot_script, plot_licence;

}  // namespace lostbits::output::page
