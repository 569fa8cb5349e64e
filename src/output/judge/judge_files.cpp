#include "output/judge/judge_files.hpp"

#include <fmt/format.h>

#include <optional>

#include "measure/judge/worst_rays.hpp"
#include "output/blame/explain_command.hpp"
#include "output/judge/ray_rows.hpp"
#include "output/map/map_files.hpp"
#include "output/map/row_names.hpp"
#include "output/sweep/worst_files.hpp"

namespace lostbits::output::judge {

using measure::answer::Outcome;
using measure::evaluate::TestedForm;
using measure::judge::JudgeRequest;
using measure::judge::JudgeSink;
using measure::judge::NotedRay;
using measure::judge::WorstRays;
using scene::dump::Chunk;
using scene::dump::Dump;

namespace {

/// What a map asks of its scene: a name, a size, and the shapes of its solids.
scene::file::Scene scene_of(const JudgeRequest& request, const Dump& dump, const JudgeFilesOptions& options) {
    scene::file::Scene scene;
    scene.id = options.id;
    scene.title = options.title;
    scene.width = request.picture ? request.picture->first : 1;
    scene.height = request.picture ? request.picture->second : 1;
    if (dump.layout().solid()) scene.listed.emplace_back(*dump.layout().solid());
    for (const Solid<double>& solid : request.solids) scene.listed.emplace_back(solid.shape);
    return scene;
}

/// What the name of a ray is to `lostbits explain`; nothing of a ray whose solids are too many to be named.
std::string name_of(const measure::evaluate::WorstRay& ray) { return blame::name_of_ray(ray.given.get()); }

std::string case_name(const TestedForm& row, const NotedRay& ray) {
    const std::string what = ray.outcome == Outcome::agree_hit
                                 ? fmt::format("{:.6g} ulp", ray.ulps)
                                 : std::string(measure::answer::outcome_names[static_cast<std::size_t>(ray.outcome)]);
    return fmt::format("{} in {}: ray {}, {}", row.form->info->name, row.format.name, ray.place, what);
}

/// The files of one row.
class RowParts final : public JudgeSink {
public:
    RowParts(const TestedForm& row, WorstRays worst, measure::evaluate::EvaluationSink& map)
        : row_(row), worst_(std::move(worst)), map_(map) {}
    void open_rows(const std::filesystem::path& path, const Dump& dump, const JudgeRequest& request) {
        rows_.emplace(path, ray_table(dump, request.metrics, request.is_of_file(row_) && dump.layout().decides_only()));
    }
    void piece(const Chunk& chunk, const measure::evaluate::BandResult& result) override {
        worst_.look_at(chunk.first, result);
        if (rows_) rows_->add(chunk, result, row_);
        map_.band(result);
    }
    [[nodiscard]] WorstRays& worst() { return worst_; }
    [[nodiscard]] std::optional<RayRows>& rows() { return rows_; }
    void close() {
        if (rows_) rows_->close();
    }

private:
    const TestedForm& row_;
    WorstRays worst_;
    measure::evaluate::EvaluationSink& map_;
    std::optional<RayRows> rows_;
};

}  // namespace

struct JudgeFiles::Parts {
    const JudgeRequest& request;
    JudgeFilesOptions options;
    scene::file::Scene scene;
    measure::evaluate::EvaluationRequest map_request = {};
    std::optional<map::MapFiles> map = {};
    std::optional<file::AtomicFile> worst = {};
    std::vector<std::unique_ptr<RowParts>> rows = {};

    /// Of a shard: the map's piece of a row takes with it the lines of the row's table.
    [[nodiscard]] map::KeepPiece keep_of_map() {
        if (!options.keep) return {};
        return [this](std::size_t row, map::MapPiece&& piece) {
            if (rows.at(row)->rows()) piece.lines = rows[row]->rows()->take_lines();
            options.keep(row, std::move(piece));
        };
    }
};

JudgeFiles::JudgeFiles(const JudgeRequest& request, const Dump& dump, JudgeFilesOptions given) {
    parts_.reset(new Parts{.request = request, .options = std::move(given), .scene = {}});
    Parts& p = *parts_;
    p.scene = scene_of(request, dump, p.options);
    p.map_request = {.scene = &p.scene, .rows = request.rows, .metrics = request.metrics};
    std::vector<file::DataResource> tables;
    const auto table_of = [](const TestedForm& row) { return map::row_name(row) + ".csv"; };
    if (p.options.rows) {
        for (const TestedForm& row : request.rows)
            tables.push_back({table_of(row),
                              fmt::format("One row per ray: {} in {}", row.form->info->name, row.format.name),
                              ray_table(dump, request.metrics).columns()});
    }
    p.map.emplace(p.map_request, map::MapFilesOptions{.folder = p.options.folder,
                                                      .drawn = p.options.drawn,
                                                      .singles = p.options.singles,
                                                      .named = "",
                                                      .also = tables,
                                                      .name_of_ray = name_of,
                                                      .listed = !request.picture,
                                                      .keep = p.keep_of_map(),
                                                      .by = request.by ? dump.layout().kept()[*request.by] : ""});
    if (p.options.worst > 0 && !p.options.keep) p.worst.emplace(p.options.folder / "worst.toml");
    const std::size_t ulps = measure::metric::place_of(request.metrics, "ulp_error");
    const auto sinks = p.map->sinks();
    for (std::size_t r = 0; r < request.rows.size(); ++r) {
        p.rows.push_back(std::make_unique<RowParts>(request.rows[r], WorstRays(p.options.worst, ulps), *sinks[r]));
        if (p.options.rows)
            p.rows.back()->open_rows(
                p.options.keep ? std::filesystem::path() : p.options.folder / table_of(request.rows[r]), dump, request);
    }
}

JudgeFiles::~JudgeFiles() = default;

std::vector<JudgeSink*> JudgeFiles::sinks() {
    std::vector<JudgeSink*> sinks;
    for (const auto& row : parts_->rows) sinks.push_back(row.get());
    return sinks;
}

void JudgeFiles::put(std::size_t row, map::MapPiece&& piece) {
    if (auto& rows = parts_->rows.at(row)->rows()) rows->add_lines(piece.lines);
    piece.lines.clear();
    parts_->map->put(row, std::move(piece));
}

std::vector<WorstRays> JudgeFiles::worst() const {
    std::vector<WorstRays> all;
    for (const auto& row : parts_->rows) all.push_back(row->worst());
    return all;
}

void JudgeFiles::append(std::vector<WorstRays>&& after) {
    for (std::size_t r = 0; r < parts_->rows.size(); ++r) parts_->rows[r]->worst().append(std::move(after.at(r)));
}

bool JudgeFiles::finish(const measure::judge::JudgeResult& result) {
    Parts& p = *parts_;
    std::string cases;
    for (std::size_t r = 0; r < p.rows.size(); ++r) {
        for (const NotedRay& ray : p.rows[r]->worst().all()) {
            if (ray.given) cases += sweep::case_text(case_name(p.request.rows[r], ray), *ray.given);
        }
        p.rows[r]->close();
    }
    const bool any = p.worst && !cases.empty();
    if (any) {
        p.worst->write(sweep::head_of_cases("The worst rays of " + p.options.title, p.options.command) + cases);
        p.worst->commit();
    }
    // That of an earlier run is about other answers.
    std::error_code ignored;
    if (!any) std::filesystem::remove(p.options.folder / "worst.toml", ignored);
    p.map->finish(result.summaries, result.groups);
    return any;
}

}  // namespace lostbits::output::judge
