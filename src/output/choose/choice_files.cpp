#include "output/choose/choice_files.hpp"

#include <fmt/format.h>

#include "measure/choose/file_rays.hpp"
#include "output/file/atomic_file.hpp"
#include "output/image/figure.hpp"
#include "output/plot/scatter_plot.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::choose {

using measure::choose::Input;
using table::or_missing;
using table::Table;
using table::when;

ChoiceResult choose_among(const measure::choose::ChoiceRequest& request, const std::vector<Candidate>& candidates,
                          measure::choose::TimedRays timed) {
    ChoiceResult result{request, candidates, timed, find_cheapest(candidates, request.requirement)};
    measure::choose::ChoiceRequest quiet_request = request;
    quiet_request.show = {};
    quiet_request.progress = [](std::uint64_t) {};
    if (result.cheapest_index)
        result.margins = find_margins(quiet_request, candidates[*result.cheapest_index].tested_form);
    else
        result.obstacle = find_obstacle(
            quiet_request, candidates[*find_nearest_candidate(candidates, request.requirement)].tested_form);
    return result;
}

Table<FormQuality> make_quality_columns() {
    return {{"rays", "rays whose truth is known", &FormQuality::ray_count},
            {"true_hits", "rays that truly hit", &FormQuality::true_hit_count},
            {"wrong", "false hits, false misses, NaNs and hits of another primitive", &FormQuality::wrong_count},
            {"wrong_fraction", "1", "wrong/rays", &FormQuality::wrong_fraction},
            {"kept_bits", "bits", "significand bits less the lost bits, at the required share of the agreed hits",
             or_missing(&FormQuality::kept_bits)}};
}

Table<CandidateRow> make_candidate_table() {
    using R = CandidateRow;
    Table<R> table;
    table.add(trade::kernel_columns("form under test; file.NAME: the answers in the files of rays"), &R::kernel);
    table.add(trade::time_columns("per ray and primitive; median of the repetitions; missing: not known",
                                  "per ray and primitive; "),
              &R::time);
    table.add(make_quality_columns(), &R::quality);
    table.add({{"distance_error", "length",
                "distance of the hit point from the true one along the ray, at the same share; missing: the "
                "requirement has no tolerance",
                or_missing([](const R& r) { return r.quality->distance_error; })},
               {"meets", "true if it meets the requirement", &R::meets_requirement},
               {"chosen", "true for the cheapest that meets the requirement", &R::is_chosen},
               {"mended", "the form that was repaired, and how; missing for a form as it is",
                [](const R& r) { return r.repair ? r.repair->method : ""; }}});
    return table;
}

Table<GrowthMargin> make_margin_table() {
    using measure::choose::MarginEnd;
    Table<GrowthMargin> table{
        {"way", "the quantity that grows: distance, radius, offset or view",
         [](const GrowthMargin& margin) {
             return measure::choose::growth_names[static_cast<std::size_t>(margin.growth)];
         }},
        {"holds", "1", "the largest factor at which the requirement was met; 0: not even by the scene as it is",
         &GrowthMargin::holding_factor},
        {"value", "the quantity at that factor, in world units or, for view, degrees; missing if holds is 0",
         [](const GrowthMargin& margin) { return when(margin.holding_factor != 0, margin.value); }},
        {"beyond", "1", "the smallest larger factor that was tried; missing: none",
         [](const GrowthMargin& margin) { return when(margin.end_factor != 0, margin.end_factor); }},
        {"end",
         "state at that factor: fails (the requirement), nothing_hit, other_scene (rounding stores another scene), "
         "none (as far as was tried)",
         [](const GrowthMargin& margin) {
             return measure::choose::margin_end_names[static_cast<std::size_t>(margin.end)];
         }}};

    // The quality at the factor that fails.
    return table.add<FormQuality>(
        {{"wrong", "rays decided wrongly at the failing factor", &FormQuality::wrong_count},
         {"rays", "number of rays at the failing factor", &FormQuality::ray_count},
         {"kept_bits", "bits", "bits kept at the failing factor", or_missing(&FormQuality::kept_bits)},
         {"distance_error", "length", "distance error at the failing factor; missing: the requirement has no tolerance",
          or_missing(&FormQuality::distance_error)}},
        [](const GrowthMargin& margin) { return margin.end == MarginEnd::fails ? &margin.end_quality : nullptr; });
}

