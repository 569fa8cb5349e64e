#include "output/choice/choice_files.hpp"

#include <fmt/format.h>

#include "measure/choice/file_rays.hpp"
#include "output/file/atomic_file.hpp"
#include "output/plot/scatter_plot.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::choice {

using file::number_or_missing;
using measure::choice::Candidate;
using measure::choice::Input;
using measure::choice::Room;
using measure::choice::Worth;
using table::Table;
using table::when;

Table<Worth> worth_columns() {
    return {
        {"rays", "integer", "", "whose truth is known", &Worth::rays},
        {"true_hits", "integer", "", "rays that truly hit", &Worth::hits},
        {"wrong", "integer", "", "false hits, false misses, NaNs and hits of another solid", &Worth::wrong},
        {"wrong_fraction", "number", "1", "wrong/rays", &Worth::wrong_fraction},
        {"kept_bits", "number", "bits", "significand bits less what is lost, at the wish's share of the agreed hits",
         [](const Worth& w) { return number_or_missing(w.kept_bits); }}};
}

Table<CandidateRow> candidate_table() {
    using R = CandidateRow;
    Table<R> table;
    table.add(speed::kernel_columns("form under test; file.NAME: the answers that the files of rays have"), &R::name);
    table.add(
        speed::time_columns("per ray and solid; median of the repetitions; missing: not known", "per ray and solid; "),
        &R::time);
    table.add(worth_columns(), &R::worth);
    table.add({{"distance_error", "number", "length",
                "how far the hit point is off along the ray, at the same share; missing: the wish has no tolerance",
                [](const R& r) { return number_or_missing(r.worth->off); }},
               {"meets", "boolean", "", "whether it meets the wish", &R::meets},
               {"chosen", "boolean", "", "the cheapest that does", &R::chosen},
               {"mended", "string", "", "what form was mended to it, and how; missing for a form as it is",
                [](const R& r) { return r.mended ? r.mended->how : ""; }}});
    return table;
}

Table<Room> room_table() {
    using measure::choice::End;
    Table<Room> table{
        {"way", "string", "", "what grows: distance, radius, offset, view",
         [](const Room& r) { return measure::choice::growth_names[static_cast<std::size_t>(r.way)]; }},
        {"holds", "number", "1", "the largest factor at which the wish was seen to hold; 0: not as the scene is",
         &Room::holds},
        {"value", "number", "", "what that is: world units, of view degrees; missing where holds is 0",
         [](const Room& r) { return when(r.holds != 0, r.value); }},
        {"beyond", "number", "1", "the first factor seen beyond that; missing: none",
         [](const Room& r) { return when(r.beyond != 0, r.beyond); }},
        {"end", "string", "",
         "what is there: fails (the wish), nothing_hit, other_scene (what is stored is another one), none (as far "
         "as was "
         "tried)",
         [](const Room& r) { return measure::choice::end_names[static_cast<std::size_t>(r.end)]; }}};
    return table.add<Worth>(
        {{"wrong", "integer", "", "rays decided wrongly where it fails", &Worth::wrong},
         {"rays", "integer", "", "of so many", &Worth::rays},
         {"kept_bits", "number", "bits", "kept there", [](const Worth& w) { return number_or_missing(w.kept_bits); }},
         {"distance_error", "number", "length", "off there; missing: the wish has no tolerance",
          [](const Worth& w) { return number_or_missing(w.off); }}},
        [](const Room& r) { return r.end == End::fails ? &r.broken : nullptr; });
}

