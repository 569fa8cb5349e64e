// Writes the files of judged rays.
#include "output/judge/judge_files.hpp"

#include <fmt/format.h>

#include <optional>

#include "measure/evaluate/map.hpp"
#include "measure/judge/worst_rays.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/map_files.hpp"
#include "output/map/row_names.hpp"
#include "output/sweep/worst_files.hpp"

namespace lostbits::output::judge {

using file::Cell;
using measure::evaluate::TestedForm;
using measure::judge::JudgeRequest;
using measure::judge::ReportedRay;
using scene::dump::Chunk;
using scene::dump::Dump;
using table::Table;
namespace slot = scene::dump::slot;

namespace {

/// The scene that a map needs: a name, a size, the shapes of the primitives, and the mesh if there is one.
scene::file::Scene scene_of(const JudgeRequest& request, const Dump& dump, const JudgeFilesOptions& options) {
    scene::file::Scene scene;
    scene.id = options.id;
    scene.title = options.title;
    scene.width = request.picture ? request.picture->first : 1;
    scene.height = request.picture ? request.picture->second : 1;
    if (dump.layout().primitive()) scene.listed.emplace_back(*dump.layout().primitive());
    for (const Primitive<double>& primitive : request.primitives) scene.listed.emplace_back(primitive.shape);
    if (request.mesh) scene.mesh = {request.mesh, &request.mesh->mesh()};
    return scene;
}

/// Arguments of `lostbits explain` that name a ray; empty if its primitives are too many to be named.
std::string ray_arguments(const measure::evaluate::WorstRay& ray) {
    return attribution::explain_ray_arguments(ray.given.get());
}

std::string case_name(const TestedForm& form_row, const ReportedRay& ray) {
    const std::string error_text =
        ray.outcome == measure::answer::Outcome::agree_hit
            ? fmt::format("{:.6g} ulp", ray.ulps)
            : std::string(measure::answer::outcome_names[static_cast<std::size_t>(ray.outcome)]);
    return fmt::format("{} in {}: ray {}, {}", form_row.form->info->name, form_row.format.name, ray.ray_index,
                       error_text);
}

/// A ray in a chunk of the file.
struct JudgedRay {
    const scene::dump::Chunk* chunk;
    map::BandRay band_ray;
};

bool has_hit(const JudgedRay& r) { return !r.chunk->hit.empty() && r.chunk->hit[r.band_ray.i] != 0; }

/// Columns with the file's data on a ray and its primitive.
Table<JudgedRay> given_columns(const Dump& dump) {
    using R = JudgedRay;
    const scene::dump::Layout& layout = dump.layout();
    Table<R> table{
        {"ray", "index of the ray in the file, from 0", [](const R& r) { return r.chunk->first + r.band_ray.i; }}};
    // Numbers of files of floats are written as short as floats allow.
    const bool is_f32 = dump.format().engine == Format::Engine::native32;
    const auto number = [is_f32](double x) { return is_f32 ? Cell(static_cast<float>(x)) : Cell(x); };
    const auto add = [&](std::size_t s, const char* type, const char* meaning, table::CellOf<R> value) {
        if (layout.has(s))
            table.add(
                {{std::string(scene::dump::name_of_slot(s, layout.primitive())), type, "", meaning}, std::move(value)});
    };
    const auto add_number = [&](std::size_t s, const char* meaning, const auto& value) {
        add(s, "number", meaning, [=](const R& r) { return number(value(*r.chunk, r.band_ray.i)); });
    };
    for (int k = 0; k < 6; ++k)
        add_number(slot::origin + static_cast<std::size_t>(k), "number of the ray, as it was judged",
                   [k](const Chunk& c, std::size_t i) {
                       const Ray<double> ray = c.rays[i];
                       return k < 3 ? ray.origin[k] : ray.direction[k - 3];
                   });
    add_number(slot::tmin, "beginning of the ray's range",
               [](const Chunk& c, std::size_t i) { return c.rays.tmin[i]; });
    add_number(slot::tmax, "end of the ray's range", [](const Chunk& c, std::size_t i) { return c.rays.tmax[i]; });
    for (std::size_t s = slot::primitive; s < slot::t; ++s)
        add_number(s, "number of the ray's primitive, as it was judged",
                   [k = s - slot::primitive](const Chunk& c, std::size_t i) { return c.primitives[i].used()[k]; });
    for (std::size_t s = slot::matrix; s < slot::count; ++s)
        add_number(s, "number of the primitive's matrix, as it was judged",
                   [k = s - slot::matrix](const Chunk& c, std::size_t i) { return c.primitives[i].placed->matrix[k]; });
    add(slot::hit, "boolean", "true if the file has a hit for this ray", has_hit);
    add(slot::t, "number", "the file's answer; missing if it has no hit",
        [number](const R& r) { return has_hit(r) ? number(r.chunk->t[r.band_ray.i]) : Cell(); });
    return table;
}

/// Columns of the table of one series. `has_no_t`: its answers are only hit or miss.
Table<JudgedRay> ray_table(const Dump& dump, const std::vector<const measure::metric::Metric*>& metrics,
                           bool has_no_t = false) {
    using Found = map::BandRay;
    Table<Found> answer_columns{map::outcome_column()};
    answer_columns.add_exact({"answer", "t", "the answer that was judged, in its own unit",
                              [has_no_t](const Found& r) { return table::when(r.hit() && !has_no_t, r.t()); }});
    answer_columns.add(map::found_columns(metrics));
    Table<JudgedRay> table = given_columns(dump);
    const std::size_t kept_count = dump.layout().kept().size();
    for (std::size_t k = 0; k < kept_count; ++k) {
        std::string name = file::without_formula(dump.layout().kept()[k]);  // a column may have the name of a formula
        while (name.empty() || table.find(name) || answer_columns.find(name)) name = "file_" + name;
        table.add({name, "this column of the file, unchanged",
                   [k, kept_count](const JudgedRay& r) { return r.chunk->kept[r.band_ray.i * kept_count + k]; }});
    }
    return table.add(answer_columns, &JudgedRay::band_ray);
}

/// Files of one series.
class RowParts {
public:
    RowParts(const TestedForm& form_row, WorstRays worst) : row_(form_row), worst_(std::move(worst)) {}
    void open_rows(const std::filesystem::path& folder, const Dump& dump, const JudgeRequest& request) {
        rows_.emplace(folder, map::row_name(row_) + ".csv",
                      fmt::format("One row per ray: {} in {}", row_.form->info->name, row_.format.name),
                      ray_table(dump, request.metrics, request.is_file_row(row_) && dump.layout().decides_only()));
    }
    void send_to(measure::evaluate::Show map) { map_ = std::move(map); }
    void piece(const Chunk& chunk, const measure::evaluate::BandResult& result) {
        worst_.add_rays(chunk.first, result);
        for (std::size_t i = 0; rows_ && i < chunk.size(); ++i) rows_->add({&chunk, {&result, i, &row_}});
        map_(result);
    }
    [[nodiscard]] WorstRays& worst() { return worst_; }
    [[nodiscard]] std::optional<table::TableFile<JudgedRay>>& rows() { return rows_; }
    void close() {
        if (rows_) rows_->close();
    }

private:
    const TestedForm& row_;
    WorstRays worst_;
    measure::evaluate::Show map_ = {};
    std::optional<table::TableFile<JudgedRay>> rows_;
};

}  // namespace

struct JudgeFiles::Parts {
    const JudgeRequest& request;
    JudgeFilesOptions options;
    scene::file::Scene scene;
    measure::evaluate::MapStudy map_request = {};
    std::optional<map::MapFiles> map = {};
    std::optional<file::AtomicFile> worst = {};
    std::vector<std::unique_ptr<RowParts>> rows = {};