namespace {

constexpr int chosen_marker = 3;  ///< marker of the chosen candidate in the plot, see `plot::draw_marker`

Table<SafeOffsetRow> make_offset_table() {
    using R = SafeOffsetRow;
    return {
        {"side", "outside: right for every ray away from the primitive; both: also for rays into it", &R::side},
        {"strategy", "rule for the start of the next ray", [](const R& r) { return r.strategy.strategy->name; }},
        {"operations", "operations per new ray, as the rule is written",
         [](const R& r) { return r.strategy.operation_count; }},
        {"oversize_p50", "1",
         "how many times longer than the smallest safe offset, median; the larger of the sides; missing: no offset is "
         "needed",
         or_missing([](const R& r) { return r.strategy.size_ratio; })}};
}

std::vector<SafeOffsetRow> offset_rows(const measure::choose::SafeOffsets& offsets) {
    std::vector<SafeOffsetRow> rows;
    for (const auto& strategy : offsets.outside) rows.push_back({"outside", strategy});
    for (const auto& strategy : offsets.both_sides) rows.push_back({"both", strategy});
    return rows;
}

Table<InputRow> make_input_table() {
    using R = InputRow;
    Table<R> table;

    // The format of each kind of input.
    const auto format_column = [](Input input) {
        return [input](const R& r) {
            if (!r.trial->is_wide(input)) return input_format_name(r.obstacle->base_format);
            return r.obstacle->wide_inputs_are_exact ? std::string("exact") : input_format_name(binary64);
        };
    };
    table.add({{"origin", "format of the ray origins; exact: not rounded", format_column(Input::origin)},
               {"direction", "format of the ray directions", format_column(Input::direction)},
               {"place", "format of the centres of spheres and the corners of boxes", format_column(Input::place)},
               {"radius", "format of the radii of spheres", format_column(Input::radius)}});

    // Bits that exact arithmetic keeps on these inputs.
    const auto kept_bits = or_missing(&FormQuality::kept_bits);
    const auto exact_quality = [](const R& r) -> const FormQuality& { return r.trial->exact; };
    table.add<FormQuality>(
        {{"rays", "rays whose truth is known", &FormQuality::ray_count},
         {"exact_wrong", "rays on which the truth of these inputs decides differently from that of the ideal ones",
          &FormQuality::wrong_count},
         {"exact_kept_bits", "bits",
          "bits, of 53, that exact arithmetic on these inputs keeps of the ideal truth, at the required share of "
          "the hits",
          kept_bits}},
        exact_quality);

    // Bits that the form nearest to the requirement keeps on them in f64.
    const auto form_quality = [](const R& r) -> const std::optional<FormQuality>& { return r.trial->form; };
    table.add<FormQuality>(
        {{"f64_wrong", "rays that the form nearest to the requirement decides wrongly, in f64 on these inputs",
          &FormQuality::wrong_count},
         {"f64_kept_bits", "bits", "bits that this form keeps on these inputs; missing: not measured", kept_bits}},
        form_quality);
    return table;
}

/// Points of the plot: every candidate, with the chosen one marked.
std::vector<trade::KernelPoint> candidate_points(const ChoiceResult& result) {
    std::vector<trade::KernelPoint> points;
    for (std::size_t k = 0; k < result.candidates.size(); ++k) {
        const Candidate& c = result.candidates[k];
        const bool is_chosen = result.cheapest_index == k;
        points.push_back({.tested_form = c.tested_form,
                          .quality = {c.time.median * 1e9, c.quality.wrong_fraction(), c.quality.kept_bits},
                          .time = c.time,
                          .marker = is_chosen ? chosen_marker : 0,
                          .is_named = is_chosen,
                          .is_hollow = !c.quality.decides_as_required(result.request.requirement)});
    }
    return points;
}

}  // namespace

