#include "report_parts.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "measure/sweep/cases.hpp"
#include "measure/map/culprit_order.hpp"
#include "output/sweep/case_files.hpp"
#include "output/page/grid_data.hpp"
#include "output/page/picture.hpp"
#include "output/page/sweep_data.hpp"
#include "output/page/text.hpp"
#include "output/map/scene_sheet.hpp"
#include "output/sweep/sweep_planes.hpp"
#include "output/sweep/sweep_plots.hpp"
#include "output/speed/trade_files.hpp"
#include "output/speed/trade_plot.hpp"
#include "scene/sweep/case_file.hpp"
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

std::vector<std::string> names_of(const std::vector<const Metric*>& metrics) {
    std::vector<std::string> names;
    for (const Metric* m : metrics) names.emplace_back(m->name);
    return names;
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
    page::SweepPart part{.kind = page::SweepPart::Kind::cases, .id = file.id, .title = file.title, .note = file.note, .source = file.source, .rows = keys_of(work.rows)};
    for (std::size_t i = 0; i < file.size(); ++i) part.cases.push_back(file.name(i));
    part.json = page::case_json(request, cases);
    for (const auto& judged : file.conventions) {
        const std::string alt = judged ? fmt::format("{}, by the {} solid", file.title, convention_name(judged)) : file.title;
        part.pictures.push_back(page::picture(alt, [&](const auto& to) { output::write_case_matrix(to, request, cases, judged); }));
    }
    return part;
}

/// Of every format, small: they stand where the plots cannot.
std::vector<page::Picture> line_pictures(const SweepRequest& request, const std::vector<SweepStep>& steps, const std::vector<Onset>& onsets) {
    constexpr output::PlotSize size{820, 470};
    auto& backend = output::image_backend();
    std::vector<Format> formats;
    for (const MapRow& row : request.rows) {
        if (std::ranges::find(formats, row.format) == formats.end()) formats.push_back(row.format);
    }
    std::vector<page::Picture> pictures;
    for (const Format& format : formats) {
        const std::string what = fmt::format("{}, {}", request.sweep->title, format.name);
        pictures.push_back(page::picture("99th percentile of lost bits: " + what, [&](const auto& to) { output::write_lost_bits_plot(backend, to, request, steps, onsets, format, 0.99, size); }));
        pictures.push_back(page::picture("Share of wrong answers: " + what, [&](const auto& to) { output::write_wrong_plot(backend, to, request, steps, onsets, format, size); }));
    }
    return pictures;
}

page::SweepPart axes_part(const SweepWork& work, const Advance& advance) {
    const scene::SweepFile sweep(work.path, work.data);
    SweepRequest request{.sweep = &sweep, .rows = work.rows, .metrics = measured({find_metric("inherent_bits"), find_metric("excess_bits")}, work.rows)};
    for (MapRow& row : request.rows) row.judged = sweep.convention;
    request.progress = [&advance](std::uint64_t) { advance(0); };
    const auto steps = run_sweep(request);
    page::SweepPart part{.kind = page::SweepPart::Kind::line, .id = sweep.id, .title = sweep.title, .note = sweep.note, .source = sweep.source, .rows = keys_of(work.rows)};
    if (sweep.axes.size() == 2) {
        const output::Plane plane(request, steps);
        part.kind = page::SweepPart::Kind::plane;
        part.axes = {plane.x, plane.y};
        part.json = page::plane_json(request, steps);
        for (std::size_t r = 0; r < request.rows.size(); ++r) {
            const std::string alt = fmt::format("{}: {} in {}", sweep.title, request.rows[r].form->info->name, request.rows[r].format.name);
            part.pictures.push_back(page::picture(alt, [&](const auto& to) { output::write_plane_picture(output::image_backend(), to, request, steps, r); }));
        }
        return part;
    }
    const auto onsets = find_onsets(request, steps);
    part.axes = {sweep.axes.front().values};
    part.json = page::sweep_json(request, steps, onsets);
    part.table = page::onset_table(request, onsets);
    part.pictures = line_pictures(request, steps, onsets);
    return part;
}

}  // namespace

page::MapPart map_part(MapWork& work, const Advance& advance) {
    const scene::Scene& scene = work.scene;
    MapRequest request{.scene = &scene, .rows = work.rows, .metrics = work.metrics};
    order_culprits(request);
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
            {fmt::format("{}: lost bits of every form and format", scene.title), page::bytes_of(file)}, work.own_size, names_of(work.metrics)};
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
