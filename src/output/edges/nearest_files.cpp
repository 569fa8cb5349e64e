#include "output/edges/nearest_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "output/blame/explain_command.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::edges {

using measure::edges::NearestRay;
using measure::edges::sought;

namespace {

std::string name_of(std::size_t outcome) {
    return std::string(measure::answer::outcome_names[static_cast<std::size_t>(sought.at(outcome))]);
}

struct NearestRow {
    measure::evaluate::TestedForm row;
    std::string outcome;
    std::uint64_t rays;
    const std::optional<NearestRay>& nearest;
    std::string explain;
};

table::Table<NearestRow> nearest_table() {
    using R = NearestRow;
    using N = NearestRay;
    const auto nearest = [](const R& r) -> const std::optional<N>& { return r.nearest; };
    table::Table<R> table;
    table.add(table::subject_columns(), &R::row);
    table.add({{"outcome", "string", "", "what was searched for: crack or double_hit", &R::outcome},
               {"found", "boolean", "", "whether a ray with that outcome was found",
                [](const R& r) { return r.nearest.has_value(); }}});
    table.add<N>({{"distance_edges", "number", "1",
                   "of the nearest one: from the eye to the point of the edge that it is aimed at, in lengths of the "
                   "edge",
                   &N::distance}},
                 nearest);
    table.add({"rays", "integer", "", "rays tried", &R::rays});
    table.add<N>({{"face_a", "integer", "", "the place of the one triangle of the edge among the solids of the scene",
                   [](const N& n) { return n.faces[0]; }},
                  {"face_b", "integer", "", "the place of the other", [](const N& n) { return n.faces[1]; }},
                  {"t", "number", "t", "the form's answer, in its own unit; missing where it misses",
                   [](const N& n) { return file::number_or_missing(n.t); }},
                  {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit", &N::truth}},
                 nearest);
    table.add(table::ray_columns("of the nearest ray"),
              [](const R& r) { return r.nearest ? &r.nearest->ray : nullptr; });
    return table.add({"explain", "string", "", "the command that explains it", &R::explain});
}

}  // namespace

std::string NearestFiles::explain(std::size_t r, const NearestRay& ray) const {
    const scene::rays::RayGroup one = scene::rays::group_of(ray.ray);
    return blame::explain_command(scene + " " + blame::name_of_ray(&one), request.rows[r]);
}

void NearestFiles::write(const std::filesystem::path& folder) const {
    table::TableFile<NearestRow> csv(
        folder, "worst.csv", "One row per form, format and outcome: the nearest ray found at an edge", nearest_table());
    for (std::size_t r = 0; r < found.size(); ++r) {
        for (std::size_t k = 0; k < sought.size(); ++k) {
            const auto& nearest = found[r].nearest.at(k);
            csv.add({request.rows[r], name_of(k), found[r].rays.at(k), nearest, nearest ? explain(r, *nearest) : ""});
        }
    }
    table::close_tables(folder, request.search.title, csv);
}

std::string NearestFiles::sentence(std::size_t r) const {
    std::string text = fmt::format("{} in {}:", request.rows[r].form->info->name, request.rows[r].format.name);
    for (std::size_t k = 0; k < sought.size(); ++k) {
        std::string what = name_of(k);
        std::ranges::replace(what, '_', ' ');
        const auto& nearest = found[r].nearest.at(k);
        text += nearest ? fmt::format("{} the nearest {} of {} rays is {:.4g} edge lengths away", k > 0 ? "," : "",
                                      what, found[r].rays.at(k), nearest->distance)
                        : fmt::format("{} no {} among {} rays", k > 0 ? "," : "", what, found[r].rays.at(k));
    }
    return text;
}

}  // namespace lostbits::output::edges
