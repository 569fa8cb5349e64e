#include "output/sweep/worst_files.hpp"

#include <fmt/format.h>

#include "output/blame/explain_command.hpp"
#include "output/file/atomic_file.hpp"
#include "output/sweep/case_text.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::sweep {

using file::number_or_missing;
using measure::answer::Outcome;
using measure::sweep::WorstFound;
using measure::sweep::WorstRequest;

namespace {

struct WorstRow {
    measure::evaluate::TestedForm row;
    const std::optional<WorstFound>& worst;
};

scene::rays::RayGroup alone(const WorstFound& w) {
    scene::rays::RayGroup one = scene::rays::group_of(w.ray);
    one.solids = {w.solid};
    return one;
}

table::Table<WorstRow> worst_table(const WorstRequest& request) {
    using R = WorstRow;
    using W = WorstFound;
    const measure::metric::Metric& metric =
        *request.metrics[measure::metric::place_of(request.metrics, request.search.metric)];
    const auto worst = [](const R& r) -> const std::optional<W>& { return r.worst; };
    table::Table<R> table;
    table.add(table::subject_columns(), &R::row);
    table.add({"found", "boolean", "", "whether the form hit anything within the ranges",
               [](const R& r) { return r.worst.has_value(); }});
    table::Table<W> of_worst{
        {"outcome", "string", "", "class of the worst ray",
         [](const W& w) { return measure::answer::outcome_names[static_cast<std::size_t>(w.outcome)]; }},
        {std::string(metric.name), "number", std::string(metric.unit),
         "of the worst ray; missing where the decision is wrong",
         [](const W& w) { return table::when(w.outcome == Outcome::agree_hit, w.value); }},
        {"distance_radii", "number", "r", "from the ray's origin to the centre of the sphere; missing for other solids",
         [](const W& w) { return number_or_missing(w.distance); }},
        {"evaluations", "integer", "", "rays tried", &W::evaluations}};
    of_worst.add_exact({"t", "number", "t", "the form's answer, in its own unit",
                        [](const W& w) { return table::when(w.outcome != Outcome::false_miss, w.t); }});
    of_worst.add_exact({"truth", "number", "t",
                        "t*, correctly rounded to binary64, in the same unit; missing for a miss",
                        [](const W& w) { return number_or_missing(w.truth); }});
    of_worst.add(table::ray_columns("of the worst ray"), &W::ray);
    of_worst.add(table::solid_columns(request.search.shape, "of its solid"), &W::solid);
    table.add(of_worst, worst);
    return table.add(
        {"explain", "string", "", "the command that explains the worst ray: these numbers again", [](const R& r) {
             if (!r.worst) return std::string();
             const scene::rays::RayGroup one = alone(*r.worst);
             return blame::explain_command(blame::name_of_ray(&one), r.row);
         }});
}

std::string case_of(const WorstRequest& request, const measure::evaluate::TestedForm& row, const WorstFound& w) {
    const bool decided = w.outcome == Outcome::agree_hit;
    std::string what = decided ? fmt::format("{} {:.6g}", request.search.metric, w.value)
                               : std::string(measure::answer::outcome_names[static_cast<std::size_t>(w.outcome)]);
    if (!decided && request.search.nearest) what += fmt::format(" at {:.6g} radii", w.distance);
    return case_text(fmt::format("{} in {}: {}", row.form->info->name, row.format.name, what), alone(w));
}

}  // namespace

void write_worst(const std::filesystem::path& folder, const WorstRequest& request,
                 const std::vector<std::optional<WorstFound>>& found) {
    const scene::sweep::SearchFile& search = request.search;
    table::TableFile<WorstRow> csv(folder, "worst.csv", "One row per form and format: the worst ray found",
                                   worst_table(request));
    file::AtomicFile hard(folder / "hard.toml");
    const std::string title = "The worst rays of each form: " + search.title;
    std::string text =
        head_of_cases(title.size() > scene::toml::TableReader::most_title_bytes ? search.title : title,
                      fmt::format("lostbits sweep {} --worst: seed {}, {} starts of {} generations of 32, {} {}",
                                  search.id, search.seed, search.starts, search.generations,
                                  search.smallest ? "smallest" : "largest", search.metric) +
                          (search.nearest ? ", nearest wrong decision" : ""));
    for (std::size_t r = 0; r < found.size(); ++r) {
        csv.add({request.rows[r], found[r]});
        if (found[r]) text += case_of(request, request.rows[r], *found[r]);
    }
    hard.write(text);
    hard.commit();
    table::close_tables(folder, search.title, csv);
}

}  // namespace lostbits::output::sweep
