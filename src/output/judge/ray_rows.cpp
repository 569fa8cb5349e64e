#include "output/judge/ray_rows.hpp"

#include <algorithm>
#include <cmath>

#include "measure/map/summary_columns.hpp"
#include "output/file/csv.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::output::judge {

using file::Cell;
using file::Column;
using measure::map::BandResult;
using measure::map::MapRow;
using measure::metric::Metric;
using scene::dump::Chunk;
using scene::dump::Dump;
using scene::dump::Layout;
namespace slot = scene::dump::slot;

namespace {

std::vector<Column> given_columns(const Layout& layout) {
    std::vector<Column> columns{{"ray", "integer", "", "place of the ray in the file, from 0"}};
    const auto add = [&](std::size_t s, const char* type, const char* meaning) {
        if (layout.has(s))
            columns.push_back({std::string(scene::dump::name_of_slot(s, layout.solid())), type, "", meaning});
    };
    for (std::size_t s = slot::origin; s < slot::tmax; ++s) add(s, "number", "of the ray, as it was judged");
    add(slot::tmin, "number", "where the range of the ray begins");
    add(slot::tmax, "number", "where it ends");
    for (std::size_t s = slot::solid; s < slot::t; ++s) add(s, "number", "of the ray's solid, as it was judged");
    for (std::size_t s = slot::matrix; s < slot::count; ++s) add(s, "number", "of its matrix, as it was judged");
    add(slot::hit, "boolean", "whether the file has a hit there");
    add(slot::t, "number", "the file's answer; missing where it has no hit");
    return columns;
}

std::vector<Column> found_columns(const std::vector<const Metric*>& metrics) {
    std::vector<Column> columns{{"outcome", "string", "", "outcome of the ray"},
                                {"answer", "number", "t", "the answer that was judged, in its own unit"},
                                {"answer_hex", "string", "t", "the same, exactly"},
                                {"truth", "number", "t", "t*, correctly rounded to binary64, in the same unit"},
                                {"truth_hex", "string", "t", "the same, exactly"}};
    for (const Metric* m : metrics)
        columns.push_back({measure::map::column_name(*m), m->categories.empty() ? "number" : "string",
                           std::string(m->unit), std::string(m->meaning)});
    return columns;
}

}  // namespace

std::vector<Column> RayRows::columns(const Dump& dump, const std::vector<const Metric*>& metrics) {
    std::vector<Column> columns = given_columns(dump.layout());
    const std::vector<Column> found = found_columns(metrics);
    const auto taken = [&](const std::string& name) {
        return std::ranges::find(columns, name, &Column::name) != columns.end() ||
               std::ranges::find(found, name, &Column::name) != found.end();
    };
    for (std::string name : dump.layout().kept()) {
        name = file::csv_text(name);  // a column may be called like a formula
        while (name.empty() || taken(name)) name = "file_" + name;
        columns.push_back({name, "string", "", "as the file has it"});
    }
    columns.insert(columns.end(), found.begin(), found.end());
    return columns;
}

RayRows::RayRows(const std::filesystem::path& path, const Dump& dump, const std::vector<const Metric*>& metrics,
                 bool decides)
    : dump_(dump),
      metrics_(metrics),
      decides_(decides),
      kept_(dump.layout().kept().size()),
      narrow_(dump.format().engine == Format::Engine::native32),
      csv_(path.empty() ? file::CsvWriter(columns(dump, metrics)) : file::CsvWriter(path, columns(dump, metrics))) {}

Cell RayRows::number(double x) const { return narrow_ ? Cell(static_cast<float>(x)) : Cell(x); }

void RayRows::add_given(const Chunk& chunk, std::size_t i) {
    const Layout& layout = dump_.layout();
    csv_.add(chunk.first + i);
    const Ray<double> ray = chunk.rays[i];
    for (int k = 0; k < 3; ++k) csv_.add(number(ray.origin[k]));
    for (int k = 0; k < 3; ++k) csv_.add(number(ray.direction[k]));
    if (layout.has(slot::tmin)) csv_.add(number(chunk.rays.tmin[i]));
    if (layout.has(slot::tmax)) csv_.add(number(chunk.rays.tmax[i]));
    if (layout.solid())
        for (const double x : chunk.solids[i].used()) csv_.add(number(x));
    if (layout.has_matrix())
        for (const double x : chunk.solids[i].placed->matrix) csv_.add(number(x));
    const bool hit = !chunk.hit.empty() && chunk.hit[i] != 0;
    if (layout.has(slot::hit)) csv_.add(hit);
    if (layout.has(slot::t)) csv_.add(hit ? number(chunk.t[i]) : Cell());
    for (std::size_t k = 0; k < kept_; ++k) csv_.add(chunk.kept[i * kept_ + k]);
}

void RayRows::add(const Chunk& chunk, const BandResult& result, const MapRow& row) {
    for (std::size_t i = 0; i < chunk.size(); ++i) {
        add_given(chunk, i);
        csv_.add(measure::answer::outcome_names[static_cast<std::size_t>(result.outcomes[i])]);
        const auto exact = [&](bool there, double x) {
            csv_.add(there ? Cell(x) : Cell()).add(there ? Cell(file::hex(x)) : Cell());
        };
        exact(result.answers->hit[i] != 0 && !decides_, result.answers->t[i]);
        const bool true_hit = result.truth(i).is_hit();
        exact(true_hit,
              true_hit ? result.band->rounded_truth(i, binary64, row.form->info->direction, result.convention) : 0);
        for (std::size_t m = 0; m < metrics_.size(); ++m) {
            const double value = result.metrics[m][i];
            const auto categories = metrics_[m]->categories;
            csv_.add(std::isnan(value)    ? Cell()
                     : categories.empty() ? Cell(value)
                                          : Cell(categories[static_cast<std::size_t>(value)]));
        }
        csv_.end_row();
    }
}

}  // namespace lostbits::output::judge
