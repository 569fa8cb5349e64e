#include "output/edges/nearest_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "output/blame/explain_command.hpp"
#include "output/file/csv.hpp"
#include "output/file/datapackage.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::edges {

using file::Cell;
using measure::edges::NearestRay;
using measure::edges::sought;

namespace {

std::string name_of(std::size_t outcome) {
    return std::string(measure::answer::outcome_names[static_cast<std::size_t>(sought.at(outcome))]);
}

std::vector<file::Column> nearest_columns() {
    std::vector<file::Column> columns{
        {"form", "string", "", "form under test"},
        {"format", "string", "", "format it computes in"},
        {"outcome", "string", "", "what was searched for: crack or double_hit"},
        {"found", "boolean", "", "whether a ray with that outcome was found"},
        {"distance_edges", "number", "1",
         "of the nearest one: from the eye to the point of the edge that it is aimed at, in lengths of the edge"},
        {"rays", "integer", "", "rays tried"},
        {"face_a", "integer", "", "the place of the one triangle of the edge among the solids of the scene"},
        {"face_b", "integer", "", "the place of the other"},
        {"t", "number", "t", "the form's answer, in its own unit; missing where it misses"},
        {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit"}};
    for (const char* name : {"origin_x", "origin_y", "origin_z", "direction_x", "direction_y", "direction_z"})
        columns.push_back({std::string(name) + "_hex", "string", "", "of the nearest ray"});
    columns.push_back({"explain", "string", "", "the command that explains it"});
    return columns;
}

}  // namespace

std::string NearestFiles::explain(std::size_t r, const NearestRay& ray) const {
    const scene::rays::RayGroup one = scene::rays::group_of(ray.ray);
    return blame::explain_command(scene + " " + blame::name_of_ray(&one), request.rows[r]);
}

void NearestFiles::write(const std::filesystem::path& folder) const {
    const std::vector<file::Column> columns = nearest_columns();
    file::CsvWriter csv(folder / "worst.csv", columns);
    for (std::size_t r = 0; r < found.size(); ++r) {
        for (std::size_t k = 0; k < sought.size(); ++k) {
            const auto& nearest = found[r].nearest.at(k);
            csv.add(request.rows[r].form->info->name).add(request.rows[r].format.name).add(name_of(k));
            csv.add(nearest.has_value()).add(nearest ? Cell(nearest->distance) : Cell()).add(found[r].rays.at(k));
            if (!nearest) {
                for (std::size_t c = 6; c < columns.size(); ++c) csv.add(Cell());
            } else {
                for (const std::uint32_t face : nearest->faces) csv.add(std::uint64_t{face});
                csv.add(std::isnan(nearest->t) ? Cell() : Cell(nearest->t)).add(nearest->truth);
                const auto& [origin, direction] = nearest->ray;
                for (const Vec<double>& v : {origin, direction})
                    for (int axis = 0; axis < 3; ++axis) csv.add(file::hex(v[axis]));
                csv.add(explain(r, *nearest));
            }
            csv.end_row();
        }
    }
    file::write_datapackage(
        folder / "datapackage.json", request.search->title,
        {{"worst.csv", "One row per form, format and outcome: the nearest ray found at an edge", columns}});
    csv.close();
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