    /// For a shard: adds the lines of the series' table to the map's piece of the series.
    [[nodiscard]] pixel::KeepPiece keep_of_map() {
        if (!options.keep) return {};
        return [this](std::size_t row_index, pixel::Piece&& piece) {
            if (rows.at(row_index)->rows()) piece.lines = rows[row_index]->rows()->take_lines();
            options.keep(row_index, std::move(piece));
        };
    }
};

JudgeFiles::JudgeFiles(const JudgeRequest& request, const Dump& dump, JudgeFilesOptions options) {
    parts_.reset(new Parts{.request = request, .options = std::move(options), .scene = {}});
    Parts& p = *parts_;
    p.scene = scene_of(request, dump, p.options);
    p.map_request = {.scene = &p.scene, .rows = request.rows, .metrics = request.metrics};
    const std::size_t ulps = measure::metric::index_of(request.metrics, "ulp_error");
    std::vector<file::DataResource> tables;
    for (const TestedForm& form_row : request.rows) {
        p.rows.push_back(std::make_unique<RowParts>(form_row, WorstRays(p.options.worst, ulps)));
        if (!p.options.rows) continue;
        p.rows.back()->open_rows(p.options.keep ? "" : p.options.folder, dump, request);
        tables.push_back(p.rows.back()->rows()->about());
    }
    p.map.emplace(p.map_request,
                  map::MapFilesOptions{.folder = p.options.folder,
                                       .drawn_metrics = p.options.drawn_metrics,
                                       .single_pictures = p.options.single_pictures,
                                       .scene_arguments = "",
                                       .other_tables = tables,
                                       .ray_arguments = ray_arguments,
                                       .is_list = !request.picture,
                                       .keep = p.keep_of_map(),
                                       .by = request.group_column ? dump.layout().kept()[*request.group_column] : ""});
    if (p.options.worst > 0 && !p.options.keep) p.worst.emplace(p.options.folder / "worst.toml");
    for (std::size_t r = 0; r < p.rows.size(); ++r)
        p.rows[r]->send_to([show = p.map->show(), r](const measure::evaluate::BandResult& band) { show(r, band); });
}

JudgeFiles::~JudgeFiles() = default;

void JudgeFiles::piece(std::size_t row_index, const Chunk& chunk, const measure::evaluate::BandResult& result) {
    parts_->rows[row_index]->piece(chunk, result);
}

void JudgeFiles::put(std::size_t row_index, pixel::Piece&& piece) {
    if (auto& rows = parts_->rows.at(row_index)->rows()) rows->add_lines(piece.lines);
    piece.lines.clear();
    parts_->map->put(row_index, std::move(piece));
}

std::vector<WorstRays> JudgeFiles::worst() const {
    std::vector<WorstRays> worst_rays;
    for (const auto& row : parts_->rows) worst_rays.push_back(row->worst());
    return worst_rays;
}

void JudgeFiles::append(std::vector<WorstRays>&& later_rays) {
    for (std::size_t r = 0; r < parts_->rows.size(); ++r) parts_->rows[r]->worst().append(std::move(later_rays.at(r)));
}

bool JudgeFiles::finish(const measure::judge::JudgeResult& result) {
    Parts& p = *parts_;
    std::string cases;
    for (std::size_t r = 0; r < p.rows.size(); ++r) {
        for (const ReportedRay& ray : p.rows[r]->worst().all()) {
            if (ray.ray_group) cases += sweep::case_text(case_name(p.request.rows[r], ray), *ray.ray_group);
        }
        p.rows[r]->close();
    }
    const bool has_cases = p.worst && !cases.empty();
    if (has_cases) {
        p.worst->write(sweep::head_of_cases("The worst rays of " + p.options.title, p.options.command) + cases);
        p.worst->commit();
    }
    // A worst.toml of an earlier run is about other answers.
    std::error_code ignored;
    if (!has_cases) std::filesystem::remove(p.options.folder / "worst.toml", ignored);
    p.map->finish(result.summaries, result.groups);
    return has_cases;
}

}  // namespace lostbits::output::judge