image::Canvas draw_pareto_plot(const ChoiceResult& result) {
    const auto& requirement = result.request.requirement;
    plot::ScatterPlotSpec spec;
    spec.title = fmt::format("Time against kept bits on {}", result.request.id());
    spec.subtitle = {
        fmt::format("Required: {}. {}.", requirement_text(requirement),
                    result.cheapest_index
                        ? fmt::format("Chosen: {} in {}",
                                      result.candidates[*result.cheapest_index].tested_form.form->info->name,
                                      result.candidates[*result.cheapest_index].tested_form.format.name)
                        : "Nothing meets the requirement"),
        fmt::format("Time: {} of the rays against {} of the primitives, median of {} of this run, bars from quartile "
                    "to quartile. Named: the Pareto front, on which fewer wrong decisions count before more bits, and "
                    "the chosen form.",
                    result.timed.ray_count, result.timed.primitive_count,
                    text::count_with_noun(result.request.plan.repetitions, "repetition"))};

    spec.x.title = "time per ray and primitive, ns";
    spec.x.scale = plot::AxisSpec::Scale::log2;
    spec.x.has_decimal_ticks = true;
    spec.y.title = "bits kept";
    spec.y.low = 0;
    trade::add_kernel_points(spec, candidate_points(result));

    spec.legend = {
        {.label = "f32", .marker = 0, .colour = 0},
        {.label = "f64", .marker = 0, .colour = 1},
        {.label = "decides more rays wrongly than allowed", .marker = 0, .colour = plot::ink_colour, .is_hollow = true},
        {.label = "not on the Pareto front", .marker = 0, .colour = 0, .is_faint = true}};
    if (result.cheapest_index)
        spec.legend.push_back({.label = "chosen", .marker = chosen_marker, .colour = plot::ink_colour});
    return plot::draw_scatter_plot(spec);
}

ChoiceWriter::ChoiceWriter(const std::filesystem::path& folder)
    : folder_(folder),
      candidates_(folder, "choose.csv", "One row per form and format, cheapest first; times vary from run to run",
                  make_candidate_table()),
      margins_(folder, "room.csv", "One row per way of stretching the scene, for the chosen form", make_margin_table()),
      offsets_(folder, "offset.csv", "One row per offset strategy that is safe for the chosen form, cheapest first",
               make_offset_table()),
      inputs_(folder, "inputs.csv",
              "If nothing meets the requirement: one row per selection of inputs in a wider format",
              make_input_table()),
      requirement_(folder, "requirement.csv",
                   "Number of pixels on which each form and format meets the requirement, and on which it is the "
                   "cheapest; then the same for formats under any form, and for none",
                   make_requirement_table()) {}

std::vector<CandidateRow> make_candidate_rows(const ChoiceResult& result) {
    const auto& requirement = result.request.requirement;
    std::vector<CandidateRow> rows;
    for (const std::size_t k : order_by_price(result.candidates)) {
        const Candidate& c = result.candidates[k];
        const std::string_view form = c.tested_form.form->info->name;
        rows.push_back({.kernel = {form, c.tested_form.format.name, c.isa},
                        .time = &c.time,
                        .quality = &c.quality,
                        .meets_requirement = c.quality.meets(requirement),
                        .is_chosen = result.cheapest_index == k,
                        .repair = result.repair_of(form)});
    }

    // The answers of the files have no time.
    if (!result.request.rays || !result.request.rays->answers) return rows;
    const auto& [name, format, quality] = *result.request.rays->answers;
    rows.push_back({.kernel = {name, format.name, ""},
                    .time = nullptr,
                    .quality = &quality,
                    .meets_requirement = quality.meets(requirement),
                    .is_chosen = false,
                    .repair = nullptr});
    return rows;
}

void ChoiceWriter::finish(const ChoiceResult& result) {
    candidates_.add_all(make_candidate_rows(result));
    margins_.add_all(result.margins);
    if (result.requirement_map) {
        requirement_.add_all(make_requirement_rows(result, *result.requirement_map));
        draw_requirement_map(folder_ / "requirement.png", result, *result.requirement_map);
    }
    if (result.offsets) offsets_.add_all(offset_rows(*result.offsets));
    if (result.obstacle)
        for (const auto& trial : result.obstacle->trials) inputs_.add({&*result.obstacle, &trial});

    image::save_figure(folder_ / "front.png", draw_pareto_plot(result));
    file::write_file(folder_ / "choose.txt", choice_text(result));
    table::close_tables(folder_,
                        fmt::format("What meets a requirement on {}: {}", result.request.id(),
                                    requirement_text(result.request.requirement)),
                        candidates_, margins_, offsets_, inputs_, requirement_);
}

}  // namespace lostbits::output::choose
