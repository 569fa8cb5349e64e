#include "output/sweep/exhaustive_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "output/blame/explain_command.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::sweep {

using measure::answer::Outcome;
using measure::sweep::ExhaustiveRequest;
using measure::sweep::FloatTally;
using measure::sweep::RangeFinding;
using scene::sweep::float_at;

namespace {

std::string_view failure(Outcome o) {
    switch (o) {
        case Outcome::false_hit: return "a false hit";
        case Outcome::false_miss: return "a false miss";
        case Outcome::wrong_object: return "a hit of another triangle";
        case Outcome::crack: return "a crack";
        case Outcome::double_hit: return "a double hit";
        case Outcome::out_of_order: return "two triangles out of order";
        default: return "a hit at a t that is not a number";
    }
}

/// `1 float`, `2 floats`.
std::string count_text(std::uint64_t n) { return fmt::format("{} float{}", n, n == 1 ? "" : "s"); }

/// ` (12 crack, 3 double hit)`.
std::string kinds_text(const FloatTally& tally) {
    std::vector<std::string> kinds;
    for (const Outcome o : measure::answer::wrong_decisions) {
        if (tally.count(o) == 0) continue;
        kinds.push_back(
            fmt::format("{} {}", tally.count(o), measure::answer::outcome_names[static_cast<std::size_t>(o)]));
        std::ranges::replace(kinds.back(), '_', ' ');
    }
    return fmt::format(" ({})", fmt::join(kinds, ", "));
}

}  // namespace

std::string float_bits(std::uint32_t place) {
    return fmt::format("{:#010x}", std::bit_cast<std::uint32_t>(float_at(place)));
}

std::string float_text(std::uint32_t place) {
    const float x = float_at(place);
    if (std::isnan(x)) return fmt::format("nan ({})", float_bits(place));
    const std::string hex = file::hex(static_cast<double>(x)), decimal = file::decimal(x);
    return std::isinf(x) ? hex : fmt::format("{} ({})", hex, decimal);
}

std::string statement(const ExhaustiveRequest& request, const RangeFinding& f) {
    const auto& sweep = *request.sweep;
    const FloatTally& tally = f.tally;
    std::string text =
        fmt::format("all {} between {} and {} were tried: {}", count_text(tally.floats()), float_text(f.floats.first),
                    float_text(f.floats.last), request.rows[f.row].form->info->name);
    if (const auto judged = request.rows[f.row].judged)
        text += fmt::format(", judged by the {} solid,", intersect::convention_name(judged));
    if (sweep.rays.size() > 1) text += fmt::format(" on the ray {}", sweep.rays[f.ray].name);
    if (!tally.first_wrong) {
        text += tally.count(Outcome::unresolved) == 0
                    ? " decides rightly for every one of them"
                    : fmt::format(" decides rightly for every one but {} whose truth is not proved",
                                  tally.count(Outcome::unresolved));
        return text;
    }
    const auto& wrong = *tally.first_wrong;
    const auto good = f.before(wrong.place);
    text += good ? fmt::format(" decides rightly for every float {} {}, and first fails at {}: {}",
                               f.floats.falls() ? "down to" : "up to", float_text(*good), float_text(wrong.place),
                               failure(wrong.outcome))
                 : fmt::format(" fails at the first of them already: {}", failure(wrong.outcome));
    text += fmt::format("; it decides wrongly for {} in all{}, the last at {}", count_text(tally.wrong()),
                        sweep.mesh ? kinds_text(tally) : "", float_text(tally.last_wrong->place));
    if (tally.padding)
        text += fmt::format("; to miss none it needs {} u of padding more", file::decimal(tally.padding->u));
    return text;
}

std::string explain_float(const ExhaustiveRequest& request, std::size_t ray, std::size_t row, std::uint32_t place) {
    const scene::rays::RayGroup group = request.sweep->group_at(ray, float_at(place));
    const std::string scene = request.sweep->mesh ? request.scene + " " : "";
    return blame::explain_command(scene + blame::name_of_ray(&group), request.rows[row]);
}

}  // namespace lostbits::output::sweep
