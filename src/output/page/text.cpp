#include "output/page/text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::page {

using measure::answer::Outcome;

namespace {

double fraction(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? std::numeric_limits<double>::quiet_NaN()
                      : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::string html(std::string_view text) {
    std::string out;
    for (const char c : file::valid_utf8(text)) {
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

double false_hit_fraction(const measure::map::MapSummary& s) {
    return fraction(s.count(Outcome::false_hit), s.rays - s.true_hits - s.count(Outcome::unresolved));
}
double false_miss_fraction(const measure::map::MapSummary& s) {
    return fraction(s.count(Outcome::false_miss), s.true_hits);
}

}  // namespace lostbits::output::page
