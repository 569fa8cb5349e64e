// Writes the files of judged rays.
#include "output/judge/judge_files.hpp"

#include <fmt/format.h>

#include <optional>

#include "measure/evaluate/map.hpp"
#include "measure/judge/worst_rays.hpp"
#include "output/attribution/explain_command.hpp"
#include "output/map/form_names.hpp"
#include "output/map/map_files.hpp"
#include "output/sweep/worst_files.hpp"

namespace lostbits::output::judge {

using file::Cell;
using measure::evaluate::TestedForm;
using measure::judge::JudgeRequest;
using measure::judge::ReportedRay;
using scene::ray_file::Chunk;
using scene::ray_file::RayFile;
using table::Table;
namespace slot = scene::ray_file::slot;

namespace {

/// Makes the scene that a map needs: a name, a size, the shapes of the primitives, and the mesh if there is one.
scene::file::Scene make_scene(const JudgeRequest& request, const RayFile& ray_file, const JudgeWriterOptions& options) {
    scene::file::Scene scene;
    scene.id = options.id;
    scene.title = options.title;
    scene.width = request.picture ? request.picture->first : 1;
    scene.height = request.picture ? request.picture->second : 1;
    if (ray_file.layout().primitive_shape()) scene.listed.emplace_back(*ray_file.layout().primitive_shape());
    for (const Primitive<double>& primitive : request.primitives) scene.listed.emplace_back(primitive.shape);
    if (request.mesh) scene.mesh = {request.mesh, &request.mesh->mesh()};
    return scene;
}

/// Arguments of `lostbits explain` that name a ray; empty if its primitives are too many to be named.
std::string ray_arguments(const measure::evaluate::WorstRay& ray) {
    return attribution::explain_ray_arguments(ray.given.get());
}

std::string case_name(const TestedForm& tested_form, const ReportedRay& ray) {
    const std::string error_text =
        ray.outcome == measure::answer::Outcome::agree_hit
            ? fmt::format("{:.6g} ulp", ray.ulps)
            : std::string(measure::answer::outcome_names[static_cast<std::size_t>(ray.outcome)]);
    return fmt::format("{} in {}: ray {}, {}", tested_form.form->info->name, tested_form.format.name, ray.ray_index,
                       error_text);
}

/// A ray in a chunk (consecutive rays) of the file, and its answer.
struct JudgedRay {
    const scene::ray_file::Chunk* chunk;
    map::BandRay band_ray;
};

bool has_file_hit(const JudgedRay& judged_ray) {
    return !judged_ray.chunk->hit.empty() && judged_ray.chunk->hit[judged_ray.band_ray.i] != 0;
}

/// Columns with the numbers that the file has for a ray and its primitive.
Table<JudgedRay> make_file_columns(const RayFile& ray_file) {
    using R = JudgedRay;
    const scene::ray_file::Layout& layout = ray_file.layout();
    Table<R> table{
        {"ray", "index of the ray in the file, from 0", [](const R& r) { return r.chunk->first + r.band_ray.i; }}};

    // Numbers of a file of floats are written with only the digits that a float needs.
    const bool is_f32 = ray_file.format().engine == Format::Engine::native32;
    const auto number = [is_f32](double x) { return is_f32 ? Cell(static_cast<float>(x)) : Cell(x); };
    const auto add = [&](std::size_t s, const char* type, const char* meaning, table::CellOf<R> value) {
        if (layout.has(s))
            table.add({{std::string(scene::ray_file::name_of_slot(s, layout.primitive_shape())), type, "", meaning},
                       std::move(value)});
    };
    const auto add_number = [&](std::size_t s, const char* meaning, const auto& value) {
        add(s, "number", meaning, [=](const R& r) { return number(value(*r.chunk, r.band_ray.i)); });
    };

    // The ray and its range.
    for (int k = 0; k < 6; ++k)
        add_number(slot::origin + static_cast<std::size_t>(k), "number of the ray, as it was judged",
                   [k](const Chunk& chunk, std::size_t i) {
                       const Ray<double> ray = chunk.rays[i];
                       return k < 3 ? ray.origin[k] : ray.direction[k - 3];
                   });
    add_number(slot::tmin, "beginning of the ray's range",
               [](const Chunk& chunk, std::size_t i) { return chunk.rays.tmin[i]; });
    add_number(slot::tmax, "end of the ray's range",
               [](const Chunk& chunk, std::size_t i) { return chunk.rays.tmax[i]; });

    // The primitive and its matrix.
    for (std::size_t s = slot::primitive; s < slot::t; ++s)
        add_number(s, "number of the ray's primitive, as it was judged",
                   [k = s - slot::primitive](const Chunk& chunk, std::size_t i) {
                       return chunk.primitives[i].shape_numbers()[k];
                   });
    for (std::size_t s = slot::matrix; s < slot::count; ++s)
        add_number(s, "number of the primitive's matrix, as it was judged",
                   [k = s - slot::matrix](const Chunk& chunk, std::size_t i) {
                       return chunk.primitives[i].transform->matrix[k];
                   });

    // The answer.
    add(slot::hit, "boolean", "true if the file has a hit for this ray", has_file_hit);
    add(slot::t, "number", "the file's answer; missing if it has no hit",
        [number](const R& r) { return has_file_hit(r) ? number(r.chunk->t[r.band_ray.i]) : Cell(); });
    return table;
}

/// Columns of the table of one tested form (a form in a format). If `has_no_t`, its answers are only hit or miss.
Table<JudgedRay> make_ray_table(const RayFile& ray_file, const std::vector<const measure::metric::Metric*>& metrics,
                                bool has_no_t = false) {
    using AnswerRay = map::BandRay;
    Table<AnswerRay> answer_columns{map::outcome_column()};
    answer_columns.add_exact({"answer", "t", "the answer that was judged, in its own unit",
                              [has_no_t](const AnswerRay& r) { return table::when(r.has_hit() && !has_no_t, r.t()); }});
    answer_columns.add(map::make_truth_and_metric_columns(metrics));

    // Columns that the file holds beside rays and answers get names that no other column has.
    Table<JudgedRay> table = make_file_columns(ray_file);
    const std::size_t kept_count = ray_file.layout().kept_columns().size();
    for (std::size_t k = 0; k < kept_count; ++k) {
        std::string name =
            file::escape_formula(ray_file.layout().kept_columns()[k]);  // a column may have the name of a formula
        while (name.empty() || table.find(name) || answer_columns.find(name)) name = "file_" + name;
        table.add({name, "this column of the file, unchanged", [k, kept_count](const JudgedRay& judged_ray) {
                       return judged_ray.chunk->kept[judged_ray.band_ray.i * kept_count + k];
                   }});
    }
    return table.add(answer_columns, &JudgedRay::band_ray);
}

/// Files of one tested form: its table of rays, its worst rays, and its part of the map.
class TestedFormWriter {
public:
    TestedFormWriter(const TestedForm& tested_form, WorstRays worst)
        : tested_form_(tested_form), worst_(std::move(worst)) {}
    void open_table(const std::filesystem::path& folder, const RayFile& ray_file, const JudgeRequest& request) {
        table_.emplace(
            folder, map::tested_form_name(tested_form_) + ".csv",
            fmt::format("One row per ray: {} in {}", tested_form_.form->info->name, tested_form_.format.name),
            make_ray_table(ray_file, request.metrics,
                           request.is_file_form(tested_form_) && ray_file.layout().has_only_decisions()));
    }
    /// Sets the function that receives each result for the map.
    void connect_map(measure::evaluate::Show show_on_map) { show_on_map_ = std::move(show_on_map); }
    void add_piece(const Chunk& chunk, const measure::evaluate::BandResult& result) {
        worst_.add_rays(chunk.first, result);
        for (std::size_t i = 0; table_ && i < chunk.size(); ++i) table_->add({&chunk, {&result, i, &tested_form_}});
        show_on_map_(result);
    }
    [[nodiscard]] WorstRays& worst() { return worst_; }
    [[nodiscard]] std::optional<table::TableFile<JudgedRay>>& table() { return table_; }
    void close() {
        if (table_) table_->close();
    }

private:
    const TestedForm& tested_form_;
    WorstRays worst_;
    measure::evaluate::Show show_on_map_ = {};
    std::optional<table::TableFile<JudgedRay>> table_;
};

}  // namespace

struct JudgeWriter::Parts {
    const JudgeRequest& request;
    JudgeWriterOptions options;
    scene::file::Scene scene;
    measure::evaluate::MapStudy map_request = {};
    std::optional<map::MapWriter> map = {};
    std::optional<file::AtomicFile> worst_file = {};
    std::vector<std::unique_ptr<TestedFormWriter>> form_writers = {};