namespace {

Table<SafeOffsetRow> offset_table() {
    using R = SafeOffsetRow;
    return {{"side", "string", "", "outside: right for every ray away from the solid; both: also for those into it",
             &R::side},
            {"strategy", "string", "", "where the next ray starts", [](const R& r) { return r.safe.strategy->name; }},
            {"operations", "integer", "", "that one new ray costs, as the rule is written",
             [](const R& r) { return r.safe.operations; }},
            {"oversize_p50", "number", "1",
             "how many times longer than the smallest safe offset, the median; the larger of the sides; missing: none "
             "is needed",
             [](const R& r) { return number_or_missing(r.safe.oversize); }}};
}

std::vector<SafeOffsetRow> offset_rows(const measure::choice::SafeOffsets& offsets) {
    std::vector<SafeOffsetRow> rows;
    for (const auto& safe : offsets.outside) rows.push_back({"outside", safe});
    for (const auto& safe : offsets.both) rows.push_back({"both", safe});
    return rows;
}

Table<InputRow> input_table() {
    using R = InputRow;
    const auto format_of = [](Input input) {
        return [input](const R& r) {
            if (!r.trial->has(input)) return name_of_inputs(r.obstacle->base);
            return r.obstacle->wider_than_f64 ? std::string("exact") : name_of_inputs(binary64);
        };
    };
    const auto exact = [](const R& r) -> const Worth& { return r.trial->exact; };
    const auto form = [](const R& r) -> const std::optional<Worth>& { return r.trial->form; };
    const auto kept_bits = [](const Worth& w) { return number_or_missing(w.kept_bits); };
    Table<R> table{
        {"origin", "string", "", "format that the origins of the rays come in; exact: not rounded",
         format_of(Input::origin)},
        {"direction", "string", "", "the same of their directions", format_of(Input::direction)},
        {"place", "string", "", "the same of the centres of spheres and the corners of boxes", format_of(Input::place)},
        {"radius", "string", "", "the same of the radii of spheres", format_of(Input::radius)}};
    return table
        .add<Worth>(
            {{"rays", "integer", "", "whose truth is known", &Worth::rays},
             {"exact_wrong", "integer", "",
              "rays on which the truth of these inputs decides otherwise than that of the ideal ones", &Worth::wrong},
             {"exact_kept_bits", "number", "bits",
              "of 53: what exact arithmetic on these inputs keeps of the ideal truth, at the wish's share of the hits",
              kept_bits}},
            exact)
        .add<Worth>({{"f64_wrong", "integer", "",
                      "rays that the form nearest to the wish decides wrongly, in f64 on these inputs", &Worth::wrong},
                     {"f64_kept_bits", "number", "bits", "what it keeps there; missing: it was not asked", kept_bits}},
                    form);
}

plot::ScatterPlotSpec front_plot(const Chosen& chosen) {
    const auto& wish = chosen.request.wish;
    plot::ScatterPlotSpec spec;
    spec.title = fmt::format("Time against kept bits on {}", chosen.request.id());
    spec.subtitle = {
        fmt::format("Wished: {}. {}.", in_words(wish),
                    chosen.meets ? fmt::format("Chosen: {} in {}", chosen.all[*chosen.meets].row.form->info->name,
                                               chosen.all[*chosen.meets].row.format.name)
                                 : "Nothing meets it"),
        fmt::format("Time: {} of the rays against {} of the solids, median of {} of "
                    "this run, bars from quartile to quartile. Named: the Pareto front, where fewer wrong "
                    "decisions count before more bits, and what is chosen.",
                    chosen.timed.rays, chosen.timed.solids,
                    scene::toml::counted(chosen.request.plan.repetitions, "repetition"))};
    spec.x = {"time per ray and solid, ns", plot::AxisSpec::Scale::log2, {}, {}, false, true};
    spec.y = {"bits kept", plot::AxisSpec::Scale::linear, 0.0, {}};
    std::vector<speed::FrontPoint> points;
    for (std::size_t k = 0; k < chosen.all.size(); ++k) {
        const Candidate& c = chosen.all[k];
        points.push_back({.row = c.row,
                          .worth = {c.time.median * 1e9, c.worth.wrong_fraction(), c.worth.kept_bits},
                          .time = c.time,
                          .marker = chosen.meets == k ? 3 : 0,
                          .named = chosen.meets == k,
                          .hollow = !c.worth.decides(wish)});
    }
    speed::add_front(spec, points);
    spec.keys = {{"f32", 0, 0},
                 {"f64", 0, 1},
                 {"decides more rays wrongly than wished", 0, plot::ink_colour, false, true},
                 {"not on the Pareto front", 0, 0, true}};
    if (chosen.meets) spec.keys.push_back({"chosen", 3, plot::ink_colour});
    return spec;
}

}  // namespace

void write_front_plot(const std::filesystem::path& path, const Chosen& chosen) {
    plot::write_scatter_plot(path, front_plot(chosen));
}

ChoiceFiles::ChoiceFiles(const std::filesystem::path& folder)
    : folder_(folder),
      candidates_(folder, "choose.csv", "One row per form and format, cheapest first; times vary from run to run",
                  candidate_table()),
      rooms_(folder, "room.csv", "One row per way in which the scene was stretched under what is chosen", room_table()),
      offsets_(folder, "offset.csv", "One row per strategy of offset that is safe under what is chosen, cheapest first",
               offset_table()),
      inputs_(folder, "inputs.csv",
              "Where nothing meets the wish: one row per choice of inputs that come in a wider format", input_table()),
      requirement_(folder, "requirement.csv",
                   "On how many pixels each form and format meets the wish, and on how many it is the cheapest; then "
                   "formats under any form, and nothing",
                   requirement_table()) {}

std::vector<CandidateRow> candidate_rows(const Chosen& chosen) {
    const auto& wish = chosen.request.wish;
    std::vector<CandidateRow> rows;
    for (const std::size_t k : by_price(chosen.all)) {
        const Candidate& c = chosen.all[k];
        const std::string_view form = c.row.form->info->name;
        rows.push_back({{form, c.row.format.name, c.isa},
                        &c.time,
                        &c.worth,
                        c.worth.meets(wish),
                        chosen.meets == k,
                        chosen.mended_as(form)});
    }
    if (!chosen.request.rays || !chosen.request.rays->answers) return rows;
    const auto& [name, format, worth] = *chosen.request.rays->answers;
    rows.push_back({{name, format.name, ""}, nullptr, &worth, worth.meets(wish), false, nullptr});
    return rows;
}

void ChoiceFiles::finish(const Chosen& chosen) {
    candidates_.add_all(candidate_rows(chosen));
    rooms_.add_all(chosen.rooms);
    if (chosen.requirement) {
        requirement_.add_all(requirement_rows(chosen, *chosen.requirement));
        draw_requirement(folder_ / "requirement.png", chosen, *chosen.requirement);
    }
    if (chosen.offsets) offsets_.add_all(offset_rows(*chosen.offsets));
    if (chosen.obstacle)
        for (const auto& trial : chosen.obstacle->trials) inputs_.add({&*chosen.obstacle, &trial});
    write_front_plot(folder_ / "front.png", chosen);
    file::write_file(folder_ / "choose.txt", in_words(chosen));
    table::close_tables(folder_,
                        fmt::format("What meets a wish on {}: {}", chosen.request.id(), in_words(chosen.request.wish)),
                        candidates_, rooms_, offsets_, inputs_, requirement_);
}

}  // namespace lostbits::output::choice
