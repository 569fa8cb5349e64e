#include "output/sweep/worst_files.hpp"

#include <fmt/format.h>

#include <cmath>

#include "output/blame/explain_command.hpp"
#include "output/file/csv.hpp"
#include "output/file/datapackage.hpp"
#include "output/file/number_text.hpp"
#include "output/sweep/case_text.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::output::sweep {

using file::Cell;
using measure::sweep::WorstFound;
using measure::sweep::WorstRequest;

namespace {

constexpr const char* ray_names[] = {"origin_x", "origin_y", "origin_z", "direction_x", "direction_y", "direction_z"};

std::vector<double> ray_numbers(const WorstFound& w) {
    return {w.ray.origin.x, w.ray.origin.y, w.ray.origin.z, w.ray.direction.x, w.ray.direction.y, w.ray.direction.z};
}

std::vector<file::Column> worst_columns(const WorstRequest& request) {
    const measure::metric::Metric& metric =
        *request.metrics[measure::metric::place_of(request.metrics, request.search->metric)];
    std::vector<file::Column> columns{
        {"form", "string", "", "form under test"},
        {"format", "string", "", "format it computes in"},
        {"found", "boolean", "", "whether the form hit anything within the ranges"},
        {"outcome", "string", "", "class of the worst ray"},
        {std::string(metric.name), "number", std::string(metric.unit),
         "of the worst ray; missing where the decision is wrong"},
        {"distance_radii", "number", "r",
         "from the ray's origin to the centre of the sphere; missing for other solids"},
        {"evaluations", "integer", "", "rays tried"},
        {"t", "number", "t", "the form's answer, in its own unit"},
        {"t_hex", "string", "t", "the same, exactly"},
        {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit; missing for a miss"},
        {"truth_hex", "string", "t", "the same, exactly"}};
    for (const char* name : ray_names)
        columns.push_back({std::string(name) + "_hex", "string", "", "of the worst ray"});
    for (const auto& name : number_names(request.search->shape))
        columns.push_back({std::string(name) + "_hex", "string", "", "of its solid"});
    columns.push_back({"explain", "string", "", "the command that explains the worst ray: these numbers again"});
    return columns;
}

std::string case_of(const WorstRequest& request, const measure::map::MapRow& row, const WorstFound& w) {
    const bool decided = w.outcome == measure::answer::Outcome::agree_hit;
    std::string what = decided ? fmt::format("{} {:.6g}", request.search->metric, w.value)
                               : std::string(measure::answer::outcome_names[static_cast<std::size_t>(w.outcome)]);
    if (!decided && request.search->nearest) what += fmt::format(" at {:.6g} radii", w.distance);
    scene::rays::RayGroup one = scene::rays::group_of(w.ray);
    one.solids = {w.solid};
    return case_text(fmt::format("{} in {}: {}", row.form->info->name, row.format.name, what), one);
}

}  // namespace

void write_worst(const std::filesystem::path& folder, const WorstRequest& request,
                 const std::vector<std::optional<WorstFound>>& found) {
    const scene::sweep::SearchFile& search = *request.search;
    file::CsvWriter csv(folder / "worst.csv", worst_columns(request));
    file::AtomicFile hard(folder / "hard.toml");
    const std::string title = "The worst rays of each form: " + search.title;
    std::string text =
        head_of_cases(title.size() > scene::toml::TableReader::most_title_bytes ? search.title : title,
                      fmt::format("lostbits sweep {} --worst: seed {}, {} starts of {} generations of 32, {} {}",
                                  search.id, search.seed, search.starts, search.generations,
                                  search.smallest ? "smallest" : "largest", search.metric) +
                          (search.nearest ? ", nearest wrong decision" : ""));
    for (std::size_t r = 0; r < found.size(); ++r) {
        const measure::map::MapRow& row = request.rows[r];
        csv.add(row.form->info->name).add(row.format.name).add(found[r].has_value());
        if (!found[r]) {
            for (std::size_t i = 3; i < worst_columns(request).size(); ++i) csv.add(Cell());
            csv.end_row();
            continue;
        }
        const WorstFound& w = *found[r];
        const bool missed = w.outcome == measure::answer::Outcome::false_miss;
        csv.add(measure::answer::outcome_names[static_cast<std::size_t>(w.outcome)])
            .add(w.outcome == measure::answer::Outcome::agree_hit ? Cell(w.value) : Cell())
            .add(std::isnan(w.distance) ? Cell() : Cell(w.distance))
            .add(w.evaluations)
            .add(missed ? Cell() : Cell(w.t))
            .add(missed ? Cell() : Cell(file::hex(w.t)));
        csv.add(std::isnan(w.truth) ? Cell() : Cell(w.truth));
        csv.add(std::isnan(w.truth) ? Cell() : Cell(file::hex(w.truth)));
        for (const double x : ray_numbers(w)) csv.add(file::hex(x));
        for (const double x : w.solid.used()) csv.add(file::hex(x));
        scene::rays::RayGroup one = scene::rays::group_of(w.ray);
        one.solids = {w.solid};
        csv.add(blame::explain_command(blame::name_of_ray(&one), row));
        csv.end_row();
        text += case_of(request, row, w);
    }
    hard.write(text);
    file::write_datapackage(
        folder / "datapackage.json", search.title,
        {{"worst.csv", "One row per form and format: the worst ray found", worst_columns(request)}});
    hard.commit();
    csv.close();
}

}  // namespace lostbits::output::sweep
