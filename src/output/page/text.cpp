#include "output/page/text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/file/escape.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::page {

std::string html(std::string_view text) {
    std::string out;
    for (const char c : file::xml_text(text)) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else out += c;
    }
    return out;
}

std::string shown(double value) {
    if (std::isnan(value)) return "&ndash;";
    const std::string look = value != 0 && (std::fabs(value) < 1e-3 || std::fabs(value) >= 1e7)
                                 ? fmt::format("{:.2e}", value)
                                 : fmt::format("{:.4g}", value);
    return fmt::format("<data value=\"{}\">{}</data>", file::decimal(value),
                       value == std::floor(value) && std::fabs(value) < 1e7 ? file::decimal(value) : look);
}

}  // namespace lostbits::output::page
