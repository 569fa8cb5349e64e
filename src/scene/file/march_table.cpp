#include "scene/file/march_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "number/rounded.hpp"
#include "scene/toml/round.hpp"

namespace lostbits::scene::file {

using intersect::MarchConstants;
using toml::TableReader;

namespace {

Real read_positive(TableReader& table, std::string_view key, const char* default_value, InputRounding inputs) {
    const Real x = table.optional_number(key).value_or(Real(default_value));
    const double stored = toml::round_to_format(x, inputs == InputRounding::shared ? binary32 : binary64);
    if (!(x > 0) || stored == 0)
        table.fail_at(key, "must be greater than 0 when it is stored; write a positive number, such as " +
                               std::string(default_value));
    if (std::isinf(stored))
        table.fail_at(key, "overflows binary32, to which inputs = \"shared\" rounds; write at most 3.4e38");
    return x;
}

/// Reads a whole number. It may be written as a real, because an axis of a sweep may set it.
int read_count(TableReader& table, std::string_view key, int lowest, int highest, int default_value) {
    const auto x = table.optional_number(key);
    if (!x) return default_value;
    if (*x != floor(*x) || *x < lowest || *x > highest) {
        table.fail_at(key, "must be a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest) +
                               ", such as " + std::to_string(default_value));
    }
    return static_cast<int>(*x);
}

}  // namespace

MarchConstants<Real> read_march(TableReader table, InputRounding inputs) {
    MarchConstants<Real> constants{
        read_positive(table, "hit_eps", "0.001", inputs), read_positive(table, "max_dist", "20", inputs),
        read_positive(table, "relative_eps", "0.001", inputs), read_positive(table, "cone", "0.001", inputs),
        read_positive(table, "over_relaxation", "1.4", inputs)};
    if (constants.over_relaxation < 1 ||
        toml::round_to_format(constants.over_relaxation, inputs == InputRounding::shared ? binary32 : binary64) >= 2)
        table.fail_at(
            "over_relaxation",
            "must lie in [1, 2): below 1 steps get shorter, and at 2 or more a step is longer than its sphere "
            "is wide; try 1.4");
    constants.max_steps = read_count(table, "max_steps", 1, 100000, constants.max_steps);
    constants.secant_steps = read_count(table, "secant_steps", 0, 200, constants.secant_steps);
    constants.bisect_steps = read_count(table, "bisect_steps", 0, 200, constants.bisect_steps);
    table.require_known_keys();
    return constants;
}

MarchConstants<double> round_march(const MarchConstants<Real>& ideal, const FloatFormat& format) {
    return convert_numbers(ideal, [&format](const Real& x) { return toml::round_to_format(x, format); });
}

MarchConstants<double> round_march(const MarchConstants<double>& constants, const FloatFormat& format) {
    return convert_numbers(constants, [&format](double x) { return rounding::to_format(x, 0, format); });
}

std::vector<std::string> find_unrepresentable_constants(const Scene& scene, const FloatFormat& format) {
    std::vector<std::string> lost;
    if (!scene.march) return lost;
    const bool is_shared = scene.inputs == InputRounding::shared;
    std::size_t i = 0;
    convert_numbers(*scene.march, [&](const Real& ideal) {
        const double stored = toml::round_to_format(ideal, is_shared ? binary32 : binary64),
                     rounded = rounding::to_format(stored, 0, format);
        const std::string_view name = intersect::march_number_names[i++];
        if (stored != 0 && (rounded == 0 || std::isinf(rounded)))
            lost.push_back(fmt::format("{} = {:g} rounds to {}", name, stored, rounded == 0 ? "0" : "infinity"));
        return rounded;
    });
    return lost;
}

}  // namespace lostbits::scene::file
