#include "scene/sweep/sweep_head.hpp"

#include <algorithm>

#include "scene/toml/result_name.hpp"

namespace lostbits::scene::sweep {

SweepHead read_sweep_head(toml::TableReader& file, const std::filesystem::path& path) {
    toml::require_schema(file, sweep_schema);
    return {.id = toml::result_name(path),
            .title = file.title("title"),
            .source = file.string("source"),
            .note = file.optional_string("note").value_or("")};
}

namespace {

/// `distance, in radii` of `distance_radii`: a name that ends in its unit says it once.
std::string words_of(std::string name, const std::string& unit) {
    const std::string plural = unit == "r" ? "radii" : unit;
    if (!unit.empty() && name.ends_with("_" + plural)) name.resize(name.size() - plural.size() - 1);
    std::ranges::replace(name, '_', ' ');
    return unit.empty() || unit == "1" ? name : name + ", in " + plural;
}

}  // namespace

AxisName read_axis_name(toml::TableReader& axis) {
    AxisName read{axis.string("name"), axis.optional_string("unit").value_or(""), "", axis.where("name")};
    const bool plain = !read.name.empty() && std::ranges::all_of(read.name, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!plain)
        axis.fail_at("name", "must be a column name of lower-case letters, digits and _, such as \"distance_radii\"");
    read.label = axis.has("label") ? axis.title("label") : words_of(read.name, read.unit);
    return read;
}

}  // namespace lostbits::scene::sweep
