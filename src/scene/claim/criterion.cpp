#include "scene/claim/criterion.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <variant>

#include "scene/toml/parse_number.hpp"

namespace lostbits::scene::claim {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Of `> 0`: what stands before the number.
std::string comparison_of(const std::string& text) {
    for (const char* each : {"<=", ">=", "<", ">", "="}) {
        if (text.starts_with(each)) return each;
    }
    return "";
}

Criterion compared(toml::TableReader& table, const std::string& text) {
    const std::string comparison = comparison_of(text);
    const auto digits = text.find_first_not_of(' ', comparison.size());
    if (comparison.empty() || digits == std::string::npos)
        table.fail_at("criterion", "is \"" + text +
                                       "\"; write what the sentence says of the number, such as \"= 0\", \"> 0\" or "
                                       "\">= 10\", or the ends of an interval, [0.4, 0.6]");
    const auto read = toml::parse_number(std::string_view(text).substr(digits));
    if (const auto* fault = std::get_if<toml::NumberFault>(&read))
        table.fail_at("criterion", "is \"" + text + "\", in which " + text.substr(digits) + " " + fault->why);
    const auto x = static_cast<double>(std::get<Real>(read));
    const std::string shown = comparison + " " + text.substr(digits);
    if (comparison == "=") return {x, x, shown};
    if (comparison == ">") return {std::nextafter(x, infinite), infinite, shown};
    if (comparison == ">=") return {x, infinite, shown};
    return {-infinite, comparison == "<" ? std::nextafter(x, -infinite) : x, shown};
}

}  // namespace

std::optional<Criterion> read_criterion(toml::TableReader& table) {
    if (!table.has("criterion")) return std::nullopt;
    if (table.node("criterion").kind != toml::Node::Kind::array) return compared(table, table.string("criterion"));
    const auto ends = table.numbers("criterion", 2);
    const auto low = static_cast<double>(ends[0]), high = static_cast<double>(ends[1]);
    if (!(low <= high)) table.fail_at("criterion", "must be [low, high] with low <= high");
    return Criterion{low, high, fmt::format("[{}, {}]", low, high)};
}

void Criterion::demand(const toml::TableReader& table, std::string_view verdict, double from, double to) const {
    const bool met = is_met_by(from, to), failed = is_failed_by(from, to);
    if (verdict == "holds" ? met : verdict == "refuted" ? failed : met || failed) return;
    table.fail_at("criterion", fmt::format("is {}, which is {} of the numbers in [{}, {}]: the verdict \"{}\" does not "
                                           "follow; change the verdict, the sentence or the interval",
                                           text,
                                           met      ? "true"
                                           : failed ? "false"
                                                    : "true of some and false of others",
                                           from, to, verdict));
}

}  // namespace lostbits::scene::claim
