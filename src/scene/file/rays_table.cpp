#include "scene/file/rays_table.hpp"

#include "scene/toml/round.hpp"

namespace lostbits::scene::file {

Range<double> read_rays(toml::TableReader table, Inputs inputs, const StoredNumbers& numbers) {
    const FloatFormat& stored = inputs == Inputs::shared ? binary32 : binary64;
    Range<double> range;
    const auto number = [&](std::string_view key, double otherwise) {
        const auto x = table.optional_number(key);
        return x ? toml::round_to_format(numbers.finite(table, key, *x), stored) : otherwise;
    };
    range.tmin = number("tmin", range.tmin);
    range.tmax = number("tmax", range.tmax);
    range.open = table.optional_one_of<OpenEnds>("open_ends", open_ends_names).value_or(OpenEnds{});
    table.reject_unknown_keys();
    if (range.tmin < 0) table.fail_at("tmin", "is below 0, and a ray looks ahead; write 0 or more");
    if (!range.holds_any())
        table.fail_at(table.has("tmax") ? "tmax" : "tmin",
                      "leaves no t between tmin and tmax; write a tmax above tmin, or leave one of them out");
    return range;
}

}  // namespace lostbits::scene::file
