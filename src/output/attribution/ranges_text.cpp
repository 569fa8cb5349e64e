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
std::vector<NodeId> nodes_by_share(const RangesBound& r) {
    std::vector<NodeId> nodes;
    for (std::size_t i = 0; i < r.node_contributions.size(); ++i)
        if (r.node_contributions[i] > 0) nodes.push_back(static_cast<NodeId>(i));
    std::ranges::stable_sort(nodes, [&](NodeId a, NodeId b) {
        return r.node_contributions[static_cast<std::size_t>(a)] > r.node_contributions[static_cast<std::size_t>(b)];
    });
    return nodes;
}

std::string ranges_block(const RangesBound& r) {
    std::string text;
    for (std::size_t k = 0; k < r.names.size(); ++k) {
        std::string ends;
        for (const InputBox& box : r.ranges) {
            const std::string range_text = box[k].is_point()
                                               ? file::decimal(box[k].low)
                                               : file::decimal(box[k].low) + " to " + file::decimal(box[k].high);
            if (ends == range_text) continue;
            ends += (ends.empty() ? "" : "; ") + range_text;
        }
        if (r.names[k] != "ray.tmax" || ends != "inf") text += fmt::format("  {:<9} = {}\n", r.names[k], ends);
    }
    return text;
}

std::string observed_errors_text(const ObservedErrors& seen, const std::string& ray_set) {
    if (seen.bounded_hits == 0) return fmt::format("None of {} hits in a range with a bound.\n", ray_set);
    std::string text =
        fmt::format("Of {}, {} hit, and {} of these lie in ranges with a bound: the worst is off by {:.3g}", ray_set,
                    seen.hits, seen.bounded_hits, seen.largest_error);
    text += fmt::format(", and none by more than {:.3g} of the bound of its box.", seen.largest_ratio);
    if (seen.running_hits > 0)
        text += fmt::format(
            " Running bounds of single rays are up to {:.3g}; for {} rays they are wider than the bound of the box.",
            seen.largest_running_bound, seen.wider_running_bounds);
    return text + "\n";
}

std::string operations_block(const RangesBound& r) {
    const TapeText tape_text(r.tape, r.names, TapeText::Style::pretty);
    std::string text = fmt::format("In the box with the largest bound, each rounding puts t off by at most, in ulp:\n");
    const auto nodes = nodes_by_share(r);
    for (std::size_t k = 0; k < std::min(nodes.size(), operations_shown); ++k)
        text += fmt::format("  {:>9.3g}  {}\n", r.node_contributions[static_cast<std::size_t>(nodes[k])],
                            tape_text.definition(nodes[k]));
    if (nodes.size() > operations_shown)
        text += fmt::format("  and {} other operations, by less\n", nodes.size() - operations_shown);
    return text;
}

Json observed_errors_json(const ObservedErrors& seen) {
    return {{"hits", seen.hits},
            {"bounded_hits", seen.bounded_hits},
            {"error", json_number(seen.largest_error)},
            {"share_of_bound", json_number(seen.largest_ratio)},
            {"running_hits", seen.running_hits},
            {"running", json_number(seen.largest_running_bound)},
            {"running_wider", seen.wider_running_bounds}};
}

}  // namespace

std::string ranges_text(const RangesRequest& request, const RangesBound& r) {
    std::string text =
        fmt::format("{} in {} over the ranges of the rays of {}, in {} box{}:\n{}", request.form->info->name,
                    request.format.name, request.id(), r.boxes, r.boxes == 1 ? "" : "es", ranges_block(r));
    if (request.is_step())
        text += fmt::format(
            "These are the ranges of the {} rays of the step. If these are random, other rays may lie beyond.\n",
            r.rays);
    text += fmt::format("No ray hits in {:.3g} % of the ranges, {:.3g} % have a bound, and {:.3g} % are undecided. ",
                        100 * r.missed_share, 100 * (1 - r.missed_share - r.unknown_share), 100 * r.unknown_share);
    text += fmt::format("In {:.3g} % rounding may change hit or miss.\n", 100 * (r.undecided_share + r.unknown_share));
    text += "Where rays may hit, rounding puts t off by at most\n";
    for (const auto& [share, error, ulps] : r.quantiles)
        text += fmt::format("  {:>9.3g} = {:.3g} ulp in {:.0f} %\n", error, ulps, 100 * share);
    if (r.unknown_share < 1 - r.missed_share)
        text += fmt::format("  {:>9.3g} = {:.3g} ulp in all ranges with a bound\n", r.largest, r.largest_ulps);
    text += observed_errors_text(r.errors_of_given_rays,
                                 request.is_step() ? "the rays of the step" : "the rays of the scene");
    text += observed_errors_text(r.errors_of_drawn_rays, "rays drawn where the bounds are largest");
    return r.node_contributions.empty() ? text : text + operations_block(r);
}

std::string ranges_json(const RangesRequest& request, const RangesBound& r) {
    Json ranges = Json::array(), quantiles = Json::array(), operations = Json::array();
    for (const InputBox& box : r.ranges) {
        Json box_json = Json::object();
        for (std::size_t k = 0; k < r.names.size(); ++k)
            box_json[r.names[k]] = {json_number(box[k].low), json_number(box[k].high)};
        ranges.push_back(box_json);
    }
    for (const auto& [share, error, ulps] : r.quantiles)
        quantiles.push_back({{"share", share}, {"error", json_number(error)}, {"ulps", json_number(ulps)}});
    const TapeText tape_text(r.tape, r.names, TapeText::Style::plain);
    for (const NodeId i : nodes_by_share(r))
        operations.push_back({{"name", tape_text.name(i)},
                              {"expression", tape_text.expression(i)},
                              {"ulps", json_number(r.node_contributions[static_cast<std::size_t>(i)])}});
    const Json document{
        {"form", std::string(request.form->info->name)},
        {"format", request.format.name},
        {request.is_step() ? "sweep" : "scene", request.id()},
        {"ranges", ranges},
        {"boxes", r.boxes},
        {"missed", r.missed_share},
        {"unsettled", r.unknown_share},
        {"undecided", r.undecided_share + r.unknown_share},
        {"quantiles", quantiles},
        {"largest", {{"error", json_number(r.largest)}, {"ulps", json_number(r.largest_ulps)}}},
        {request.is_step() ? "rays_of_step" : "rays_of_scene", observed_errors_json(r.errors_of_given_rays)},
        {"rays_drawn", observed_errors_json(r.errors_of_drawn_rays)},
        {"operations", operations}};
    return file::json_text(document);
}

}  // namespace lostbits::output::attribution