    /// For a shard: adds the lines of the tested form's table to the map's piece of the tested form.
    [[nodiscard]] pixel::PieceReceiver keep_map_piece() {
        if (!options.keep_piece) return {};
        return [this](std::size_t form_index, pixel::Piece&& piece) {
            if (form_writers.at(form_index)->table()) piece.lines = form_writers[form_index]->table()->take_lines();
            options.keep_piece(form_index, std::move(piece));
        };
    }
};

JudgeWriter::JudgeWriter(const JudgeRequest& request, const RayFile& ray_file, JudgeWriterOptions options) {
    parts_.reset(new Parts{.request = request, .options = std::move(options), .scene = {}});
    Parts& p = *parts_;
    p.scene = make_scene(request, ray_file, p.options);
    p.map_request = {.scene = &p.scene, .tested_forms = request.tested_forms, .metrics = request.metrics};
    const std::size_t ulp_error_index = measure::metric::index_of(request.metrics, "ulp_error");

    // The files of each tested form.
    std::vector<file::DataResource> tables;
    for (const TestedForm& tested_form : request.tested_forms) {
        p.form_writers.push_back(
            std::make_unique<TestedFormWriter>(tested_form, WorstRays(p.options.worst_count, ulp_error_index)));
        if (!p.options.writes_rows) continue;
        p.form_writers.back()->open_table(p.options.keep_piece ? "" : p.options.folder, ray_file, request);
        tables.push_back(p.form_writers.back()->table()->about());
    }

    p.map.emplace(
        p.map_request,
        map::MapFilesOptions{
            .folder = p.options.folder,
            .drawn_metrics = p.options.drawn_metrics,
            .draws_single_pictures = p.options.draws_single_pictures,
            .scene_arguments = "",
            .other_tables = tables,
            .ray_arguments = ray_arguments,
            .is_list = !request.picture,
            .keep_piece = p.keep_map_piece(),
            .group_column = request.group_column ? ray_file.layout().kept_columns()[*request.group_column] : ""});
    if (p.options.worst_count > 0 && !p.options.keep_piece) p.worst_file.emplace(p.options.folder / "worst.toml");

    for (std::size_t r = 0; r < p.form_writers.size(); ++r)
        p.form_writers[r]->connect_map(
            [show = p.map->show(), r](const measure::evaluate::BandResult& band) { show(r, band); });
}

JudgeWriter::~JudgeWriter() = default;

void JudgeWriter::add_piece(std::size_t form_index, const Chunk& chunk, const measure::evaluate::BandResult& result) {
    parts_->form_writers[form_index]->add_piece(chunk, result);
}

void JudgeWriter::put(std::size_t form_index, pixel::Piece&& piece) {
    if (auto& table = parts_->form_writers.at(form_index)->table()) table->add_lines(piece.lines);
    piece.lines.clear();
    parts_->map->put(form_index, std::move(piece));
}

std::vector<WorstRays> JudgeWriter::worst() const {
    std::vector<WorstRays> worst_rays;
    for (const auto& form_writers : parts_->form_writers) worst_rays.push_back(form_writers->worst());
    return worst_rays;
}

void JudgeWriter::append(std::vector<WorstRays>&& later_rays) {
    for (std::size_t r = 0; r < parts_->form_writers.size(); ++r)
        parts_->form_writers[r]->worst().append(std::move(later_rays.at(r)));
}

bool JudgeWriter::finish(const measure::judge::JudgeResult& result) {
    Parts& p = *parts_;
    std::string cases;
    for (std::size_t r = 0; r < p.form_writers.size(); ++r) {
        for (const ReportedRay& ray : p.form_writers[r]->worst().all()) {
            if (ray.ray_group) cases += sweep::case_text(case_name(p.request.tested_forms[r], ray), *ray.ray_group);
        }
        p.form_writers[r]->close();
    }

    const bool has_cases = p.worst_file && !cases.empty();
    if (has_cases) {
        p.worst_file->write(sweep::case_file_head("The worst rays of " + p.options.title, p.options.command) + cases);
        p.worst_file->commit();
    }
    // A worst.toml of an earlier run is about other answers.
    std::error_code ignored;
    if (!has_cases) std::filesystem::remove(p.options.folder / "worst.toml", ignored);
    p.map->finish(result.summaries, result.groups);
    return has_cases;
}

}  // namespace lostbits::output::judge
