// Texts of a bound over ranges of inputs (see `ranges_text` and `ranges_json`).
#include "output/attribution/explain_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "measure/attribution/tape_text.hpp"
#include "output/file/json.hpp"

namespace lostbits::output::attribution {
using measure::apriori::InputBox;
using measure::apriori::ObservedErrors;

namespace {

using Json = file::OrderedJson;
using file::json_number;

constexpr std::size_t operations_shown = 8;

/// Operations that round, those with the largest share of the bound first.
std::vector<NodeId> nodes_by_contribution(const RangesBound& bound) {
    std::vector<NodeId> nodes;
    for (std::size_t i = 0; i < bound.node_contributions.size(); ++i)
        if (bound.node_contributions[i] > 0) nodes.push_back(static_cast<NodeId>(i));
    std::ranges::stable_sort(
        nodes, [&](NodeId a, NodeId b) { return bound.node_contributions[a] > bound.node_contributions[b]; });
    return nodes;
}

std::string ranges_block(const RangesBound& bound) {
    std::string text;
    for (std::size_t k = 0; k < bound.names.size(); ++k) {
        std::string ends;
        for (const InputBox& box : bound.ranges) {
            const std::string range_text = box[k].is_point()
                                               ? file::decimal(box[k].low)
                                               : file::decimal(box[k].low) + " to " + file::decimal(box[k].high);
            if (ends == range_text) continue;
            ends += (ends.empty() ? "" : "; ") + range_text;
        }
        if (bound.names[k] != "ray.tmax" || ends != "inf") text += fmt::format("  {:<9} = {}\n", bound.names[k], ends);
    }
    return text;
}

std::string observed_errors_text(const ObservedErrors& seen, const std::string& ray_set) {
    if (seen.bounded_hit_count == 0) return fmt::format("None of {} hits in a range with a bound.\n", ray_set);
    std::string text =
        fmt::format("Of {}, {} hit, and {} of these lie in ranges with a bound: the worst is off by {:.3g}", ray_set,
                    seen.hit_count, seen.bounded_hit_count, seen.largest_error);
    text += fmt::format(", and none by more than {:.3g} of the bound of its piece.", seen.largest_ratio);
    if (seen.running_hit_count > 0)
        text += fmt::format(
            " Running bounds of single rays are up to {:.3g}; for {} rays they are wider than the bound of the "
            "piece.",
            seen.largest_running_bound, seen.larger_running_bound_count);
    return text + "\n";
}

std::string operations_block(const RangesBound& bound) {
    const TapeText tape_text(bound.tape, bound.names, TapeText::TextStyle::pretty);
    std::string text =
        fmt::format("In the piece with the largest bound, each rounding puts t off by at most, in ulp:\n");
    const auto nodes = nodes_by_contribution(bound);
    for (std::size_t k = 0; k < std::min(nodes.size(), operations_shown); ++k)
        text += fmt::format("  {:>9.3g}  {}\n", bound.node_contributions[nodes[k]], tape_text.definition(nodes[k]));
    if (nodes.size() > operations_shown)
        text += fmt::format("  and {} other operations, by less\n", nodes.size() - operations_shown);
    return text;
}

Json observed_errors_json(const ObservedErrors& seen) {
    return {{"hits", seen.hit_count},
            {"bounded_hits", seen.bounded_hit_count},
            {"error", json_number(seen.largest_error)},
            {"share_of_bound", json_number(seen.largest_ratio)},
            {"running_hits", seen.running_hit_count},
            {"running", json_number(seen.largest_running_bound)},
            {"running_wider", seen.larger_running_bound_count}};
}

}  // namespace

std::string ranges_text(const RangesRequest& request, const RangesBound& bound) {
    std::string text = fmt::format("{} in {} over the ranges of the rays of {}, in {} piece{}:\n{}",
                                   request.form->info->name, request.format.name, request.id(), bound.box_count,
                                   bound.box_count == 1 ? "" : "s", ranges_block(bound));
    if (request.is_step())
        text += fmt::format(
            "These are the ranges of the {} rays of the step. If these are random, other rays may lie beyond.\n",
            bound.ray_count);

    // The parts of the ranges without hits, with a bound, and without one.
    text += fmt::format("No ray hits in {:.3g} % of the ranges, {:.3g} % have a bound, and {:.3g} % are undecided. ",
                        100 * bound.missed_fraction, 100 * (1 - bound.missed_fraction - bound.unknown_fraction),
                        100 * bound.unknown_fraction);
    text += fmt::format("In {:.3g} % rounding may change hit or miss.\n",
                        100 * (bound.undecided_fraction + bound.unknown_fraction));

    text += "Where rays may hit, rounding puts t off by at most\n";
    for (const auto& [fraction, error, ulps] : bound.quantiles)
        text += fmt::format("  {:>9.3g} = {:.3g} ulp in {:.0f} %\n", error, ulps, 100 * fraction);
    if (bound.unknown_fraction < 1 - bound.missed_fraction)
        text += fmt::format("  {:>9.3g} = {:.3g} ulp in all ranges with a bound\n", bound.largest, bound.largest_ulps);

    // Errors of rays, for comparison with the bound.
    text += observed_errors_text(bound.errors_of_given_rays,
                                 request.is_step() ? "the rays of the step" : "the rays of the scene");
    text += observed_errors_text(bound.errors_of_drawn_rays, "rays drawn where the bounds are largest");
    return bound.node_contributions.empty() ? text : text + operations_block(bound);
}

std::string ranges_json(const RangesRequest& request, const RangesBound& bound) {
    Json ranges = Json::array();
    for (const InputBox& box : bound.ranges) {
        Json box_json = Json::object();
        for (std::size_t k = 0; k < bound.names.size(); ++k)
            box_json[bound.names[k]] = {json_number(box[k].low), json_number(box[k].high)};
        ranges.push_back(box_json);
    }

    Json quantiles = Json::array();
    for (const auto& [fraction, error, ulps] : bound.quantiles)
        quantiles.push_back({{"share", fraction}, {"error", json_number(error)}, {"ulps", json_number(ulps)}});

    Json operations = Json::array();
    const TapeText tape_text(bound.tape, bound.names, TapeText::TextStyle::plain);
    for (const NodeId i : nodes_by_contribution(bound))
        operations.push_back({{"name", tape_text.name(i)},
                              {"expression", tape_text.expression(i)},
                              {"ulps", json_number(bound.node_contributions[i])}});

    const Json document{
        {"form", std::string(request.form->info->name)},
        {"format", request.format.name},
        {request.is_step() ? "sweep" : "scene", request.id()},
        {"ranges", ranges},
        {"boxes", bound.box_count},
        {"missed", bound.missed_fraction},
        {"unsettled", bound.unknown_fraction},
        {"undecided", bound.undecided_fraction + bound.unknown_fraction},
        {"quantiles", quantiles},
        {"largest", {{"error", json_number(bound.largest)}, {"ulps", json_number(bound.largest_ulps)}}},
        {request.is_step() ? "rays_of_step" : "rays_of_scene", observed_errors_json(bound.errors_of_given_rays)},
        {"rays_drawn", observed_errors_json(bound.errors_of_drawn_rays)},
        {"operations", operations}};
    return file::json_text(document);
}

}  // namespace lostbits::output::attribution
