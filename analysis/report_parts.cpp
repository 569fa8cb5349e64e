#include "report_parts.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "measure/cases.hpp"
#include "output/case_files.hpp"
#include "output/report/picture.hpp"
#include "output/report/sweep_data.hpp"
#include "output/report/text.hpp"
#include "output/scene_sheet.hpp"
#include "output/sweep_planes.hpp"
#include "output/sweep_plots.hpp"
#include "output/trade_files.hpp"
#include "output/trade_plot.hpp"
#include "scene/case_file.hpp"
#include "select.hpp"

namespace lostbits::analysis {
namespace {

namespace page = output::report;

/// Serves two readers of one row.
class Both final : public MapSink {
public:
    Both(MapSink* a, MapSink* b) : a_(a), b_(b) {}
    void band(const BandResult& result) override {
        a_->band(result);
        b_->band(result);
    }

private:
    MapSink *a_, *b_;
};

std::vector<std::string> keys_of(const std::vector<MapRow>& rows) {
    std::vector<std::string> keys;
    for (const MapRow& row : rows) keys.push_back(page::row_key(row));
    return keys;
}

page::SweepPart case_part(const SweepWork& work) {
    const scene::CaseFile file(work.path);
    CaseRequest request{.file = &file, .rows = {}, .metrics = measured({find_metric("inherent_bits"), find_metric("excess_bits")}, work.rows)};
    for (MapRow row : work.rows) {
        for (const auto& judged : file.conventions) {
            row.judged = judged;
            request.rows.push_back(row);
        }
    }
    const auto cases = run_cases(request);
    page::SweepPart part{file.id, file.title, file.note, file.source, keys_of(work.rows), {}, {}, {}};
    for (const auto& judged : file.conventions) {
        const std::string alt = judged ? fmt::format("{}, by the {} solid", file.title, convention_name(judged)) : file.title;
        part.pictures.push_back(page::picture(alt, [&](const auto& to) { output::write_case_matrix(to, request, cases, judged); }));
    }
    return part;
}

/// Of the first format alone: they stand where the plots, which have all, cannot.
std::vector<page::Picture> line_pictures(const SweepRequest& request, const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets) {
    auto& backend = output::image_backend();
    const Format& format = request.rows.front().format;
    const std::string what = fmt::format("{}, {}", request.sweep->title, format.name);
    return {page::picture("99th percentile of lost bits: " + what, [&](const auto& to) { output::write_lost_bits_plot(backend, to, request, steps, onsets, format, 0.99); }),
            page::picture("Share of wrong answers: " + what, [&](const auto& to) { output::write_wrong_plot(backend, to, request, steps, onsets, format); })};
}

page::SweepPart axes_part(const SweepWork& work, const Advance& advance) {
    const scene::SweepFile sweep(work.path, work.data);
    SweepRequest request{.sweep = &sweep, .rows = work.rows, .metrics = measured({find_metric("inherent_bits"), find_metric("excess_bits")}, work.rows)};
    for (MapRow& row : request.rows) row.judged = sweep.convention;
    request.progress = [&advance](std::uint64_t) { advance(0); };
    const auto steps = run_sweep(request);
    page::SweepPart part{sweep.id, sweep.title, sweep.note, sweep.source, keys_of(work.rows), {}, {}, {}};
    if (sweep.axes.size() == 2) {
        for (std::size_t r = 0; r < request.rows.size(); ++r) {
            const std::string alt = fmt::format("{}: {} in {}", sweep.title, request.rows[r].form->info->name, request.rows[r].format.name);
            part.pictures.push_back(page::picture(alt, [&](const auto& to) { output::write_plane_picture(output::image_backend(), to, request, steps, r); }));
        }
        return part;
    }
    const auto onsets = find_onsets(request, steps);
    part.json = page::sweep_json(request, steps, onsets);
    part.table = page::onset_table(request, onsets);
    part.pictures = line_pictures(request, steps, onsets);
    return part;
}

}  // namespace

page::MapPart map_part(MapWork& work, const Advance& advance) {
    const scene::Scene& scene = work.scene;
    MapRequest request{.scene = &scene, .rows = work.rows, .metrics = work.metrics};
    request.progress = advance;
    const page::TemporaryFolder folder;
    const auto file = folder.path() / "contact.png";
    output::SceneSheet sheet(request, file);
    page::MapData data(request);
    std::vector<std::unique_ptr<Both>> both;
    std::vector<MapSink*> sinks;
    const auto drawn = sheet.sinks(), kept = data.sinks();
    for (std::size_t r = 0; r < drawn.size(); ++r) sinks.push_back(both.emplace_back(std::make_unique<Both>(drawn[r], kept[r])).get());
    const auto summaries = run_map(request, sinks);
    sheet.finish(summaries);
    work.unresolved = summaries.front().count(Outcome::unresolved);
    return {scene.id, scene.title, scene.note, scene.source, keys_of(work.rows), data.index(summaries, work.own_size), data.blobs(), page::summary_table(request, summaries),
            {fmt::format("{}: lost bits of every form and format", scene.title), page::bytes_of(file)}, work.own_size};
}

page::SweepPart sweep_part(const SweepWork& work, const Advance& advance) {
    auto part = scene::sweep_kind(work.path) == scene::SweepKind::cases ? case_part(work) : axes_part(work, advance);
    advance(1);
    return part;
}

page::TradePart trade_part(Shape shape, const std::vector<MapRow>& rows, const Advance& advance) {
    TradeRequest request{.shape = shape, .kernels = trade_kernels(rows), .metrics = {find_metric("lost_bits"), find_metric("excess_bits")}, .loads = trade_loads(cache_sizes()), .plan = {}};
    request.plan.repetitions = 5;  // as `lostbits trade --quick`
    request.plan.least_seconds = 1e-4;
    request.plan.progress = [&advance](std::uint64_t) { advance(0); };
    const TradeResult result = run_trade(request);
    page::TradePart part{std::string(shape_names[static_cast<std::size_t>(shape)]), page::trade_json(request, result), output::trade_in_words(request, result), {}};
    const auto sets = ray_sets(shape);
    for (std::size_t s = 0; s < sets.size(); ++s) {
        part.pictures.push_back(page::picture(fmt::format("Time against kept bits: {}", sets[s].title), [&](const auto& to) { output::write_trade_plot(to, request, result, s); }));
    }
    advance(1);
    return part;
}

}  // namespace lostbits::analysis
