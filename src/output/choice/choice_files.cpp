#include "output/choice/choice_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measure/choice/file_rays.hpp"
#include "output/choice/other_tables.hpp"
#include "output/choice/requirement_files.hpp"
#include "output/file/datapackage.hpp"
#include "output/plot/scatter_plot.hpp"
#include "output/speed/kernel_rows.hpp"

namespace lostbits::output::choice {

using file::Cell;
using file::Column;
using file::number_or_missing;
using measure::choice::Candidate;
using measure::choice::Room;

std::vector<Column> candidate_columns() {
    auto columns = speed::kernel_columns("form under test; file.NAME: the answers that the files of rays have");
    columns.insert(
        columns.end(),
        {{"time_ns", "number", "ns", "per ray and solid; median of the repetitions; missing: not known"},
         {"time_ns_q1", "number", "ns", "per ray and solid; first quartile"},
         {"time_ns_q3", "number", "ns", "per ray and solid; third quartile"},
         {"rays", "integer", "", "whose truth is known"},
         {"true_hits", "integer", "", "rays that truly hit"},
         {"wrong", "integer", "", "false hits, false misses, NaNs and hits of another solid"},
         {"wrong_fraction", "number", "1", "wrong/rays"},
         {"kept_bits", "number", "bits", "significand bits less what is lost, at the wish's share of the agreed hits"},
         {"distance_error", "number", "length",
          "how far the hit point is off along the ray, at the same share; missing: the wish has no tolerance"},
         {"meets", "boolean", "", "whether it meets the wish"},
         {"chosen", "boolean", "", "the cheapest that does"},
         {"mended", "string", "", "what form was mended to it, and how; missing for a form as it is"}});
    return columns;
}

std::vector<Column> room_columns() {
    return {{"way", "string", "", "what grows: distance, radius, offset, view"},
            {"holds", "number", "1", "the largest factor at which the wish was seen to hold; 0: not as the scene is"},
            {"value", "number", "", "what that is: world units, of view degrees; missing where holds is 0"},
            {"beyond", "number", "1", "the first factor seen beyond that; missing: none"},
            {"end", "string", "",
             "what is there: fails (the wish), nothing_hit, other_scene (what is stored is another one), none (as far "
             "as was "
             "tried)"},
            {"wrong", "integer", "", "rays decided wrongly where it fails"},
            {"rays", "integer", "", "of so many"},
            {"kept_bits", "number", "bits", "kept there"},
            {"distance_error", "number", "length", "off there; missing: the wish has no tolerance"}};
}

namespace {

void add_worth(file::CsvWriter& csv, const measure::choice::Worth& worth) {
    csv.add(worth.rays).add(worth.hits).add(worth.wrong).add(worth.wrong_fraction());
    csv.add(number_or_missing(worth.kept_bits)).add(number_or_missing(worth.off));
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
        fmt::format("Time: {} of the rays against {} of the solids, median of {} repetitions of "
                    "this run, bars from quartile to quartile. Named: the Pareto front, where fewer wrong "
                    "decisions count before more bits, and what is chosen.",
                    chosen.timed.rays, chosen.timed.solids, chosen.request.plan.repetitions)};
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
    plot::write_scatter_plot(image::image_backend(), path, front_plot(chosen));
}

ChoiceFiles::ChoiceFiles(const std::filesystem::path& folder)
    : folder_(folder),
      candidates_(folder / "choose.csv", candidate_columns()),
      rooms_(folder / "room.csv", room_columns()),
      offsets_(folder / "offset.csv", offset_columns()),
      inputs_(folder / "inputs.csv", input_columns()),
      requirement_(folder / "requirement.csv", requirement_columns) {}

void add_candidates(file::CsvWriter& csv, const Chosen& chosen) {
    for (const std::size_t k : by_price(chosen.all)) {
        const Candidate& c = chosen.all[k];
        speed::add_kernel(csv, c.row, c.isa);
        csv.add(c.time.median * 1e9).add(c.time.low_quartile * 1e9).add(c.time.high_quartile * 1e9);
        add_worth(csv, c.worth);
        csv.add(c.worth.meets(chosen.request.wish)).add(chosen.meets == k);
        const MendedCandidate* const mended = chosen.mended_as(c.row.form->info->name);
        csv.add(mended ? Cell(mended->how) : Cell());
        csv.end_row();
    }
    if (!chosen.request.rays || !chosen.request.rays->answers) return;
    const auto& [name, format, worth] = *chosen.request.rays->answers;
    csv.add(name).add(format.name).add(Cell()).add(Cell()).add(Cell()).add(Cell());
    add_worth(csv, worth);
    csv.add(worth.meets(chosen.request.wish)).add(false).add(Cell());
    csv.end_row();
}

void add_rooms(file::CsvWriter& csv, const Chosen& chosen) {
    for (const Room& room : chosen.rooms) {
        const bool fails = room.end == measure::choice::End::fails;
        csv.add(measure::choice::growth_names[static_cast<std::size_t>(room.way)]).add(room.holds);
        csv.add(room.holds == 0 ? Cell() : Cell(room.value)).add(room.beyond == 0 ? Cell() : Cell(room.beyond));
        csv.add(measure::choice::end_names[static_cast<std::size_t>(room.end)]);
        csv.add(fails ? Cell(room.broken.wrong) : Cell()).add(fails ? Cell(room.broken.rays) : Cell());
        csv.add(fails ? number_or_missing(room.broken.kept_bits) : Cell());
        csv.add(fails ? number_or_missing(room.broken.off) : Cell());
        csv.end_row();
    }
}

void ChoiceFiles::finish(const Chosen& chosen) {
    add_candidates(candidates_, chosen);
    add_rooms(rooms_, chosen);
    if (chosen.requirement) {
        write_requirement(requirement_, chosen, *chosen.requirement);
        draw_requirement(folder_ / "requirement.png", chosen, *chosen.requirement);
    }
    if (chosen.offsets) add_offsets(offsets_, *chosen.offsets);
    if (chosen.obstacle) add_inputs(inputs_, *chosen.obstacle);
    write_front_plot(folder_ / "front.png", chosen);
    file::AtomicFile words(folder_ / "choose.txt");
    words.write(in_words(chosen));
    words.commit();
    file::write_datapackage(
        folder_ / "datapackage.json",
        fmt::format("What meets a wish on {}: {}", chosen.request.id(), in_words(chosen.request.wish)),
        {{"choose.csv", "One row per form and format, cheapest first; times vary from run to run", candidate_columns()},
         {"room.csv", "One row per way in which the scene was stretched under what is chosen", room_columns()},
         {"offset.csv", "One row per strategy of offset that is safe under what is chosen, cheapest first",
          offset_columns()},
         {"inputs.csv", "Where nothing meets the wish: one row per choice of inputs that come in a wider format",
          input_columns()},
         {"requirement.csv",
          "On how many pixels each form and format meets the wish, and on how many it is the cheapest; then formats "
          "under any form, and nothing",
          requirement_columns}});
    candidates_.close();
    rooms_.close();
    offsets_.close();
    inputs_.close();
    requirement_.close();
}

}  // namespace lostbits::output::choice
